"""The space that depth rays prove empty, as free ranges by bearing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.extraction.depth import DepthFrame
from palms.extraction.settings import ExtractionSettings
from palms.geometry import FloatArray, check_finite

__all__ = ["BEARINGS", "free_ranges"]

BEARINGS = 360  # ours: sectors of a scan's coverage
_PER_SECTOR = 3  # ours: bearings looked along in each; the shortest counts
_CELL_M = 0.02  # ours
_FAN_RAD = np.deg2rad(0.5)  # ours: bearings told apart in one image
_TOP_SHARE = 0.8  # ours: so many of a bearing's rays may be shorter: floor, furniture, noise
_BODY_M = 1.0  # ours: a user who turns stays within; where they were is free


def free_ranges(
    frames: Sequence[DepthFrame],
    position_m: npt.ArrayLike = (0.0, 0.0),
    settings: ExtractionSettings | None = None,
    step: int = 1,
) -> FloatArray:
    """Find how far depth rays prove that nothing stands, by bearing from one point.

    A ray that ends at a wall, on furniture or on the floor shows that no wall stands
    before its end. The rays of each image sweep a fan; the fans together, and where the
    user stood, are the empty space.

    Parameters
    ----------
    frames : sequence of DepthFrame
    position_m : array_like (2,)
        The observation point, on the ground.
    settings : ExtractionSettings, optional
    step : int
        Only every so manieth row and column of the images.

    Returns
    -------
    ndarray (360,)
        Metres that are free in the sector from ``2 pi b / 360``; NaN where nobody looked.

    Examples
    --------
    >>> level = [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 1.4], [0, 0, 0, 1]]
    >>> frame = DepthFrame(np.full((64, 64), 2.0), [60, 60], [31.5, 31.5], level)
    >>> free = free_ranges([frame])
    >>> round(float(free[90]), 1), bool(np.isnan(free[270]))
    (2.0, True)
    """
    from palms._compiled import raster as cells

    settings = settings or ExtractionSettings()
    here = check_finite(position_m, "the observation point", (2,))
    if not len(frames):
        raise InputError("depth images", expected="at least one", got="none")
    ends = [_rays(frame, settings, step) for frame in frames]
    reach = settings.range_m + 0.5
    count = int(2 * reach / _CELL_M)
    empty = np.zeros((count, count), np.uint8)
    fans = [_fan(frame, rays) for frame, rays in zip(frames, ends, strict=True)]
    triangles = np.concatenate([_body(frames, here), *fans]) - (here - reach)
    cells.fill_triangles(np.ascontiguousarray(triangles.reshape(-1, 6)), _CELL_M, empty)
    free = np.minimum(_cast(_mended(empty), reach), settings.range_m)
    free[~_looked(ends, here)] = np.nan
    return free


def _rays(frame: DepthFrame, settings: ExtractionSettings, step: int) -> FloatArray:
    """Return where the surely free parts of rays end (N, 2), on the ground."""
    ends = frame.ends_m(step).reshape(-1, 3)
    off = ends[np.isfinite(ends[:, 0])] - frame.camera_m
    length = np.linalg.norm(off, axis=1)
    sure = np.clip(length, None, settings.range_m)
    sure = sure * (1 - settings.margin_share) - settings.margin_m
    return np.asarray(frame.camera_m[:2] + off[:, :2] * (np.maximum(sure, 0) / length)[:, None])


def _fan(frame: DepthFrame, ends: FloatArray) -> FloatArray:
    """Triangles (K, 3, 2) from the camera to neighbouring bearings of one image."""
    eye = frame.camera_m[:2]
    off = ends - eye
    turn = np.arctan2(off[:, 1], off[:, 0])
    middle = np.arctan2(np.sin(turn).sum(), np.cos(turn).sum()) if len(turn) else 0.0
    turn = np.mod(turn - middle + np.pi, 2 * np.pi)
    pitch = max(_FAN_RAD, 1.5 / float(frame.focal_px.max()))
    fan = (turn / pitch).astype(np.int64)
    ranges = _upper(fan, np.hypot(*off.T), int(2 * np.pi / pitch) + 2)
    reach = np.fmin(ranges[:-1], ranges[1:])
    known = np.flatnonzero(np.isfinite(ranges[:-1]) & np.isfinite(ranges[1:]))
    corners = []
    for edge in (known + 0.5, known + 1.5):
        bearing = edge * pitch + middle - np.pi
        unit = np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
        corners.append(eye + reach[known, None] * unit)
    return np.stack([np.broadcast_to(eye, corners[0].shape), *corners], axis=1)


def _upper(group: npt.NDArray[np.int64], values: FloatArray, count: int) -> FloatArray:
    """Upper quantile (count,) of the values of each group; NaN for empty ones."""
    order = np.lexsort((values, group))
    counts = np.bincount(group, minlength=count)
    at = np.cumsum(counts) - counts + np.floor(_TOP_SHARE * np.maximum(counts - 1, 0))
    found = np.full(count, np.nan)
    some = counts > 0
    found[some] = values[order][at[some].astype(np.int64)]
    return found


def _body(frames: Sequence[DepthFrame], here: FloatArray) -> FloatArray:
    """Triangles between the places of the camera around a point: the user was there."""
    import shapely

    eyes = np.array([frame.camera_m[:2] for frame in frames])
    near = eyes[np.linalg.norm(eyes - here, axis=1) <= _BODY_M]
    shape = shapely.MultiPoint([*near, here]).convex_hull.buffer(2 * _CELL_M)
    ring = shapely.get_coordinates(shape.exterior)
    middle = np.broadcast_to(ring[:-1].mean(axis=0), ring[1:].shape)
    return np.stack([middle, ring[:-1], ring[1:]], axis=1)


def _mended(empty: npt.NDArray[np.uint8]) -> npt.NDArray[np.bool_]:
    """Close the slits of a cell or two that lie between fans."""
    from scipy.ndimage import binary_closing

    return np.asarray(binary_closing(empty, np.ones((3, 3), bool)), dtype=bool)


def _cast(empty: npt.NDArray[np.bool_], reach: float) -> FloatArray:
    """Range (360,) up to the first cell that is not empty, from the middle."""
    count = BEARINGS * _PER_SECTOR
    bearing = (np.arange(count) + 0.5) * 2 * np.pi / count
    places = np.arange(0.0, reach - 2 * _CELL_M, _CELL_M / 2)
    column = ((reach + np.cos(bearing)[:, None] * places) / _CELL_M).astype(np.int64)
    row = ((reach + np.sin(bearing)[:, None] * places) / _CELL_M).astype(np.int64)
    blocked = ~empty[row, column]
    blocked[:, -1] = True
    free = places[blocked.argmax(axis=1)]
    return np.asarray(free.reshape(BEARINGS, _PER_SECTOR).min(axis=1))


def _looked(ends: Sequence[FloatArray], here: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether any ray ended in each sector (360,)."""
    off = np.concatenate(ends) - here
    sector = np.mod(np.arctan2(off[:, 1], off[:, 0]), 2 * np.pi) * BEARINGS / (2 * np.pi)
    counts = np.bincount(sector.astype(np.int64) % BEARINGS, minlength=BEARINGS)
    sparse = max(np.median(counts[counts > 0]) / 100, 1) if counts.any() else 1
    return np.asarray(counts >= sparse)
