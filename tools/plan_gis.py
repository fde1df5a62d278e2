"""A floor as GeoPackage and as shapefiles, for the tests."""

from __future__ import annotations

import contextlib
import sqlite3
import struct
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import shapely

from palms import FloorPlan, SegmentClass

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
            lines = [
                shapely.LineString(plan.origin.to_lonlat(each)) for each in plan.of_class(kind)
            ]
            _table(database, table, [(None, line) for line in lines])
        rooms = [
            (room.name, shapely.Polygon(plan.origin.to_lonlat(room.polygon_m)))
            for room in plan.rooms
        ]
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


def write_shapefiles(plan: FloorPlan, path: Path) -> None:
    """Write an archive of shapefiles, in UTM metres."""
    import pyproj

    system = f"EPSG:{32600 + int((plan.origin.lon_deg + 180) / 6) + 1}"
    to_utm = pyproj.Transformer.from_crs("EPSG:4326", system, always_xy=True).transform
    projection = pyproj.CRS(system).to_wkt("WKT1_ESRI").encode()

    def placed(points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        return np.column_stack(to_utm(*plan.origin.to_lonlat(np.asarray(points)).T))

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
    whole = np.concatenate([*shapes, np.zeros((int(not shapes), 2))])
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
