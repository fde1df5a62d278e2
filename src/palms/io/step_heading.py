"""Steps and headings as CSV: when each step ended, how long it was, where it went.

Columns by their header: a time (``t``, ``time``, in s, ms, us or ns), a length (``length``,
``step_length``, ``step``, in m) and a heading (``heading``, ``yaw``, ``direction``; names ending in
``_rad`` or ``_deg`` say the unit). Without a header: time in s, length, heading in rad.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Literal

import numpy as np

from palms.errors import FormatError, InputError
from palms.io.files import sniff
from palms.io.options import choice_option
from palms.io.packed import text_head
from palms.io.pose_log import TIME_UNITS
from palms.io.pose_table import Table, cells_of, read_table
from palms.io.registry import Format
from palms.io.values import StrPath, locating, parse_number
from palms.io.walk import RecordedWalk
from palms.odometry import Odometry

__all__ = ["FORMAT", "read_step_heading"]

_EXPECTED = "steps: rows of time, step length and heading"
_UPTIME_S = 1e5  # ours: later times count from 1970, not from the walk's start
_NAMES = {
    "time": re.compile(r"^(?:t|time|timestamp|seconds_elapsed)(?:[_ (]+(?P<unit>s|ms|us|ns)\)?)?$"),
    "length": re.compile(r"^(?:step[_ ]?)?(?:length|len|step)(?:[_ (]+m\)?)?$"),
    "heading": re.compile(
        r"^(?:step[_ ]?)?(?:heading|yaw|direction|theta)(?:[_ (]+(?P<unit>rad|deg)\)?)?$"
    ),
}


def read_step_heading(
    path: StrPath,
    *,
    angle: Literal["auto", "rad", "deg"] = "auto",
    turning: Literal["left", "right"] = "left",
) -> RecordedWalk:
    r"""Read steps and headings; the walk begins at the origin of a frame of its own.

    Parameters
    ----------
    path : path
        The CSV file.
    angle : {"auto", "rad", "deg"}
        Unit of the headings; auto: as the header says, radians when it says nothing.
    turning : {"left", "right"}
        Which way headings grow: counter-clockwise as everywhere here, or clockwise as on a
        compass.

    Raises
    ------
    InputError
        When it cannot be read, or an option is wrong.
    FormatError
        When it holds no such rows; the message names the line.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_text
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/a.csv", "t_s,length_m,heading_deg\n0.5,0.6,0\n1,0.6,90\n")
    ...     walk = read_step_heading(f"{folder}/a.csv")
    >>> walk.odometry("ronin").position_m.round(3).tolist()
    [[0.6, 0.0], [0.6, 0.6]]
    """
    unit = choice_option(angle, "angle", ("auto", "rad", "deg"))
    sign = 1.0 if choice_option(turning, "turning", ("left", "right")) == "left" else -1.0
    table = read_table(path, _EXPECTED)
    columns, units = _columns(table, path)
    time, length, heading = (table.values[:, columns[name]] for name in _NAMES)
    if unit == "auto":
        unit = units["heading"] or "rad"
        if units["heading"] is None and np.abs(np.diff(heading)).max(initial=0) > 2 * math.pi:
            raise InputError(
                f"{path}: headings", expected="radians, or a header such as heading_deg",
                got=f"turns of {np.abs(np.diff(heading)).max():.4g}", fix="give the option angle",
            )  # fmt: skip
    heading = sign * (np.radians(heading) if unit == "deg" else heading)
    scale = TIME_UNITS[units["time"] or "s"]
    seconds = scale * (time - (time[0] if time[0] * scale > _UPTIME_S else 0.0))
    moves = length[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    with locating(path):
        walk = Odometry(seconds, np.cumsum(moves, axis=0), frame="own", source="inertial")
    return RecordedWalk.of(walk, path=Path(path))


def _columns(table: Table, path: StrPath) -> tuple[dict[str, int], dict[str, str | None]]:
    """Return which column holds what, and the units that the header names."""
    if not table.names and table.values.shape[1] == 3:
        return {name: k for k, name in enumerate(_NAMES)}, dict.fromkeys(_NAMES)
    found = _named(table.names)
    if len(found) < len(_NAMES):
        missing = ", ".join(name for name in _NAMES if name not in found)
        raise FormatError(
            str(path), expected=_EXPECTED, got=f"no column of {missing}",
            fix="name them in a header: t_s,length_m,heading_rad",
        )  # fmt: skip
    return (
        {name: column for name, (column, _) in found.items()},
        {name: unit for name, (_, unit) in found.items()},
    )  # fmt: skip


def _named(names: tuple[str, ...]) -> dict[str, tuple[int, str | None]]:
    found: dict[str, tuple[int, str | None]] = {}
    for column, raw in enumerate(names):
        for part, pattern in _NAMES.items():
            match = pattern.match(raw.strip().lower())
            if match is not None and part not in found:
                found[part] = column, match.groupdict().get("unit")
    return found


def _recognizes(path: Path) -> bool:
    """Whether the header names a time, a length and a heading."""
    start = text_head(path)
    if path.is_dir() or sniff(start) != "text":
        return False
    lines = start.decode("utf-8-sig", "replace").splitlines()
    first = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    cells = cells_of(first)
    if len(cells) == 3 and path.suffix.lower() == ".csv" and parse_number(cells[0]) is not None:
        return all(parse_number(cell) is not None for cell in cells)
    return len(_named(tuple(cells))) == len(_NAMES)


FORMAT = Format(
    name="steps",
    description="steps as CSV: time, length and heading of each",
    suffixes=(".csv",),
    recognizes=_recognizes,
    read=read_step_heading,
)
