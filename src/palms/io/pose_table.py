"""Numbers of pose logs: rows of text or objects of JSON, with or without names of columns."""

from __future__ import annotations

import json
import os
import re
import warnings
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np

from palms.errors import FormatError, InputError, PalmsWarning
from palms.geometry import FloatArray
from palms.io.files import read_json, sniff
from palms.io.packed import read_lines, text_head
from palms.io.values import StrPath, brief, parse_number

__all__ = ["Parts", "Table", "cells_of", "named_parts", "read_table"]

MAX_ROWS: Final = 1_000_000  # ours: four hours at 60 poses a second
MAX_JSON_BYTES: Final = 30_000_000  # ours: in memory it becomes fifteen times as much
_COMMENTS = ("#", "//", "%")
_LISTS = ("poses", "frames", "data", "trajectory", "samples", "camera_poses", "cameraPoses")
_POSITION = re.compile(r"^(?:t|p|pos|position|trans|translation|loc|location)?[._ ]?([xyz])$")
_ROTATION = re.compile(r"^(?:q|quat|quaternion|rot|rotation|orientation)[._ ]?([xyzw])$")
_MATRIX = re.compile(r"^(?:transform|matrix|pose|camera.?transform|camera.?pose)\.(\d+)$")
_TIME = re.compile(r"^(?:t|time|timestamp|time.?stamp|ts|seconds_elapsed)$")
_WITH_UNIT = re.compile(r"^(.+?)(?:_|\s*[\[(]\s*)(ns|us|ms|s|sec|seconds|m)\s*[\])]?$")
_UNITS = {"ns": "ns", "us": "us", "ms": "ms", "s": "s", "sec": "s", "seconds": "s"}


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of numbers.

    Parameters
    ----------
    values : ndarray (T, k)
        T at least 1.
    names : tuple of str
        Of the columns, as the file has them; empty when it has none.
    comments : tuple of str
        Comment lines before the first row, without their mark.

    Examples
    --------
    >>> Table(np.zeros((1, 2)), ("t", "x"), ()).names
    ('t', 'x')
    """

    values: FloatArray
    names: tuple[str, ...]
    comments: tuple[str, ...]


class Parts(NamedTuple):
    """Which columns hold what.

    Attributes
    ----------
    columns : dict of str to int
        Of time, x, y, z, qx, qy, qz, qw, as far as they are there.
    matrix : list of int
        Of the numbers of a matrix, in order.
    unit : str or None
        Of time, where its name says so.

    Examples
    --------
    >>> Parts({"time": 0}, [], "ns").unit
    'ns'
    """

    columns: dict[str, int]
    matrix: list[int]
    unit: str | None


def cells_of(line: str) -> list[str]:
    """Return the cells of a line: between semicolons, else commas, tabs or blanks.

    Beside semicolons a comma is a decimal one.

    Examples
    --------
    >>> cells_of("0.5, 1.5, not tracking"), cells_of("0,5;1,5"), cells_of("2 3")
    (['0.5', '1.5', 'not tracking'], ['0.5', '1.5'], ['2', '3'])
    """
    if ";" in line:
        cells = line.replace(",", ".").split(";")
    elif "," in line or "\t" in line.strip():
        cells = line.split("," if "," in line else "\t")
    else:
        return line.split()
    cells = [cell.strip().strip("\"'") for cell in cells]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def read_table(path: StrPath, expected: str) -> Table:
    """Read rows of numbers, JSON objects in a list, or one JSON object a line.

    Parameters
    ----------
    path : path
    expected : str
        What it should hold, for the message.

    Raises
    ------
    InputError
        When it cannot be read.
    FormatError
        When a row is no row of finite numbers like the others; the message names the line.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_text
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/a.csv", "t,x,y,z" + chr(10) + "0,1,2,3" + chr(10))
    ...     read_table(f"{folder}/a.csv", "poses").values.tolist()
    [[0.0, 1.0, 2.0, 3.0]]
    """
    if sniff(text_head(path)) == "JSON":
        return _of_objects(_objects(path, expected), path, expected)
    rows = _Rows(expected)
    for number, line in read_lines(path, expected):
        text = line.strip()
        if text.startswith(_COMMENTS):
            rows.note(text.lstrip("#/% "))
        elif text:
            rows.add(cells_of(text), f"{path} line {number}")
        if len(rows.numbers) > MAX_ROWS * len(rows.used):
            raise InputError(str(path), expected=f"at most {MAX_ROWS} poses", got="more")
    return rows.table(path)


class _Rows:
    """Rows of text while they are read; columns of words are left out where columns have names."""

    def __init__(self, expected: str) -> None:
        self.expected = expected
        self.numbers = array("d")
        self.names: tuple[str, ...] = ()
        self.comments: list[str] = []
        self.width = 0
        self.used: list[int] = []

    def note(self, comment: str) -> None:
        """Keep a comment, if it stands before the first row."""
        if not self.width and comment:
            self.comments.append(comment)

    def add(self, cells: list[str], what: str) -> None:
        """Add a row, or take it for the header."""
        if not self.width:
            if not self.names and cells and parse_number(cells[0]) is None:
                self.names = tuple(cells)
                return
            self._begin(cells)
        if len(cells) != self.width:
            raise FormatError(
                what, expected=f"{self.expected}, {self.width} numbers in each line",
                got=str(len(cells)), fix="mend or remove that line",
            )  # fmt: skip
        for column in self.used:
            value = parse_number(cells[column])
            if value is None or not np.isfinite(value):
                raise FormatError(
                    what, expected=f"{self.expected}, finite numbers", got=brief(cells[column]),
                    fix="mend or remove that line",
                )  # fmt: skip
            self.numbers.append(value)

    def _begin(self, cells: list[str]) -> None:
        """Settle width, names and the columns that count, by the first row."""
        self.width = max(len(cells), 1)
        self.used = list(range(self.width))
        told = tuple(cells_of(self.comments[-1])) if self.comments and not self.names else ()
        known = named_parts(told).columns
        if len(told) == self.width and {"time", "x", "y", "z"} <= set(known):
            self.names = told
        if len(self.names) == self.width:
            self.used = [k for k, cell in enumerate(cells) if parse_number(cell) is not None]
            self.names = tuple(self.names[k] for k in self.used)

    def table(self, path: StrPath) -> Table:
        """Return what was read.

        Raises
        ------
        FormatError
            When there is no row, or the header has names for other columns.
        """
        comments = tuple(self.comments)
        return _checked(self.numbers, len(self.used), self.names, comments, (path, self.expected))


def _checked(
    numbers: array[float],
    width: int,
    names: tuple[str, ...],
    comments: tuple[str, ...],
    where: tuple[StrPath, str],
) -> Table:
    path, expected = where
    if not numbers:
        raise FormatError(
            str(path), expected=expected, got="no row with numbers",
            fix="check that it is the right file",
        )  # fmt: skip
    if names and len(names) != width:
        raise FormatError(
            str(path), expected=f"{len(names)} numbers in each line, as the header has names",
            got=str(width), fix="check header and separators",
        )  # fmt: skip
    return Table(np.frombuffer(numbers, dtype=np.float64).reshape(-1, width), names, comments)


def _objects(path: StrPath, expected: str) -> list[Any]:
    """Return the objects of a list, of a list in an object, or of lines."""
    if os.path.getsize(path) > MAX_JSON_BYTES:
        raise InputError(
            str(path), expected=f"at most {MAX_JSON_BYTES / 1e6:g} MB of JSON", got="more",
            fix="export rows of text instead",
        )  # fmt: skip
    if _is_lines(text_head(path)):
        return [
            _object(line, f"{path} line {number}", expected)
            for number, line in read_lines(path, expected)
            if line.strip()
        ]
    content = read_json(path, expected)
    if isinstance(content, dict):
        content = next((content[name] for name in _LISTS if name in content), content)
    if not isinstance(content, list) or not content:
        raise FormatError(str(path), expected=expected, got=brief(content))
    return content


def _is_lines(start: bytes) -> bool:
    """Whether JSON begins with a line that is an object, and another one."""
    lines = [line.strip() for line in start.splitlines() if line.strip()][:2]
    return len(lines) == 2 and lines[0][:1] + lines[0][-1:] == b"{}" and lines[1][:1] == b"{"


def _object(line: str, what: str, expected: str) -> Any:  # noqa: ANN401
    try:
        return json.loads(line, parse_int=float)
    except (ValueError, RecursionError) as error:
        raise FormatError(
            what, expected=expected, got=f"no JSON ({brief(str(error), 60)})",
            fix="mend or remove that line",
        ) from None  # fmt: skip


def _of_objects(objects: list[Any], path: StrPath, expected: str) -> Table:
    """Return objects as rows, without those that lack a number, as when tracking was lost."""
    rows = [dict(_flattened(item)) if isinstance(item, dict) else {} for item in objects]
    names = tuple(next((row for row in rows if row), {}))
    whole = [row for row in rows if row and all(name in row for name in names)]
    numbers = array("d", (row[name] for row in whole for name in names))
    lost = len(rows) - len(whole)
    if len(whole) < lost:
        raise FormatError(
            str(path), expected=expected, got=f"{lost} of {len(rows)} objects without the numbers "
            "of the first", fix="check that it is the right file",
        )  # fmt: skip
    if lost:
        warnings.warn(
            f"{path}: {lost} of {len(rows)} objects have no pose and are left out",
            PalmsWarning,
            stacklevel=4,
        )
    return _checked(numbers, len(names), names, (), (path, expected))


def _flattened(item: dict[str, Any], before: str = "") -> Iterator[tuple[str, float]]:
    """Yield names and numbers of an object: nested names joined by dots, lists numbered."""
    for key, value in item.items():
        name = f"{before}{key}"
        if isinstance(value, dict) and not before:
            yield from _flattened(value, f"{name}.")
        elif isinstance(value, list):
            yield from _listed(value, name)
        elif isinstance(value, int | float) and not isinstance(value, bool) and np.isfinite(value):
            yield name, float(value)


def _listed(values: list[Any], name: str) -> Iterator[tuple[str, float]]:
    flat = [v for row in values for v in (row if isinstance(row, list) else [row])]
    if len(flat) > 16 or not all(isinstance(v, int | float) and np.isfinite(v) for v in flat):
        return
    labels = "xyzw"[: len(flat)] if len(flat) in (3, 4) else range(len(flat))
    yield from ((f"{name}.{label}", float(v)) for label, v in zip(labels, flat, strict=True))


def named_parts(names: tuple[str, ...]) -> Parts:
    """Return which columns hold what; unknown ones are ignored.

    Examples
    --------
    >>> parts = named_parts(("frame", "timestamp_ns", "x", "y", "z"))
    >>> parts.columns, parts.unit
    ({'time': 1, 'x': 2, 'y': 3, 'z': 4}, 'ns')
    """
    columns: dict[str, int] = {}
    matrix: dict[int, int] = {}
    unit = None
    for index, raw in enumerate(names):
        name, found = _without_unit(raw)
        if _TIME.match(name) and "time" not in columns:
            columns["time"], unit = index, found
        elif (match := _POSITION.match(name)) is not None:
            columns.setdefault(match[1], index)
        elif (match := _ROTATION.match(name)) is not None:
            columns.setdefault(f"q{match[1]}", index)
        elif (match := _MATRIX.match(name)) is not None:
            matrix[int(match[1])] = index
    return Parts(columns, [matrix[k] for k in sorted(matrix)], unit)


def _without_unit(name: str) -> tuple[str, str | None]:
    """Split "timestamp (ns)" or "timestamp_ns" into name and unit."""
    plain = name.strip().strip("\"'").lower()
    match = _WITH_UNIT.match(plain)
    return (match[1], _UNITS.get(match[2])) if match is not None else (plain, None)
