"""Template: what a scan says about walls and empty space around its anchor (paper III-B)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms._compiled import raster as cells
from palms.errors import InputError
from palms.geometry import FloatArray, as_readonly, rotate
from palms.grid import Grid
from palms.scan import Scan
from palms.settings import TemplateSettings

__all__ = ["Template", "build_template", "certainly_empty", "empty_triangles", "recorded_walls"]


@dataclass(frozen=True, slots=True)
class Template:
    """The paper's convolution kernel, RW - alpha * CES, turned by one drift.

    Parameters
    ----------
    values : (h, w) float32
        Its cells.
    anchor : tuple of int
        (row, column) of the cell whose centre is the observation point: it travels with the
        template, so that no shift is ever needed.
    drift_rad : float
        The drift it is turned by.
    """

    values: npt.NDArray[np.float32]
    anchor: tuple[int, int]
    drift_rad: float

    def __post_init__(self) -> None:
        values = as_readonly(self.values, np.float32)
        if values.ndim != 2 or not all(
            0 <= a < n for a, n in zip(self.anchor, values.shape, strict=True)
        ):
            raise InputError(
                "template", expected="an anchor on it", got=f"{self.anchor} of {values.shape}"
            )
        object.__setattr__(self, "values", values)


def build_template(
    scan: Scan, drift_rad: float, cell_size_m: float, settings: TemplateSettings | None = None
) -> Template:
    """Turn a scan by a drift and make the template RW - alpha * CES of it (paper III-B).

    Parameters
    ----------
    scan : Scan
    drift_rad : float
        Turns odom vectors into map vectors.
    cell_size_m : float
        Of the plan's raster.
    settings : TemplateSettings, optional

    Returns
    -------
    Template

    Examples
    --------
    >>> ahead = Scan([[[2, -1], [2, 1]]])
    >>> template = build_template(ahead, np.pi / 2, 0.1)
    >>> row, column = np.unravel_index(template.values.argmax(), template.values.shape)
    >>> int(row - template.anchor[0]), abs(int(column - template.anchor[1])) < 10
    (20, True)
    """
    settings = settings or TemplateSettings()
    walls_m = rotate(scan.relative_m, drift_rad)
    grid, anchor = _frame(walls_m, cell_size_m, settings)
    values = recorded_walls(walls_m, grid, settings)
    values -= settings.empty_weight * certainly_empty(walls_m, grid, settings)
    return Template(values, anchor, drift_rad)


def recorded_walls(
    walls_m: FloatArray, grid: Grid, settings: TemplateSettings
) -> npt.NDArray[np.float32]:
    """RW of paper III-B: the observed walls (N, 2, 2), smoothed, on a grid around (0, 0)."""
    from scipy import ndimage

    flat = np.ascontiguousarray((walls_m - grid.origin_m).reshape(-1, 4))
    density = np.zeros(grid.shape, np.float32)
    cells.add_lengths(flat, np.ones(len(flat)), grid.cell_size_m, True, density)
    np.minimum(density, np.sqrt(2), out=density)
    sigma = settings.wall_sigma_m / grid.cell_size_m
    radius = settings.truncate_cells or int(np.ceil(4 * sigma))
    walls = ndimage.gaussian_filter(density, sigma, mode="constant", radius=radius)
    if np.isfinite(settings.range_sigma_m):
        walls *= np.exp(-0.5 * _range_m(grid) ** 2 / settings.range_sigma_m**2)
    total = walls.max() if settings.wall_scale == "peak" else walls.sum()
    return np.asarray(walls / max(float(total), 1e-12), dtype=np.float32)


def certainly_empty(
    walls_m: FloatArray, grid: Grid, settings: TemplateSettings
) -> npt.NDArray[np.float32]:
    """CES of paper III-B: 1 where no wall can be, on a grid around (0, 0)."""
    from scipy import ndimage

    triangles = empty_triangles(walls_m, settings.empty_shrink)
    empty = np.zeros(grid.shape, np.uint8)
    corners = np.ascontiguousarray((triangles - grid.origin_m).reshape(-1, 6))
    cells.fill_triangles(corners, grid.cell_size_m, empty)
    if settings.empty_erode_cells:
        empty = ndimage.binary_erosion(empty, iterations=settings.empty_erode_cells)
    if np.isfinite(settings.empty_range_m):
        empty = empty * (_range_m(grid) <= settings.empty_range_m)
    return empty.astype(np.float32)


def empty_triangles(walls_m: FloatArray, shrink: float) -> FloatArray:
    """Triangles (N, 3, 2) between (0, 0) and each wall (N, 2, 2), shrunk towards (0, 0).

    Paper III-B: a wall was seen, so nothing stands before it.

    Examples
    --------
    >>> empty_triangles(np.array([[[2.0, 0.0], [2.0, 1.0]]]), 0.5).tolist()
    [[[0.0, 0.0], [1.0, 0.0], [1.0, 0.5]]]
    """
    corner = np.zeros((len(walls_m), 1, 2))
    return np.concatenate([corner, shrink * walls_m], axis=1)


def template_reach_m(scan: Scan, settings: TemplateSettings) -> float:
    """How far from its anchor a template of this scan can reach, for any drift."""
    far = float(np.linalg.norm(scan.relative_m, axis=-1).max())
    return far + 4 * settings.wall_sigma_m


def _frame(
    walls_m: FloatArray, cell: float, settings: TemplateSettings
) -> tuple[Grid, tuple[int, int]]:
    """Return the grid around (0, 0) that holds the smoothed walls; (0, 0) is a cell's centre."""
    points = np.concatenate([walls_m.reshape(-1, 2), np.zeros((1, 2))])
    reach = 4 * settings.wall_sigma_m
    before = np.ceil((reach - points.min(axis=0)) / cell).astype(int)
    after = np.ceil((reach + points.max(axis=0)) / cell).astype(int)
    columns, rows = (int(n) for n in before + after + 1)
    grid = Grid(as_readonly(-(before + 0.5) * cell), cell, (rows, columns))
    return grid, (int(before[1]), int(before[0]))


def _range_m(grid: Grid) -> FloatArray:
    rows, columns = np.indices(grid.shape)
    centres = grid.position_of(np.stack([rows, columns], axis=-1))
    return np.asarray(np.linalg.norm(centres, axis=-1))
