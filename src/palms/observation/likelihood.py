"""The likelihood of a scan at single poses."""

from __future__ import annotations

import numpy as np

from palms._compiled import observation as loops
from palms.geometry import FloatArray, as_readonly
from palms.observation.points import ScanPoints
from palms.observation.sight import blurred, see
from palms.raster import PlanRaster
from palms.settings import ObservationSettings

__all__ = ["empty_nats", "log_likelihood", "rough_nats", "wall_nats"]

SHIFT_M = 0.1  # ours: between the errors of a wall that are tried
EVERY = 5  # ours: so many points of empty space are enough for a rough look
REACH = 2.0  # ours: standard deviations of the larger kind of error that are tried


def log_likelihood(
    points: ScanPoints,
    raster: PlanRaster,
    position_m: FloatArray,
    drift_rad: FloatArray,
    settings: ObservationSettings | None = None,
) -> FloatArray:
    """Return what a scan says about poses, in nats (N,); 0 where it says nothing.

    Against the same scan in a place without any wall of the plan; before `strength`.

    Parameters
    ----------
    points : ScanPoints
    raster : PlanRaster
    position_m : (N, 2)
        Where the scan may have been taken, map frame.
    drift_rad : (N,)
    settings : ObservationSettings, optional

    Examples
    --------
    >>> from palms import FloorPlan, Scan
    >>> from palms.observation import scan_points
    >>> from palms.raster import rasterize
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
    >>> seen, plan = scan_points(Scan(room - (2.0, 1.0))), rasterize(FloorPlan(room))
    >>> there, off = log_likelihood(seen, plan, np.array([[2.0, 1.0], [2.5, 1.0]]), np.zeros(2))
    >>> bool(there > off + 5)
    True
    """
    settings = settings or ObservationSettings()
    walls = wall_nats(points, raster, position_m, drift_rad, settings)
    return walls + empty_nats(points, raster, position_m, drift_rad, settings)


def wall_nats(
    points: ScanPoints,
    raster: PlanRaster,
    position_m: FloatArray,
    drift_rad: FloatArray,
    settings: ObservationSettings,
) -> FloatArray:
    """Return what the walls that were seen say; see `log_likelihood`."""
    sight, said = see(raster, settings), np.empty(len(position_m))
    loops.walls(
        *_contiguous(position_m, drift_rad), points.wall_m, points.wall_weight_m, points.first,
        points.normal, *_errors(settings), settings.unplanned_share, sight.support, sight.frame,
        said,
    )  # fmt: skip
    return said


def empty_nats(
    points: ScanPoints,
    raster: PlanRaster,
    position_m: FloatArray,
    drift_rad: FloatArray,
    settings: ObservationSettings,
) -> FloatArray:
    """Return what the plan's walls in empty space say, at most 0; see `log_likelihood`."""
    sight, said = see(raster, settings), np.empty(len(position_m))
    loops.empties(
        *_contiguous(position_m, drift_rad), points.empty_m, points.empty_m2, sight.wall,
        sight.metres, sight.n_walls, settings.empty_nats_per_m, settings.missing_share,
        sight.frame, said,
    )  # fmt: skip
    return said


def rough_nats(
    points: ScanPoints,
    raster: PlanRaster,
    position_m: FloatArray,
    drift_rad: FloatArray,
    settings: ObservationSettings,
) -> FloatArray:
    """Return what a scan says by the rough model of the search, where each metre errs by itself.

    In the raster's own cells, and for poses between the cells and drifts of the search.
    """
    field, place = blurred(raster, settings), _contiguous(position_m, drift_rad)
    walls, empty = np.empty(len(position_m)), np.empty(len(position_m))
    loops.lookup(
        *place, points.wall_m, points.wall_weight_m, field.support, field.frame, walls
    )  # fmt: skip
    some = as_readonly(points.empty_m[::EVERY])  # as the walls' points: one loop serves both
    area = as_readonly(np.full(len(some), EVERY * points.empty_m2))
    loops.lookup(*place, some, area, field.metres, field.frame, empty)
    return np.asarray(walls - settings.search_empty_nats_per_m * empty)


def _contiguous(position_m: FloatArray, drift_rad: FloatArray) -> tuple[FloatArray, FloatArray]:
    return (
        np.ascontiguousarray(position_m, dtype=np.float64),
        np.ascontiguousarray(drift_rad, dtype=np.float64),
    )


def _errors(settings: ObservationSettings) -> tuple[FloatArray, FloatArray]:
    """How far a wall may lie off as a whole (J,), and how probable that is."""
    n = int(np.ceil(REACH * max(settings.offset_sd_m, settings.far_offset_sd_m) / SHIFT_M))
    shift: FloatArray = SHIFT_M * np.arange(-n, n + 1, dtype=np.float64)
    near, far = (
        np.exp(-0.5 * (shift / sd) ** 2) for sd in (settings.offset_sd_m, settings.far_offset_sd_m)
    )
    share = settings.far_offset_share
    chance: FloatArray = (1 - share) * near / near.sum() + share * far / far.sum()
    return shift, chance
