"""Namer: rooms by point, quickly: a live session asks several times a step."""

from __future__ import annotations

from typing import Any

from palms.building import Building
from palms.floorplan import FloorPlan

__all__ = ["Namer"]


class Namer:
    """Names the rooms of a plan, as `FloorPlan.room_at` does, or of all levels of a building.

    Parameters
    ----------
    plan : FloorPlan or Building

    Examples
    --------
    >>> from palms.floorplan import Room
    >>> hall = Room("Hall", [[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> name = Namer(FloorPlan([[[0, 0], [4, 0]]], rooms=(hall,)))
    >>> name(1.0, 1.0), name(9.0, 9.0)
    ('Hall', None)
    """

    def __init__(self, plan: FloorPlan | Building) -> None:
        levels = (plan,) if isinstance(plan, FloorPlan) else plan.levels
        self._rooms = {level.level: _Rooms(level) for level in levels}
        self._lowest = self._rooms[levels[0].level]

    def __call__(self, x_m: float, y_m: float, level: str | None = None) -> str | None:
        """Return the name of the room at a point, the smallest where several hold it.

        Parameters
        ----------
        x_m, y_m : float
        level : str, optional
            The lowest when left out.
        """
        return self._rooms.get(level, self._lowest).at(x_m, y_m)


class _Rooms:
    """The rooms of one level."""

    def __init__(self, plan: FloorPlan) -> None:
        import shapely

        polygons = [shapely.make_valid(shapely.Polygon(room.polygon_m)) for room in plan.rooms]
        self._names = [room.name for room in plan.rooms]
        self._areas = [float(polygon.area) for polygon in polygons]
        shapely.prepare(polygons)
        self._tree: Any = shapely.STRtree(polygons)
        self._point = shapely.Point

    def at(self, x_m: float, y_m: float) -> str | None:
        holding = self._tree.query(self._point(x_m, y_m), predicate="intersects")
        return min(((self._areas[i], self._names[i]) for i in holding), default=(0.0, None))[1]
