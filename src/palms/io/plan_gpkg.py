"""Floor plans from GeoPackage: tables of walls, doors and rooms in one file of SQLite."""

from __future__ import annotations

import contextlib
import os
import sqlite3
import struct
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import FormatError
from palms.floorplan import FloorPlan
from palms.io.files import MAX_BYTES, head, read_bytes, sniff
from palms.io.geojson import Feature
from palms.io.plan_layers import Choice, Layer, plan_of_layers
from palms.io.registry import Format
from palms.io.values import StrPath, brief, check_array

__all__ = ["FORMAT", "read_plan_gpkg"]

_EXPECTED = "a GeoPackage with tables of walls, doors or rooms"
_MAGIC = b"SQLite format 3\x00"
_ENVELOPES = {0: 0, 1: 32, 2: 48, 3: 48, 4: 64}  # bytes, by the flags of a geometry
_MAX_FEATURES = 500_000  # ours
_MAX_STEPS = 500  # ours: of 100,000 instructions each: reading 500,000 features takes 100
_DEPTH = 8  # ours: of geometry collections in each other


def read_plan_gpkg(  # noqa: PLR0913
    path: StrPath,
    *,
    layers: str | None = None,
    where: str | None = None,
    level: str | None = None,
    class_property: str | None = None,
    classes: str | None = None,
    name_property: str | None = None,
    crs: str | None = None,
    scale: float = 1.0,
    origin: tuple[float, float] | None = None,
) -> FloorPlan:
    """Read a floor plan from a GeoPackage.

    Parameters
    ----------
    path : path
    layers : str, optional
        Tables to take, as ``walls,doors``; all of them when left out.
    where : str, optional
        Takes the features of which an attribute has a value, as ``building:B2``.
    level : str, optional
        Of the features that have an attribute level, floor or storey, those to take.
    class_property : str, optional
        Attribute that names the class; found among class, type, kind, category and others when
        left out, and else the layer's name tells.
    classes : str, optional
        Words of your own, as ``muro:wall,vidrio:glass``.
    name_property : str, optional
        Attribute that names a room; name, ref, room, label or number when left out.
    crs : str, optional
        The coordinate system where the file does not say or says it wrong, as ``EPSG:25832``;
        ``local`` for plain metres.
    scale : float
        Metres of one unit, where coordinates are local.
    origin : (float, float), optional
        Longitude and latitude that become (0, 0); the middle of the file when left out.

    Raises
    ------
    InputError
        When it cannot be read, holds several levels and none is named, or no wall.
    """
    choice = Choice(
        layers, where, level, class_property, classes, name_property, crs, scale, origin
    )
    return plan_of_layers(_layers(path), choice, path)


def _layers(path: StrPath) -> list[Layer]:
    if not os.path.isfile(path) or os.path.getsize(path) > MAX_BYTES:
        read_bytes(path)  # which says what is wrong
    start = head(path)
    if not start.startswith(_MAGIC):
        raise FormatError(
            str(path), expected=_EXPECTED, got=sniff(start) if start else "an empty file",
            fix="check that it is the right file",
        )  # fmt: skip
    start += bytes(max(0, 100 - len(start)))
    size, pages = struct.unpack_from(">H", start, 16)[0], struct.unpack_from(">I", start, 28)[0]
    whole = (65_536 if size == 1 else size) * pages
    if os.path.getsize(path) < whole:
        raise FormatError(
            str(path), expected=f"{whole} bytes, as it says", got=f"{os.path.getsize(path)}",
            fix="it may be cut off; download or export it again",
        )  # fmt: skip
    uri = f"{Path(path).resolve().as_uri()}?mode=ro&immutable=1"
    try:
        with contextlib.closing(sqlite3.connect(uri, uri=True)) as database:
            _guard(database)
            return [_layer(database, table, str(path)) for table in _tables(database, str(path))]
    except sqlite3.Error as error:
        raise FormatError(
            str(path), expected="a whole GeoPackage", got=brief(str(error), 60),
            fix="it may be damaged; export it again",
        ) from None  # fmt: skip


def _guard(database: sqlite3.Connection) -> None:
    """Keep a file of strangers from running long, eating memory or calling functions."""
    steps = iter(range(_MAX_STEPS))
    database.set_progress_handler(lambda: next(steps, None) is None, 100_000)
    database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_BYTES // 4)
    database.execute("PRAGMA trusted_schema = OFF")
    database.execute("PRAGMA query_only = ON")
    database.text_factory = lambda content: content.decode("utf-8", "replace")


def _tables(database: sqlite3.Connection, what: str) -> list[tuple[str, str, str]]:
    """Return table, column of geometry, and coordinate system of each layer."""
    try:
        rows = database.execute(
            "SELECT g.table_name, g.column_name, g.srs_id FROM gpkg_geometry_columns AS g "
            "JOIN gpkg_contents AS c ON c.table_name = g.table_name WHERE c.data_type = 'features'"
        ).fetchmany(1000)
        systems = {
            srs: (str(organization), code, definition)
            for srs, organization, code, definition in database.execute(
                "SELECT srs_id, organization, organization_coordsys_id, definition "
                "FROM gpkg_spatial_ref_sys"
            ).fetchmany(10_000)
        }
    except sqlite3.OperationalError as error:
        if "no such" not in str(error):
            raise
        raise FormatError(what, expected=_EXPECTED, got=brief(str(error), 60)) from None
    return [
        (str(table), str(column), _system(srs, systems.get(srs))) for table, column, srs in rows
    ]


def _system(srs_id: object, known: tuple[str, Any, Any] | None) -> str:
    if srs_id == -1:
        return "local"
    if srs_id == 0 or known is None:
        return ""
    organization, code, definition = known
    named = organization.upper() in ("EPSG", "ESRI", "OGC") and isinstance(code, int)
    return f"{organization.upper()}:{code}" if named else str(definition or "")


def _layer(database: sqlite3.Connection, table: tuple[str, str, str], what: str) -> Layer:
    name, column, system = table
    quoted = '"' + name.replace('"', '""') + '"'
    cursor = database.execute(f"SELECT * FROM {quoted} LIMIT {_MAX_FEATURES + 1}")
    keys = [each[0] for each in cursor.description]
    features = []
    for number, row in enumerate(cursor):
        if number >= _MAX_FEATURES:
            raise FormatError(
                what, expected=f"at most {_MAX_FEATURES:,} features", got="more",
                fix="export the building alone",
            )  # fmt: skip
        values = dict(zip(keys, row, strict=True))
        feature = _feature(values.pop(column, None), values, f"{what}, {name} row {number + 1}")
        if feature is not None:
            features.append(feature)
    return Layer(name, features, system)


def _feature(blob: object, values: Mapping[str, Any], what: str) -> Feature | None:
    """Return a row as a feature; None when it has no geometry."""
    import shapely

    if blob is None:
        return None
    if not isinstance(blob, bytes) or len(blob) < 8 or blob[:2] != b"GP":
        raise FormatError(what, expected="a GeoPackage geometry", got=brief(blob))
    envelope = _ENVELOPES.get(blob[3] >> 1 & 7)
    if envelope is None:
        raise FormatError(what, expected="a GeoPackage geometry", got=f"flags {blob[3]}")
    try:
        with np.errstate(all="ignore"):
            geometry = shapely.from_wkb(blob[8 + envelope :])
    except (shapely.errors.ShapelyError, ValueError, NotImplementedError) as error:
        raise FormatError(
            what, expected="a whole line or area of straight edges", got=brief(str(error), 60),
            fix="turn curves into lines, or export it again",
        ) from None  # fmt: skip
    known = {key: value for key, value in values.items() if not isinstance(value, bytes)}
    lines, rings = [], []
    for part in _parts([geometry], _DEPTH):
        if part.geom_type == "Polygon":
            rings += [part.exterior, *part.interiors]
        elif part.geom_type in ("LineString", "LinearRing"):
            lines.append(part)
    found = [
        tuple(check_array(shapely.get_coordinates(each), what, (None, 2)) for each in every)
        for every in (lines, rings)
    ]
    return Feature(found[0], found[1], known)


def _parts(geometries: Sequence[Any], depth: int) -> Iterator[Any]:
    import shapely

    for each in geometries:
        if each is None or each.is_empty:
            continue
        if hasattr(each, "geoms"):
            if depth:
                yield from _parts(shapely.get_parts(each), depth - 1)
        else:
            yield each


def _recognizes(path: Path) -> bool:
    start = head(path)
    kind = start[68:72] in (b"GPKG", b"GP10", b"GP11")
    return start.startswith(_MAGIC) and (kind or b"gpkg_contents" in start)


FORMAT = Format(
    name="gpkg",
    description="GeoPackage: tables of walls, doors, rooms",
    suffixes=(".gpkg",),
    recognizes=_recognizes,
    read=read_plan_gpkg,
    extra="gis",
)
