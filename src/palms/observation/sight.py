"""A plan as a scanner would see it, in cells; made once and kept with the raster."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms._compiled import raster as cells
from palms.floorplan import SegmentClass
from palms.geometry import FloatArray, as_readonly
from palms.grid import Grid
from palms.raster import PlanRaster, away_cells
from palms.settings import ObservationSettings

__all__ = ["Blurred", "Field", "Sight", "blurred", "coarseness", "see"]

OF_CLASS = {  # ours: what a wall of a class may explain, and what it counts in empty space
    SegmentClass.WALL: (1.0, 1.0),
    SegmentClass.DOOR: (0.5, 0.0),  # shut or open
    SegmentClass.GLASS: (0.5, 0.2),  # seldom seen
}

FAR = 9.5  # standard deviations from a wall where it explains nothing, to the last bit

Field = npt.NDArray[np.float32]
Blur = tuple[float, float]  # standard deviation of walls in metres, and what they do not explain


@dataclass(frozen=True, slots=True)
class Sight:
    """A plan for poses to be judged one by one.

    Parameters
    ----------
    grid : Grid
    support : (R, C) float32
        Log likelihood ratio, in nats per metre of seen wall, against a wall that the plan
        does not have; 0 far from walls.
    metres : (R, C) float32
        Metres of wall per square metre, as they count where space is seen empty.
    wall : (R, C) int32
        Number of the wall that they belong to; -1 where there is none.
    n_walls : int
    """

    grid: Grid
    support: Field
    metres: Field
    wall: npt.NDArray[np.int32]
    n_walls: int

    @property
    def frame(self) -> FloatArray:
        """What the loops need: x and y of the corner, cells per metre."""
        return _frame(self.grid)


@dataclass(frozen=True, slots=True)
class Blurred:
    """A plan for whole maps: coarser cells, and walls as wide as the plan may err.

    Parameters
    ----------
    grid : Grid
    support, metres : (R, C) float32
        As in `Sight`.
    """

    grid: Grid
    support: Field
    metres: Field

    @property
    def frame(self) -> FloatArray:
        """What the loops need: x and y of the corner, cells per metre."""
        return _frame(self.grid)


def see(raster: PlanRaster, settings: ObservationSettings) -> Sight:
    """Return the plan for poses to be judged; kept with the raster.

    Parameters
    ----------
    raster : PlanRaster
    settings : ObservationSettings
    """
    key = _sight_key(settings)
    if key not in raster.sights:
        _make(raster, settings, coarseness(raster.grid, settings))
    sight: Sight = raster.sights[key]
    return sight


def blurred(raster: PlanRaster, settings: ObservationSettings, coarse: int = 1) -> Blurred:
    """Return the plan for whole maps; kept with the raster.

    Parameters
    ----------
    raster : PlanRaster
    settings : ObservationSettings
    coarse : int
        Cells of the raster along a side of a cell. The walls are then blurred by half a cell
        more, since the true place lies anywhere within it.
    """
    key = _blurred_key(settings, coarse)
    if key not in raster.sights:
        _make(raster, settings, coarse if coarse > 1 else coarseness(raster.grid, settings))
    field: Blurred = raster.sights[key]
    return field


def coarseness(grid: Grid, settings: ObservationSettings) -> int:
    """Return how many cells of the raster lie along a side of a cell of the search."""
    k = max(1, round(settings.cell_size_m / grid.cell_size_m))
    while grid.size / k**2 > settings.max_cells:
        k += 1
    return k


def _sight_key(settings: ObservationSettings) -> tuple[str | float, ...]:
    return ("sight", settings.wall_sd_m, settings.unexplained_share)


def _blurred_key(settings: ObservationSettings, coarse: int) -> tuple[str | float, ...]:
    return ("blurred", settings.search_sd_m, settings.search_share, coarse)


def _make(raster: PlanRaster, settings: ObservationSettings, coarse: int) -> None:
    """Keep all that a scan is looked up in, once: it shares how far cells lie from walls."""
    grid, sd = raster.grid, settings.search_sd_m
    wide = sd if coarse == 1 else math.hypot(sd, 0.5 * coarse * grid.cell_size_m)
    of_poses = (settings.wall_sd_m, settings.unexplained_share)
    of_cells, of_maps = (sd, settings.search_share), (wide, settings.search_share)
    supports, metres = _fields(raster, {of_poses, of_cells, of_maps})
    wall, n_walls = _walls(raster, metres)
    shape = (-(-grid.shape[0] // coarse), -(-grid.shape[1] // coarse))
    made: dict[tuple[str | float, ...], Sight | Blurred] = {
        _sight_key(settings): Sight(grid, supports[of_poses], metres, wall, n_walls),
        _blurred_key(settings, 1): Blurred(grid, supports[of_cells], metres),
        _blurred_key(settings, coarse): Blurred(
            Grid(grid.origin_m, coarse * grid.cell_size_m, shape),
            _means(supports[of_maps], coarse), _means(metres, coarse),
        ),
    }  # fmt: skip
    for key, each in made.items():
        raster.sights.setdefault(key, each)


def _frame(grid: Grid) -> FloatArray:
    return np.array([*grid.origin_m, 1 / grid.cell_size_m])


def _fields(raster: PlanRaster, blurs: set[Blur]) -> tuple[dict[Blur, Field], Field]:
    """Support, cell by cell, for each standard deviation and share; and metres."""
    grid = raster.grid
    support = {blur: np.zeros(grid.shape, np.float32) for blur in blurs}
    counted, here = np.zeros(grid.shape, np.float32), np.empty(grid.shape, np.float32)
    for kind, (explains, counts) in OF_CLASS.items():
        if not len(raster.plan.of_class(kind)):
            continue
        metres, squared = _of_class(raster, kind)
        for (sd, rare), most in support.items():
            by_distance = _explained(explains, sd, rare, grid.cell_size_m)
            np.maximum(most, by_distance.take(squared, mode="clip", out=here), out=most)
        np.minimum(metres, math.sqrt(2), out=metres)
        metres *= counts
        metres /= grid.cell_size_m
        counted += metres
        del metres, squared  # plans may be large
    for field in (*support.values(), counted):
        field.setflags(write=False)
    return support, counted


def _explained(explains: float, sd: float, rare: float, cell_m: float) -> Field:
    """Support (D,) so many cells, squared, from a wall that explains so much; the last is 0."""
    cells = np.arange(math.ceil((FAR * sd / cell_m) ** 2) + 1)
    near = explains * (1 - rare) * np.exp(-0.5 * (np.sqrt(cells) * cell_m / sd) ** 2) + rare
    near[-1] = rare
    return np.log(near / rare).astype(np.float32)


def _of_class(raster: PlanRaster, kind: SegmentClass) -> tuple[Field, npt.NDArray[np.int32]]:
    """Cells' worth of wall of a class in each cell; squared distance from any, in cells."""
    grid = raster.grid
    metres = np.zeros(grid.shape, np.float32)
    flat = np.ascontiguousarray((raster.plan.of_class(kind) - grid.origin_m).reshape(-1, 4))
    cells.add_lengths(flat, np.ones(len(flat)), grid.cell_size_m, True, metres)
    away = away_cells(metres <= 0)
    np.square(away, out=away)
    return metres, np.rint(away, out=away).astype(np.int32)


def _walls(raster: PlanRaster, metres: Field) -> tuple[npt.NDArray[np.int32], int]:
    """Return the number of the wall in each cell, -1 for none, and how many walls there are."""
    plan, grid = raster.plan, raster.grid
    counting = [plan.of_class(kind) for kind, (_, counts) in OF_CLASS.items() if counts > 0]
    segments = np.concatenate(counting)
    wall = np.full(grid.shape, -1, np.int32)
    flat = np.ascontiguousarray((segments - grid.origin_m).reshape(-1, 4))
    cells.number(flat, grid.cell_size_m, wall)
    wall[metres <= 0] = -1
    wall.setflags(write=False)
    return wall, len(segments)


def _means(field: Field, k: int) -> Field:
    """Means of blocks of k x k cells; beyond the border there is nothing."""
    if k == 1:
        return field
    rows, columns = (-(-n // k) for n in field.shape)
    padded = np.pad(field, [(0, rows * k - field.shape[0]), (0, columns * k - field.shape[1])])
    mean: Field = as_readonly(
        padded.reshape(rows, k, columns, k).mean(axis=(1, 3)), np.float32
    )  # fmt: skip
    return mean
