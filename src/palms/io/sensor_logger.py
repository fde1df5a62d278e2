"""Recordings of the app Sensor Logger: CSV files in a zip archive or folder, or JSON.

Columns are found by their header. Android's axes of acceleration are those of `InertialLog`;
iPhones write all three with the other sign, unless the app was told to "Standardise Units &
Frames". ``Metadata.csv`` says which; without it the orientation tells, since gravity points the
other way from what it says is up.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Literal

import numpy as np

from palms.errors import PalmsWarning
from palms.geometry import FloatArray
from palms.inertial.log import GRAVITY_M_S2
from palms.io.files import sniff
from palms.io.options import choice_option
from palms.io.packed import text_head
from palms.io.reckoned import ReckoningOptions, at_times, reckon
from palms.io.registry import Format
from palms.io.sensor_logger_files import FELT, Readings, is_recording, read_archive, read_messages
from palms.io.values import StrPath
from palms.io.walk import RecordedWalk

__all__ = ["FORMAT", "read_sensor_logger"]

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
        The zip archive, or a folder with its files; the JSON export, or a file of messages
        that the app pushed.
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
    is_json = not Path(path).is_dir() and sniff(text_head(path)) == "JSON"
    log, metadata = read_messages(path) if is_json else read_archive(path)
    felt = _acceleration(log)
    turned = log.get("orientation", _nothing(4))
    sign = _sign(told, metadata, felt, turned, path)
    rate = log.get("gyroscope", log.get("gyroscopeuncalibrated", _nothing(3)))
    sensors = {
        "acceleration": (felt[0], sign * felt[1]),
        "rate": rate,
        "attitude": _earthward(turned, (felt[0], sign * felt[1])),
    }
    return RecordedWalk.of(reckon(sensors, options, path), path=Path(path))


def _nothing(width: int) -> Readings:
    return np.empty(0), np.empty((0, width))


def _acceleration(log: dict[str, Readings]) -> Readings:
    """Acceleration with gravity, from the files that there are."""
    if "accelerometer" in log and len(log.get("gravity", _nothing(3))[0]) > 1:
        time, moved = log["accelerometer"]
        return time, moved + at_times(log["gravity"], time)
    whole = next((log[name] for name in FELT[1:] if name in log), _nothing(3))
    if not len(whole[0]):
        return whole
    in_g = float(np.median(np.linalg.norm(whole[1], axis=1))) < _IN_G
    return whole[0], whole[1] * (GRAVITY_M_S2 if in_g else 1.0)


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
    if not len(felt[0]):
        return 1.0
    z = float(np.median(felt[1][:, 2]))
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


FORMAT = Format(
    name="sensor-logger",
    description="recordings of the app Sensor Logger (Android, iPhone), by dead reckoning",
    suffixes=(".zip", ".json"),
    recognizes=is_recording,
    read=read_sensor_logger,
)
