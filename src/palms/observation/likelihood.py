"""The likelihood of a scan at single poses."""

from __future__ import annotations

import numpy as np

from palms._compiled import observation as loops
from palms.geometry import FloatArray
from palms.observation.points import ScanPoints
from palms.observation.sight import see
from palms.raster import PlanRaster
from palms.settings import ObservationSettings

__all__ = ["log_likelihood"]

SHIFT_M = 0.1  # ours: between the errors of a wall that are tried
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
    sight = see(raster, settings)
    place = np.ascontiguousarray(position_m, dtype=np.float64)
    turn = np.ascontiguousarray(drift_rad, dtype=np.float64)
    walls, empty = np.empty(len(turn)), np.empty(len(turn))
    shift, share = _errors(settings)
    loops.walls(
        place, turn, points.wall_m, points.wall_weight_m, points.first, points.normal, shift,
        share, settings.unplanned_share, sight.support, sight.frame, walls,
    )  # fmt: skip
    loops.empties(
        place, turn, points.empty_m, points.empty_m2, sight.wall, sight.metres, sight.n_walls,
        settings.empty_nats_per_m, settings.missing_share, sight.frame, empty,
    )  # fmt: skip
    return np.asarray(walls + empty)


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
