"""Surroundings: the named rooms of a building, asked for by place."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from palms.building import Building
from palms.floorplan import FloorPlan, SegmentClass
from palms.geometry import FloatArray
from palms.voice.understanding import Named

__all__ = ["Area", "Nearby", "Surroundings"]

ROOMY_M = 15.0  # ours: in a larger room or corridor it helps to name a neighbour
DOOR_M = 0.4  # ours: a door this near to a room's outline is its own
LONGEST = 60  # ours: characters of a name that are spoken


@dataclass(frozen=True)
class Area:
    """A named room or corridor.

    Parameters
    ----------
    name : str
        In one line.
    level : str
    polygon : shapely geometry
        Its outline, map frame.
    doors_m : (D, 2)
        Middles of its doors and openings.
    """

    name: str
    level: str
    polygon: Any
    doors_m: FloatArray

    @property
    def is_roomy(self) -> bool:
        """Whether its name alone says little of where in it one is."""
        left, low, right, high = self.polygon.bounds
        return math.hypot(right - left, high - low) >= ROOMY_M

    def away_m(self, x_m: float, y_m: float) -> float:
        """Return how far a point is from it; 0 inside."""
        import shapely

        return float(self.polygon.distance(shapely.Point(x_m, y_m)))

    def target_m(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Return where one would go from a point: its nearest door, else its outline."""
        import shapely

        if len(self.doors_m):
            away = np.hypot(self.doors_m[:, 0] - x_m, self.doors_m[:, 1] - y_m)
            x, y = self.doors_m[int(away.argmin())].tolist()
            return x, y
        nearest = shapely.shortest_line(self.polygon.boundary, shapely.Point(x_m, y_m))
        x, y = nearest.coords[0]
        return float(x), float(y)


class Nearby(NamedTuple):
    """An area seen from a point.

    Attributes
    ----------
    area : Area
    away_m : float
        From the point to its door, as the crow flies.
    bearing_rad : float
        In the map.
    """

    area: Area
    away_m: float
    bearing_rad: float


class Surroundings:
    """The named rooms of a building.

    Parameters
    ----------
    levels : sequence of FloorPlan
    names : sequence of str, optional
        What to call the levels; as the plans say when left out.

    Attributes
    ----------
    levels : tuple of str
    rooms : tuple of Named
        All rooms, as the plans have them.

    Examples
    --------
    >>> from palms.floorplan import Room
    >>> hall = Room("Hall", [[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> around = Surroundings([FloorPlan([[[0, 0], [4, 0]]], rooms=(hall,), level="1")])
    >>> around.home("1", 1.0, 1.0).name, around.home("1", 9.0, 9.0)
    ('Hall', None)
    """

    def __init__(self, levels: Sequence[FloorPlan], names: Sequence[str] | None = None) -> None:
        import shapely

        self.levels = tuple(names or [plan.level or "" for plan in levels])
        self.rooms = tuple(
            Named(name, room.name)
            for name, plan in zip(self.levels, levels, strict=True)
            for room in plan.rooms
        )
        self._areas = {
            name: _areas(plan, name) for name, plan in zip(self.levels, levels, strict=True)
        }
        self._trees = {
            name: shapely.STRtree([area.polygon for area in areas])
            for name, areas in self._areas.items()
        }

    @classmethod
    def of(cls, plan: FloorPlan | Building) -> Surroundings:
        """Return the surroundings of a plan or a building."""
        return cls(plan.levels if isinstance(plan, Building) else (plan,))

    def areas(self, level: str) -> tuple[Area, ...]:
        """Return the named rooms of a level, those of one name each by itself."""
        return tuple(self._areas[level])

    def home(self, level: str | None, x_m: float, y_m: float) -> Area | None:
        """Return the area that holds a point, the smallest where several do."""
        found = self._within(level, x_m, y_m, 0.0)
        return min(found, key=lambda area: (area.polygon.area, area.name), default=None)

    def touching(self, level: str | None, x_m: float, y_m: float, radius_m: float) -> list[Area]:
        """Return the areas that a disc touches, the nearest first."""
        import shapely

        point = shapely.Point(x_m, y_m)
        found = self._within(level, x_m, y_m, radius_m)
        return sorted(found, key=lambda area: (area.polygon.distance(point), area.name))

    def nearest(
        self, level: str | None, place_m: tuple[float, float], within_m: float, n: int = 1
    ) -> list[Nearby]:
        """Return up to n areas whose doors are near, the nearest first.

        Without the one that holds the point.
        """
        x, y = place_m
        home = self.home(level, x, y)
        found = []
        for area in self._within(level, x, y, within_m):
            if area is home:
                continue
            to_x, to_y = area.target_m(x, y)
            away = math.hypot(to_x - x, to_y - y)
            if away <= within_m:
                found.append(Nearby(area, away, math.atan2(to_y - y, to_x - x)))
        return sorted(found, key=lambda each: (each.away_m, each.area.name))[:n]

    def _within(self, level: str | None, x_m: float, y_m: float, radius_m: float) -> list[Area]:
        import shapely

        name = self.levels[0] if level is None or level not in self._areas else level
        point = shapely.Point(x_m, y_m)
        found = self._trees[name].query(point, predicate="dwithin", distance=radius_m)
        return [self._areas[name][k] for k in sorted(found.tolist())]


def _areas(plan: FloorPlan, level: str) -> list[Area]:
    import shapely

    doors = plan.of_class(SegmentClass.DOOR, SegmentClass.OPENING).mean(axis=1)
    points = shapely.points(doors)
    found = []
    for room in plan.rooms:
        name = _one_line(room.name)
        if name:
            polygon = shapely.make_valid(shapely.Polygon(room.polygon_m))
            own = shapely.distance(polygon.boundary, points) <= DOOR_M
            shapely.prepare(polygon)
            found.append(Area(name, level, polygon, doors[own]))
    return found


def _one_line(name: str) -> str:
    """Return a name without line breaks and signs that nobody can speak."""
    plain = "".join(c if unicodedata.category(c)[0] not in "CZ" else " " for c in name)
    return " ".join(plain.split())[:LONGEST].strip()
