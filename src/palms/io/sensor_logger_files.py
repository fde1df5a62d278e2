"""The files that the app Sensor Logger makes: archives of CSV, JSON, and messages that it pushes.

Its JSON export is a list of records, whose ``sensor`` and numbers are texts; what it pushes to a
server are messages whose ``payload`` lists records with ``name`` and ``values``. A file holds one
message, a list of them, or one after the other, as a server would log them.
"""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Any, Final, NamedTuple

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.archives import member_names, open_member
from palms.io.files import read_bytes, sniff
from palms.io.packed import lines_of, text_head, unzipped
from palms.io.reckoned import Gathered, report_damage
from palms.io.values import StrPath, brief, parse_number

__all__ = ["FELT", "Readings", "Recording", "is_recording", "read_archive", "read_messages"]

Readings = tuple[FloatArray, FloatArray]

_EXPECTED = "a Sensor Logger recording: a zip archive or folder with Accelerometer.csv"
_RECORDS = "records of Sensor Logger: sensor or name, time and values"
_AXES = ("x", "y", "z")
_TURNS = ("qx", "qy", "qz", "qw")
SENSORS: Final = {  # columns, and how far they can go
    "accelerometer": (_AXES, 200.0),  # m/s2, without gravity
    "gravity": (_AXES, 20.0),
    "totalacceleration": (_AXES, 200.0),
    "accelerometeruncalibrated": (_AXES, 200.0),  # with gravity; in g on an iPhone
    "gyroscope": (_AXES, 60.0),
    "gyroscopeuncalibrated": (_AXES, 60.0),
    "orientation": (_TURNS, 1.01),
}
FELT = ("accelerometer", "totalacceleration", "accelerometeruncalibrated")
_VALUE = re.compile(r"[^\s,]")
_MOST_BYTES = 100_000_000  # ours: half an hour of four sensors; as objects five times as much
_UPTIME_S = 1e6  # ours: later times count from 1970, not from the start of the recording


class Recording(NamedTuple):
    """What a recording holds.

    Attributes
    ----------
    sensors : dict
        Times (N,) in seconds and values (N, width) of each known sensor, by its name in
        lower case; empty ones are left out.
    metadata : dict
        What it says of phone and app, in lower case.
    """

    sensors: dict[str, Readings]
    metadata: dict[str, str]


def read_archive(path: StrPath) -> Recording:
    """Read a zip archive, or a folder, with a CSV file for each sensor.

    Raises
    ------
    FormatError
        When it has no accelerometer, or is damaged.
    """
    members = _members(path)
    sensors = {name: _read_sensor(path, members[name], name) for name in SENSORS if name in members}
    return Recording(_from_start(sensors), _metadata(path, members))


def _from_start(sensors: dict[str, Readings]) -> dict[str, Readings]:
    """Return readings with times that count from the first of all, where they count from 1970."""
    starts = [float(time.min()) for time, _ in sensors.values() if len(time)]
    first = min(starts, default=0.0)
    zero = first if first > _UPTIME_S else 0.0
    return {name: (time - zero, values) for name, (time, values) in sensors.items()}


def _members(path: StrPath) -> dict[str, str]:
    """Return the archive's files by the sensor they are of: the first of each."""
    found: dict[str, str] = {}
    for name in member_names(path):
        place = PurePosixPath(name.replace("\\", "/"))
        if place.suffix.lower() == ".csv" and not place.name.startswith("."):
            found.setdefault(place.stem.lower().replace(" ", ""), name)
    if not any(name in found for name in FELT):
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
    axes, limit = SENSORS[name]
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


def read_messages(path: StrPath) -> Recording:
    """Read the JSON export, or messages that the app pushed; may be packed by gzip.

    Raises
    ------
    FormatError
        When it is no JSON, is cut off, or holds no record of a sensor.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_json
    >>> record = {"name": "gravity", "time": 1_700_000_000_500_000_000,
    ...           "values": {"x": 0, "y": 0, "z": 9.8}}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/push.json", {"messageId": 1, "payload": [record]})
    ...     [values.tolist() for values in read_messages(f"{folder}/push.json").sensors["gravity"]]
    [[0.0], [[0.0, 0.0, 9.8]]]
    """
    log = {name: Gathered(len(axes), limit) for name, (axes, limit) in SENSORS.items()}
    metadata: dict[str, str] = {}
    rows = damaged = 0
    for record in (record for message in _messages(path) for record in _records(message)):
        name = str(record.get("sensor") or record.get("name") or "").lower().replace(" ", "")
        if name == "metadata":
            metadata |= {str(k).lower(): str(v).lower() for k, v in record.items()}
        elif name in log:
            rows += 1
            damaged += not _add(log[name], record, SENSORS[name][0])
    if not rows:
        raise FormatError(
            str(path), expected=_RECORDS, got="none", fix="check that it is the right file"
        )
    report_damage(damaged, rows, path)
    sensors = {name: each.readings() for name, each in log.items() if len(each)}
    return Recording(_from_start(sensors), metadata)


def _add(sensor: Gathered, record: dict[str, Any], axes: tuple[str, ...]) -> bool:
    """Add a record's reading; False when it is damaged."""
    values = record.get("values")
    given = values if isinstance(values, dict) else record
    elapsed = _number(record.get("seconds_elapsed"))
    since_1970 = _number(record.get("time"))
    if elapsed is None and since_1970 is not None:
        elapsed = since_1970 * 1e-9
    numbers = [_number(given.get(axis)) for axis in axes]
    known = [number for number in numbers if number is not None]
    return elapsed is not None and len(known) == len(axes) and sensor.add(elapsed, known)


def _number(value: object) -> float | None:
    """Return a number that may be written as a text; None when it is none, or not finite."""
    number = parse_number(value) if isinstance(value, str) else value
    if isinstance(number, bool) or not isinstance(number, int | float):
        return None
    return float(number) if abs(number) < 1e300 else None


def _records(message: Any) -> Iterator[dict[str, Any]]:  # noqa: ANN401
    """Yield the records of a message, or of a list of messages; a record is one itself."""
    if isinstance(message, dict):
        payload = message.get("payload")
        if not isinstance(payload, list):
            yield message
            return
        message = payload
    if isinstance(message, list):
        for each in message:
            yield from _records(each)


def _messages(path: StrPath) -> Iterator[Any]:
    """Yield what stands in a list, or one after the other, without holding all of it at once."""
    content = unzipped(read_bytes(path), str(path))
    if len(content) > _MOST_BYTES:
        raise FormatError(
            str(path), expected=f"at most {_MOST_BYTES / 1e6:g} MB of JSON", got="more",
            fix="export it as zipped CSV",
        )  # fmt: skip
    text, decoder = content.decode("utf-8-sig", "replace"), json.JSONDecoder()
    at = _next(text, 0)
    listed = text[at : at + 1] == "["
    at = _next(text, at + listed)
    while at < len(text) and not (listed and text[at] == "]"):
        try:
            value, at = decoder.raw_decode(text, at)
        except (ValueError, RecursionError) as error:
            line = 1 + text.count("\n", 0, at)
            raise FormatError(
                f"{path} line {line}", expected=_RECORDS,
                got=brief(str(error), 60), fix="the file may be cut off or be of another format",
            ) from None  # fmt: skip
        yield value
        at = _next(text, at)
    if listed and at >= len(text):
        raise FormatError(
            str(path), expected=_RECORDS, got="a list that does not end",
            fix="the file may be cut off; export it again",
        )  # fmt: skip


def _next(text: str, at: int) -> int:
    """Where the next value begins; the end of the text when there is none."""
    found = _VALUE.search(text, at)
    return found.start() if found else len(text)


def is_recording(path: Path) -> bool:
    """Whether a file or folder looks like one of these.

    Examples
    --------
    >>> is_recording(Path("no such file"))
    False
    """
    stems = {
        PurePosixPath(name).stem.lower().replace(" ", "")
        for name in member_names(path) if name.lower().endswith(".csv")
    }  # fmt: skip
    if stems.intersection(FELT):
        return True
    start = b"" if path.is_dir() else text_head(path)
    if sniff(start) != "JSON" or b'"time"' not in start:
        return False
    return b'"sensor"' in start or (b'"payload"' in start and b'"name"' in start)
