"""A building of several levels: plans above each other, and the stairs and lifts between them.

For localization its levels are laid out side by side, as sheets of an atlas: one plan, in
which a place says its level too. Search, filter and belief then need to know nothing of
levels, but that stairs lead from sheet to sheet.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from palms._compiled import raster as cells
from palms.errors import InputError
from palms.floorplan import FloorPlan, Room
from palms.geometry import FloatArray, check_points
from palms.grid import Grid
from palms.raster import PlanRaster, rasterize
from palms.settings import RasterSettings

__all__ = ["Atlas", "Building", "Sheets", "Stairs", "joined_stairs", "named_stairs"]

STAIRS_CELL_M = 0.5  # ours: a look at cells tells most places that are not on stairs
GAP_M = 25.0  # ours: between sheets; no scan sees so far
_STAIRS = re.compile(r"stair|lift|elevator|escalator|treppe|aufzug|rolltreppe|escalier|ascenseur",
                     re.IGNORECASE)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Stairs:
    """Where one gets from a level to the next: stairs, a lift, an escalator.

    Parameters
    ----------
    name : str
        Of its room.
    polygon_m : array_like (N, 2)
        Its outline, in the map frame of all levels.

    Examples
    --------
    >>> Stairs("Stairs A", [[0, 0], [3, 0], [3, 6], [0, 6]]).position_m.tolist()
    [1.5, 3.0]
    """

    name: str
    polygon_m: FloatArray

    def __post_init__(self) -> None:
        polygon = check_points(self.polygon_m, f"outline of {self.name!r}")
        object.__setattr__(self, "polygon_m", polygon)

    @property
    def position_m(self) -> FloatArray:
        """The middle (2,)."""
        return np.asarray(self.polygon_m.mean(axis=0))


@dataclass(frozen=True)
class Building:
    """Levels that lie above each other in one map frame, and the stairs between them.

    Parameters
    ----------
    levels : sequence of FloorPlan
        From the lowest up, each with a `level` of its own.
    stairs : sequence of Stairs, optional
        On all levels; rooms that are called stairs, lift, elevator or escalator when left out.

    Raises
    ------
    InputError
        When there is no level, or two have one name.

    Examples
    --------
    >>> from dataclasses import replace
    >>> room = Room("Stairs", [[0, 0], [2, 0], [2, 2], [0, 2]])
    >>> hall = FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]], rooms=(room,), level="1")
    >>> building = Building((hall, replace(hall, level="2")))
    >>> [stairs.name for stairs in building.stairs], building.level("2").level
    (['Stairs'], '2')
    """

    levels: tuple[FloorPlan, ...]
    stairs: tuple[Stairs, ...] = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        object.__setattr__(self, "levels", tuple(self.levels))
        if not self.levels:
            raise InputError("building", expected="at least one level", got="none")
        names = [plan.level for plan in self.levels]
        if len(names) > 1 and (None in names or len(set(names)) < len(names)):
            raise InputError(
                "building", expected="levels with names of their own",
                got=", ".join(str(name) for name in names), fix="name each level",
            )  # fmt: skip
        found = self.stairs
        if found is None:
            found = joined_stairs([named_stairs(plan) for plan in self.levels])
        object.__setattr__(self, "stairs", tuple(found))

    def __getstate__(self) -> dict[str, Any]:
        """Leave the atlas behind: in another process it may not be needed."""
        return {"levels": self.levels, "stairs": self.stairs}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the levels, from the lowest up."""
        return tuple(plan.level or "" for plan in self.levels)

    def level(self, name: str) -> FloorPlan:
        """Return the plan of a level.

        Raises
        ------
        InputError
            When the building has no such level.
        """
        return self.levels[self.index(name)]

    def index(self, name: str) -> int:
        """Return the number of a level, 0 for the lowest."""
        if name not in self.names:
            raise InputError(
                "level", expected=f"one of the building's ({', '.join(self.names)})", got=repr(name)
            )
        return self.names.index(name)

    @cached_property
    def atlas(self) -> Atlas:
        """The levels as sheets side by side."""
        return Atlas(self)


def named_stairs(plan: FloorPlan) -> tuple[Stairs, ...]:
    """Return the rooms of a plan that are called stairs, lift, elevator or escalator.

    Examples
    --------
    >>> rooms = [Room(name, [[0, 0], [2, 0], [2, 2]]) for name in ("Hall", "Treppe 3")]
    >>> [each.name for each in named_stairs(FloorPlan([[[0, 0], [8, 0]]], rooms=rooms))]
    ['Treppe 3']
    """
    rooms = (room for room in plan.rooms if _STAIRS.search(room.name))
    return tuple(Stairs(room.name, room.polygon_m) for room in rooms)


def joined_stairs(found: Sequence[Sequence[Stairs]]) -> tuple[Stairs, ...]:
    """Return the stairs that lead somewhere: those that another level has at the same place.

    Parameters
    ----------
    found : sequence of sequence of Stairs
        Those of each level; stairs at one place are returned once, as the first level has them.
    """
    import shapely

    areas = [
        (k, each, shapely.make_valid(shapely.Polygon(each.polygon_m)))
        for k, stairs in enumerate(found)
        for each in stairs
    ]
    known: list[shapely.Geometry] = []
    joined: list[Stairs] = []
    for k, each, area in areas:
        again = any(other.intersects(area) for other in known)
        above = any(j != k and other.intersects(area) for j, _, other in areas)
        if above and not again:
            known.append(area)
            joined.append(each)
    return tuple(joined)


@dataclass(frozen=True)
class Sheets(FloorPlan):
    """The plan of an atlas: levels side by side.

    Parameters
    ----------
    corners_m : tuple
        Name of each level, and the upper left corner (x, y) of its sheet.
    """

    corners_m: tuple[tuple[str, tuple[float, float]], ...] = ()


class Atlas:
    """The levels of a building side by side, as sheets: one plan.

    Parameters
    ----------
    building : Building

    Attributes
    ----------
    plan : FloorPlan
        All levels. That of a building of one level is its plan as it is.
    names : tuple of str
        Of the levels.
    shift_m : (L, 2)
        From a place in the map to the same place of a level's sheet.

    Examples
    --------
    >>> from dataclasses import replace
    >>> hall = FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]], level="1")
    >>> atlas = Building((hall, replace(hall, level="2"))).atlas
    >>> there = atlas.shift_m[1] + (3.0, 2.0)
    >>> atlas.level_of(there[None]).tolist(), atlas.folded(there[None]).round(6).tolist()
    ([1], [[3.0, 2.0]])
    """

    def __init__(self, building: Building) -> None:
        self.building = building
        self.names = building.names
        corners = np.array([plan.bounds_m for plan in building.levels])
        self._low = corners[:, 0].min(axis=0)
        size = corners[:, 1].max(axis=0) - self._low
        self._tile = size + GAP_M
        n = len(building.levels)
        self._columns = max(1, min(n, round(float(np.sqrt(n * self._tile[1] / self._tile[0])))))
        number = np.arange(n)
        self.shift_m: FloatArray = self._tile * np.stack(
            [number % self._columns, number // self._columns], axis=1
        )
        self.plan = building.levels[0] if n == 1 else self._laid_out()

    def _laid_out(self) -> FloorPlan:
        levels, shifts = self.building.levels, self.shift_m
        rooms = tuple(
            Room(room.name, room.polygon_m + shift)
            for plan, shift in zip(levels, shifts, strict=True)
            for room in plan.rooms
        )
        segments = [plan.segments_m + shift for plan, shift in zip(levels, shifts, strict=True)]
        low_high = [(plan.bounds_m, shift) for plan, shift in zip(levels, shifts, strict=True)]
        corners = [
            (float(low[0] + shift[0]), float(high[1] + shift[1])) for (low, high), shift in low_high
        ]
        return Sheets(
            np.concatenate(segments), np.concatenate([plan.classes for plan in levels]), rooms,
            name=levels[0].name, corners_m=tuple(zip(self.names, corners, strict=True)),
        )  # fmt: skip

    def level_of(self, position_m: FloatArray) -> npt.NDArray[np.int64]:
        """Return the number of the level (N,) that places (N, 2) of the atlas lie on."""
        n = len(self.names)
        if n == 1:
            return np.zeros(len(position_m), np.int64)
        level = np.empty(len(position_m), np.int64)
        frame = np.array([*self._low, GAP_M / 2, *self._tile])
        cells.tiles(
            np.ascontiguousarray(position_m, np.float64), frame, (self._columns, n), level
        )  # fmt: skip
        return level

    def folded(self, position_m: FloatArray) -> FloatArray:
        """Return places (N, 2) of the atlas as places of the map, whatever their level."""
        folded: FloatArray = position_m - self.shift_m[self.level_of(position_m)]
        return folded

    def on_level(self, position_m: FloatArray, level: npt.NDArray[np.int64] | int) -> FloatArray:
        """Return places (N, 2) of the atlas moved to the same place of other levels."""
        moved: FloatArray = self.folded(position_m) + self.shift_m[level]
        return moved

    def on_stairs(self, position_m: FloatArray, within_m: float = 0.0) -> npt.NDArray[np.bool_]:
        """Whether places (N, 2) of the atlas lie on stairs, or so near to them."""
        import shapely

        on = np.zeros(len(position_m), np.bool_)
        if self.building.stairs:
            area, mask, frame = self._stairs(within_m)
            near = cells.marked(np.ascontiguousarray(position_m, np.float64), mask, frame)
            x, y = self.folded(position_m[near]).T
            on[near] = shapely.contains_xy(area, x, y)
        return on

    def _stairs(self, within_m: float) -> tuple[Any, npt.NDArray[np.bool_], FloatArray]:
        """Return the area of all stairs, and the cells of the atlas that may reach into it."""
        if within_m not in self._prepared:
            import shapely

            polygons = [shapely.Polygon(each.polygon_m) for each in self.building.stairs]
            union = shapely.union_all([shapely.make_valid(each) for each in polygons])
            area, near = (union.buffer(within_m + more) for more in (0.0, STAIRS_CELL_M))
            shapely.prepare(area)
            shapely.prepare(near)
            grid = self._grid_around(near)
            rows, columns = np.indices(grid.shape)
            x, y = self.folded(grid.position_of(np.stack([rows.ravel(), columns.ravel()], 1))).T
            mask = shapely.contains_xy(near, x, y).reshape(grid.shape)
            frame = np.array([*grid.origin_m, 1 / STAIRS_CELL_M])
            self._prepared[within_m] = (area, mask, frame)
        return self._prepared[within_m]

    def _grid_around(self, area: Any) -> Grid:  # noqa: ANN401
        """Return cells that cover an area on each sheet, as far as it lies on sheets."""
        low, high = np.array((0.0, 0.0, 0.0, 0.0) if area.is_empty else area.bounds).reshape(2, 2)
        low = np.clip(low, self._low - GAP_M / 2, self._low + self._tile)
        high = np.clip(high, low, self._low + self._tile)
        return Grid.covering(
            low + self.shift_m.min(axis=0), high + self.shift_m.max(axis=0) + STAIRS_CELL_M,
            STAIRS_CELL_M,
        )  # fmt: skip

    def raster(self, settings: RasterSettings) -> PlanRaster:
        """Return the cells of all levels; made once."""
        if settings not in self._rasters:
            self._rasters[settings] = rasterize(self.plan, settings, self._sheets())
        return self._rasters[settings]

    def _sheets(self) -> list[FloorPlan]:
        """Plans of the sheets where they lie; none where there is one level."""
        if len(self.names) == 1:
            return []
        return [
            FloorPlan(
                plan.segments_m + shift, plan.classes,
                outline_m=None if plan.outline_m is None else plan.outline_m + shift,
                name=plan.name,
            )
            for plan, shift in zip(self.building.levels, self.shift_m, strict=True)
        ]  # fmt: skip

    @cached_property
    def _rasters(self) -> dict[RasterSettings, PlanRaster]:
        return {}

    @cached_property
    def _prepared(self) -> dict[float, tuple[Any, npt.NDArray[np.bool_], FloatArray]]:
        return {}
