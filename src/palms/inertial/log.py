"""InertialLog: what accelerometer, gyroscope and platform said, on one clock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.geometry import FloatArray, check_finite

__all__ = ["GRAVITY_M_S2", "MAX_DURATION_S", "RATE_HZ", "InertialLog", "Readings"]

RATE_HZ: Final = 50.0  # ours: 15 times the step rate; phones give 50 to 200
MAX_DURATION_S: Final = 6 * 3600.0  # ours: longer logs are no walk; a million samples
GRAVITY_M_S2: Final = 9.80665  # standard gravity
_SHORTEST_S = 2.0  # ours: two steps

Readings = tuple[npt.ArrayLike, npt.ArrayLike]  # times (N,) in s, values (N, k)


@dataclass(frozen=True, slots=True)
class InertialLog:
    """Readings of one phone at common times, in axes of the phone.

    The axes are Android's and Apple's: x to the right of the screen, y to its top, z out of
    it. Acceleration is what an accelerometer feels: lying still with its screen up it is
    +9.8 m/s2 along z.

    Parameters
    ----------
    time_s : array_like (N,)
        Increasing.
    acceleration_m_s2 : array_like (N, 3)
        With gravity.
    rate_rad_s : array_like (N, 3), optional
        Of rotation about the three axes.
    attitude : array_like (N, 4), optional
        Quaternions x, y, z, w that turn vectors of the phone's axes into axes of the earth
        with z up: the platform's own estimate.

    Raises
    ------
    InputError
        When lengths differ, a number is not finite, times do not increase, or the log is
        shorter than two seconds or longer than `MAX_DURATION_S`.

    Examples
    --------
    >>> at_rest = InertialLog(np.arange(200) / 50, np.tile([0, 0, 9.81], (200, 1)))
    >>> round(at_rest.duration_s, 2), at_rest.rate_rad_s is None
    (3.98, True)
    """

    time_s: FloatArray
    acceleration_m_s2: FloatArray
    rate_rad_s: FloatArray | None = None
    attitude: FloatArray | None = None

    def __post_init__(self) -> None:
        time = check_finite(self.time_s, "the log's times", (None,))
        object.__setattr__(self, "time_s", time)
        for name, width in (("acceleration_m_s2", 3), ("rate_rad_s", 3), ("attitude", 4)):
            if getattr(self, name) is not None:
                values = check_finite(getattr(self, name), f"the log's {name}", (len(time), width))
                object.__setattr__(self, name, values)
        if len(time) > 1 and (np.diff(time) <= 0).any():
            at = int(np.argmax(np.diff(time) <= 0)) + 1
            raise InputError(
                "inertial log", expected="times that increase", got=f"{time[at]:.6g} s at {at}",
                fix="sort the readings and drop repeated ones",
            )  # fmt: skip
        _check_duration(float(time[-1] - time[0]) if len(time) else 0.0)

    @property
    def duration_s(self) -> float:
        """From the first to the last reading."""
        return float(self.time_s[-1] - self.time_s[0])

    @classmethod
    def of_sensors(
        cls, acceleration: Readings, rate: Readings | None = None, attitude: Readings | None = None
    ) -> InertialLog:
        """Bring readings with times of their own onto one clock of `RATE_HZ`.

        Readings are sorted and repeated times dropped; a new one is the mean over its fiftieth
        of a second, so that faster sensors lose nothing but their noise.

        Parameters
        ----------
        acceleration, rate, attitude : tuple of array_like
            Times (N,) in seconds and values (N, 3), or quaternions (N, 4). The log covers
            the time that all of them cover.

        Raises
        ------
        InputError
            When a sensor has fewer than two readings, or they have no two seconds in common.

        Examples
        --------
        >>> t = np.arange(0, 4, 0.01)
        >>> log = InertialLog.of_sensors((t, np.ones((400, 3))), rate=(t[::2], np.zeros((200, 3))))
        >>> len(log.time_s), log.acceleration_m_s2[0].round(6).tolist()
        (199, [1.0, 1.0, 1.0])
        """
        given = {"acceleration_m_s2": acceleration, "rate_rad_s": rate, "attitude": attitude}
        series = {name: _sorted(each, name) for name, each in given.items() if each is not None}
        start = max(float(time[0]) for time, _ in series.values())
        end = min(float(time[-1]) for time, _ in series.values())
        _check_duration(end - start)
        edges = start + np.arange(int((end - start) * RATE_HZ + 1e-6) + 1) / RATE_HZ
        means = {name: _cell_means(*each, edges) for name, each in series.items()}
        return cls(0.5 * (edges[1:] + edges[:-1]), **means)

    def resampled(self) -> InertialLog:
        """Return the log at `RATE_HZ`; itself when it has that rate."""
        if np.allclose(np.diff(self.time_s), 1 / RATE_HZ, rtol=0, atol=1e-6):
            return self
        rest = {
            name: (self.time_s, values)
            for name, values in (("rate", self.rate_rad_s), ("attitude", self.attitude))
            if values is not None
        }
        return InertialLog.of_sensors((self.time_s, self.acceleration_m_s2), **rest)


def _check_duration(duration_s: float) -> None:
    if not _SHORTEST_S <= duration_s <= MAX_DURATION_S:
        raise InputError(
            "inertial log",
            expected=f"{_SHORTEST_S:g} s to {MAX_DURATION_S / 3600:g} h that all its sensors cover",
            got=f"{max(duration_s, 0.0):.4g} s",
            fix="record a walk, with accelerometer and gyroscope at the same time",
        )


def _sorted(readings: Readings, name: str) -> tuple[FloatArray, FloatArray]:
    """Return times that increase, and values (N, k); quaternions on one side."""
    width = 4 if name == "attitude" else 3
    values = check_finite(readings[1], f"the log's {name}", (None, width))
    time, first = np.unique(
        check_finite(readings[0], f"the log's times of {name}", (len(values),)), return_index=True
    )
    if len(time) < 2:
        raise InputError(
            "inertial log", expected=f"readings of {name}", got=f"{len(time)}",
            fix="switch that sensor on before you record",
        )  # fmt: skip
    values = values[first]
    return time, _continuous(values) if name == "attitude" else values


def _continuous(quaternions: FloatArray) -> FloatArray:
    """Flip quaternions so that neighbours lie on the same side; q and -q are one attitude."""
    flips = np.sign((quaternions[1:] * quaternions[:-1]).sum(axis=1))
    signs = np.cumprod(np.concatenate([[1.0], np.where(flips == 0, 1.0, flips)]))
    return np.asarray(quaternions * signs[:, None])


def _cell_means(time: FloatArray, values: FloatArray, edges: FloatArray) -> Any:  # noqa: ANN401
    """Mean of the readings, joined by straight lines, between consecutive edges."""
    area = np.diff(time)[:, None] * 0.5 * (values[1:] + values[:-1])
    total = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(area, axis=0)])
    at = np.clip(np.searchsorted(time, edges, side="right") - 1, 0, len(time) - 2)
    past = (edges - time[at])[:, None]
    slope = (values[at + 1] - values[at]) / np.diff(time)[at][:, None]
    integral = total[at] + past * values[at] + 0.5 * past**2 * slope
    return np.diff(integral, axis=0) / np.diff(edges)[:, None]
