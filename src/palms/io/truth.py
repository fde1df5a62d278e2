"""The truth of a simulated walk, beside it: ``truth.csv``, one row per sample."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

import numpy as np

from palms.errors import FormatError, InputError
from palms.geometry import FloatArray, as_readonly, check_finite, check_points
from palms.io.files import read_text, write_text
from palms.io.values import StrPath, brief, locating, parse_number

__all__ = ["Truth", "read_truth", "write_truth"]

TRUTH_FILE = "truth.csv"
_COLUMNS = ("t_s", "x_m", "y_m", "heading_rad", "level")
_EXPECTED = "a truth: rows " + ",".join(_COLUMNS)


@dataclass(frozen=True, slots=True)
class Truth:
    """Where a walker truly was, in the map frame.

    Parameters
    ----------
    time_s : array_like (T,)
        Time of each sample.
    position_m : array_like (T, 2)
        Position, map frame.
    heading_rad : array_like (T,)
        Direction of travel, map frame; NaN where there was none.
    level : sequence of str, optional
        Name of the floor at each sample; empty where it has no name.

    Raises
    ------
    InputError
        When lengths differ or a number is not finite.

    Examples
    --------
    >>> Truth([0.5], [[1, 2]], [0.0]).level
    ('',)
    """

    time_s: FloatArray
    position_m: FloatArray
    heading_rad: FloatArray
    level: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        time = check_finite(self.time_s, "the truth's times", (None,))
        position = check_points(self.position_m, "the truth's positions")
        heading = as_readonly(self.heading_rad)
        level = tuple(self.level) or ("",) * len(time)
        for what, values in (("positions", position), ("headings", heading), ("levels", level)):
            if len(values) != len(time):
                raise InputError(
                    "truth", expected=f"{len(time)} {what}, one for each time", got=str(len(values))
                )
        if heading.ndim != 1 or np.isinf(heading).any():
            raise InputError("the truth's headings", expected="radians or NaN", got="infinity")
        object.__setattr__(self, "time_s", time)
        object.__setattr__(self, "position_m", position)
        object.__setattr__(self, "heading_rad", heading)
        object.__setattr__(self, "level", level)

    def __len__(self) -> int:
        return len(self.time_s)


def _number(cell: str, what: str, column: str) -> float:
    value = parse_number(cell)
    if not cell.strip() and column == "heading_rad":
        return float("nan")
    if value is None or not np.isfinite(value):
        raise FormatError(
            f"{what}, {column}",
            expected="a finite number",
            got=brief(cell),
            fix="mend or remove the file",
        )
    return value


def read_truth(path: StrPath) -> Truth:
    r"""Read ``truth.csv``; an empty heading means that there was none.

    Raises
    ------
    InputError
        When it cannot be read; the message names file and line.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/truth.csv", "t_s,x_m,y_m,heading_rad,level\n0.5,1,2,,G\n")
    ...     truth = read_truth(f"{folder}/truth.csv")
    >>> truth.position_m.tolist(), truth.level
    ([[1.0, 2.0]], ('G',))
    """
    try:
        lines = list(csv.reader(io.StringIO(read_text(path, _EXPECTED))))
    except csv.Error as error:
        raise FormatError(str(path), expected=_EXPECTED, got=str(error)) from None
    numbers, levels = [], []
    for number, cells in enumerate(lines, start=1):
        header = number == 1 and parse_number(cells[0] if cells else "") is None
        if header or not any(cell.strip() for cell in cells):
            continue
        what = f"{path} line {number}"
        if not 4 <= len(cells) <= 5:
            raise FormatError(what, expected=",".join(_COLUMNS), got=f"{len(cells)} cells")
        numbers.append([_number(c, what, n) for c, n in zip(cells, _COLUMNS[:4], strict=False)])
        levels.append(cells[4].strip() if len(cells) == 5 else "")
    if not numbers:
        raise FormatError(str(path), expected=_EXPECTED, got="no row with numbers")
    table = np.array(numbers)
    with locating(path):
        return Truth(table[:, 0], table[:, 1:3], table[:, 3], tuple(levels))


def write_truth(truth: Truth, path: StrPath) -> None:
    """Write ``truth.csv``.

    Raises
    ------
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_truth(Truth([0.5], [[1, 2]], [0.0], ["G"]), f"{folder}/truth.csv")
    ...     print(read_text(f"{folder}/truth.csv"), end="")
    t_s,x_m,y_m,heading_rad,level
    0.5,1.0,2.0,0.0,G
    """
    table = np.column_stack([truth.time_s, truth.position_m, truth.heading_rad]).tolist()
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for row, level in zip(table, truth.level, strict=True):
        writer.writerow([*("" if np.isnan(value) else repr(value) for value in row), level])
    write_text(path, out.getvalue())
