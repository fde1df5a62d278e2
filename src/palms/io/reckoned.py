"""What readers of inertial logs share: readings gathered row by row, and dead reckoning."""

from __future__ import annotations

import warnings
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final, cast, get_args

import numpy as np

from palms.errors import FormatError, InputError, PalmsWarning
from palms.geometry import FloatArray
from palms.inertial import HeadingMethod, InertialLog, InertialSettings, LengthMethod, dead_reckon
from palms.inertial.log import MAX_DURATION_S
from palms.io.options import choice_option, number_option
from palms.io.values import StrPath, locating
from palms.odometry import Odometry

__all__ = ["MAX_READINGS", "Gathered", "ReckoningOptions", "at_times", "reckon", "report_damage"]

MAX_READINGS: Final = 5_000_000  # ours: of one sensor; six hours at 200 a second
_GAP_S = 1.0  # ours: two steps
_SLOW_S = 0.06  # ours: nine readings a step; phones give 50 a second and more
_MOSTLY = 0.5  # ours: a log of which more is damaged is none


@dataclass
class Gathered:
    """Readings of one sensor while a file is read; not frozen, as it grows.

    Parameters
    ----------
    width : int
        Numbers in each reading.
    limit : float
        Larger numbers are damage: no phone's sensor goes so far.

    Examples
    --------
    >>> rate = Gathered(3, 50.0)
    >>> rate.add(0.5, [0.1, 0.0, 0.0]), rate.add(1.0, [1e9, 0.0, 0.0]), len(rate)
    (True, False, 1)
    """

    width: int
    limit: float
    times: array[float] = field(default_factory=lambda: array("d"))
    values: array[float] = field(default_factory=lambda: array("d"))

    def __len__(self) -> int:
        return len(self.times)

    def add(self, time_s: float, values: Sequence[float]) -> bool:
        """Add a reading; False when it is damaged."""
        usable = len(values) == self.width and all(-self.limit <= v <= self.limit for v in values)
        if usable and len(self) < MAX_READINGS:
            self.times.append(time_s)
            self.values.extend(values)
        return usable

    def readings(self, about_s: float | None = None) -> tuple[FloatArray, FloatArray]:
        """Return times (N,) and values (N, width), without times far from most of them."""
        time = np.array(self.times)
        values = np.array(self.values).reshape(-1, self.width)
        if not len(time):
            return time, values
        middle = float(np.median(time)) if about_s is None else about_s
        near = np.abs(time - middle) <= 0.5 * MAX_DURATION_S
        return time[near], values[near]


@dataclass(frozen=True, slots=True)
class ReckoningOptions:
    """Options of readers that reckon a walk from sensors, as the user gave them.

    Parameters
    ----------
    length, heading : str
        As in `palms.inertial.InertialSettings`.
    step_m, leg_m : float or str, optional
        Likewise; its own when left out.

    Examples
    --------
    >>> ReckoningOptions("constant", "gyro", step_m="0.7").settings().step_m
    0.7
    """

    length: str = "pendulum"
    heading: str = "gyro"
    step_m: float | str | None = None
    leg_m: float | str | None = None

    def settings(self) -> InertialSettings:
        """Return the settings that they stand for.

        Raises
        ------
        InputError
            When an option is wrong.
        """
        length = choice_option(self.length, "length", get_args(LengthMethod))
        heading = choice_option(self.heading, "heading", get_args(HeadingMethod))
        numbers = {
            name: number_option(getattr(self, name), name, low, high)
            for name, low, high in (("step_m", 0.1, 2.0), ("leg_m", 0.3, 1.5))
            if getattr(self, name) is not None
        }
        return InertialSettings(
            length=cast(LengthMethod, length), heading=cast(HeadingMethod, heading), **numbers
        )


def at_times(readings: tuple[FloatArray, FloatArray], time_s: FloatArray) -> FloatArray:
    """Return what a sensor read at other times (N,), in between its readings: (N, width).

    Examples
    --------
    >>> at_times((np.array([0.0, 1.0]), np.array([[0.0], [2.0]])), np.array([0.5])).tolist()
    [[1.0]]
    """
    time, values = readings
    order = np.argsort(time, kind="stable")
    columns = [np.interp(time_s, time[order], column) for column in values[order].T]
    return np.column_stack(columns)


def reckon(
    sensors: dict[str, tuple[FloatArray, FloatArray]], options: ReckoningOptions, path: StrPath
) -> Odometry:
    """Return the walk of a file's readings.

    Parameters
    ----------
    sensors : dict
        Readings by what they are: "acceleration", "rate", "attitude"; empty ones count as
        missing.
    options : ReckoningOptions
    path : path
        For messages.

    Raises
    ------
    FormatError
        When a sensor that is needed is missing, or nobody walks.
    """
    settings = options.settings()
    there = {name: each for name, each in sensors.items() if len(each[0]) > 1}
    if "acceleration" not in there:
        raise FormatError(
            str(path), expected="readings of an accelerometer", got="none",
            fix="switch it on before you record",
        )  # fmt: skip
    if settings.heading == "attitude" and "attitude" not in there:
        raise InputError(
            "option heading", expected="gyro, as there is no rotation vector", got="'attitude'"
        )
    if "rate" in there and settings.heading != "attitude":
        there.pop("attitude", None)
    with locating(path):
        walk = dead_reckon(InertialLog.of_sensors(**there), settings, str(path))
    for name, (time, _) in there.items():
        _look_for_gaps(np.sort(time), name, path)
    return walk


def _look_for_gaps(time_s: FloatArray, name: str, path: StrPath) -> None:
    """Warn of a sensor that paused, or is too slow to show steps."""
    step = np.diff(time_s)
    longest, usual = float(step.max()), float(np.median(step))
    if longest > _GAP_S:
        at = float(time_s[int(step.argmax())])
        problem = f"no readings of {name} for {longest:.1f} s from {at:.0f} s on; what was walked"
        problem += " then is missing"
    elif usual > _SLOW_S:
        problem = f"only {1 / usual:.0f} readings of {name} a second; steps may be missed"
    else:
        return
    warnings.warn(f"{path}: {problem}", PalmsWarning, stacklevel=4)


def report_damage(damaged: int, rows: int, path: StrPath) -> None:
    """Warn of damaged rows that were left out, or refuse a file that has little else.

    Raises
    ------
    FormatError
        When more than half of the rows are damaged.
    """
    if damaged > _MOSTLY * rows:
        raise FormatError(
            str(path), expected="rows of sensor readings",
            got=f"{damaged} of {rows} that cannot be read", fix="record or copy it again",
        )  # fmt: skip
    if damaged:
        warnings.warn(
            f"{path}: {damaged} of {rows} rows of sensors cannot be read and are left out",
            PalmsWarning,
            stacklevel=3,
        )
