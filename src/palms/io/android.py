"""Logs of Android's sensors as text: ``unix_ms <tab> TYPE_... <tab> values``, a reading a line.

The Indoor Location Competition's recorder writes them. ``TYPE_WAYPOINT`` rows are where the
walker said to be, in metres of the map: the reference. Other types are left alone; damaged lines
occur, also two on one line.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final, Literal, NamedTuple

import numpy as np

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.files import sniff
from palms.io.packed import read_lines, text_head
from palms.io.reckoned import Gathered, ReckoningOptions, at_times, reckon, report_damage
from palms.io.registry import Format
from palms.io.values import StrPath
from palms.io.walk import RecordedWalk
from palms.odometry import Odometry

__all__ = ["FORMAT", "Readings", "read_android", "read_readings"]

_EXPECTED = "an Android sensor log: rows of unix_ms, TYPE_ACCELEROMETER, x, y, z"
_SENSORS: Final = {  # numbers in a reading that count, and how far they can go
    "TYPE_ACCELEROMETER": (3, 200.0),  # m/s2; phones go to 16 g
    "TYPE_ACCELEROMETER_UNCALIBRATED": (3, 200.0),
    "TYPE_LINEAR_ACCELERATION": (3, 200.0),
    "TYPE_GRAVITY": (3, 20.0),
    "TYPE_GYROSCOPE": (3, 60.0),  # rad/s; phones go to 2,000 degrees/s
    "TYPE_GYROSCOPE_UNCALIBRATED": (3, 60.0),
    "TYPE_ROTATION_VECTOR": (3, 1.0),
    "TYPE_GAME_ROTATION_VECTOR": (3, 1.0),
    "TYPE_WAYPOINT": (2, 1e6),
}
_ROW = re.compile(rb"^\d{10,19}\t+TYPE_[A-Z]", re.MULTILINE)
_NEAR_S = 1.0  # ours: a waypoint belongs to the step that ends nearest, if any is so near


def read_android(
    path: StrPath,
    *,
    length: Literal["pendulum", "weinberg", "constant"] = "pendulum",
    heading: Literal["gyro", "attitude"] = "gyro",
    step_m: float | str | None = None,
    leg_m: float | str | None = None,
) -> RecordedWalk:
    """Read an Android sensor log; its walk is found by dead reckoning.

    The frame is the walk's own. Times count from the first reading or waypoint.

    Parameters
    ----------
    path : path
        The file; may be packed by gzip.
    length : {"pendulum", "weinberg", "constant"}
        How long steps are; see `palms.inertial.InertialSettings`.
    heading : {"gyro", "attitude"}
        Where they go.
    step_m : float, optional
        A step's length, for "constant".
    leg_m : float, optional
        The walker's leg, for "pendulum".

    Raises
    ------
    InputError
        When it cannot be read, or an option is wrong.
    FormatError
        When it is no such log, has no accelerometer, or nobody walks.

    Warns
    -----
    PalmsWarning
        When rows are damaged, or the phone was not held steady.

    Examples
    --------
    >>> read_android("no/such/log.txt")
    Traceback (most recent call last):
    palms.errors.InputError: no/such/log.txt: expected a file, got nothing there; check the ...
    """
    options = ReckoningOptions(length, heading, step_m, leg_m)
    options.settings()
    readings = read_readings(path)
    return _with_waypoints(reckon(readings.sensors, options, path), readings, path)


class Readings(NamedTuple):
    """What a log says before a walk is reckoned from it.

    Parameters
    ----------
    sensors : dict
        Times (N,) in seconds from the first reading or waypoint, and values, of "acceleration",
        "rate" and "attitude".
    waypoints : tuple
        Times (W,), and points (W, 2) in metres of the map.
    place : str or None
        What the log calls it.
    """

    sensors: dict[str, tuple[FloatArray, FloatArray]]
    waypoints: tuple[FloatArray, FloatArray]
    place: str | None


def read_readings(path: StrPath) -> Readings:
    """Read the readings of an Android sensor log, for who reckons more than one walk from them.

    Raises
    ------
    InputError, FormatError
        As `read_android`.

    Examples
    --------
    >>> read_readings("no/such/log.txt")
    Traceback (most recent call last):
    palms.errors.InputError: no/such/log.txt: expected a file, got nothing there; check the ...
    """
    log = {name: Gathered(*bounds) for name, bounds in _SENSORS.items()}
    place = _gather(path, log)
    sensors = _sensors(log)
    all_times = np.concatenate([times for times, _ in sensors.values()])
    marks = log["TYPE_WAYPOINT"].readings(float(np.median(all_times)) if len(all_times) else None)
    starts = [float(times.min()) for times, _ in (*sensors.values(), marks) if len(times)]
    zero = min(starts, default=0.0)
    shifted = {name: (times - zero, values) for name, (times, values) in sensors.items()}
    return Readings(shifted, (marks[0] - zero, marks[1]), place)


def _gather(path: StrPath, log: dict[str, Gathered]) -> str | None:
    """Fill the log from a file; return what it calls the place."""
    rows = damaged = 0
    place: dict[str, str] = {}
    for _, line in read_lines(path, _EXPECTED):
        if line.startswith("#"):
            place.update(re.findall(r"(SiteName|FloorName):([^\t]*)", line))
            continue
        for cells in _rows(line):
            if cells[1] in log:
                rows += 1
                damaged += not _add(log[cells[1]], cells)
    if not rows:
        raise FormatError(
            str(path), expected=_EXPECTED, got="no such row",
            fix="check that it is the right file",
        )  # fmt: skip
    report_damage(damaged, rows, path)
    return " ".join(place.values()) or None


def _rows(line: str) -> Iterator[list[str]]:
    """Yield the cells of each row on a line; where a line end got lost there are two."""
    parts = [line] if line.count("\tTYPE_") < 2 else re.split(r"(?=\d{13}\tTYPE_)", line)
    for part in parts:
        cells = part.split("\t")
        if len(cells) > 2:
            yield cells


def _add(sensor: Gathered, cells: list[str]) -> bool:
    try:
        time = int(cells[0]) / 1000
        return sensor.add(time, [float(cell) for cell in cells[2 : 2 + sensor.width]])
    except (ValueError, OverflowError):
        return False


def _sensors(log: dict[str, Gathered]) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return the best of what there is: acceleration with gravity, rate, attitude."""

    def first(*names: str) -> tuple[FloatArray, FloatArray]:
        return next((log[n] for n in names if len(log[n]) > 1), log[names[-1]]).readings()

    felt = first("TYPE_ACCELEROMETER", "TYPE_ACCELEROMETER_UNCALIBRATED")
    gravity = log["TYPE_GRAVITY"].readings()
    if not len(felt[0]) and len(gravity[0]) > 1:
        time, moved = log["TYPE_LINEAR_ACCELERATION"].readings()
        felt = time, moved + at_times(gravity, time)
    rate = first("TYPE_GYROSCOPE", "TYPE_GYROSCOPE_UNCALIBRATED")
    time, vector = first("TYPE_ROTATION_VECTOR", "TYPE_GAME_ROTATION_VECTOR")
    rest = np.sqrt(np.clip(1 - (vector**2).sum(axis=1), 0, 1))
    attitude = time, np.column_stack([vector, rest])
    return {"acceleration": felt, "rate": rate, "attitude": attitude}


def _with_waypoints(odometry: Odometry, readings: Readings, path: StrPath) -> RecordedWalk:
    """Give each waypoint to the step that ends nearest in time."""
    time, points = readings.waypoints
    reference = np.full((len(odometry), 2), np.nan)
    for at, point in zip(time.tolist(), points, strict=True):
        nearest = int(np.abs(odometry.time_s - at).argmin())
        if math.fabs(odometry.time_s[nearest] - at) <= _NEAR_S:
            reference[nearest] = point
    ahead = points[1] if len(points) > 1 and (points[1] != points[0]).any() else None
    return RecordedWalk(
        ronin=odometry,
        reference_m=reference,
        start_m=points[0] if len(points) else None,
        ahead_m=ahead,
        building_id=readings.place,
        path=Path(path),
    )


def _recognizes(path: Path) -> bool:
    start = text_head(path)
    return not path.is_dir() and sniff(start) == "text" and _ROW.search(start) is not None


FORMAT = Format(
    name="android",
    description="Android sensor logs as text (Indoor Location Competition), by dead reckoning",
    suffixes=(".txt",),
    recognizes=_recognizes,
    read=read_android,
)
