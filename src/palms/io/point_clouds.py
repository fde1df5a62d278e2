"""What point clouds of any format have in common: which way is up, where the user stood."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from palms.errors import FormatError, InputError
from palms.extraction.scans import scan_from_points
from palms.extraction.settings import ExtractionSettings
from palms.geometry import FloatArray
from palms.io.planes import session_of
from palms.io.values import StrPath, locating
from palms.scan import Scan

__all__ = [
    "MAX_POINTS",
    "UP_AXES",
    "CloudOptions",
    "cloud_scan",
    "find_up",
    "parse_metres",
    "parse_position",
    "thinning",
]

MAX_POINTS = 3_000_000  # ours: of larger clouds every so manieth point is taken
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


def thinning(count: int) -> int:
    """Return n such that every n-th of so many points are few enough.

    Examples
    --------
    >>> thinning(100), thinning(7_000_000)
    (1, 3)
    """
    return max(1, -(-count // MAX_POINTS))


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
        x, y, z, -x, -y, -z, or auto.
    position : (x, y), str or None
        The observation point on the ground.
    floor : float, str or None
        Height of the floor, along the axis that is up.
    settings : ExtractionSettings or None
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
