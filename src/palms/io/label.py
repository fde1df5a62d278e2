"""Where a scan was taken, as the PALMS data set says it: ``label.txt`` with ``x, y, theta``."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from palms.errors import FormatError
from palms.geometry import FloatArray, check_finite, wrap_angle
from palms.io.files import read_text, write_text
from palms.io.values import StrPath, brief, locating, parse_number

__all__ = ["Label", "read_label", "write_label"]

_EXPECTED = "a label: x, y, theta in metres and radians"


@dataclass(frozen=True, slots=True)
class Label:
    """Where and in which orientation a scan was taken.

    Parameters
    ----------
    position_m : array_like (2,)
        The observation point, map frame.
    drift_rad : float
        Angle that turns odom vectors into map vectors; brought to (-pi, pi].

    Raises
    ------
    InputError
        When a number is not finite.

    Examples
    --------
    >>> Label((3, 4), 0.5).position_m.tolist()
    [3.0, 4.0]
    """

    position_m: FloatArray
    drift_rad: float

    def __post_init__(self) -> None:
        position = check_finite(self.position_m, "the label's position", (2,))
        drift = float(check_finite([self.drift_rad], "the label's drift", (1,))[0])
        if not -math.pi < drift <= math.pi:
            drift = float(wrap_angle(drift))
        object.__setattr__(self, "position_m", position)
        object.__setattr__(self, "drift_rad", drift)


def read_label(path: StrPath) -> Label:
    r"""Read ``label.txt``: the first line that is not blank counts.

    Raises
    ------
    InputError
        When it cannot be read or holds no three numbers.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/label.txt", "41.4, 46.5, -1.5\n")
    ...     read_label(f"{folder}/label.txt").drift_rad
    -1.5
    """
    line = next(line for line in read_text(path, _EXPECTED).splitlines() if line.strip())
    cells = [cell for cell in re.split(r"[,;\s]+", line.strip().strip("()[]")) if cell]
    values = [parse_number(cell) for cell in cells]
    if len(values) != 3 or None in values:
        raise FormatError(
            str(path), expected=_EXPECTED, got=brief(line), fix="write the three numbers in a line"
        )
    with locating(path):
        return Label(values[:2], values[2])  # type: ignore[arg-type]


def write_label(label: Label, path: StrPath) -> None:
    """Write ``label.txt``.

    Raises
    ------
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_label(Label((3, 4), 0.5), f"{folder}/label.txt")
    ...     print(read_text(f"{folder}/label.txt"), end="")
    3.0, 4.0, 0.5
    """
    x, y = label.position_m.tolist()
    write_text(path, f"{x!r}, {y!r}, {label.drift_rad!r}\n")
