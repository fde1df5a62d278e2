"""A scan as points on its walls and in its empty space."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms.geometry import FloatArray, as_readonly
from palms.scan import Scan
from palms.settings import ObservationSettings

__all__ = ["ScanPoints", "scan_points"]

BEARINGS = 360  # ours: empty space is known for every degree
ERODE = 2  # ours: bearings on either side that must be free as well


@dataclass(frozen=True, slots=True)
class ScanPoints:
    """A scan as points, seen from its observation point, axes of the odom frame.

    Parameters
    ----------
    wall_m : (P, 2)
        On the walls, wall by wall.
    wall_weight_m : (P,)
        Metres of wall that each stands for.
    first : (W + 1,) int64
        Where each wall's points begin; the last is P.
    normal : (W, 2)
        Across each wall, of length 1.
    empty_m : (E, 2)
        In space that is proven empty.
    empty_m2 : float
        Square metres that each of these stands for.
    """

    wall_m: FloatArray
    wall_weight_m: FloatArray
    first: npt.NDArray[np.int64]
    normal: FloatArray
    empty_m: FloatArray
    empty_m2: float

    @property
    def reach_m(self) -> float:
        """Distance of the farthest point."""
        points = np.concatenate([self.wall_m, self.empty_m])
        return float(np.linalg.norm(points, axis=1).max())


def scan_points(scan: Scan, settings: ObservationSettings | None = None) -> ScanPoints:
    """Turn a scan into points on its walls and in its empty space.

    Parameters
    ----------
    scan : Scan
    settings : ObservationSettings, optional

    Examples
    --------
    >>> points = scan_points(Scan([[[2.0, -1.0], [2.0, 1.0]]]))
    >>> round(float(points.wall_weight_m.sum()), 6), bool((points.empty_m[:, 0] < 1.9).all())
    (2.0, True)
    """
    settings = settings or ObservationSettings()
    along = scan.relative_m[:, 1] - scan.relative_m[:, 0]
    length = np.linalg.norm(along, axis=1)
    counts = np.maximum(1, np.round(length / settings.spacing_m)).astype(np.int64)
    wall = np.repeat(np.arange(len(counts)), counts)
    first = np.concatenate([[0], np.cumsum(counts)])
    part = (np.arange(first[-1]) - first[wall] + 0.5) / counts[wall]
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.maximum(length, 1e-9)[:, None]
    return ScanPoints(
        as_readonly(scan.relative_m[wall, 0] + part[:, None] * along[wall]),
        as_readonly((length / counts)[wall]), as_readonly(first, np.int64), as_readonly(normal),
        as_readonly(_empty_m(scan, settings)), settings.spacing_m**2,
    )  # fmt: skip


def _empty_m(scan: Scan, settings: ObservationSettings) -> FloatArray:
    """Points (E, 2) on a lattice in the space that is surely empty."""
    free = np.minimum(_free_m(scan), settings.empty_range_m)
    free = np.nan_to_num(free - settings.empty_margin_m, nan=0.0)
    free = np.min([np.roll(free, k) for k in range(-ERODE, ERODE + 1)], axis=0)
    n = max(1, math.ceil(max(float(free.max()), 0.0) / settings.spacing_m))
    x, y = (axis.ravel() * settings.spacing_m for axis in np.meshgrid(*2 * [np.arange(-n, n + 1)]))
    bearing = np.floor(np.mod(np.arctan2(y, x), 2 * np.pi) / (2 * np.pi) * BEARINGS)
    empty = np.hypot(x, y) < free[bearing.astype(int) % BEARINGS]
    return np.stack([x[empty], y[empty]], axis=1)


def _free_m(scan: Scan) -> FloatArray:
    """How far it is surely free by bearing: up to the nearest wall seen; NaN where none was.

    What the scan itself says of its coverage counts too, where it is nearer.
    """
    angle = (np.arange(BEARINGS) + 0.5) * 2 * np.pi / BEARINGS
    beam = np.stack([np.cos(angle), np.sin(angle)], axis=1)[:, None]
    start, along = scan.relative_m[:, 0], scan.relative_m[:, 1] - scan.relative_m[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        across = beam[..., 0] * along[:, 1] - beam[..., 1] * along[:, 0]
        range_m = (start[:, 0] * along[:, 1] - start[:, 1] * along[:, 0]) / across
        part = (start[:, 0] * beam[..., 1] - start[:, 1] * beam[..., 0]) / across
    met = (range_m > 0) & (part >= 0) & (part <= 1)
    free: FloatArray = np.where(met, range_m, np.inf).min(axis=1)
    free[np.isinf(free)] = np.nan
    if scan.coverage_m is not None:
        index = (angle / (2 * np.pi) * len(scan.coverage_m)).astype(int)
        free = np.fmin(free, scan.coverage_m[index])
    return free
