"""FloorPlan: walls, doors, openings and glass in metres, and the rooms between them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.geodesy import Origin
from palms.geometry import FloatArray, as_readonly, bounds, check_points, check_segments, lengths
from palms.settings import LIMITS

__all__ = ["FloorPlan", "Room", "SegmentClass", "likely_factor"]


_BUILDING_M = (4.0, 1500.0)  # ours: what a floor may measure when its unit is guessed
_UNITS = (
    (0.001, "millimetres"),
    (0.01, "centimetres"),
    (0.0254, "inches"),
    (0.3048, "feet"),
    (1000.0, "kilometres, or metres read as millimetres"),
    (100.0, "a drawing at 1:100"),
)


def likely_factor(largest: float) -> str:
    """Say by what to multiply a plan whose larger side is impossible in metres.

    Examples
    --------
    >>> likely_factor(40_000.0), likely_factor(0.04)
    ('multiply by 0.001 (millimetres?)', 'multiply by 1000 (kilometres, or metres read as ...?)')
    """
    for factor, unit in _UNITS:
        if _BUILDING_M[0] <= largest * factor <= _BUILDING_M[1]:
            return f"multiply by {factor:g} ({unit}?)"
    return "multiply by its unit's length in metres"


class SegmentClass(IntEnum):
    """What a segment of a plan is.

    Doors and openings let people through; doors and glass are seen about half of the time.
    """

    WALL = 0
    DOOR = 1
    OPENING = 2
    GLASS = 3

    @property
    def blocks(self) -> bool:
        """Whether nobody walks through it."""
        return self in (SegmentClass.WALL, SegmentClass.GLASS)


@dataclass(frozen=True, slots=True)
class Room:
    """A named area of a plan.

    Parameters
    ----------
    name : str
        As a person would say it: "Room 215", "East corridor".
    polygon_m : array_like (N, 2)
        Its outline, N at least 3, not closed.
    """

    name: str
    polygon_m: FloatArray

    def __post_init__(self) -> None:
        polygon = check_points(self.polygon_m, f"outline of room {self.name!r}")
        if len(polygon) < 3:
            raise InputError(
                f"outline of room {self.name!r}",
                expected="at least 3 points",
                got=str(len(polygon)),
            )
        object.__setattr__(self, "polygon_m", polygon)


@dataclass(frozen=True)
class FloorPlan:
    """One floor of a building, in the map frame.

    Parameters
    ----------
    segments_m : array_like (N, 2, 2)
        Walls, doors, openings and glass, in metres; N at least 1.
    classes : array_like (N,), optional
        A `SegmentClass` each; all walls when left out, which is the paper.
    rooms : sequence of Room
        Named areas.
    outline_m : array_like (M, 2), optional
        Outline of the building, when the format has one.
    name, level : str
        What to call plan and floor.
    origin : Origin, optional
        Where on Earth (0, 0) lies, when the format knows; answers then come as longitude and
        latitude, too.

    Raises
    ------
    InputError
        When there is no wall, a number is not finite, or the plan is narrower than a metre
        or wider than five kilometres (its unit is then hardly the metre).

    Examples
    --------
    >>> plan = FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]], name="two walls")
    >>> plan.size_m.tolist()
    [8.0, 5.0]
    """

    segments_m: FloatArray
    classes: npt.NDArray[np.uint8] = None  # type: ignore[assignment]
    rooms: tuple[Room, ...] = ()
    outline_m: FloatArray | None = None
    name: str = "plan"
    level: str | None = None
    origin: Origin | None = None

    def __post_init__(self) -> None:
        what = f"floor plan {self.name}"
        segments = check_segments(self.segments_m, what)
        classes = np.zeros(len(segments), np.uint8) if self.classes is None else self.classes
        classes = as_readonly(classes, np.uint8)
        if classes.shape != (len(segments),):
            raise InputError(what, expected=f"{len(segments)} classes", got=str(classes.shape))
        if classes.size and classes.max() > max(SegmentClass):
            raise InputError(what, expected="classes 0 to 3", got=str(classes.max()))
        object.__setattr__(self, "segments_m", segments)
        object.__setattr__(self, "classes", classes)
        object.__setattr__(self, "rooms", tuple(self.rooms))
        if self.outline_m is not None:
            object.__setattr__(self, "outline_m", check_points(self.outline_m, f"{what}, outline"))
        self._check_extent(what)

    def _check_extent(self, what: str) -> None:
        blocking = self.of_class(SegmentClass.WALL, SegmentClass.GLASS)
        if not len(blocking) or not lengths(blocking).any():
            raise InputError(
                what,
                expected="at least one wall with a length",
                got="none",
                fix="check that this is the plan's file and its walls are in it",
            )
        width, height = (float(v) for v in self.size_m)
        largest = max(width, height)
        if largest > LIMITS.max_plan_m:
            raise InputError(
                what,
                expected=f"metres, at most {LIMITS.max_plan_m:g} m wide",
                got=f"{width:.6g} x {height:.6g}",
                fix=f"convert it to metres: {likely_factor(largest)}, and remove stray points",
            )
        if largest < LIMITS.min_plan_m:
            raise InputError(
                what,
                expected=f"metres, at least {LIMITS.min_plan_m:g} m wide",
                got=f"{width:.4g} x {height:.4g}",
                fix=f"convert it to metres: {likely_factor(largest)}",
            )

    def of_class(self, *wanted: SegmentClass) -> FloatArray:
        """Segments (M, 2, 2) of the wanted classes."""
        return self.segments_m[np.isin(self.classes, wanted)]

    @cached_property
    def blocking_m(self) -> FloatArray:
        """Segments (M, 2, 2) that nobody walks through: walls and glass."""
        return self.of_class(*(c for c in SegmentClass if c.blocks))

    @property
    def bounds_m(self) -> tuple[FloatArray, FloatArray]:
        """Lower left and upper right corner of all segments."""
        return bounds(self.segments_m)

    @property
    def size_m(self) -> FloatArray:
        """Width and height (2,)."""
        low, high = self.bounds_m
        return high - low

    def room_at(self, point_m: npt.ArrayLike) -> str | None:
        """Name of the room that holds a point, the smallest where several do, else None.

        Examples
        --------
        >>> hall = Room("Hall", [[0, 0], [4, 0], [4, 4], [0, 4]])
        >>> FloorPlan([[[0, 0], [4, 0]]], rooms=(hall,)).room_at([1.0, 1.0])
        'Hall'
        """
        import shapely

        x, y = np.asarray(point_m, dtype=np.float64)
        holding = [
            (polygon.area, room.name)
            for room, polygon in zip(self.rooms, self._polygons, strict=True)
            if shapely.intersects_xy(polygon, x, y)
        ]
        return min(holding)[1] if holding else None

    @cached_property
    def _polygons(self) -> tuple[Any, ...]:
        import shapely

        polygons = tuple(shapely.Polygon(room.polygon_m) for room in self.rooms)
        shapely.prepare(polygons)
        return polygons
