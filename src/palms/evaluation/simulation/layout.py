"""From rooms drawn as right-angled shapes to a floor plan of walls, doors and glass.

A building is first a set of rooms that share edges, in axes of its own; its walls follow:
every edge of a room is a wall, except where a `Passage` says otherwise.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geometry import FloatArray, check_finite, rotate

__all__ = ["OUTSIDE", "Passage", "Pose", "box", "carve", "join", "plan_of_rooms", "split_row"]

OUTSIDE = ""
_MILLI = 1000.0  # coordinates are compared in whole millimetres
_JAMB_M = 0.2  # ours: wall left beside a door

# A stretch of a grid line: (axis along which it runs, where the line lies, low, high), in mm.
_Stretch = tuple[int, int, int, int]
_Feature = tuple[int, int, SegmentClass | None]  # low, high in mm, what is drawn


@dataclass(frozen=True, slots=True)
class Passage:
    """Something other than a wall between two rooms.

    Parameters
    ----------
    room, other : str
        Their names; `OUTSIDE` stands for outdoors.
    at : float
        Where along the longest edge they share: 0 at its low end, 1 at its high end.
    width_m : float or None
        Its width; None for every edge they share.
    kind : SegmentClass or None
        What is drawn; None for nothing (one space with two names).

    Examples
    --------
    >>> Passage("Room 201", "South corridor", at=0.25).kind.name
    'DOOR'
    """

    room: str
    other: str
    at: float = 0.5
    width_m: float | None = 0.95
    kind: SegmentClass | None = SegmentClass.DOOR


@dataclass(frozen=True, slots=True)
class Pose:
    """Where a building's own axes lie in the map.

    Parameters
    ----------
    origin_m : array_like (2,)
        The building's origin, in the map frame.
    turn_rad : float
        Direction of its x axis, in the map frame.

    Examples
    --------
    >>> Pose((1.0, 2.0), np.pi / 2).apply([3.0, 0.0]).tolist()
    [1.0, 5.0]
    """

    origin_m: FloatArray = (0.0, 0.0)  # type: ignore[assignment]
    turn_rad: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin_m", check_finite(self.origin_m, "pose", (2,)))

    def apply(self, points_m: npt.ArrayLike) -> FloatArray:
        """Points (..., 2) of the building in the map frame, in whole millimetres."""
        return np.asarray(np.round(rotate(points_m, self.turn_rad) + self.origin_m, 3)) + 0.0


def box(x_low: float, y_low: float, x_high: float, y_high: float) -> Any:  # noqa: ANN401
    """Return a rectangle as a shapely polygon.

    Examples
    --------
    >>> box(0, 0, 4, 3).area
    12.0
    """
    import shapely

    return shapely.box(x_low, y_low, x_high, y_high)


def split_row(
    names: Sequence[str], widths_m: Sequence[float], low_m: tuple[float, float], depth_m: float
) -> dict[str, Any]:
    """Lay rooms side by side along x, as polygons by name.

    Parameters
    ----------
    names : sequence of str
    widths_m : sequence of float
        As many as names.
    low_m : tuple of float
        The row's lower left corner.
    depth_m : float
        Extent along y.

    Examples
    --------
    >>> row = split_row(["A", "B"], [3.0, 4.0], (1.0, 0.0), 5.0)
    >>> row["B"].bounds
    (4.0, 0.0, 8.0, 5.0)
    """
    x, y = low_m
    edges = np.round(x + np.cumsum([0.0, *widths_m]), 3).tolist()
    return {
        name: box(a, y, b, y + depth_m) for name, (a, b) in zip(names, pairwise(edges), strict=True)
    }


def carve(rooms: Mapping[str, Any], giver: str, taker: str, part: Any) -> dict[str, Any]:  # noqa: ANN401
    """Return the rooms after `part` of one of them went to another: an alcove, a niche.

    Examples
    --------
    >>> rooms = carve(split_row(["A", "B"], [3, 4], (0, 0), 5), "A", "B", box(2, 0, 3, 2))
    >>> rooms["A"].area, rooms["B"].area
    (13.0, 22.0)
    """
    given = rooms[giver].intersection(part)
    return {
        **rooms,
        giver: rooms[giver].difference(given),
        taker: rooms[taker].union(given),
    }


def join(rooms: Mapping[str, Any], name: str, others: Sequence[str]) -> dict[str, Any]:
    """Return the rooms after `others` became part of the room called `name`.

    Examples
    --------
    >>> join(split_row(["A", "B"], [3, 4], (0, 0), 5), "A", ["B"])["A"].area
    35.0
    """
    import shapely

    rest = {key: shape for key, shape in rooms.items() if key not in others}
    rest[name] = shapely.union_all([rooms[name], *(rooms[key] for key in others)])
    return rest


def plan_of_rooms(
    rooms: Mapping[str, Any],
    passages: Sequence[Passage],
    pose: Pose,
    *,
    name: str = "plan",
    level: str | None = None,
) -> FloorPlan:
    """Draw the walls around rooms, as centre lines that nowhere overlap.

    Parameters
    ----------
    rooms : mapping of str to shapely polygon
        Right-angled, without holes, in the building's own axes; they share edges.
    passages : sequence of Passage
        Later ones win where two meet.
    pose : Pose
        Where the building lies in the map.
    name, level : str
        Passed on to the plan.

    Raises
    ------
    InputError
        When a passage names rooms that share no edge long enough.

    Examples
    --------
    >>> rooms = split_row(["A", "B"], [3, 4], (0, 0), 5)
    >>> plan = plan_of_rooms(rooms, [Passage("A", "B")], Pose())
    >>> len(plan.segments_m), len(plan.of_class(SegmentClass.DOOR))
    (7, 1)
    """
    rings = {key: _ring(shape) for key, shape in rooms.items()}
    edges = {key: _stretches(ring) for key, ring in rings.items()}
    drawn: dict[_Stretch, SegmentClass | None] = {}
    for passage in passages:
        drawn.update(dict.fromkeys(_place(passage, edges), passage.kind))
    pieces = _wall_pieces([s for stretches in edges.values() for s in stretches], drawn)
    return FloorPlan(
        pose.apply([_ends(stretch) for stretch, _ in pieces]),
        np.array([kind for _, kind in pieces], np.uint8),
        rooms=tuple(Room(key, pose.apply(ring)) for key, ring in rings.items()),
        name=name,
        level=level,
    )


def _ring(shape: Any) -> FloatArray:  # noqa: ANN401
    """Corners (N, 2) of a polygon, not closed, without points on straight edges."""
    import shapely

    tidy = shapely.normalize(shapely.orient_polygons(shape.simplify(0.0)))
    corners = np.round(shapely.get_coordinates(tidy), 3)[:-1]
    before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
    straight = (np.abs(after - before) < 1e-6).any(axis=1)
    return np.asarray(corners[~straight])


def _stretches(ring: FloatArray) -> list[_Stretch]:
    """Edges of a right-angled ring as stretches of grid lines."""
    whole = np.round(ring * _MILLI).astype(int).tolist()
    result: list[_Stretch] = []
    for a, b in pairwise([*whole, whole[0]]):
        axis = 0 if a[1] == b[1] else 1
        low, high = sorted((a[axis], b[axis]))
        result.append((axis, a[1 - axis], low, high))
    return result


def _ends(stretch: _Stretch) -> list[list[float]]:
    axis, line, low, high = stretch
    points = [[low, line], [high, line]] if axis == 0 else [[line, low], [line, high]]
    return [[v / _MILLI for v in point] for point in points]


def _place(passage: Passage, edges: Mapping[str, list[_Stretch]]) -> list[_Stretch]:
    """Where a passage lies."""
    shared = _shared(passage, edges)
    if passage.width_m is None:
        return shared
    axis, line, low, high = max(shared, key=lambda s: s[3] - s[2], default=(0, 0, 0, 0))
    width, jamb = round(passage.width_m * _MILLI), round(_JAMB_M * _MILLI)
    play = high - low - width - 2 * jamb
    if play < 0:
        raise InputError(
            f"passage between {passage.room!r} and {passage.other or 'outside'!r}",
            expected=f"a shared wall of at least {(width + 2 * jamb) / _MILLI:g} m",
            got=f"{(high - low) / _MILLI:g} m",
        )
    start = low + jamb + round(play * passage.at)
    return [(axis, line, start, start + width)]


def _shared(passage: Passage, edges: Mapping[str, list[_Stretch]]) -> list[_Stretch]:
    own = edges[passage.room]
    if passage.other != OUTSIDE:
        return _overlaps(own, edges[passage.other])
    others = [s for key, stretches in edges.items() if key != passage.room for s in stretches]
    covered = dict.fromkeys(_overlaps(own, others))
    return [s for s, kind in _wall_pieces(own, covered) if kind is SegmentClass.WALL]


def _overlaps(ours: Sequence[_Stretch], theirs: Sequence[_Stretch]) -> list[_Stretch]:
    return [
        (a[0], a[1], max(a[2], b[2]), min(a[3], b[3]))
        for a in ours
        for b in theirs
        if a[:2] == b[:2] and min(a[3], b[3]) > max(a[2], b[2])
    ]


def _wall_pieces(
    edges: Sequence[_Stretch], drawn: Mapping[_Stretch, SegmentClass | None]
) -> list[tuple[_Stretch, SegmentClass]]:
    """Cut each grid line into pieces of one class; walls that touch become one."""
    walls: dict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
    for axis, line, low, high in edges:
        walls[axis, line].append((low, high))
    features: dict[tuple[int, int], list[_Feature]] = defaultdict(list)
    for (axis, line, low, high), kind in drawn.items():
        features[axis, line].append((low, high, kind))
    return [
        ((*key, low, high), kind)
        for key in sorted(walls)
        for low, high, kind in _cut_line(walls[key], features[key])
    ]


def _cut_line(
    walls: Sequence[tuple[int, int]], features: Sequence[_Feature]
) -> list[tuple[int, int, SegmentClass]]:
    layers: list[_Feature] = [(*wall, SegmentClass.WALL) for wall in walls]
    layers += features
    cuts = sorted({v for low, high, _ in layers for v in (low, high)})
    runs: list[tuple[int, int, int]] = []  # low, high, layer on top
    for low, high in pairwise(cuts):
        on_top = [i for i, (a, b, _) in enumerate(layers) if a <= low and high <= b]
        if not on_top:
            continue
        top = on_top[-1] if on_top[-1] >= len(walls) else 0
        goes_on = bool(runs) and runs[-1][1:] == (low, top)
        start = runs.pop()[0] if goes_on else low
        runs.append((start, high, top))
    pieces = ((low, high, layers[top][2]) for low, high, top in runs)
    return [(low, high, kind) for low, high, kind in pieces if kind is not None]
