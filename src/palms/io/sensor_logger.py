"""Recordings of the app Sensor Logger: a zip archive, or folder, with a CSV file per sensor.

Columns are found by their header. Android's axes of acceleration are those of `InertialLog`;
iPhones write all three with the other sign, unless the app was told to "Standardise Units &
Frames". ``Metadata.csv`` says which; without it the orientation tells, since gravity points the
other way from what it says is up.
"""

from __future__ import annotations

import csv
import warnings
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Final, Literal

import numpy as np

from palms.errors import FormatError, PalmsWarning
from palms.geometry import FloatArray
from palms.inertial.log import GRAVITY_M_S2
from palms.io.archives import member_names, open_member
from palms.io.options import choice_option
from palms.io.packed import lines_of
from palms.io.reckoned import Gathered, ReckoningOptions, at_times, reckon, report_damage
from palms.io.registry import Format
from palms.io.values import StrPath, parse_number
from palms.io.walk import RecordedWalk

__all__ = ["FORMAT", "read_sensor_logger"]

Readings = tuple[FloatArray, FloatArray]

_EXPECTED = "a Sensor Logger recording: a zip archive or folder with Accelerometer.csv"
_AXES = ("x", "y", "z")
_TURNS = ("qx", "qy", "qz", "qw")
_SENSORS: Final = {  # columns, and how far they can go
    "accelerometer": (_AXES, 200.0),  # m/s2, without gravity
    "gravity": (_AXES, 20.0),
    "totalacceleration": (_AXES, 200.0),
    "accelerometeruncalibrated": (_AXES, 200.0),  # with gravity; in g on an iPhone
    "gyroscope": (_AXES, 60.0),
    "gyroscopeuncalibrated": (_AXES, 60.0),
    "orientation": (_TURNS, 1.01),
}
_FELT = ("accelerometer", "totalacceleration", "accelerometeruncalibrated")
_IN_G = 3.0  # ours: an acceleration whose median is below this many m/s2 is given in g


def read_sensor_logger(
    path: StrPath,
    *,
    platform: Literal["auto", "android", "ios"] = "auto",
    length: Literal["pendulum", "weinberg", "constant"] = "pendulum",
    heading: Literal["gyro", "attitude"] = "gyro",
    step_m: float | str | None = None,
    leg_m: float | str | None = None,
) -> RecordedWalk:
    """Read a Sensor Logger recording; its walk is found by dead reckoning.

    The frame is the walk's own. Times count from the start of the recording.

    Parameters
    ----------
    path : path
        The zip archive, or a folder with its files.
    platform : {"auto", "android", "ios"}
        Whose signs acceleration has. "ios" is an iPhone without standardised frames; a
        standardised one is "android". auto: as the recording says.
    length, heading, step_m, leg_m
        As in `palms.io.android.read_android`.

    Raises
    ------
    InputError
        When it cannot be read, or an option is wrong.
    FormatError
        When it is no such recording, has no accelerometer, or nobody walks.

    Warns
    -----
    PalmsWarning
        When rows are damaged, the signs are a guess, or the phone was not held steady.

    Examples
    --------
    >>> read_sensor_logger("no/such.zip")
    Traceback (most recent call last):
    palms.errors.FormatError: no/such.zip: expected a Sensor Logger recording: a zip archive or ...
    """
    options = ReckoningOptions(length, heading, step_m, leg_m)
    options.settings()
    told = choice_option(platform, "platform", ("auto", "android", "ios"))
    members = _members(path)
    log = {name: _read_sensor(path, member, name) for name, member in members.items()
           if name in _SENSORS}  # fmt: skip
    felt = _acceleration(log)
    turned = log.get("orientation", _nothing(4))
    sign = _sign(told, _metadata(path, members), felt, turned, path)
    rate = log.get("gyroscope", log.get("gyroscopeuncalibrated", _nothing(3)))
    sensors = {
        "acceleration": (felt[0], sign * felt[1]),
        "rate": rate,
        "attitude": _earthward(turned, (felt[0], sign * felt[1])),
    }
    return RecordedWalk.of(reckon(sensors, options, path), path=Path(path))


def _nothing(width: int) -> Readings:
    return np.empty(0), np.empty((0, width))


def _members(path: StrPath) -> dict[str, str]:
    """Return the archive's files by the sensor they are of: the first of each."""
    found: dict[str, str] = {}
    for name in member_names(path):
        place = PurePosixPath(name.replace("\\", "/"))
        if place.suffix.lower() == ".csv" and not place.name.startswith("."):
            found.setdefault(place.stem.lower().replace(" ", ""), name)
    if not any(name in found for name in _FELT):
        raise FormatError(
            str(path), expected=_EXPECTED, got=", ".join(sorted(found)[:5]) or "no such file in it",
            fix="export the recording as Zipped CSV, with the accelerometer switched on",
        )  # fmt: skip
    return found


def _rows(path: StrPath, member: str) -> Iterator[list[str]]:
    with open_member(path, member) as content:
        lines = (line for _, line in lines_of(content, f"{path}: {member}", _EXPECTED))
        try:
            yield from csv.reader(lines)
        except csv.Error as error:
            raise FormatError(f"{path}: {member}", expected=_EXPECTED, got=str(error)) from None


def _read_sensor(path: StrPath, member: str, name: str) -> Readings:
    """Return the readings of one sensor, by the names of its columns."""
    axes, limit = _SENSORS[name]
    rows = _rows(path, member)
    header = [cell.strip().lower() for cell in next(rows, [])]
    clock = next((each for each in ("seconds_elapsed", "time") if each in header), None)
    if clock is None or any(axis not in header for axis in axes):
        raise FormatError(
            f"{path}: {member}", expected=f"the columns seconds_elapsed, {', '.join(axes)}",
            got=", ".join(header)[:80] or "an empty file", fix="export the recording again",
        )  # fmt: skip
    columns = [header.index(each) for each in (clock, *axes)]
    unit = 1.0 if clock == "seconds_elapsed" else 1e-9
    sensor, damaged, total = Gathered(len(axes), limit), 0, 0
    for row in rows:
        if not row:
            continue
        total += 1
        cells = [parse_number(row[k]) if k < len(row) else None for k in columns]
        known = [cell for cell in cells if cell is not None]
        if len(known) < len(cells) or not sensor.add(known[0] * unit, known[1:]):
            damaged += 1
    report_damage(damaged, total, f"{path}: {member}")
    return sensor.readings()


def _acceleration(log: dict[str, Readings]) -> Readings:
    """Acceleration with gravity, from the files that there are."""
    if "accelerometer" in log and len(log.get("gravity", _nothing(3))[0]) > 1:
        time, moved = log["accelerometer"]
        return time, moved + at_times(log["gravity"], time)
    whole = next((log[name] for name in _FELT[1:] if name in log), _nothing(3))
    if not len(whole[0]):
        return whole
    in_g = float(np.median(np.linalg.norm(whole[1], axis=1))) < _IN_G
    return whole[0], whole[1] * (GRAVITY_M_S2 if in_g else 1.0)


def _metadata(path: StrPath, members: dict[str, str]) -> dict[str, str]:
    """Return what Metadata.csv says, in lower case; nothing when there is none."""
    if "metadata" not in members:
        return {}
    rows = _rows(path, members["metadata"])
    header, values = next(rows, []), next(rows, [])
    return {
        name.strip().lower(): value.strip().lower()
        for name, value in zip(header, values, strict=False)
    }


def _sign(
    told: str, metadata: dict[str, str], felt: Readings, turned: Readings, path: StrPath
) -> float:
    """Return 1 when acceleration has Android's signs, -1 when it has the iPhone's."""
    system = metadata.get("platform", "")
    if told == "auto" and system in ("android", "ios"):
        standard = metadata.get("standardisation", "") == "true"
        told = "android" if system == "android" or standard else "ios"
    if told != "auto":
        return 1.0 if told == "android" else -1.0
    z = float(np.median(felt[1][:, 2])) if len(felt[0]) else 0.0
    if len(turned[0]) > 1:
        # what turns z into z is the same in a rotation and its inverse
        quaternion = turned[1]
        upright = float(np.median(1 - 2 * (quaternion[:, 0] ** 2 + quaternion[:, 1] ** 2)))
        return 1.0 if upright * z >= 0 else -1.0
    system = "Android" if z >= 0 else "an iPhone"
    warnings.warn(
        f"{path}: without Metadata.csv and Orientation.csv the phone is taken as {system}, since "
        "its screen would else look down; say which with the option platform",
        PalmsWarning,
        stacklevel=3,
    )
    return 1.0 if z >= 0 else -1.0


def _earthward(turned: Readings, felt: Readings) -> Readings:
    """Return attitudes from phone to earth, inverted where the platform has it the other way."""
    time, quaternion = turned
    if len(time) < 2 or len(felt[0]) < 2:
        return turned
    up = at_times(felt, time)
    x, y, z, w = quaternion.T
    agrees = _raised(x, y, z, w, up)
    return turned if agrees >= _raised(-x, -y, -z, w, up) else (time, quaternion * [-1, -1, -1, 1])


def _raised(x: FloatArray, y: FloatArray, z: FloatArray, w: FloatArray, up: FloatArray) -> float:
    """Return how far vectors point up on average, turned by quaternions."""
    row = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x**2 + y**2)
    return float(np.mean(sum(each * up[:, k] for k, each in enumerate(row))))


def _recognizes(path: Path) -> bool:
    stems = {PurePosixPath(name).stem.lower().replace(" ", "") for name in member_names(path)
             if name.lower().endswith(".csv")}  # fmt: skip
    return any(name in stems for name in _FELT)


FORMAT = Format(
    name="sensor-logger",
    description="recordings of the app Sensor Logger (Android, iPhone), by dead reckoning",
    suffixes=(".zip",),
    recognizes=_recognizes,
    read=read_sensor_logger,
)
