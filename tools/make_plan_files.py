"""Write the sample building's floor in every format of floor plans, for the tests.

Run it after a change of the sample or of a writer: ``python tools/make_plan_files.py``. It
rewrites ``tests/io/data/plans``; ``--out FOLDER`` writes elsewhere. The same bytes every time.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import math
import sqlite3
import struct
import zipfile
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely
from PIL import Image, ImageDraw

from palms import FloorPlan, Origin, SegmentClass, read_floorplan
from palms.io import write_floorplan
from palms.sample import sample_folder

DATA = Path(__file__).resolve().parents[1] / "tests" / "io" / "data" / "plans"
ORIGIN = Origin(-122.0632, 36.9996)
SCALE_M = 0.05  # metres per pixel of the picture
MARGIN_M = 1.0
WALL_PX = 4


def sample_plan() -> FloorPlan:
    """Return the floor that all files hold."""
    plan = read_floorplan(sample_folder() / "maps" / "sample.csv")
    return replace(plan, origin=ORIGIN, name="floor")


def write_imdf(plan: FloorPlan, path: Path) -> None:
    """Write rooms as units and doors as openings; IMDF has no walls."""
    level = {"id": "level-2", "properties": {"name": {"en": "Second floor"}, "ordinal": 1,
             "short_name": {"en": "2"}, "building_ids": ["b"]}}  # fmt: skip
    level["geometry"] = {"type": "Polygon", "coordinates": [_ring(_outline(plan))]}
    building = {"id": "b", "properties": {"name": {"en": "floor"}}, "geometry": None}
    units = [_unit(f"unit-{i}", room.name, room.polygon_m) for i, room in enumerate(plan.rooms)]
    openings = [
        {"id": f"opening-{i}", "geometry": {"type": "LineString", "coordinates": _earth(line)},
         "properties": {"category": "pedestrian", "level_id": "level-2",
                        "door": {"type": "swinging" if kind == SegmentClass.DOOR else "open"}}}
        for i, (line, kind) in enumerate(zip(plan.segments_m, plan.classes, strict=True))
        if kind in (SegmentClass.DOOR, SegmentClass.OPENING)
    ]  # fmt: skip
    found = {"level": [level], "building": [building], "unit": units, "opening": openings}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for kind, features in found.items():
            whole = [{"type": "Feature", "feature_type": kind, **each} for each in features]
            text = json.dumps({"type": "FeatureCollection", "features": whole})
            archive.writestr(zipfile.ZipInfo(f"{kind}.geojson", (2024, 1, 1, 0, 0, 0)), text)


def _outline(plan: FloorPlan) -> npt.NDArray[np.float64]:
    """Outline (N, 2) of all rooms together."""
    covered = shapely.union_all([shapely.Polygon(room.polygon_m) for room in plan.rooms])
    floor = covered.buffer(0.1, join_style="mitre").buffer(-0.1, join_style="mitre")
    return np.asarray(shapely.get_coordinates(floor.exterior)[:-1])


def _unit(name: str, title: str, ring: npt.ArrayLike) -> dict[str, Any]:
    category = "walkway" if "orridor" in title else "room"
    return {
        "id": name,
        "geometry": {"type": "Polygon", "coordinates": [_ring(ring)]},
        "properties": {"category": category, "name": {"en": title}, "level_id": "level-2"},
    }


def _earth(points: npt.ArrayLike) -> list[list[float]]:
    return ORIGIN.to_lonlat(np.asarray(points)).round(9).tolist()  # type: ignore[no-any-return]


def _ring(points: npt.ArrayLike) -> list[list[float]]:
    ring = _earth(points)
    return [*ring, ring[0]]


def write_osm(plan: FloorPlan, path: Path) -> None:
    """Write rooms as areas of Simple Indoor Tagging, doors as nodes on their outlines."""
    nodes: dict[tuple[float, float], str] = {}
    doors = [(segment.mean(axis=0), _door_tags(segment, kind))
             for segment, kind in zip(plan.segments_m, plan.classes, strict=True)
             if kind in (SegmentClass.DOOR, SegmentClass.OPENING)]  # fmt: skip
    ways = [_way(1000, _refs(_outline(plan), nodes, doors), building="yes", name="floor")]
    level = {"indoor": "level", "level": "1", "ref": "2", "name": "Second floor"}
    ways.append(_way(1001, _refs(_outline(plan), nodes, doors), **level))
    for i, room in enumerate(plan.rooms):
        kind = "corridor" if "orridor" in room.name else "room"
        tags = {"indoor": kind, "level": "1", "name": room.name}
        ways.append(_way(1002 + i, _refs(room.polygon_m, nodes, doors), **tags))
    lines = ["<?xml version='1.0' encoding='UTF-8'?>", "<osm version='0.6' generator='palms'>"]
    lines += [f" <node id='{i + 1}' {place}" for i, place in enumerate(nodes.values())]
    path.write_text("\n".join([*lines, *ways, "</osm>\n"]))


def _door_tags(segment: npt.NDArray[np.float64], kind: int) -> str:
    door = "hinged" if kind == SegmentClass.DOOR else "no"
    return f"<tag k='door' v='{door}'/><tag k='width' v='{math.dist(*segment):.3f}'/>"


def _refs(ring: npt.ArrayLike, nodes: dict[Any, str], doors: list[Any]) -> list[int]:
    """Return the nodes of a ring, those of the doors on it too."""
    refs, points = [], np.asarray(ring)
    for a, b in zip(points, np.roll(points, -1, axis=0), strict=True):
        edge = shapely.LineString([a, b])
        on = [(math.dist(a, at), at, tags) for at, tags in doors
              if edge.distance(shapely.Point(at)) < 0.01]  # fmt: skip
        for _, at, tags in [(0.0, a, ""), *sorted(on, key=lambda each: each[0])]:
            key = tuple(np.round(at, 3).tolist())
            lon, lat = _earth(at)
            end = f">{tags}</node>" if tags else "/>"
            nodes.setdefault(key, f"lat='{lat:.9f}' lon='{lon:.9f}'{end}")
            refs.append(list(nodes).index(key) + 1)
    return [*refs, refs[0]]


def _way(number: int, refs: list[int], **tags: str) -> str:
    inside = [f"  <nd ref='{ref}'/>" for ref in refs]
    inside += [f"  <tag k='{key}' v='{value}'/>" for key, value in tags.items()]
    return "\n".join([f" <way id='{number}'>", *inside, " </way>"])


SVG_CLASSES = {
    SegmentClass.WALL: "Walls", SegmentClass.GLASS: "Glass", SegmentClass.OPENING: "Openings"
}  # fmt: skip


def write_svg(plan: FloorPlan, path: Path) -> None:
    """Write shapes in centimetres in groups, as Inkscape's layers; y down from the lower left."""
    width, height = np.ceil(plan.bounds_m[1] + MARGIN_M) * 100
    lines = [
        "<?xml version='1.0' encoding='UTF-8'?>",
        "<svg xmlns='http://www.w3.org/2000/svg' xmlns:inkscape='http://www.inkscape.org/namespaces"
        f"/inkscape' viewBox='0 0 {width:g} {height:g}'>",
        f" <g transform='translate(0 {height:g}) scale(1 -1)' fill='none' stroke='black'>",
    ]
    for kind, label in SVG_CLASSES.items():
        lines.append(f"  <g inkscape:label='{label}' stroke-width='8'>")
        for segment in plan.of_class(kind) * 100:
            (x0, y0), (x1, y1) = segment.round(2).tolist()
            lines.append(f"   <path d='M{x0:g} {y0:g}L{x1:g} {y1:g}'/>")
        lines.append("  </g>")
    lines.append("  <g inkscape:label='Doors'>")
    for segment in plan.of_class(SegmentClass.DOOR) * 100:
        (x0, y0), (x1, y1) = segment.round(2).tolist()
        leaf, radius = (x0 - (y1 - y0), y0 + (x1 - x0)), math.hypot(x1 - x0, y1 - y0)
        lines.append(f"   <path d='M{x0:g} {y0:g}L{leaf[0]:.2f} {leaf[1]:.2f}"
                     f"A{radius:.3f} {radius:.3f} 0 0 0 {x1:g} {y1:g}'/>")  # fmt: skip
    lines.append("  </g>\n  <g id='rooms' stroke='none'>")
    for room in plan.rooms:
        corners = " ".join(f"{x:g},{y:g}" for x, y in (room.polygon_m * 100).round(2).tolist())
        lines.append(f"   <polygon points='{corners}'><title>{room.name}</title></polygon>")
    path.write_text("\n".join([*lines, "  </g>", " </g>", "</svg>\n"]))


POINT_M = 0.0254 / 72 * 200  # metres of a point of the PDF, at 1:200
PDF_LAYERS = {
    SegmentClass.WALL: ("A-WALL", 1.5), SegmentClass.GLASS: ("A-GLAZ", 0.5),
    SegmentClass.OPENING: ("A-OPENING", 0.25), SegmentClass.DOOR: ("A-DOOR", 0.35),
}  # fmt: skip
_KAPPA = 4 / 3 * (math.sqrt(2) - 1)  # of the Bezier curve that is a quarter circle, nearly


def pdf_page(plan: FloorPlan, layers: bool = True) -> str:
    """Return the content of a page at 1:200, from its lower left corner."""
    lines = ["1 J"]
    for i, (kind, (_, width)) in enumerate(PDF_LAYERS.items()):
        lines.append(f"/OC /Layer{i} BDC\n{width:g} w" if layers else f"{width:g} w")
        for a, b in plan.of_class(kind) / POINT_M:
            if kind != SegmentClass.DOOR:
                lines.append(f"{_at(a)} m {_at(b)} l S")
                continue
            across = np.array([a[1] - b[1], b[0] - a[0]])
            leaf, bend = a + across, (b - a) * _KAPPA
            lines.append(f"{_at(a)} m {_at(leaf)} l S")
            lines.append(
                f"{_at(leaf)} m {_at(leaf + bend)} {_at(b + across * _KAPPA)} {_at(b)} c S"
            )
        lines += ["EMC"] if layers else []
    for room in plan.rooms:
        at = room.polygon_m.mean(axis=0) / POINT_M
        lines.append(f"BT /F1 5 Tf {_at(at)} Td ({room.name}) Tj ET")
    return "\n".join(lines)


def _at(point: npt.NDArray[np.float64]) -> str:
    return f"{point[0]:.3f} {point[1]:.3f}"


def write_pdf(plan: FloorPlan, path: Path, layers: bool = True) -> None:
    """Write a sheet of vector drawing, with or without layers."""
    size = np.ceil((plan.bounds_m[1] + MARGIN_M) / POINT_M)
    content = zlib.compress(pdf_page(plan, layers).encode(), 9)
    numbers = [f"{8 + i} 0 R" for i in range(len(PDF_LAYERS))]
    properties = " ".join(f"/Layer{i} {number}" for i, number in enumerate(numbers))
    optional = f"<< /OCGs [{' '.join(numbers)}] /D << >> >>"
    objects = [
        f"<< /Type /Catalog /Pages 2 0 R /OCProperties {optional} >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        f"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {size[0]:g} {size[1]:g}] /Contents 4 0 R "
        f"/Resources << /Font << /F1 5 0 R >> /Properties << {properties} >> >> >>",
        f"<< /Length {len(content)} /Filter /FlateDecode >>",
        "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
        "<< /Title (floor) >>",
        "<< >>",
        *(f"<< /Type /OCG /Name ({name}) >>" for name, _ in PDF_LAYERS.values()),
    ]
    path.write_bytes(pdf_file(objects, {4: content}))


def pdf_file(objects: list[str], streams: dict[int, bytes]) -> bytes:
    """Return a PDF of numbered objects, the catalogue first."""
    out, places = b"%PDF-1.5\n", []
    for number, text in enumerate(objects, start=1):
        places.append(len(out))
        stream = streams.get(number)
        inside = b"" if stream is None else b"\nstream\n" + stream + b"\nendstream"
        out += f"{number} 0 obj\n{text}".encode() + inside + b"\nendobj\n"
    table = "".join(f"{place:010d} 00000 n \n" for place in places)
    head = f"xref\n0 {len(objects) + 1}\n0000000000 65535 f \n{table}"
    trailer = f"trailer\n<< /Size {len(objects) + 1} /Root 1 0 R >>\nstartxref\n{len(out)}\n%%EOF\n"
    return out + (head + trailer).encode()


TABLES = {
    "walls": SegmentClass.WALL, "doors": SegmentClass.DOOR,
    "openings": SegmentClass.OPENING, "windows": SegmentClass.GLASS,
}  # fmt: skip


WGS84 = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],'
    'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]]'
)


def write_gpkg(plan: FloorPlan, path: Path) -> None:
    """Write a table each of walls, doors, openings, windows and rooms, as lon/lat."""
    path.unlink(missing_ok=True)
    with contextlib.closing(sqlite3.connect(path)) as database:
        database.executescript(
            "PRAGMA application_id = 0x47504B47; PRAGMA user_version = 10300;"
            "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY,"
            " organization TEXT NOT NULL, organization_coordsys_id INTEGER NOT NULL, "
            "definition TEXT NOT NULL, description TEXT);"
            "CREATE TABLE gpkg_contents (table_name TEXT PRIMARY KEY, data_type TEXT NOT NULL, "
            "identifier TEXT UNIQUE, description TEXT DEFAULT '', last_change DATETIME NOT NULL, "
            "min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE, srs_id INTEGER);"
            "CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT "
            "NULL, geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, "
            "m TINYINT NOT NULL, PRIMARY KEY (table_name, column_name));"
        )
        systems = [("Undefined Cartesian", -1, "NONE", -1, "undefined"),
                   ("Undefined geographic", 0, "NONE", 0, "undefined"),
                   ("WGS 84", 4326, "EPSG", 4326, WGS84)]  # fmt: skip
        for system in systems:
            values = "(?, ?, ?, ?, ?, NULL)"
            database.execute(f"INSERT INTO gpkg_spatial_ref_sys VALUES {values}", system)
        for table, kind in TABLES.items():
            lines = [shapely.LineString(_earth(each)) for each in plan.of_class(kind)]
            _table(database, table, [(None, line) for line in lines])
        rooms = [(room.name, shapely.Polygon(_ring(room.polygon_m))) for room in plan.rooms]
        _table(database, "rooms", rooms)
        database.commit()


def _table(database: sqlite3.Connection, name: str, rows: list[tuple[str | None, Any]]) -> None:
    database.execute(f"CREATE TABLE {name} (fid INTEGER PRIMARY KEY, geom BLOB, name, level TEXT)")
    content = f"'{name}', 'features', '{name}', '', '2024-01-01T00:00:00Z', 0, 0, 0, 0, 4326"
    database.execute(f"INSERT INTO gpkg_contents VALUES ({content})")
    columns = f"('{name}', 'geom', 'GEOMETRY', 4326, 0, 0)"
    database.execute(f"INSERT INTO gpkg_geometry_columns VALUES {columns}")
    head = b"GP\x00\x01" + struct.pack("<i", 4326)
    for fid, (title, shape) in enumerate(rows, start=1):
        row = (fid, head + shapely.to_wkb(shape), title, "2")
        database.execute(f"INSERT INTO {name} VALUES (?, ?, ?, ?)", row)


UTM = "EPSG:32610"


def write_shapefiles(plan: FloorPlan, path: Path) -> None:
    """Write an archive of shapefiles, in UTM metres."""
    import pyproj

    to_utm = pyproj.Transformer.from_crs("EPSG:4326", UTM, always_xy=True).transform
    projection = pyproj.CRS(UTM).to_wkt("WKT1_ESRI").encode()

    def placed(points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        return np.column_stack(to_utm(*np.array(_earth(points)).T))

    layers = {table: [("", placed(each)) for each in plan.of_class(kind)]
              for table, kind in TABLES.items()}  # fmt: skip
    rings = [(room.name, placed([*room.polygon_m, room.polygon_m[0]])) for room in plan.rooms]
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, shapes in {**layers, "rooms": rings}.items():
            shp, shx = shp_file([s for _, s in shapes], 5 if name == "rooms" else 3)
            parts = {"shp": shp, "shx": shx,
                     "dbf": dbf_file([[title, "2"] for title, _ in shapes], ["NAME", "LEVEL"]),
                     "prj": projection, "cpg": b"UTF-8"}  # fmt: skip
            for suffix, content in parts.items():
                info = zipfile.ZipInfo(f"{name}.{suffix}", (2024, 1, 1, 0, 0, 0))
                archive.writestr(info, content, zipfile.ZIP_DEFLATED)


def shp_file(shapes: list[npt.NDArray[np.float64]], kind: int) -> tuple[bytes, bytes]:
    """Return a .shp file and its index; kind 3 has lines, 5 has areas."""
    body = index = b""
    for number, points in enumerate(shapes, start=1):
        box = np.concatenate([points.min(axis=0), points.max(axis=0)]).astype("<f8").tobytes()
        record = struct.pack("<i", kind) + box + struct.pack("<iii", 1, len(points), 0)
        record += points.astype("<f8").tobytes()
        index += struct.pack(">ii", (100 + len(body)) // 2, len(record) // 2)
        body += struct.pack(">ii", number, len(record) // 2) + record
    whole = np.concatenate(shapes)
    extent = [*whole.min(axis=0), *whole.max(axis=0), 0.0, 0.0, 0.0, 0.0]
    tail = struct.pack("<ii8d", 1000, kind, *extent)
    heads = [struct.pack(">7i", 9994, 0, 0, 0, 0, 0, (100 + len(each)) // 2) + tail
             for each in (body, index)]  # fmt: skip
    return heads[0] + body, heads[1] + index


def dbf_file(rows: list[list[str]], names: list[str], width: int = 40) -> bytes:
    """Return a .dbf file of columns of text."""
    fields = b"".join(
        name.encode().ljust(11, b"\x00") + b"C" + bytes(4) + bytes([width]) + bytes(15)
        for name in names
    )
    sizes = struct.pack("<IHH", len(rows), 33 + len(fields), 1 + width * len(names))
    body = b"".join(b" " + b"".join(v.encode().ljust(width) for v in row) for row in rows)
    return b"\x03" + bytes([124, 1, 1]) + sizes + bytes(20) + fields + b"\r" + body + b"\x1a"


def picture(plan: FloorPlan) -> Image.Image:
    """Return walls and glass as thick strokes, doors as thin ones and their swings, and names."""
    low, high = plan.bounds_m
    width, height = (int(v) for v in np.ceil((high - low + 2 * MARGIN_M) / SCALE_M))
    image = Image.new("L", (width, height), 255)
    draw = ImageDraw.Draw(image)

    def pixel(point: npt.ArrayLike) -> tuple[float, float]:
        x, y = (np.asarray(point) - low + MARGIN_M) / SCALE_M
        return float(x), float(height - y)

    for room in plan.rooms:
        draw.text(pixel(room.polygon_m.mean(axis=0)), room.name, fill=0, anchor="mm")
    for segment, kind in zip(plan.segments_m, plan.classes, strict=True):
        ends = [pixel(point) for point in segment]
        if SegmentClass(kind).blocks:
            draw.line(ends, fill=0, width=WALL_PX)
        elif kind == SegmentClass.DOOR:
            (x, y), radius = ends[0], math.dist(*ends)
            start = math.degrees(math.atan2(ends[1][1] - y, ends[1][0] - x))
            box = (x - radius, y - radius, x + radius, y + radius)
            draw.arc(box, start, start + 90, fill=0, width=1)
    return image


def write_image(plan: FloorPlan, path: Path) -> None:
    """Write the picture, in black and white."""
    buffer = io.BytesIO()
    picture(plan).convert("1").save(buffer, "PNG", optimize=True)
    path.write_bytes(buffer.getvalue())


def write_ros(plan: FloorPlan, path: Path) -> None:
    """Write a ROS map whose picture is a PNG, which is smaller."""
    write_floorplan(plan, path)
    text = path.read_text().replace(".pgm", ".png")
    pgm = path.with_suffix(".pgm")
    Image.open(pgm).save(path.with_suffix(".png"), optimize=True)
    pgm.unlink()
    path.write_text(text)


def write_dxf(plan: FloorPlan, path: Path) -> None:
    """Write lines in millimetres on layers, doors as a leaf with its swing."""
    layers = {SegmentClass.WALL: "A-WALL", SegmentClass.GLASS: "A-GLAZ",
              SegmentClass.OPENING: "A-OPENING"}  # fmt: skip
    pairs: list[tuple[int, Any]] = [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"),
             (9, "$INSUNITS"), (70, 4), (0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")]  # fmt: skip
    for segment, kind in zip(plan.segments_m * 1000, plan.classes, strict=True):
        (x0, y0), (x1, y1) = segment.round(1).tolist()
        if kind != SegmentClass.DOOR:
            pairs += _line(layers[SegmentClass(kind)], x0, y0, x1, y1)
            continue
        pairs += _line("A-DOOR", x0, y0, x0 - (y1 - y0), y0 + (x1 - x0))
        start = math.degrees(math.atan2(y1 - y0, x1 - x0)) % 360
        radius = math.hypot(x1 - x0, y1 - y0)
        pairs += [(0, "ARC"), (8, "A-DOOR"), (10, x0), (20, y0), (40, round(radius, 3)),
                  (50, round(start, 4)), (51, round((start + 90) % 360, 4))]  # fmt: skip
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    path.write_text("".join(f"{code}\n{value}\n" for code, value in pairs))


def _line(layer: str, x0: float, y0: float, x1: float, y1: float) -> list[tuple[int, Any]]:
    return [(0, "LINE"), (8, layer), (10, x0), (20, y0), (11, x1), (21, y1)]


def write_all(folder: Path) -> None:
    """Write the floor in every format."""
    folder.mkdir(parents=True, exist_ok=True)
    plan = sample_plan()
    write_floorplan(plan, folder / "floor.geojson")
    write_floorplan(replace(plan, origin=None), folder / "floor-metres.geojson")
    write_imdf(plan, folder / "floor.imdf.zip")
    write_image(plan, folder / "floor-picture.png")
    write_ros(plan, folder / "floor-map.yaml")
    write_dxf(plan, folder / "floor.dxf")
    write_osm(plan, folder / "floor.osm")
    write_svg(plan, folder / "floor.svg")
    write_pdf(plan, folder / "floor.pdf")
    write_gpkg(plan, folder / "floor.gpkg")
    write_shapefiles(plan, folder / "floor-shapes.zip")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=DATA)
    write_all(parser.parse_args().out)
