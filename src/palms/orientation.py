"""Principal orientations, and the drifts that align a scan with a plan (paper III-A)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from palms.geometry import FloatArray, as_readonly, directions, lengths, wrap_angle

__all__ = ["candidate_drifts", "principal_orientation", "smallest_alignment"]

QUARTER = np.pi / 2
BIN_RAD = np.pi / 360  # ours: half a degree
SMOOTH_RAD = np.radians(3.0)  # ours: planes are off by about a degree each
WINDOW_RAD = np.radians(10.0)  # ours: what still counts as one orientation


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
        peak += float(near @ off) / max(float(near.sum()), 1e-12)
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


def _fold(angle_rad: FloatArray) -> FloatArray:
    return np.mod(angle_rad + QUARTER / 2, QUARTER) - QUARTER / 2
