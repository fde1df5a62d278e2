"""The sample building: one floor of a university, drawn by its proportions.

A loop of corridors with a crossing one, offices all around, laboratories in the core::

    +------------------- north offices -------------------+
    |  w  +--------------- North corridor ----------+  e  |
    |  e  | stairs  laboratories        restrooms   |  a  |
    |  s  | -------------- Cross corridor --------- |  s  |
    |  t  | laboratories   lounge     lecture hall  |  t  |
    |     +--------------- South corridor ----------+     |
    +-------- south offices ---- Lobby -------------------+
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from palms.evaluation.simulation.layout import (
    OUTSIDE,
    Passage,
    Pose,
    box,
    carve,
    join,
    plan_of_rooms,
    split_row,
)
from palms.floorplan import FloorPlan, SegmentClass

__all__ = ["sample_building"]

_Rooms = dict[str, Any]

# The building's own axes, metres: where corridors and rows of rooms lie (ours).
_WIDTH, _DEPTH = 70.0, 45.0
_WEST, _WEST_CORRIDOR, _EAST_CORRIDOR, _EAST = 5.6, 7.4, 60.8, 63.4
_SOUTH, _SOUTH_CORRIDOR, _CROSS, _CROSS_END = 5.2, 7.2, 17.6, 19.3
_MIDDLE, _NORTH_CORRIDOR, _NORTH = 27.3, 36.4, 38.9
_POSE = Pose(np.array([14.5, 3.25]), np.deg2rad(17.0))


def sample_building() -> FloorPlan:
    """Return the floor plan of the sample building: about 70 x 45 m, level 2.

    Returns
    -------
    FloorPlan
        Walls as centre lines, doors, openings, glass and named rooms that cover the
        inside; its axes are turned by 17 degrees in the map.

    Examples
    --------
    >>> plan = sample_building()
    >>> plan.name, plan.level, len(plan.of_class(SegmentClass.OPENING))
    ('sample', '2', 2)
    """
    rooms = _corridors() | _offices() | _core()
    rooms = _irregularities(rooms)
    passages = _office_doors(rooms) + _core_doors() + _public_passages()
    return plan_of_rooms(rooms, passages, _POSE, name="sample", level="2")


def _corridors() -> _Rooms:
    return {
        "South corridor": box(_WEST, _SOUTH, _EAST, _SOUTH_CORRIDOR),
        "North corridor": box(_WEST, _NORTH_CORRIDOR, _EAST, _NORTH),
        "West corridor": box(_WEST, _SOUTH_CORRIDOR, _WEST_CORRIDOR, _NORTH_CORRIDOR),
        "East corridor": box(_EAST_CORRIDOR, _SOUTH_CORRIDOR, _EAST, _NORTH_CORRIDOR),
        "Cross corridor": box(_WEST_CORRIDOR, _CROSS, _EAST_CORRIDOR, _CROSS_END),
    }


def _numbers(first: int, count: int) -> list[str]:
    return [f"Room {number}" for number in range(first, first + count)]


def _fill(total: float, count: int, wide: Mapping[int, float]) -> list[float]:
    """Widths of `count` rooms that fill `total`: the ones in `wide` as given, the rest equal."""
    usual = (total - sum(wide.values())) / (count - len(wide))
    return [wide.get(i, usual) for i in range(count)]


def _flip(rooms: _Rooms) -> _Rooms:
    """Exchange x and y."""
    import shapely

    return {name: shapely.transform(shape, lambda xy: xy[:, ::-1]) for name, shape in rooms.items()}


def _offices() -> _Rooms:
    """Four rows of offices around the loop; the lobby lies in the southern one."""
    south = ["Lobby" if n == "Room 209" else n for n in _numbers(201, 17)]
    rows = split_row(south, _fill(_WIDTH, 17, {0: 9.2, 8: 10.4, 16: 10.1}), (0.0, 0.0), _SOUTH)
    rows |= split_row(
        _numbers(243, 16),
        _fill(_WIDTH, 16, {0: 8.8, 5: 6.1, 15: 10.5}),
        (0.0, _NORTH),
        _DEPTH - _NORTH,
    )
    side = _NORTH - _SOUTH
    rows |= _flip(split_row(_numbers(218, 9), _fill(side, 9, {3: 5.0}), (_SOUTH, _EAST), 6.6))
    west_widths = _fill(side, 10, {6: 4.6})
    rows |= _flip(split_row(_numbers(259, 10), west_widths, (_SOUTH, 0.0), _WEST))
    return rows


def _core() -> _Rooms:
    """Laboratories and services, in two blocks between the corridors."""
    width, low = _EAST_CORRIDOR - _WEST_CORRIDOR, _WEST_CORRIDOR
    depth = (_CROSS - _SOUTH_CORRIDOR) / 2
    rooms = split_row(
        ["Lab 230", "Lab 231", "Kitchen", "Room 232", "Room 233", "Lecture hall"],
        _fill(width, 6, {2: 4.2, 3: 5.1, 4: 5.1, 5: 15.5}),
        (low, _SOUTH_CORRIDOR),
        depth,
    )
    rooms |= split_row(
        ["Stairs A", "Lab 234", "Lounge", "Lab 235", "Storage", "Hall 2"],
        _fill(width, 6, {0: 4.8, 2: 9.0, 4: 6.4, 5: 15.5}),
        (low, _SOUTH_CORRIDOR + depth),
        depth,
    )
    rooms |= split_row(
        ["Workshop", "Lab 236", "Restroom W", "Restroom M", "Lab 237", "Stairs B"],
        _fill(width, 6, {0: 8.7, 2: 5.0, 3: 5.0, 5: 5.2}),
        (low, _CROSS_END),
        _MIDDLE - _CROSS_END,
    )
    rooms |= split_row(
        ["Library", "Room 238", "Room 239", "Room 240", "Lab 241", "Lab 242"],
        _fill(width, 6, {0: 13.6, 1: 4.4, 2: 4.4, 3: 4.4}),
        (low, _MIDDLE),
        _NORTH_CORRIDOR - _MIDDLE,
    )
    return join(rooms, "Lecture hall", ["Hall 2"])


def _irregularities(rooms: _Rooms) -> _Rooms:
    """Niches and alcoves that tell one stretch of corridor from another."""
    moves = (
        ("Lab 231", "South corridor", box(24.6, _SOUTH_CORRIDOR, 27.4, 8.9)),
        ("Room 251", "North corridor", box(37.0, _NORTH, 41.0, 40.6)),
        ("Lab 242", "North corridor", box(58.4, 34.2, _EAST_CORRIDOR, _NORTH_CORRIDOR)),
        ("Lab 242", "East corridor", box(59.6, 31.0, _EAST_CORRIDOR, 33.0)),
        ("Room 265", "West corridor", box(4.4, 25.4, _WEST, 28.0)),
        ("Lab 237", "Cross corridor", box(48.0, _CROSS_END, 50.4, _CROSS_END + 1.4)),
    )
    for giver, taker, part in moves:
        rooms = carve(rooms, giver, taker, part)
    return rooms


def _office_doors(rooms: _Rooms) -> list[Passage]:
    """One door for each office; neighbours have theirs side by side, as builders do."""
    doors: list[Passage] = []
    for first, count, corridor in (
        (201, 17, "South"),
        (218, 9, "East"),
        (243, 16, "North"),
        (259, 10, "West"),
    ):
        names = [name for name in _numbers(first, count) if name in rooms]
        for i, name in enumerate(names):
            other = _reached_from(rooms, name, f"{corridor} corridor")
            doors.append(Passage(name, other, at=_door_place(i)))
    return doors


def _door_place(index: int) -> float:
    """Mirrored pairs, with every fifth door out of the pattern."""
    if index % 5 == 3:
        return 0.5
    return 0.88 if index % 2 else 0.12


def _reached_from(rooms: _Rooms, name: str, usual: str) -> str:
    """Name the corridor that a room shares most of its outline with."""
    corridors = sorted(key for key in rooms if key.endswith("corridor"))
    shared = {key: rooms[name].intersection(rooms[key]).length for key in corridors}
    return usual if shared[usual] > 1.5 else max(corridors, key=lambda key: shared[key])


def _core_doors() -> list[Passage]:
    single = (
        ("Lab 230", "South corridor", (0.1,)),
        ("Lab 231", "South corridor", (0.85,)),
        ("Kitchen", "South corridor", (0.3,)),
        ("Room 232", "South corridor", (0.1,)),
        ("Room 233", "South corridor", (0.9,)),
        ("Stairs A", "West corridor", (0.4,)),
        ("Lab 234", "Cross corridor", (0.2, 0.9)),
        ("Lab 235", "Cross corridor", (0.15,)),
        ("Storage", "Cross corridor", (0.7,)),
        ("Workshop", "West corridor", (0.8,)),
        ("Lab 236", "Cross corridor", (0.1, 0.75)),
        ("Restroom W", "Cross corridor", (0.2,)),
        ("Restroom M", "Cross corridor", (0.8,)),
        ("Lab 237", "Cross corridor", (0.4,)),
        ("Stairs B", "East corridor", (0.6,)),
        ("Room 238", "North corridor", (0.15,)),
        ("Room 239", "North corridor", (0.85,)),
        ("Room 240", "North corridor", (0.15,)),
        ("Lab 241", "North corridor", (0.3,)),
        ("Lab 242", "North corridor", (0.6,)),
        ("Lab 230", "Lab 231", (0.7,)),
        ("Lab 241", "Lab 242", (0.2,)),
    )
    doors = [Passage(a, b, at) for a, b, places in single for at in places]
    double = (
        ("Lecture hall", "East corridor", 0.3),
        ("Lecture hall", "South corridor", 0.2),
        ("Library", "North corridor", 0.55),
        ("Workshop", "Cross corridor", 0.3),
    )
    return doors + [Passage(a, b, at, width_m=1.8) for a, b, at in double]


def _public_passages() -> list[Passage]:
    """Corridors that flow into each other, the lobby's glass and the lounge's opening."""
    return [
        *_free_between(_CORRIDOR_JOINTS),
        Passage("Lobby", OUTSIDE, width_m=None, kind=SegmentClass.GLASS),
        Passage("Lobby", OUTSIDE, at=0.5, width_m=1.9),
        Passage("Lobby", "South corridor", at=0.35, width_m=6.0, kind=SegmentClass.OPENING),
        Passage("Lounge", "Cross corridor", at=0.6, width_m=5.2, kind=SegmentClass.OPENING),
        Passage("Library", "West corridor", at=0.3, width_m=3.5, kind=SegmentClass.GLASS),
    ]


_CORRIDOR_JOINTS = (
    ("South corridor", "West corridor", "North corridor", "East corridor", "South corridor"),
    ("West corridor", "Cross corridor", "East corridor"),
)


def _free_between(chains: Sequence[Sequence[str]]) -> list[Passage]:
    return [Passage(a, b, width_m=None, kind=None) for chain in chains for a, b in pairwise(chain)]
