"""Write the sample building's floor in every format of floor plans, for the tests.

Run it after a change of the sample or of a writer: ``python tools/make_plan_files.py``. It
rewrites ``tests/io/data/plans``; ``--out FOLDER`` writes elsewhere. The same bytes every time.
"""

from __future__ import annotations

import argparse
import io
import json
import math
import zipfile
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
from plan_gis import write_gpkg, write_shapefiles
from plan_model import write_ifc
from plan_sheets import write_pdf, write_svg

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
    write_ifc(plan, folder / "floor.ifc")
    write_shapefiles(plan, folder / "floor-shapes.zip")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=DATA)
    write_all(parser.parse_args().out)
