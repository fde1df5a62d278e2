"""Points to columns: cells of the ground whose points reach over a wall's height."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms.extraction.settings import ExtractionSettings
from palms.geometry import FloatArray

__all__ = ["LAYER_M", "Columns", "find_columns", "floor_height_m", "height_of_bits_m"]

LAYER_M = 0.1  # ours: heights are told apart by this much
_BIN_M = 0.05  # ours: of the histogram of heights
_LEVEL = 2.0  # ours: a floor has so many times the points of a usual height
_BELOW_SHARE = 0.02  # ours: at most so much lies below a floor: reflections
_STRAY_SHARE = 0.001  # ours: so much may lie anywhere
_CAMERA_M, _BELOW_CAMERA_M = 1.4, (0.6, 2.1)  # ours: usual and possible height of a hand
_NEIGHBOURS = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]


@dataclass(frozen=True, slots=True)
class Columns:
    """Cells of the ground whose points may be a wall's.

    Parameters
    ----------
    centre_m : ndarray (N, 2)
        Mean of the points of each.
    layers : ndarray (N,)
        Heights that hold points, as bits: bit k for the k-th tenth of a metre of the band.
    points_m : ndarray (P, 2)
        The points of all columns on the ground.
    column : ndarray (P,)
        The column of each point.
    band_m : ndarray (B, 2)
        All points of the band, whatever their column.
    """

    centre_m: FloatArray
    layers: npt.NDArray[np.int64]
    points_m: FloatArray
    column: npt.NDArray[np.int64]
    band_m: FloatArray

    def __len__(self) -> int:
        return len(self.centre_m)

    @property
    def weight(self) -> FloatArray:
        """Number of heights (N,) that hold points."""
        return np.bitwise_count(self.layers).astype(np.float64)


def floor_height_m(height_m: FloatArray, camera_m: float | None = None) -> float:
    """Height of the floor: the lowest level at which many points lie, with few below it.

    Parameters
    ----------
    height_m : ndarray (P,)
        Heights of points; P at least 1.
    camera_m : float, optional
        Height of the camera, when there was one: the floor lies below by what people's
        arms allow.

    Returns
    -------
    float
        Without such a level, what lies below nearly all points, or below the camera.

    Examples
    --------
    >>> floor_height_m(np.concatenate([np.full(500, -1.4), np.linspace(-1.4, 1.0, 300)]))
    -1.4
    """
    lowest, highest = (float(v) for v in np.quantile(height_m, [_STRAY_SHARE, 1 - _STRAY_SHARE]))
    usual = len(height_m) * _BIN_M / max(highest - lowest, _BIN_M)
    low, high, guess = lowest, highest, lowest
    if camera_m is not None:
        low, high = camera_m - _BELOW_CAMERA_M[1], camera_m - _BELOW_CAMERA_M[0]
        guess = camera_m - _CAMERA_M
    inside = height_m[(height_m >= low - _BIN_M) & (height_m <= high + _BIN_M)]
    counts = np.bincount(((inside - low) / _BIN_M + 1).astype(np.int64), minlength=4)
    below = np.cumsum(counts) - counts + np.sum(height_m < low - _BIN_M)
    level = counts >= _LEVEL * usual
    if camera_m is None:
        level &= below - np.roll(counts, 1) <= _BELOW_SHARE * len(height_m)
    if not level.any():
        return guess
    peak = int(np.where(level, counts, -1).argmax())
    near = np.abs(height_m - (low + (peak - 0.5) * _BIN_M)) <= _BIN_M
    return float(np.median(height_m[near]))


def find_columns(points_m: FloatArray, settings: ExtractionSettings) -> Columns:
    """Gather points in columns, and keep those that reach over a wall's height.

    Parameters
    ----------
    points_m : ndarray (P, 3)
        On the ground x and y, and height above the floor.
    settings : ExtractionSettings

    Examples
    --------
    >>> z = np.linspace(0.3, 2.1, 40)
    >>> wall = np.column_stack([0 * z + 1.01, 0 * z + 2.01, z])
    >>> len(find_columns(wall, ExtractionSettings()))
    1
    """
    z = points_m[:, 2] - settings.low_m
    in_band = (z >= 0) & (z < settings.high_m - settings.low_m)
    xy, layer = points_m[in_band, :2], (z[in_band] / LAYER_M).astype(np.int64)
    cell = np.floor(xy / settings.cell_m).astype(np.int64)
    if not len(cell):
        return Columns(xy, np.empty(0, np.int64), xy, np.empty(0, np.int64), xy)
    cell -= cell.min(axis=0) - 1
    width = int(cell[:, 1].max()) + 2
    keys, column = np.unique(cell[:, 0] * width + cell[:, 1], return_inverse=True)
    layers = _layers(column, layer, len(keys))
    high = height_of_bits_m(_with_neighbours(keys, layers, width), settings) > 0
    kept = np.cumsum(high) - 1
    mine = high[column]
    band, column, xy = xy, kept[column[mine]], xy[mine]
    count = np.bincount(column, minlength=high.sum())
    centre = [np.bincount(column, xy[:, k], high.sum()) / np.maximum(count, 1) for k in (0, 1)]
    return Columns(np.stack(centre, axis=1), layers[high], xy, column, band)


def _layers(
    column: npt.NDArray[np.int64], layer: npt.NDArray[np.int64], count: int
) -> npt.NDArray[np.int64]:
    """Bits (count,) of the layers that hold points."""
    seen = np.unique(column * 64 + layer)
    starts = np.searchsorted(seen, np.arange(count) * 64)
    return np.bitwise_or.reduceat(np.left_shift(1, seen % 64), starts)


def _with_neighbours(
    keys: npt.NDArray[np.int64], layers: npt.NDArray[np.int64], width: int
) -> npt.NDArray[np.int64]:
    """Layers of each column and the eight around it: sparse clouds fill no column alone."""
    together = np.zeros_like(layers)
    for i, j in _NEIGHBOURS:
        wanted = keys + i * width + j
        at = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
        together |= np.where(keys[at] == wanted, layers[at], 0)
    return together


def height_of_bits_m(layers: npt.NDArray[np.int64], settings: ExtractionSettings) -> FloatArray:
    """Height that layers reach over, 0 where it is too little, too thin or too high up.

    Examples
    --------
    >>> full, table = 0b1111111111, 0b11
    >>> height_of_bits_m(np.array([full, table]), ExtractionSettings()).tolist()
    [1.0, 0.0]
    """
    some = np.maximum(layers, 1)
    highest = np.floor(np.log2(some))
    lowest = np.log2(some & -some)
    span = np.where(layers > 0, highest - lowest + 1, 0)
    filled = np.bitwise_count(layers) >= settings.fill_share * span
    high = span * LAYER_M >= settings.min_height_m - 1e-9
    down = settings.low_m + lowest * LAYER_M <= settings.reach_down_m
    return np.asarray(np.where(filled & high & down, span * LAYER_M, 0.0))
