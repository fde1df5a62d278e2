"""What files hold, checked: cells, numbers, arrays; and how messages show them."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.errors import FormatError, InputError
from palms.geometry import FloatArray, check_finite

__all__ = [
    "StrPath",
    "brief",
    "check_array",
    "check_number",
    "locating",
    "null_for_nan",
    "parse_number",
]

StrPath = str | os.PathLike[str]


def brief(value: object, width: int = 40) -> str:
    """Show a value of a file in a message, cut to `width` characters.

    Examples
    --------
    >>> brief("a very long cell indeed", 12)
    "'a very l..."
    """
    text = repr(value)
    return text if len(text) <= width else text[: width - 3] + "..."


def parse_number(cell: str) -> float | None:
    """Return the number in a cell of a text file, None when it holds none.

    Examples
    --------
    >>> parse_number(' "1.5" '), parse_number("wall"), parse_number("1_0")
    (1.5, None, None)
    """
    text = cell.strip().strip("\"'").strip()
    if "_" in text:
        return None
    try:
        return float(text)
    except ValueError:
        return None


def check_array(values: object, what: str, shape: tuple[int | None, ...]) -> FloatArray:
    """Return numbers of a file as `palms.geometry.check_finite` does, as a FormatError.

    Examples
    --------
    >>> check_array([[1, 2], [3]], "walk.json: ARKit_raw_2D", (None, 2))
    Traceback (most recent call last):
    palms.errors.FormatError: walk.json: ARKit_raw_2D: expected numbers of shape (N, 2), got ...
    """
    try:
        return check_finite(values, what, shape)  # type: ignore[arg-type]
    except InputError as error:
        raise FormatError(str(error)) from None
    except (OverflowError, RecursionError) as error:
        raise FormatError(what, expected="finite numbers", got=brief(str(error))) from None


def check_number(value: object, what: str) -> float:
    """Return a finite number of a file.

    Examples
    --------
    >>> check_number("soon", "scan.json: t_s")
    Traceback (most recent call last):
    palms.errors.FormatError: scan.json: t_s: expected a finite number, got 'soon'
    """
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not np.isfinite(value):  # type: ignore[call-overload]
        raise FormatError(what, expected="a finite number", got=brief(value))
    return float(value)  # type: ignore[arg-type]


@contextlib.contextmanager
def locating(path: StrPath) -> Iterator[None]:
    """Put the name of the file before what a value says of its content.

    Overflow in the checks of absurd numbers is silent; the checks themselves speak.

    Examples
    --------
    >>> with locating("plan.csv"):
    ...     raise InputError("floor plan", expected="a wall", got="none")
    Traceback (most recent call last):
    palms.errors.FormatError: plan.csv: floor plan: expected a wall, got none
    """
    try:
        with np.errstate(all="ignore"):
            yield
    except FormatError:
        raise
    except InputError as error:
        raise FormatError(f"{path}: {error}") from None


def null_for_nan(values: npt.ArrayLike) -> list[Any]:
    """Return nested lists for JSON, with None in place of NaN.

    Examples
    --------
    >>> null_for_nan([1.0, float("nan")])
    [1.0, None]
    """
    array = np.asarray(values, dtype=np.float64)
    boxed = array.astype(object)
    boxed[np.isnan(array)] = None
    listed: list[Any] = boxed.tolist()
    return listed
