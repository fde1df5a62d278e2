"""How a plan looks to a scanner: where walls may be seen, and how much wall is where."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from palms._compiled import raster as cells
from palms.floorplan import SegmentClass
from palms.geometry import FloatArray, as_readonly
from palms.grid import Grid
from palms.raster import PlanRaster
from palms.settings import ObservationSettings

__all__ = ["Field", "Sight", "see"]

OF_CLASS = {  # ours: what a wall of a class may explain, and what it counts in empty space
    SegmentClass.WALL: (1.0, 1.0),
    SegmentClass.DOOR: (0.5, 0.0),  # shut or open
    SegmentClass.GLASS: (0.5, 0.2),  # seldom seen
}

Field = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Sight:
    """A plan as a scanner would see it, in cells.

    Parameters
    ----------
    grid : Grid
    support : (R, C) float32
        Log likelihood ratio, in nats per metre of seen wall, against a wall that the plan
        does not have; 0 far from walls.
    cost : (R, C) float32
        Metres of wall per square metre.
    """

    grid: Grid
    support: Field
    cost: Field

    @property
    def frame(self) -> FloatArray:
        """What the loops need: x and y of the corner, cells per metre."""
        return np.array([*self.grid.origin_m, 1 / self.grid.cell_size_m])


def see(raster: PlanRaster, settings: ObservationSettings, coarse: int = 1) -> Sight:
    """Return the plan as a scanner would see it; kept with the raster.

    Parameters
    ----------
    raster : PlanRaster
    settings : ObservationSettings
    coarse : int
        Cells of the raster along a side of a cell. The support is then blurred by half a
        cell, since the true place lies anywhere within it.
    """
    key = (settings.wall_sd_m, settings.unexplained_share, coarse)
    if key not in raster.sights:
        raster.sights[key] = _see(raster, settings, coarse)
    sight: Sight = raster.sights[key]
    return sight


def _see(raster: PlanRaster, settings: ObservationSettings, coarse: int) -> Sight:
    fine, rare = raster.grid, settings.unexplained_share
    sd = settings.wall_sd_m
    if coarse > 1:
        sd = math.hypot(sd, 0.5 * coarse * fine.cell_size_m)
    support = np.zeros(fine.shape, np.float32)
    cost = np.zeros(fine.shape, np.float32)
    for kind, (explains, counts) in OF_CLASS.items():
        segments = raster.plan.of_class(kind)
        if not len(segments):
            continue
        metres = np.zeros(fine.shape, np.float32)
        flat = np.ascontiguousarray((segments - fine.origin_m).reshape(-1, 4))
        cells.add_lengths(flat, np.ones(len(flat)), fine.cell_size_m, True, metres)
        away = ndimage.distance_transform_edt(metres <= 0) * fine.cell_size_m
        near = explains * (1 - rare) * np.exp(-0.5 * (away / sd) ** 2) + rare
        np.maximum(support, np.log(near / rare), out=support)
        cost += counts * np.minimum(metres, math.sqrt(2)) / fine.cell_size_m
    grid = Grid(
        fine.origin_m, coarse * fine.cell_size_m,
        (-(-fine.shape[0] // coarse), -(-fine.shape[1] // coarse)),
    )  # fmt: skip
    return Sight(grid, _means(support, coarse), _means(cost, coarse))


def _means(field: Field, k: int) -> Field:
    """Means of blocks of k x k cells; beyond the border there is nothing."""
    rows, columns = (-(-n // k) for n in field.shape)
    padded = np.pad(field, [(0, rows * k - field.shape[0]), (0, columns * k - field.shape[1])])
    mean: Field = as_readonly(
        padded.reshape(rows, k, columns, k).mean(axis=(1, 3)), np.float32
    )  # fmt: skip
    return mean
