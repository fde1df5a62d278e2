"""PlanRaster: a floor plan as cells to match against and as walls to meet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.fft

from palms._compiled import distance
from palms._compiled import filter as loops
from palms._compiled import raster as cells
from palms.errors import InputError
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray, as_readonly
from palms.grid import Grid
from palms.settings import RasterSettings

__all__ = ["PlanRaster", "away_cells", "rasterize"]

BUCKET_CELLS = 5  # ours: buckets of half a metre hold two to four walls indoors
INSIDE_CELL_M = 0.3  # ours: the inside of a building needs no finer cells
SLACK_M = 1e-6  # buckets overlap by this, so that rounding loses no wall


@dataclass(frozen=True)
class PlanRaster:
    """A floor plan, rasterised once and used by every match and every move.

    Parameters
    ----------
    plan : FloorPlan
        Where it comes from.
    grid : Grid
        Its cells.
    density : (R, C) float32
        Cells' worth of wall in each cell, weighted by class: the bitmap of paper III-B, but
        smooth, so that a wall shifted by half a cell gives half of the change.
    inside : (R, C) bool
        Cells inside the building, walls included: the plan's outline where it has one; else
        what the walls enclose once gaps of up to twice `closing_m` are closed. Where that is
        much less than the walls' hull, the plan has holes, and the hull counts as inside too:
        a place too many dies at the first wall, a place left out is never found.
    walls : Walls
        What the particle loops need to know where moves end.
    settings : RasterSettings
    sights : dict
        What `palms.observation` has worked out of it, kept for the next scan.

    Examples
    --------
    >>> square = [[[0, 0], [4, 0]], [[4, 0], [4, 4]], [[4, 4], [0, 4]], [[0, 4], [0, 0]]]
    >>> raster = rasterize(FloorPlan(square))
    >>> raster.grid.shape, bool(raster.inside[30, 30]), bool(raster.inside[2, 2])
    ((80, 80), True, False)
    """

    plan: FloorPlan
    grid: Grid
    density: npt.NDArray[np.float32]
    inside: npt.NDArray[np.bool_]
    walls: loops.Walls
    settings: RasterSettings
    sights: dict[tuple[str | float, ...], Any] = field(
        default_factory=dict, repr=False, compare=False
    )
    _spectra: dict[tuple[int, ...], npt.NDArray[np.complex64]] = field(
        default_factory=dict, repr=False, compare=False
    )

    def __getstate__(self) -> dict[str, Any]:
        """Leave behind what was worked out of it: in another process it may not be needed."""
        return {**self.__dict__, "sights": {}, "_spectra": {}}

    def blocked(self, start_m: npt.ArrayLike, end_m: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Whether each move from start (N, 2) to end (N, 2) touches a wall or ends outside.

        Exact along the whole move, whatever its length; standing still is never blocked.
        """
        start = np.ascontiguousarray(start_m, dtype=np.float64).reshape(-1, 2)
        end = np.ascontiguousarray(end_m, dtype=np.float64).reshape(-1, 2)
        out = np.empty(len(start), np.bool_)
        loops.blocked(self.walls, start, end, out)
        return out

    def spectrum(self, shape: tuple[int, int], offset: int) -> npt.NDArray[np.complex64]:
        """Fourier transform of `density`, set off by some zeros and padded to `shape`; cached."""
        key = (*shape, offset)
        if key not in self._spectra:
            padded = np.zeros(shape, np.float32)
            rows, columns = self.grid.shape
            padded[offset : offset + rows, offset : offset + columns] = self.density
            self._spectra[key] = scipy.fft.rfft2(padded)
        return self._spectra[key]


def rasterize(
    plan: FloorPlan, settings: RasterSettings | None = None, parts: Sequence[FloorPlan] = ()
) -> PlanRaster:
    """Turn a floor plan into cells (paper III-B, "rasterizing these segments into bitmaps").

    Parameters
    ----------
    plan : FloorPlan
    settings : RasterSettings, optional
    parts : sequence of FloorPlan, optional
        Plans apart from each other that make up this one: nothing between them is inside.

    Raises
    ------
    InputError
        When it would take more cells than the settings allow.
    """
    settings = settings or RasterSettings()
    grid = _grid(plan, settings)
    density = _weighted(plan, grid, settings)
    np.minimum(density, np.sqrt(2), out=density)  # no cell holds more than one straight wall
    density.setflags(write=False)
    inside = (
        _inside_each(parts, grid, settings) if parts else _inside(plan, grid, density, settings)
    )
    walls = _walls(plan.blocking_m, grid, _near(inside, settings.margin_m / grid.cell_size_m))
    return PlanRaster(plan, grid, density, inside, walls, settings)


def _grid(plan: FloorPlan, settings: RasterSettings) -> Grid:
    low, high = plan.bounds_m
    width, height = (high - low) + 2 * settings.margin_m
    cells_needed = width * height / settings.cell_size_m**2
    if cells_needed > settings.max_cells:
        enough = float(np.ceil(100 * np.sqrt(width * height / settings.max_cells)) / 100)
        raise InputError(
            f"floor plan {plan.name}",
            expected=f"at most {settings.max_cells:,} cells",
            got=f"{width:.4g} x {height:.4g} m, {cells_needed:,.0f} cells of "
            f"{settings.cell_size_m:g} m",
            fix=f"use a cell size of {enough:g} m, crop the plan, or check its unit",
        )
    return Grid.covering(low - settings.margin_m, high + settings.margin_m, settings.cell_size_m)


def _flat(segments_m: FloatArray, grid: Grid) -> FloatArray:
    """Segments (N, 4) relative to the grid's corner."""
    return np.ascontiguousarray((segments_m - grid.origin_m).reshape(-1, 4))


def _density(
    segments_m: FloatArray, weights: FloatArray, grid: Grid, spread: bool
) -> npt.NDArray[np.float32]:
    out = np.zeros(grid.shape, np.float32)
    cells.add_lengths(_flat(segments_m, grid), weights, grid.cell_size_m, spread, out)
    return out


def _weighted(plan: FloorPlan, grid: Grid, settings: RasterSettings) -> npt.NDArray[np.float32]:
    """Metres of wall in each cell, by what their class counts."""
    by_class = np.array(
        [settings.wall_weight, settings.door_weight, settings.opening_weight, settings.glass_weight]
    )
    return _density(plan.segments_m, by_class[plan.classes], grid, spread=True)


def _walls(blocking_m: FloatArray, grid: Grid, indoors: npt.NDArray[np.bool_]) -> loops.Walls:
    cell = grid.cell_size_m
    on_wall = _density(blocking_m, np.ones(len(blocking_m)), grid, spread=False) > 0
    half_cells = away_cells(indoors & ~on_wall)  # from here on in place: plans may be large
    half_cells *= 2
    np.clip(half_cells, 1, 255, out=half_cells)
    clearance = half_cells.astype(np.uint8)
    clearance[~indoors] = loops.OUTSIDE
    bucket = BUCKET_CELLS * cell
    rows, columns = (-(-n // BUCKET_CELLS) for n in grid.shape)
    start, items = cells.bucket_segments(_flat(blocking_m, grid), bucket, rows, columns, SLACK_M)
    return loops.Walls(
        as_readonly(blocking_m.reshape(-1, 4)),
        as_readonly(clearance, np.uint8),
        as_readonly(start, np.int32),
        as_readonly(items, np.int32),
        as_readonly([*grid.origin_m, 1 / cell, 1 / bucket, rows, columns]),
    )


def _inside(
    plan: FloorPlan, grid: Grid, density: npt.NDArray[np.float32], settings: RasterSettings
) -> npt.NDArray[np.bool_]:
    """Find the inside on a coarser grid: it is smooth, and large plans are many cells."""
    k = max(1, round(INSIDE_CELL_M / grid.cell_size_m))
    rows, columns = (-(-n // k) for n in grid.shape)
    coarse = Grid(grid.origin_m, k * grid.cell_size_m, (rows, columns))
    if plan.outline_m is not None:
        inside = _within(plan.outline_m, coarse)
    else:
        padded = np.zeros((rows * k, columns * k), np.bool_)
        padded[: grid.shape[0], : grid.shape[1]] = density > 0
        walls = np.asarray(padded.reshape(rows, k, columns, k).any(axis=(1, 3)))
        inside = _enclosed(walls, settings.closing_m / coarse.cell_size_m)
        hull = _within(_hull(plan.segments_m), coarse)
        if inside.sum() < settings.enclosed_share * hull.sum():
            inside |= hull
    fine = inside.repeat(k, axis=0).repeat(k, axis=1)[: grid.shape[0], : grid.shape[1]]
    mask: npt.NDArray[np.bool_] = as_readonly(fine, np.bool_)
    return mask


def away_cells(mask: npt.NDArray[np.bool_]) -> FloatArray:
    """Return the distance (R, C), in cells, of set cells to the nearest that is not set."""
    away = np.empty(mask.shape)
    distance.to_clear(mask, away)
    return away


def _inside_each(
    parts: Sequence[FloorPlan], grid: Grid, settings: RasterSettings
) -> npt.NDArray[np.bool_]:
    """Find the inside of each part by itself; all grids have their corners on whole cells."""
    inside = np.zeros(grid.shape, np.bool_)
    for part in parts:
        own = _grid(part, settings)
        column, row = np.rint((own.origin_m - grid.origin_m) / grid.cell_size_m).astype(int)
        of_part = _inside(part, own, _weighted(part, own, settings), settings)
        rows, columns = own.shape
        inside[row : row + rows, column : column + columns] |= of_part
    return as_readonly(inside, np.bool_)


def _near(mask: npt.NDArray[np.bool_], radius: float) -> npt.NDArray[np.bool_]:
    """Return the cells within `radius` cells of a mask."""
    return np.asarray(away_cells(~mask) <= radius)


def _within(outline_m: FloatArray, grid: Grid) -> npt.NDArray[np.bool_]:
    import shapely

    polygon = shapely.make_valid(shapely.Polygon(outline_m))
    shapely.prepare(polygon)
    inside = np.empty(grid.shape, np.bool_)
    column = np.arange(grid.shape[1])
    for row in range(grid.shape[0]):
        x, y = grid.position_of(np.stack([np.full_like(column, row), column], axis=-1)).T
        inside[row] = shapely.contains_xy(polygon, x, y)
    return inside


def _hull(segments_m: FloatArray) -> FloatArray:
    import shapely

    points: Any = shapely.MultiPoint(segments_m.reshape(-1, 2))
    hull = shapely.concave_hull(points, ratio=0.3)
    if hull.geom_type != "Polygon":
        hull = points.buffer(0.5).convex_hull
    return np.asarray(hull.exterior.coords)


def _enclosed(walls: npt.NDArray[np.bool_], radius: float) -> npt.NDArray[np.bool_]:
    """Return what walls enclose after morphological closing by a disc of `radius` cells."""
    pad = int(np.ceil(radius)) + 2
    padded = np.pad(walls, pad)
    filled = np.empty(padded.shape, np.bool_)
    distance.enclosed(_near(padded, radius), filled)
    shrunk = away_cells(filled) > radius
    return np.ascontiguousarray((shrunk | padded)[pad:-pad, pad:-pad])
