"""Tracks of RoNIN as it saves them: npy arrays N x 4, predicted x, y and reference x, y.

There are no times in them: samples lie evenly, 200 a second in RoNIN's own data.
"""

from __future__ import annotations

import tokenize
from pathlib import Path
from typing import Final

import numpy as np

from palms.errors import FormatError, InputError
from palms.geometry import FloatArray
from palms.io.files import MAX_BYTES, head, read_text
from palms.io.options import number_option
from palms.io.pose_log import EVERY_S, thinned
from palms.io.registry import Format
from palms.io.values import StrPath, brief, locating
from palms.io.walk import RecordedWalk
from palms.odometry import Odometry

__all__ = ["FORMAT", "RATE_HZ", "read_ronin"]

RATE_HZ: Final = 200.0  # RoNIN's data set
MAX_ROWS: Final = 2_000_000  # ours: almost three hours of them
_MAGIC = b"\x93NUMPY"
_UNREADABLE = (
    OSError, ValueError, EOFError, SyntaxError, TypeError, OverflowError, tokenize.TokenError,
)  # fmt: skip
_EXPECTED = "a track of RoNIN: an npy array of x, y, with reference x, y or without"


def read_ronin(
    path: StrPath, *, rate_hz: float | str = RATE_HZ, every_s: float | str = EVERY_S
) -> RecordedWalk:
    """Read a track of RoNIN; its frame is its own, and it begins at the origin.

    Parameters
    ----------
    path : path
        The npy file.
    rate_hz : float
        Samples a second.
    every_s : float
        Samples nearer in time are left out; 0 keeps them all.

    Raises
    ------
    InputError
        When it cannot be read, or an option is wrong.
    FormatError
        When it is no array of two or four columns of finite numbers.

    Examples
    --------
    >>> import tempfile
    >>> line = np.column_stack([np.arange(1000) / 200, np.zeros(1000)])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.save(f"{folder}/a.npy", line)
    ...     walk = read_ronin(f"{folder}/a.npy")
    >>> len(walk), round(float(walk.odometry("ronin").walked_m[-1]), 3)
    (13, 4.995)
    """
    rate = number_option(rate_hz, "rate_hz", 0.2, 10_000.0)
    every = number_option(every_s, "every_s", 0.0, 60.0)
    if head(path, 6) != _MAGIC:
        read_text(path, _EXPECTED)  # says what a missing, empty or binary file is
        raise FormatError(str(path), expected=_EXPECTED, got="text")
    table = _load(path)
    kept = thinned(np.arange(len(table)) / rate, every)
    time, points = np.array(kept) / rate, table[kept]
    track = points[:, :2] - points[0, :2]
    with locating(path):
        odometry = Odometry(time[1:], track[1:], frame="own", source="inertial")
        reference = points[:, 2:] if points.shape[1] == 4 else None
        return RecordedWalk(
            ronin=odometry,
            reference_m=None if reference is None else reference[1:],  # type: ignore[arg-type]
            start_m=None if reference is None else reference[0],
            path=Path(path),
        )


def _load(path: StrPath) -> FloatArray:
    """Read the array; its header is not believed before the size of the file is checked."""
    if Path(path).stat().st_size > MAX_BYTES:
        raise InputError(str(path), expected=f"at most {MAX_BYTES / 1e6:g} MB", got="more")
    try:
        array = np.load(path, mmap_mode="r", allow_pickle=False)
        numeric = array.dtype.kind in "fiu" and array.ndim == 2 and array.shape[1] in (2, 4)
        if numeric and len(array) > MAX_ROWS:
            raise InputError(str(path), expected=f"at most {MAX_ROWS} samples", got="more")
        with np.errstate(all="ignore"):  # numbers that are none are refused below
            table = np.array(array, dtype=np.float64) if numeric else None
    except InputError:
        raise
    except _UNREADABLE as error:
        raise FormatError(
            str(path), expected=_EXPECTED,
            got=f"an array that cannot be read ({brief(str(error), 60)})",
            fix="copy or save it again",
        ) from None  # fmt: skip
    if table is None or len(table) < 3:
        raise FormatError(
            str(path), expected=_EXPECTED, got=f"{array.dtype} of shape {array.shape}",
            fix="save the positions alone",
        )  # fmt: skip
    if not np.isfinite(table).all():
        raise FormatError(str(path), expected="finite positions", got="NaN or infinity")
    return table


def _recognizes(path: Path) -> bool:
    return head(path, 6) == _MAGIC


FORMAT = Format(
    name="ronin",
    description="tracks of RoNIN: npy arrays of x, y, with reference x, y or without",
    suffixes=(".npy",),
    recognizes=_recognizes,
    read=read_ronin,
)
