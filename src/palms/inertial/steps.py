"""Steps: when they end, how long they take, how much the body swings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palms.geometry import FloatArray
from palms.inertial.log import RATE_HZ, InertialLog
from palms.inertial.settings import InertialSettings

__all__ = ["Steps", "find_steps"]

_LONGEST_S = 1.0  # ours: who waits longer stood still before the step
_SMOOTHED_STEPS = 5  # ours: the median duration of so many counts


@dataclass(frozen=True, slots=True)
class Steps:
    """Steps in order of time.

    Parameters
    ----------
    start_s, end_s : ndarray (S,)
        When each began and ended: with the one before, or up to a second earlier.
    duration_s : ndarray (S,)
        How long it took, the median over some neighbours.
    swing_m_s2 : ndarray (S,)
        From the lowest to the highest acceleration during it.

    Examples
    --------
    >>> len(Steps(*np.zeros((4, 0))))
    0
    """

    start_s: FloatArray
    end_s: FloatArray
    duration_s: FloatArray
    swing_m_s2: FloatArray

    def __len__(self) -> int:
        return len(self.end_s)


def find_steps(log: InertialLog, settings: InertialSettings) -> Steps:
    """Find steps as peaks of the magnitude of acceleration, in the band of walking.

    The magnitude does not depend on how the phone is held.

    Parameters
    ----------
    log : InertialLog
        At `RATE_HZ`.
    settings : InertialSettings

    Examples
    --------
    >>> t = np.arange(500) / 50
    >>> bobbing = np.outer(9.81 + 3 * np.sin(2 * np.pi * 2 * t), [0, 0, 1])
    >>> steps = find_steps(InertialLog(t, bobbing), InertialSettings())
    >>> len(steps), steps.duration_s[5].tolist(), round(float(steps.swing_m_s2[5]))
    (20, 0.5, 6)
    """
    from scipy.signal import butter, find_peaks, sosfiltfilt

    band = butter(2, [settings.low_hz, settings.high_hz], "bandpass", fs=RATE_HZ, output="sos")
    felt = np.linalg.norm(log.acceleration_m_s2, axis=1)
    wave = sosfiltfilt(band, felt - felt.mean(), padlen=min(len(felt) - 1, int(3 * RATE_HZ)))
    apart = max(int(settings.apart_s * RATE_HZ), 1)
    peaks, _ = find_peaks(wave, prominence=settings.swing_m_s2, distance=apart)
    if not len(peaks):
        return Steps(*np.zeros((4, 0)))
    longest = int(_LONGEST_S * RATE_HZ)
    before = np.concatenate([[-longest], peaks[:-1]])
    begin = np.maximum(np.maximum(before, peaks - longest), 0)
    inner = [wave[i : j + 1] for i, j in zip(begin, peaks, strict=True)]
    swing = np.array([part.max() - part.min() for part in inner])
    return Steps(
        log.time_s[begin], log.time_s[peaks], _smoothed((peaks - begin) / RATE_HZ), swing
    )  # fmt: skip


def _smoothed(values: FloatArray) -> FloatArray:
    """Return the running median: a step that was missed spoils no neighbour."""
    half = _SMOOTHED_STEPS // 2
    padded = np.pad(values, half, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, _SMOOTHED_STEPS)
    return np.asarray(np.median(windows, axis=1))
