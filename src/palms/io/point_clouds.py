"""What point clouds of any format have in common: which way is up, where the user stood."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from palms.errors import FormatError, InputError
from palms.extraction.scans import scan_from_points
from palms.extraction.settings import ExtractionSettings
from palms.geometry import FloatArray
from palms.io.planes import session_of
from palms.io.values import StrPath, brief, locating
from palms.scan import Scan

__all__ = [
    "CHUNK_ROWS",
    "MAX_POINTS",
    "UP_AXES",
    "CloudOptions",
    "Thinned",
    "cloud_file",
    "cloud_scan",
    "find_up",
    "parse_metres",
    "parse_position",
]

MAX_POINTS = 3_000_000  # ours: of larger clouds every so manieth point is taken
CHUNK_ROWS = 250_000  # ours: points that are read at once
UP_AXES = {  # rows: what becomes x and y on the ground, and height; all are rotations
    "x": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    "-x": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
    "y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "-y": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "z": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "-z": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
}
_LEVEL_M = 0.05  # ours: thickness of floors and ceilings in a histogram
_CLEARER = 1.5  # ours: so much more must lie on two levels along one axis than another


class Thinned:
    """Points of a file, gathered piece by piece; of very many, every n-th is kept.

    Parameters
    ----------
    count : int
        How many the file has.

    Examples
    --------
    >>> points = Thinned(2 * MAX_POINTS)
    >>> for first in range(0, 9, 3):
    ...     points.add(points.of(np.arange(first, first + 3.0)[:, None] * [1, 1, 1]), 3)
    >>> points.stacked()[:, 0].tolist()
    [0.0, 2.0, 4.0, 6.0, 8.0]
    """

    def __init__(self, count: int) -> None:
        self.step = max(1, -(-count // MAX_POINTS))
        self.seen = 0
        self._parts: list[FloatArray] = []

    def of(self, piece: Any) -> Any:  # noqa: ANN401
        """Return what of the next piece is kept: of an array's rows, or of a list."""
        return piece[-self.seen % self.step :: self.step]

    def add(self, points: npt.NDArray[Any], rows: int) -> None:
        """Add what was kept of the next piece, which had so many rows."""
        self._parts.append(points.astype(np.float64))
        self.seen += rows

    def stacked(self) -> FloatArray:
        """All that was kept, (P, 3)."""
        return np.concatenate(self._parts) if self._parts else np.empty((0, 3))


@contextlib.contextmanager
def cloud_file(path: StrPath, expected: str, fix: str = "") -> Iterator[None]:
    """Say in one line what is wrong with the file of a point cloud that a library reads.

    Parameters
    ----------
    path : path
        The file; a folder is refused.
    expected : str
        What it should be.
    fix : str, optional
        What to do when it is not.

    Raises
    ------
    InputError
        In place of whatever the library raises; some raise things of their own.

    Examples
    --------
    >>> with cloud_file("a.las", "a LAS file"):
    ...     raise ValueError("unknown version")
    Traceback (most recent call last):
    palms.errors.FormatError: a.las: expected a LAS file, got 'unknown version'
    """
    if os.path.isdir(path):
        raise InputError(str(path), expected=expected, got="a folder", fix="name the file in it")
    try:
        yield
    except (InputError, ImportError, KeyboardInterrupt, SystemExit):
        raise
    except MemoryError:
        raise InputError(
            str(path), expected="points that fit into memory", got="more",
            fix="thin the cloud first",
        ) from None  # fmt: skip
    except BaseException as error:  # compiled decompressors panic on damaged files
        reason = getattr(error, "strerror", None) or brief(str(error), 80)
        raise FormatError(str(path), expected=expected, got=reason, fix=fix) from None


def parse_position(value: object) -> FloatArray | None:
    """Return an observation point, from two numbers or a text ``x,y``; None for None.

    Examples
    --------
    >>> parse_position("1.5, -2").tolist()
    [1.5, -2.0]
    """
    if value is None:
        return None
    parts: Sequence[Any] = value.split(",") if isinstance(value, str) else value  # type: ignore[assignment]
    try:
        point = np.array([float(part) for part in parts])
    except (TypeError, ValueError):
        point = np.empty(0)
    if point.shape != (2,) or not np.isfinite(point).all():
        raise InputError("option position", expected="x,y in metres on the ground", got=repr(value))
    return point


def parse_metres(value: object, what: str) -> float | None:
    """Return a number of metres, from a number or a text; None for None.

    Examples
    --------
    >>> parse_metres("-1.4", "floor")
    -1.4
    """
    if value is None:
        return None
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        number = np.nan
    if not np.isfinite(number):
        raise InputError(f"option {what}", expected="a number of metres", got=repr(value))
    return number


class CloudOptions(NamedTuple):
    """What a user may say of a point cloud.

    Attributes
    ----------
    up : str
        x, y, z, -x, -y, -z, or auto: found by floor and ceiling.
    position : (x, y), str or None
        The observation point on the ground: (x, -z) of a cloud with y up, (x, y) of one
        with z up.
    floor : float, str or None
        Height of the floor, along the axis that is up; found when left out.
    settings : ExtractionSettings or None
        What counts as a wall.
    """

    up: str = "auto"
    position: object = None
    floor: object = None
    settings: ExtractionSettings | None = None


def cloud_scan(points_m: npt.NDArray[Any], path: StrPath, options: CloudOptions) -> Scan:
    """Make a scan of a point cloud.

    Parameters
    ----------
    points_m : ndarray (P, 3)
        As the file has them; rows with NaN are left out.
    path : path
        The file, for messages.
    options : CloudOptions

    Raises
    ------
    InputError
        When it is not clear which way is up, or there is no wall.
    """
    up = options.up
    if up != "auto" and up not in UP_AXES:
        raise InputError("option up", expected=f"auto, {', '.join(UP_AXES)}", got=repr(up))
    here, level = parse_position(options.position), parse_metres(options.floor, "floor")
    points = np.asarray(points_m, dtype=np.float64)
    with np.errstate(all="ignore"):
        points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        raise FormatError(str(path), expected="points", got="none", fix="export the cloud again")
    with locating(path):
        turned = points @ np.array(UP_AXES[find_up(points) if up == "auto" else up], float).T
        scan = scan_from_points(turned, here, options.settings, floor_m=level)
        return Scan(scan.walls_m, scan.position_m, session=session_of(path))


def find_up(points: FloatArray) -> str:
    """Axis along which most points lie on two levels: floor and ceiling."""
    shares = []
    for k in range(3):
        low, high = np.quantile(points[:, k], [0.001, 0.999])
        if high - low > 1000:
            raise InputError(
                "points", expected="a room, at most 1000 m across", got=f"{high - low:.4g} m",
                fix="check that their unit is the metre",
            )  # fmt: skip
        inside = points[(points[:, k] >= low) & (points[:, k] <= high), k]
        counts = np.sort(np.bincount(((inside - low) / _LEVEL_M).astype(np.int64)))
        shares.append(counts[-2:].sum() / len(points))
    best, second = np.argsort(shares)[::-1][:2]
    if shares[best] < _CLEARER * shares[second]:
        raise InputError(
            "points", expected="a floor or ceiling that shows which way is up",
            got=f"as much along {'xyz'[best]} as along {'xyz'[second]}",
            fix="say so: up=y (AR sessions) or up=z (surveyors)",
        )  # fmt: skip
    return "xyz"[best]
