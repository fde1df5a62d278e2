"""Angles, points and segments, and the checks at the door.

Metres and radians; x right, y up, angles counter-clockwise from +x. Segments are
arrays of shape (N, 2, 2): segment, end, coordinate.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.errors import InputError

__all__ = [
    "FloatArray",
    "as_readonly",
    "bounds",
    "check_finite",
    "check_points",
    "check_segments",
    "circular_mean",
    "directions",
    "distance_to_segments",
    "lengths",
    "rotate",
    "rotate_each",
    "wrap_angle",
]

FloatArray = npt.NDArray[np.float64]


def as_readonly(values: npt.ArrayLike, dtype: npt.DTypeLike = np.float64) -> npt.NDArray[Any]:
    """Return a C-contiguous copy of `values` that nobody can write to.

    Examples
    --------
    >>> as_readonly([1, 2]).flags.writeable
    False
    """
    array = np.array(values, dtype=dtype, order="C")
    array.setflags(write=False)
    return array


def check_finite(values: npt.ArrayLike, what: str, shape: tuple[int | None, ...]) -> FloatArray:
    """Return `values` as a read-only float array of `shape`, or say what is wrong.

    Parameters
    ----------
    values : array_like
        What came in.
    what : str
        Its name for the message.
    shape : tuple of int or None
        The shape asked for; None stands for any length.

    Raises
    ------
    InputError
        When it is no array of numbers, has another shape, or holds NaN or infinity.

    Examples
    --------
    >>> check_finite([[0, 1]], "points", (None, 2)).shape
    (1, 2)
    """
    wanted = "(" + ", ".join("N" if n is None else str(n) for n in shape) + ")"
    try:
        array: FloatArray = as_readonly(values)
    except (TypeError, ValueError, OverflowError):
        raise InputError(
            what,
            expected=f"numbers of shape {wanted}",
            got="something else",
            fix="check that every row has as many numbers as the first",
        ) from None
    if array.size == 0 and shape[0] is None:
        array = as_readonly(np.empty([0 if n is None else n for n in shape]))
    if array.ndim != len(shape) or any(
        n is not None and n != m for n, m in zip(shape, array.shape, strict=True)
    ):
        raise InputError(
            what,
            expected=f"shape {wanted}",
            got=f"shape {array.shape}",
            fix="check the number of columns",
        )
    if not np.isfinite(array).all():
        row = int(np.argwhere(~np.isfinite(np.atleast_1d(array)))[0][0])
        raise InputError(
            what,
            expected="finite numbers",
            got=f"NaN or infinity in row {row}",
            fix="remove or mend that row",
        )
    return array


def check_points(points: npt.ArrayLike, what: str = "points") -> FloatArray:
    """Return points as a read-only (N, 2) float array, or raise InputError.

    Examples
    --------
    >>> check_points([[0, 0], [1, 2]]).tolist()
    [[0.0, 0.0], [1.0, 2.0]]
    """
    return check_finite(points, what, (None, 2))


def check_segments(segments: npt.ArrayLike, what: str = "segments") -> FloatArray:
    """Return segments as a read-only (N, 2, 2) float array, or raise InputError.

    Examples
    --------
    >>> check_segments([[[0, 0], [1, 0]]]).shape
    (1, 2, 2)
    """
    return check_finite(segments, what, (None, 2, 2))


def rotate(points: npt.ArrayLike, angle_rad: float) -> FloatArray:
    """Turn points of shape (..., 2) counter-clockwise about the origin.

    Examples
    --------
    >>> rotate([1.0, 0.0], np.pi / 2).round(6).tolist()
    [0.0, 1.0]
    """
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    xy = np.asarray(points, dtype=np.float64)
    x, y = xy[..., 0], xy[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def rotate_each(vector: npt.ArrayLike, angle_rad: FloatArray) -> FloatArray:
    """Turn one vector (2,) counter-clockwise by each of N angles.

    Examples
    --------
    >>> rotate_each([1.0, 0.0], np.array([0.0, np.pi / 2])).round(3).tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    x, y = np.asarray(vector, dtype=np.float64)
    return np.stack([c * x - s * y, s * x + c * y], axis=1)


def wrap_angle(angle_rad: npt.ArrayLike) -> Any:  # noqa: ANN401
    """Return angles in (-pi, pi]; a float for a float, an array for an array.

    Examples
    --------
    >>> float(wrap_angle(3 * np.pi))
    3.141592653589793
    """
    if isinstance(angle_rad, float):
        return math.pi - (math.pi - angle_rad) % (2 * math.pi)
    return np.pi - np.mod(np.pi - np.asarray(angle_rad, dtype=np.float64), 2 * np.pi)


def lengths(segments: FloatArray) -> FloatArray:
    """Lengths (N,) in metres of segments (N, 2, 2).

    Examples
    --------
    >>> lengths(np.array([[[0.0, 0.0], [3.0, 4.0]]])).tolist()
    [5.0]
    """
    d = segments[:, 1] - segments[:, 0]
    return np.asarray(np.hypot(d[:, 0], d[:, 1]))


def directions(segments: FloatArray) -> FloatArray:
    """Directions (N,) in radians, of each segment from its first to its second end.

    Examples
    --------
    >>> directions(np.array([[[0.0, 0.0], [0.0, 2.0]]])).round(4).tolist()
    [1.5708]
    """
    d = segments[:, 1] - segments[:, 0]
    return np.asarray(np.arctan2(d[:, 1], d[:, 0]))


def bounds(segments: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lower and upper corner (2,), (2,) of segments (N, 2, 2); N at least 1.

    Examples
    --------
    >>> [corner.tolist() for corner in bounds(np.array([[[0.0, 5.0], [3.0, 4.0]]]))]
    [[0.0, 4.0], [3.0, 5.0]]
    """
    points = segments.reshape(-1, 2)
    return points.min(axis=0), points.max(axis=0)


def distance_to_segments(point_m: npt.ArrayLike, segments: FloatArray) -> FloatArray:
    """Distance (N,) from one point to each of N segments, in metres.

    Examples
    --------
    >>> distance_to_segments([1.0, 2.0], np.array([[[0.0, 0.0], [4.0, 0.0]]])).tolist()
    [2.0]
    """
    a, d = segments[:, 0], segments[:, 1] - segments[:, 0]
    rel = np.asarray(point_m, dtype=np.float64) - a
    squared = np.maximum((d**2).sum(axis=1), 1e-18)
    t = np.clip((rel * d).sum(axis=1) / squared, 0.0, 1.0)
    return np.asarray(np.linalg.norm(rel - t[:, None] * d, axis=1))


def circular_mean(angles_rad: FloatArray, weights: FloatArray) -> float:
    """Weighted mean direction in (-pi, pi].

    Examples
    --------
    >>> round(circular_mean(np.array([3.1, -3.1]), np.ones(2)), 4)
    3.1416
    """
    sine, cosine = (weights * of(angles_rad) for of in (np.sin, np.cos))
    mean = np.arctan2(sine.sum(), cosine.sum())
    return float(wrap_angle(mean))
