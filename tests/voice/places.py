"""A small building that the voice's tests speak of."""

from __future__ import annotations

import numpy as np

from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.voice import Moment, Narrator, Preferences, Surroundings, Voice

DOORS = [[[2, 2], [3, 2]], [[7, 2], [8, 2]], [[22, 2], [23, 2]]]
WALLS = [
    [[0, 0], [30, 0]],
    [[0, 2], [2, 2]],
    [[0, 6], [30, 6]],
    [[0, 0], [0, 6]],
    [[30, 0], [30, 6]],
]


def box(name, left, low, right, high):
    return Room(name, [[left, low], [right, low], [right, high], [left, high]])


def corridor(level="2"):
    """A corridor of 30 m along x, three rooms above it."""
    rooms = (
        box("East corridor", 0, 0, 30, 2), box("Room 215", 0, 2, 5, 6), box("217", 5, 2, 10, 6),
        box("Lab", 20, 2, 30, 6), box(" ", 10, 2, 20, 6),
    )  # fmt: skip
    classes = [SegmentClass.WALL] * len(WALLS) + [SegmentClass.DOOR] * len(DOORS)
    return FloorPlan(np.array(WALLS + DOORS, float), np.array(classes), rooms, level=level)


def voice(*levels, **preferences):
    plans = [corridor(level) for level in levels or ("2",)]
    return Voice(Surroundings(plans), Preferences(**preferences))


def at(x_m, y_m, radius_95_m=0.8, **others):
    """A moment at a place, the phone looking along x."""
    known = {"walked_m": 40.0, "facing_rad": 0.0, "spread_rad": 0.05, "shares": (0.99,)}
    return Moment("localized", position_m=(x_m, y_m), radius_95_m=radius_95_m, **(known | others))


def narrator(*levels, **preferences):
    return Narrator(voice(*levels, **preferences))
