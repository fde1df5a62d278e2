"""Principal orientations, and the drifts that align a scan with a plan (paper III-A)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from palms.geometry import FloatArray, as_readonly, directions, lengths, wrap_angle

__all__ = ["candidate_drifts", "likely_drifts", "principal_orientation", "smallest_alignment"]

QUARTER = np.pi / 2
BIN_RAD = np.pi / 360  # ours: half a degree
SMOOTH_RAD = np.radians(3.0)  # ours: planes are off by about a degree each
WINDOW_RAD = np.radians(10.0)  # ours: what still counts as one orientation
WALL_BIN_RAD = np.radians(2.0)  # ours: bins of all directions of walls
WALL_SMOOTH_RAD = np.radians(4.0)  # ours: walls of plan and scan agree to about this


def principal_orientation(segments_m: npt.ArrayLike) -> float:
    """Return the orientation that most metres of wall share, in [0, pi/2).

    Together with its perpendicular it makes the two orthogonal principal orientations of
    paper III-A. Length-weighted histogram over a quarter turn, then the circular mean around
    its peak.

    Parameters
    ----------
    segments_m : array_like (N, 2, 2)
        Walls, or moves of a walk; N at least 1.

    Returns
    -------
    float
        Angle in radians.

    Examples
    --------
    >>> walls = [[[0, 0], [4, 1]], [[0, 0], [-1, 4]], [[0, 0], [0.5, 0.5]]]
    >>> round(principal_orientation(walls), 4) == round(float(np.arctan2(1, 4)), 4)
    True
    """
    segments = np.asarray(segments_m, dtype=np.float64)
    angle, weight = np.mod(directions(segments), QUARTER), lengths(segments)
    n_bins = round(QUARTER / BIN_RAD)
    histogram = np.bincount((angle / BIN_RAD).astype(int) % n_bins, weight, n_bins)
    offset = (np.arange(n_bins) + n_bins / 2) % n_bins - n_bins / 2
    kernel = np.exp(-0.5 * (offset * BIN_RAD / SMOOTH_RAD) ** 2)
    smooth = np.fft.irfft(np.fft.rfft(histogram) * np.fft.rfft(kernel), n_bins)
    peak = (float(np.argmax(smooth)) + 0.5) * BIN_RAD
    for _ in range(5):
        off = _fold(angle - peak)
        near = weight * (np.abs(off) <= WINDOW_RAD)
        peak += float((near * off).sum()) / max(float(near.sum()), 1e-12)
    return float(np.mod(peak, QUARTER))


def smallest_alignment(from_rad: float, to_rad: float) -> float:
    """Return theta: the smallest angle that turns one pair of orientations onto another.

    Paper III-A. In [-pi/4, pi/4).

    Examples
    --------
    >>> round(smallest_alignment(0.1, 1.5), 4)
    -0.1708
    """
    return float(_fold(np.asarray(to_rad - from_rad)))


def candidate_drifts(theta_rad: float, n: int = 4) -> FloatArray:
    """Return the drifts theta + k * 2 pi / n, k = 0 .. n-1, in (-pi, pi].

    Paper III-A with n = 4: right angles cannot tell quarter turns apart.

    Examples
    --------
    >>> np.degrees(candidate_drifts(np.radians(10.0))).round().tolist()
    [10.0, 100.0, -170.0, -80.0]
    """
    drifts: FloatArray = as_readonly(wrap_angle(theta_rad + np.arange(n) * 2 * np.pi / n))
    return drifts


def likely_drifts(
    scan_m: npt.ArrayLike, plan_m: npt.ArrayLike, step_rad: float, share: float
) -> FloatArray:
    """Return the drifts all around that turn a scan's walls along some of a plan's.

    Correlation of the two histograms of wall directions, by metres: no right angles needed.

    Parameters
    ----------
    scan_m, plan_m : array_like (N, 2, 2), (M, 2, 2)
        Walls.
    step_rad : float
        Between two drifts.
    share : float
        Of the best drift's agreement; drifts with less are left out.

    Returns
    -------
    (K,) in (-pi, pi]
        Multiples of `step_rad`.

    Examples
    --------
    >>> room = [[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]]
    >>> drifts = likely_drifts(room, room, np.radians(5), 0.5)
    >>> sorted(set(((np.degrees(drifts) / 90).round().astype(int) % 4).tolist()))
    [0, 1, 2, 3]
    """
    n, turns = round(np.pi / WALL_BIN_RAD), round(2 * np.pi / step_rad)
    drifts = np.arange(turns) * 2 * np.pi / turns
    seen, drawn = (
        _by_direction(np.asarray(walls, dtype=np.float64), n) for walls in (scan_m, plan_m)
    )
    agree = np.fft.irfft(np.conj(np.fft.rfft(seen)) * np.fft.rfft(drawn), n)
    agree = _smoothed(agree, WALL_SMOOTH_RAD / WALL_BIN_RAD)
    score = np.interp(
        np.mod(drifts, np.pi), np.arange(n + 1) * WALL_BIN_RAD, [*agree, agree[0]]
    )  # fmt: skip
    return as_readonly(wrap_angle(drifts[score >= share * score.max()]))


def _by_direction(segments_m: FloatArray, n: int) -> FloatArray:
    """Metres of wall by direction, a half turn in n bins."""
    index = np.floor(np.mod(directions(segments_m), np.pi) / np.pi * n).astype(int) % n
    return np.bincount(index, lengths(segments_m), n).astype(np.float64)


def _smoothed(values: FloatArray, sd: float) -> FloatArray:
    """Blur values (N,) around a circle; `sd` in values.

    What `scipy.ndimage.gaussian_filter1d` gives, whose import takes far longer.
    """
    reach = int(4 * sd + 0.5)
    share = np.exp(-0.5 / sd**2 * np.arange(-reach, reach + 1) ** 2)
    share /= share.sum()
    smooth: FloatArray = values * share[reach]
    for k in range(reach, 0, -1):
        smooth += (np.roll(values, k) + np.roll(values, -k)) * share[reach - k]
    return smooth


def _fold(angle_rad: FloatArray) -> FloatArray:
    return np.mod(angle_rad + QUARTER / 2, QUARTER) - QUARTER / 2
