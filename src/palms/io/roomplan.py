"""Scans from Apple RoomPlan: the JSON of a CapturedRoom or a CapturedStructure."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from palms.errors import FormatError, InputError
from palms.extraction.scans import observation_point
from palms.geometry import FloatArray
from palms.io.files import read_json
from palms.io.plane_geometry import MAX_TILT, on_ground, read_matrices, read_vector, word_of
from palms.io.plane_json import has_keys
from palms.io.planes import session_of
from palms.io.point_clouds import parse_position
from palms.io.registry import Format
from palms.io.values import StrPath, brief, check_number, locating
from palms.scan import Scan

__all__ = ["FORMAT", "read_roomplan"]

_EXPECTED = "a RoomPlan room: an object with walls, each with transform and dimensions"
_ARC_STEP_RAD = np.deg2rad(10.0)  # ours: curved walls become chords of at most this
_BELONGS_M = 0.3  # ours: a door without a parent belongs to a wall this near
_PARALLEL = 0.94  # ours: cosine of 20 degrees
_MIN_PIECE_M = 0.1  # ours: what is left between two doors
_MOST = 5000  # ours: surfaces of one kind; a large house has 200
_CONFIDENCE = {"low": 0, "medium": 1, "high": 2}


class _Surface(NamedTuple):
    """A wall, door or opening: its line (K, 2) on the ground, its own and its wall's name."""

    line_m: FloatArray
    identifier: str | None
    parent: str | None


def read_roomplan(
    path: StrPath, *, doors: str = "cut", confidence: str = "low", position: object = None
) -> Scan:
    """Read the walls of a room that RoomPlan captured.

    Parameters
    ----------
    path : path
        The JSON that an app wrote with JSONEncoder.
    doors : {"cut", "keep"}
        Whether doors are cut out of the walls that run through them, as openings are.
    confidence : {"low", "medium", "high"}
        Walls below are left out.
    position : (x, y) or str, optional
        The observation point on the ground; the origin of the session when it lies among
        the walls, else their middle.

    Raises
    ------
    InputError
        When it cannot be read or holds no wall.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_json
    >>> wall = {"transform": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1.2, -2, 1],
    ...         "dimensions": [4, 2.4, 0], "category": {"wall": {}}, "identifier": "A"}
    >>> door = wall | {"dimensions": [1, 2, 0], "category": {"door": {"isOpen": False}},
    ...                "parentIdentifier": "A"}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/room.json", {"walls": [wall], "doors": [door]})
    ...     read_roomplan(f"{folder}/room.json", position=(0, 0)).walls_m.tolist()
    [[[-2.0, 2.0], [-0.5, 2.0]], [[0.5, 2.0], [2.0, 2.0]]]
    """
    if doors not in ("cut", "keep"):
        raise InputError("option doors", expected="cut or keep", got=repr(doors))
    if confidence not in _CONFIDENCE:
        raise InputError("option confidence", expected=", ".join(_CONFIDENCE), got=repr(confidence))
    room = _room(read_json(path, _EXPECTED), path)
    walls = _surfaces(room, "walls", path, _CONFIDENCE[confidence])
    if not walls:
        raise FormatError(
            str(path), expected="at least one wall", got="none", fix="capture the room again"
        )
    gaps = _surfaces(room, "openings", path, 0)
    if doors == "cut":
        gaps += _surfaces(room, "doors", path, 0)
    pieces = [piece for wall in walls for piece in _cut(wall, _gaps_of(wall, walls, gaps))]
    if not pieces:
        raise FormatError(str(path), expected="walls", got="walls that are all doors")
    with locating(path):
        segments = np.concatenate([np.stack([p[:-1], p[1:]], axis=1) for p in pieces])
        place = observation_point(segments, parse_position(position))
        return Scan(segments, place, session=session_of(path))


def _room(content: object, path: StrPath) -> dict[str, list[Any]]:
    """Return lists of surfaces: of a room, or of all rooms of a structure."""
    if not isinstance(content, dict):
        raise FormatError(str(path), expected=_EXPECTED, got=brief(content))
    rooms = content.get("rooms")
    whole = [content] if "walls" in content or not isinstance(rooms, list) else rooms
    found: dict[str, list[Any]] = {}
    for room in whole:
        if not isinstance(room, dict) or not isinstance(room.get("walls"), list):
            raise FormatError(str(path), expected=_EXPECTED, got=brief(room))
        for kind in ("walls", "doors", "openings"):
            listed = room.get(kind)
            found.setdefault(kind, []).extend(listed if isinstance(listed, list) else [])
    return found


def _surfaces(room: dict[str, list[Any]], kind: str, path: StrPath, level: int) -> list[_Surface]:
    listed = room.get(kind, [])
    names = [f"{path} {kind}[{i}]" for i in range(len(listed))]
    if len(listed) > _MOST:
        raise FormatError(f"{path} {kind}", expected=f"at most {_MOST}", got=str(len(listed)))
    for surface, name in zip(listed, names, strict=True):
        if not isinstance(surface, dict):
            raise FormatError(name, expected="a surface", got=brief(surface))
    matrices = read_matrices(
        [surface.get("transform") for surface in listed], [f"{name}, transform" for name in names]
    )
    found = []
    for surface, name, matrix in zip(listed, names, matrices, strict=True):
        sure = _CONFIDENCE.get(word_of(surface.get("confidence")), 2) >= level
        if sure and abs(matrix[1, 1]) >= np.sqrt(1 - MAX_TILT**2):
            line = on_ground(_line(surface, name) @ matrix[:3, :3].T + matrix[:3, 3])
            names_of = (surface.get("identifier"), surface.get("parentIdentifier"))
            found.append(_Surface(line, *(None if n is None else str(n) for n in names_of)))
    return found


def _line(surface: dict[str, Any], what: str) -> FloatArray:
    """Points (K, 3) along a surface, in its own frame: x along it, y up."""
    dimensions = surface.get("dimensions")
    width = read_vector(dimensions, f"{what}, dimensions", "xyz")[0]
    if not 0 <= width < 1000:
        raise FormatError(f"{what}, width", expected="0 to 1000 m", got=f"{width:.6g}")
    if isinstance(surface.get("curve"), dict):
        return _arc(surface["curve"], f"{what}, curve")
    return np.array([[-width / 2, 0.0, 0.0], [width / 2, 0.0, 0.0]])


def _arc(curve: dict[str, Any], what: str) -> FloatArray:
    """Points (K, 3) on a curved wall: an arc about a centre in the x-z plane of the wall."""
    radius = check_number(curve.get("radius"), f"{what}, radius")
    start, end = (_angle(curve.get(key), f"{what}, {key}") for key in ("startAngle", "endAngle"))
    center = curve.get("center")
    middle = np.zeros(2)
    if center is not None:
        long = isinstance(center, dict) or (isinstance(center, list) and len(center) > 2)
        middle = read_vector(center, f"{what}, center", "xyz" if long else "xz")[[0, -1]]
    if not 0 < radius < 1000:
        raise FormatError(f"{what}, radius", expected="0 to 1000 m", got=f"{radius:.6g}")
    count = int(np.ceil(abs(end - start) / _ARC_STEP_RAD)) + 1
    angle = np.linspace(start, end, max(count, 2))
    x, z = middle[0] + radius * np.cos(angle), middle[1] + radius * np.sin(angle)
    return np.column_stack([x, 0 * x, z])


def _angle(value: object, what: str) -> float:
    """Angle in radians, from a number or a measurement with its unit; at most one turn."""
    degrees = False
    if isinstance(value, dict):
        unit = value.get("unit")
        symbol = unit.get("symbol") if isinstance(unit, dict) else unit
        degrees = str(symbol).lower() in ("°", "deg", "degrees")
        value = value.get("value")
    angle = check_number(value, what)
    degrees = degrees or abs(angle) > 2 * np.pi + 0.01  # no wall turns further
    angle = np.deg2rad(angle) if degrees else angle
    if abs(angle) > 2 * np.pi + 0.01:
        raise FormatError(what, expected="at most one turn", got=f"{np.rad2deg(angle):.6g} degrees")
    return float(angle)


def _gaps_of(wall: _Surface, walls: list[_Surface], gaps: list[_Surface]) -> list[_Surface]:
    """Doors and openings of a wall: those that name it, or name no wall and lie in it."""
    names = {other.identifier for other in walls if other.identifier}
    return [
        gap for gap in gaps
        if (gap.parent == wall.identifier if gap.parent in names else _lies_in(gap, wall))
    ]  # fmt: skip


def _lies_in(gap: _Surface, wall: _Surface) -> bool:
    import shapely

    line = shapely.LineString(wall.line_m)
    middle = (gap.line_m[0] + gap.line_m[-1]) / 2
    if line.distance(shapely.Point(middle)) > _BELONGS_M:
        return False
    at = line.project(shapely.Point(middle))
    near = np.array([line.interpolate(max(at + d, 0)).coords[0] for d in (-0.1, 0.1)])
    along, across = near[1] - near[0], gap.line_m[-1] - gap.line_m[0]
    size = np.linalg.norm(along) * np.linalg.norm(across)
    return bool(abs(along @ across) >= _PARALLEL * size)


def _cut(wall: _Surface, gaps: list[_Surface]) -> list[FloatArray]:
    """Pieces (K, 2) of a wall's line between its doors and openings."""
    import shapely
    from shapely.ops import substring

    line = shapely.LineString(wall.line_m)
    free = [(0.0, float(line.length))]
    for gap in gaps:
        half = float(np.linalg.norm(gap.line_m[-1] - gap.line_m[0])) / 2
        at = line.project(shapely.Point((gap.line_m[0] + gap.line_m[-1]) / 2))
        free = [
            part for a, b in free for part in ((a, min(b, at - half)), (max(a, at + half), b))
            if part[1] > part[0]
        ]  # fmt: skip
    kept = [part for part in free if part[1] - part[0] >= _MIN_PIECE_M]
    return [np.asarray(substring(line, a, b).coords) for a, b in kept]


def _recognizes(path: Path) -> bool:
    return (
        not path.is_dir()
        and has_keys(path, b"dimensions", b"transform", (b"walls", b"completedEdges", b"category"))
        and not has_keys(path, (b"planeExtent",))
    )


FORMAT = Format(
    name="roomplan",
    description="Apple RoomPlan's CapturedRoom or CapturedStructure as JSON",
    suffixes=(".json",),
    recognizes=_recognizes,
    read=read_roomplan,
)
