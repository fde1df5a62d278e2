"""Recorded walks as the PALMS data set has them: ``<walk>.json``.

``ARKit_raw_2D`` is stored negated, ``RoNIN_raw_2D`` lies in a frame of its own. The
reference ``ARKit_PF`` has six rows less than there are samples: row 0 is the start point,
row j >= 1 belongs to sample 6 + j (counted from 0), so that the last belongs to the last.
``truth.csv`` beside the walk, when there is one, gives the reference for every sample.
Of ours are the keys ``facing_rad`` (odom frame) and ``session_names``.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import FormatError, InputError, OutputError
from palms.geometry import FloatArray
from palms.io.files import read_json, write_json
from palms.io.registry import Format
from palms.io.truth import TRUTH_FILE, read_truth, write_truth
from palms.io.values import StrPath, brief, check_array, locating, null_for_nan
from palms.io.walk import RecordedWalk
from palms.odometry import Odometry

__all__ = ["FORMAT", "read_tracking", "walk_file", "write_tracking"]

REFERENCE_LAG = 6  # samples before the reference's first row but the start point
_KEYS = {"arkit": "ARKit_raw_2D", "ronin": "RoNIN_raw_2D"}
_EXPECTED = "a walk: an object with ARKit_raw_2D or RoNIN_raw_2D and time_intervals"


def walk_file(path: StrPath) -> Path:
    """Return the file of a walk: the path itself, or the one walk in a folder.

    Parameters
    ----------
    path : path
        A file, or a folder ``trajectories/<scene>/<walk>``.

    Raises
    ------
    InputError
        When a folder holds no walk, or several.

    Examples
    --------
    >>> walk_file("a/walk.json").name
    'walk.json'
    """
    place = Path(path)
    if not place.is_dir():
        return place
    found = sorted(place.glob("*.json"))
    if len(found) != 1 or found[0].name == "events.json":
        found = [file for file in found if _recognizes(file)]
    if len(found) == 1:
        return found[0]
    names = ", ".join(file.name for file in found[:3])
    raise InputError(
        str(path),
        expected="a folder with the JSON file of one walk",
        got=f"{len(found)}: {names}" if found else "none",
        fix="name the walk's file" if found else "check the folder",
    )


def read_tracking(path: StrPath) -> RecordedWalk:
    """Read a walk of the data set.

    Parameters
    ----------
    path : path
        The JSON file, or the folder of one walk. ``truth.csv`` beside it is read, too.

    Raises
    ------
    InputError
        When it cannot be read; the message names file and key.

    Examples
    --------
    >>> import tempfile
    >>> content = {"ARKit_raw_2D": [[-1, 0], [-2, 0]], "time_intervals": [12.5, 0.5]}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/Session_7.json", content)
    ...     walk = read_tracking(f"{folder}/Session_7.json")
    >>> walk.odometry("arkit").position_m.tolist(), walk.time_s.tolist(), walk.session
    ([[1.0, 0.0], [2.0, 0.0]], [12.5, 13.0], ('7',))
    """
    file = walk_file(path)
    content = read_json(file, _EXPECTED)
    if not isinstance(content, dict):
        raise FormatError(str(file), expected=_EXPECTED, got=brief(content))
    names = _session_names(content, file)
    times = _times(content, file)
    odometry = {name: _odometry(content, file, name, (times, names)) for name in _KEYS}
    if not any(odometry.values()):
        raise FormatError(
            str(file), expected=_EXPECTED, got="neither ARKit_raw_2D nor RoNIN_raw_2D"
        )
    start, ahead = _start(content, file)
    pf = _reference(content, file, len(times))
    truth_path = file.with_name(TRUTH_FILE)
    truth = read_truth(truth_path) if truth_path.is_file() else None
    building = content.get("building_id")
    with locating(file):
        return RecordedWalk(
            **odometry,
            reference_m=pf if truth is None else truth.position_m,
            start_m=start,
            ahead_m=ahead,
            session=names,
            building_id=None if building is None else str(building),
            truth=truth,
            path=file,
        )


def _times(content: dict[str, Any], path: Path) -> FloatArray:
    if content.get("time_intervals") is None:
        raise FormatError(
            str(path), expected="the key time_intervals", got="none", fix="record the walk again"
        )
    intervals = check_array(content["time_intervals"], f"{path}: time_intervals", (None,))
    wrong = intervals <= 0
    wrong[:1] = intervals[:1] < 0  # the first sample may be the start of the clock
    if wrong.any():
        at = int(wrong.argmax())
        raise FormatError(
            f"{path}: time_intervals",
            expected="seconds above 0",
            got=f"{intervals[at]:.6g} at sample {at}",
            fix="sort the samples and drop repeated ones",
        )
    with np.errstate(all="ignore"):
        return np.cumsum(intervals)


def _odometry(
    content: dict[str, Any], path: Path, source: str, shared: tuple[FloatArray, tuple[str, ...]]
) -> Odometry | None:
    """Odometry of one source; `shared` are the times and session names of the walk."""
    key, (times, names) = _KEYS[source], shared
    if content.get(key) is None:
        return None
    stored = check_array(content[key], f"{path}: {key}", (None, 2))
    if len(stored) != len(times):
        raise FormatError(
            f"{path}: {key}",
            expected=f"{len(times)} rows, one for each of time_intervals",
            got=str(len(stored)),
            fix="record the walk again",
        )
    facing = content.get("facing_rad") if source == "arkit" else None
    if facing is not None:
        facing = check_array(facing, f"{path}: facing_rad", (len(times),))
    with locating(path):
        if source == "arkit":
            return Odometry(times, -stored + 0.0, facing_rad=facing, session=names)
        return Odometry(times, stored, frame="own", source="inertial", session=names)


def _points(rows: object, what: str) -> FloatArray:
    """Points (N, 2) of a file, NaN where a row is null or of nulls."""
    if not isinstance(rows, list):
        raise FormatError(what, expected="a list of points", got=brief(rows))
    absent = np.array([row is None or row == [None, None] for row in rows], dtype=bool)
    filled = [[0.0, 0.0] if none else row for row, none in zip(rows, absent, strict=True)]
    return np.where(absent[:, None], np.nan, check_array(filled, what, (None, 2)))


def _reference(content: dict[str, Any], path: Path, samples: int) -> FloatArray:
    reference = np.full((samples, 2), np.nan)
    if not content.get("ARKit_PF"):
        return reference
    rows = _points(content["ARKit_PF"], f"{path}: ARKit_PF")
    if len(rows) != samples - REFERENCE_LAG:
        raise FormatError(
            f"{path}: ARKit_PF",
            expected=f"{max(samples - REFERENCE_LAG, 0)} rows, {REFERENCE_LAG} less than samples",
            got=str(len(rows)),
            fix="record the walk again, or leave the key out",
        )
    reference[REFERENCE_LAG + 1 :] = rows[1:]
    return reference


def _start(content: dict[str, Any], path: Path) -> tuple[FloatArray | None, FloatArray | None]:
    """Start point and a second point ahead of it, of the map; None where not known."""
    start = ahead = None
    if content.get("starting_vector"):
        vector = check_array(content["starting_vector"], f"{path}: starting_vector", (2, 2))
        start = vector[0]
        ahead = vector[1] if (vector[0] != vector[1]).any() else None
    if content.get("ARKit_PF"):
        row = _points(content["ARKit_PF"], f"{path}: ARKit_PF")[0]
        start = row if np.isfinite(row).all() else start
    return start, ahead


def _session_names(content: dict[str, Any], path: Path) -> tuple[str, ...]:
    """Names of the walk as a session; a session_id that is no integer is an uptime."""
    listed = content.get("session_names")
    names = [content.get("session_id"), *(listed if isinstance(listed, list) else [])]
    texts = [text for value in names if (text := _session_name(value))]
    for rest in re.findall(r"Session_(.+)", path.stem):
        texts += [rest.split("_")[0], rest]
    return tuple(dict.fromkeys(text for text in texts if text))


def _session_name(value: object) -> str | None:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    text = str(value).strip().removeprefix("Session_")
    try:
        number = float(text)
    except ValueError:
        return text or None
    if not number.is_integer():
        return None
    return text if isinstance(value, int | str) and "." not in text else str(int(number))


def write_tracking(walk: RecordedWalk, path: StrPath) -> None:
    """Write a walk of the data set, and ``truth.csv`` beside it when the truth is known.

    Parameters
    ----------
    walk : RecordedWalk
        The walk; its odometry must start at the origin, as the format wants it. The format
        has no place for a reference of the first seven samples; the truth has.
    path : path
        The JSON file; its folder must exist.

    Raises
    ------
    InputError
        When an odometry does not start at the origin.
    OutputError
        When it cannot be written, or the truth of another walk lies beside it.

    Examples
    --------
    >>> import tempfile
    >>> walk = RecordedWalk(arkit=Odometry([0.5, 1.0], [[0.6, 0.0], [1.2, 0.0]]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_tracking(walk, f"{folder}/walk.json")
    ...     read_tracking(folder).odometry().position_m.tolist()
    [[0.6, 0.0], [1.2, 0.0]]
    """
    truth_path = Path(path).with_name(TRUTH_FILE)
    if walk.truth is None and truth_path.is_file():
        raise OutputError(
            str(path),
            expected=f"a folder without {TRUTH_FILE}",
            got="one, which would be taken for this walk's",
            fix="choose another folder or remove it",
        )
    write_json(path, _content(walk))
    if walk.truth is not None:
        write_truth(walk.truth, truth_path)


def _content(walk: RecordedWalk) -> dict[str, Any]:
    content: dict[str, Any] = {"source": "palms"}
    for name in walk.sources:
        odometry = walk.odometry(name)
        if odometry.start_m.any():
            raise InputError(
                f"walk to be written, {name}",
                expected="a start at the origin of its frame",
                got=str(odometry.start_m.tolist()),
                fix="subtract start_m from walk and scan",
            )
        sign = -1.0 if name == "arkit" else 1.0
        content[_KEYS[name]] = (sign * odometry.position_m + 0.0).tolist()
    if walk.arkit is not None and walk.arkit.facing_rad is not None:
        content["facing_rad"] = walk.arkit.facing_rad.tolist()
    content["time_intervals"] = np.diff(walk.time_s, prepend=0.0).tolist()
    if walk.session:
        first = walk.session[0]
        plain = first.isascii() and first.isdigit() and str(int(first)) == first
        content["session_id"] = int(first) if plain else f"Session_{first}"
    if len(walk.session) > 1:
        content["session_names"] = list(walk.session[1:])
    if walk.building_id is not None:
        content["building_id"] = walk.building_id
    return content | _written_reference(walk)


def _written_reference(walk: RecordedWalk) -> dict[str, Any]:
    content: dict[str, Any] = {}
    if walk.start_m is not None:
        ahead = walk.start_m if walk.ahead_m is None else walk.ahead_m
        content["starting_vector"] = [walk.start_m.tolist(), ahead.tolist()]
    rows = walk.reference_m[REFERENCE_LAG:].copy()
    if len(rows):
        rows[0] = np.nan if walk.start_m is None else walk.start_m
        if np.isfinite(rows[1:]).any():
            content["ARKit_PF"] = null_for_nan(rows)
    return content


def _recognizes(path: Path) -> bool:
    if path.is_dir():
        return any(_recognizes(file) for file in path.glob("*.json") if file.is_file())
    try:
        with open(path, "rb") as file:
            start = file.read(1000).removeprefix(b"\xef\xbb\xbf").lstrip()
            if not start.startswith(b"{"):
                return False
            content = start + file.read(50_000_000)
    except (OSError, ValueError):
        return False
    return b'"ARKit_raw_2D"' in content or b'"RoNIN_raw_2D"' in content


FORMAT = Format(
    name="tracking",
    description="the PALMS data set's walks: ARKit and RoNIN positions, reference",
    suffixes=(".json",),
    recognizes=_recognizes,
    read=read_tracking,
    write=write_tracking,
)
