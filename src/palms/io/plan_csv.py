"""Floor plans as CSV: rows ``x1,y1,x2,y2[,class]`` in metres.

A first line whose first cell is no number is a header. Beside ``hall.csv`` the file
``hall.rooms.geojson`` may hold what a row cannot: named rooms, outline and level, as a
FeatureCollection of polygons in the same metres.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import FormatError, PalmsWarning
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geodesy import Origin
from palms.geometry import FloatArray
from palms.io.files import head, read_json, read_text, remove_stale, sniff, write_json, write_text
from palms.io.registry import Format
from palms.io.values import StrPath, brief, check_array, locating, parse_number

__all__ = ["FORMAT", "plan_name", "read_plan_csv", "rooms_path", "write_plan_csv"]

_CLASSES = {"": SegmentClass.WALL, **{c.name.lower(): c for c in SegmentClass}}
_SECOND_SUFFIXES = {".geojson", ".json", ".csv", ".svg", ".dxf", ".ifc", ".osm", ".png", ".imdf"}
_EXPECTED = "a floor plan: rows x1,y1,x2,y2[,class] in metres"
_FIX = "check that it is the plan's CSV file"


def plan_name(path: StrPath) -> str:
    """Return what to call the plan of a file: its stem, without a second suffix.

    Examples
    --------
    >>> plan_name("maps/Baskin_New.Engineering.geojson.csv")
    'Baskin_New.Engineering'
    """
    stem = Path(path).stem
    second = Path(stem).suffix.lower()
    return stem[: -len(second)] if second in _SECOND_SUFFIXES and stem != second else stem


def rooms_path(path: StrPath) -> Path:
    """Return the file beside a plan that holds its rooms.

    Examples
    --------
    >>> rooms_path("maps/hall.csv").name
    'hall.rooms.geojson'
    """
    return Path(path).with_suffix(".rooms.geojson")


def _cells(line: str) -> list[str]:
    """Cells of a line; semicolons (with decimal commas) and tabs separate, too."""
    if ";" in line:
        cells = line.replace(",", ".").split(";")
    elif "," in line:
        cells = line.split(",")
    else:
        cells = line.split("\t")
    cells = [cell.strip() for cell in cells]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield number and cells of each line that is neither blank nor the header."""
    first = True
    for number, line in enumerate(re.split(r"\r\n|\r|\n", text), start=1):
        if not line.strip():
            continue
        cells = _cells(line)
        header = first and (not cells or parse_number(cells[0]) is None)
        first = False
        if cells and not header:
            yield number, cells


def _parse_row(cells: list[str]) -> tuple[list[float], str] | str:
    """Return coordinates and class word of a row, or what is wrong with it."""
    if not 4 <= len(cells) <= 5:
        return f"{len(cells)} cell{'s' * (len(cells) != 1)}: {brief(','.join(cells))}"
    values: list[float] = []
    for cell in cells[:4]:
        value = parse_number(cell)
        if value is None or not np.isfinite(value):
            return brief(cell)
        values.append(value)
    return values, cells[4].strip("\"' ").lower() if len(cells) == 5 else ""


def _parse(text: str, path: StrPath) -> tuple[FloatArray, list[str]]:
    rows, words = [], []
    kind = sniff(text[:1000].encode())
    looks = "" if kind == "text" else f", in what looks like {kind}"
    for number, cells in _rows(text):
        parsed = _parse_row(cells)
        if isinstance(parsed, str):
            raise FormatError(
                f"{path} line {number}",
                expected="x1,y1,x2,y2[,class] with 4 finite numbers",
                got=parsed + looks,
                fix="mend or remove that line" if not looks else _FIX,
            )
        rows.append(parsed[0])
        words.append(parsed[1])
    if not rows:
        raise FormatError(
            str(path), expected=_EXPECTED, got=f"no row with numbers{looks}", fix=_FIX
        )
    return np.array(rows, dtype=np.float64).reshape(-1, 2, 2), words


def _classes_of(words: list[str], path: StrPath) -> list[SegmentClass]:
    unknown = sorted(set(words) - set(_CLASSES))
    if unknown:
        shown = ", ".join(brief(word) for word in unknown[:5]) + ", ..." * (len(unknown) > 5)
        warnings.warn(
            f"{path}: fifth column: expected wall, door, opening or glass, got {shown} in "
            f"{sum(word in unknown for word in words)} rows; they count as walls",
            PalmsWarning,
            stacklevel=3,
        )
    return [_CLASSES.get(word, SegmentClass.WALL) for word in words]


def read_plan_csv(path: StrPath, *, scale: float = 1.0) -> FloorPlan:
    r"""Read a floor plan from CSV, with the rooms beside it.

    Parameters
    ----------
    path : path
        The CSV file. ``<stem>.rooms.geojson`` beside it is read, too.
    scale : float
        Metres of one unit of the rows, as 0.001 for millimetres.

    Raises
    ------
    InputError
        When it cannot be read; the message names file and line.

    Warns
    -----
    PalmsWarning
        Once for class words that are not known, once for segments without a length.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/hall.csv", "x1,y1,x2,y2\n0,0,8,0\n8,0,8,5,door\n")
    ...     plan = read_plan_csv(f"{folder}/hall.csv")
    >>> plan.name, plan.classes.tolist()
    ('hall', [0, 1])
    """
    segments, words = _parse(read_text(path, _EXPECTED), path)
    segments = segments * scale
    classes = np.array(_classes_of(words, path), dtype=np.uint8)
    has_length = (segments[:, 0] != segments[:, 1]).any(axis=1)
    if not has_length.all():
        warnings.warn(
            f"{path}: {np.sum(~has_length)} of {len(segments)} segments have no length "
            "and are left out",
            PalmsWarning,
            stacklevel=2,
        )
    sidecar = rooms_path(path)
    extras = _read_sidecar(sidecar) if sidecar.is_file() else {}
    with locating(path):
        return FloorPlan(segments[has_length], classes[has_length], name=plan_name(path), **extras)


def _read_sidecar(path: Path) -> dict[str, Any]:
    """Rooms, outline and level, as keyword arguments of FloorPlan."""
    collection = read_json(path, "a GeoJSON FeatureCollection of rooms")
    features = collection.get("features") if isinstance(collection, dict) else None
    if not isinstance(features, list):
        raise FormatError(
            str(path),
            expected="a GeoJSON FeatureCollection of rooms",
            got=brief(collection),
            fix="mend it, or remove it when the plan shall have no rooms",
        )
    rooms, found = [], {}
    for index, feature in enumerate(features):
        ring, properties = _ring(feature, f"{path} feature {index}")
        if ring is None:
            continue
        if properties.get("kind") == "outline":
            found["outline_m"] = ring
        elif properties.get("name") is not None:
            with locating(path):
                rooms.append(Room(str(properties["name"]), ring))
    level = collection.get("level")
    return {
        **found,
        "rooms": tuple(rooms),
        "level": None if level is None else str(level),
        "origin": _origin(collection.get("origin"), path),
    }


def _origin(value: object, path: Path) -> Origin | None:
    if value is None:
        return None
    lon, lat = check_array(value, f"{path}, origin", (2,)).tolist()
    with locating(path):
        return Origin(lon, lat)


def _ring(feature: object, what: str) -> tuple[FloatArray | None, dict[str, Any]]:
    """Outer ring, not closed, and properties of a polygon; None for other geometries."""
    if not isinstance(feature, dict):
        raise FormatError(what, expected="a GeoJSON Feature", got=brief(feature))
    geometry, properties = feature.get("geometry"), feature.get("properties")
    if not isinstance(geometry, dict) or geometry.get("type") != "Polygon":
        return None, {}
    rings = geometry.get("coordinates")
    if not isinstance(rings, list) or not rings:
        raise FormatError(what, expected="a polygon with a ring of points", got=brief(rings))
    ring = check_array(rings[0], f"{what}, outer ring", (None, 2))
    if len(ring) > 1 and (ring[0] == ring[-1]).all():
        ring = ring[:-1]
    return ring, properties if isinstance(properties, dict) else {}


def _feature(ring: FloatArray, **properties: str) -> dict[str, Any]:
    points = ring.tolist()
    geometry = {"type": "Polygon", "coordinates": [[*points, points[0]]]}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def write_plan_csv(plan: FloorPlan, path: StrPath) -> None:
    """Write a floor plan as CSV; rooms, outline and level go into a file beside it.

    Parameters
    ----------
    plan : FloorPlan
        The plan. Its name is that of the file.
    path : path
        The CSV file; its folder must exist. A file of rooms beside it that belonged to
        what was there before is replaced, or removed when this plan has none.

    Raises
    ------
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_plan_csv(FloorPlan([[[0, 0], [8, 0]]]), f"{folder}/hall.csv")
    ...     print(read_text(f"{folder}/hall.csv"), end="")
    x1,y1,x2,y2
    0.0,0.0,8.0,0.0
    """
    rows = [",".join(map(repr, row)) for row in plan.segments_m.reshape(-1, 4).tolist()]
    header = "x1,y1,x2,y2"
    if plan.classes.any():
        words = [SegmentClass(c).name.lower() for c in plan.classes.tolist()]
        rows = [f"{row},{word}" for row, word in zip(rows, words, strict=True)]
        header += ",class"
    write_text(path, "\n".join([header, *rows]) + "\n")
    features = [_feature(room.polygon_m, name=room.name) for room in plan.rooms]
    if plan.outline_m is not None and len(plan.outline_m):
        features.append(_feature(plan.outline_m, kind="outline"))
    if not features and plan.level is None and plan.origin is None:
        remove_stale(rooms_path(path))
        return
    known: dict[str, Any] = {} if plan.level is None else {"level": plan.level}
    if plan.origin is not None:
        known["origin"] = [plan.origin.lon_deg, plan.origin.lat_deg]
    write_json(rooms_path(path), {"type": "FeatureCollection", **known, "features": features})


def _recognizes(path: Path) -> bool:
    """Whether one of the first rows holds four numbers."""
    start = head(path)
    if sniff(start) not in ("text", "JSON"):
        return False
    text = start.decode("utf-8-sig", "replace").rpartition("\n")[0] or start.decode(
        "utf-8-sig", "replace"
    )
    for count, (_, cells) in enumerate(_rows(text)):
        if not isinstance(_parse_row(cells), str):
            return True
        if count >= 4:
            break
    return False


FORMAT = Format(
    name="csv",
    description="rows x1,y1,x2,y2[,class] in metres, rooms beside it",
    suffixes=(".csv",),
    recognizes=_recognizes,
    read=read_plan_csv,
    write=write_plan_csv,
)
