"""Scans from points and from depth images."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from palms.errors import InputError, PalmsWarning
from palms.extraction.columns import floor_height_m
from palms.extraction.depth import DepthFrame, points_of, step_of
from palms.extraction.empty import free_ranges
from palms.extraction.settings import ExtractionSettings
from palms.extraction.walls import walls_from_points
from palms.geometry import FloatArray, bounds, check_finite
from palms.scan import Scan

__all__ = ["observation_point", "scan_from_depth", "scan_from_points"]

_ORIGIN_M = 1.0  # ours: a user who turns at the origin stays within


def scan_from_points(
    points_m: npt.ArrayLike,
    position_m: npt.ArrayLike | None = None,
    settings: ExtractionSettings | None = None,
    *,
    floor_m: float | None = None,
) -> Scan:
    """Make a scan of the walls among points.

    Parameters
    ----------
    points_m : array_like (P, 3)
        x and y on the ground, and height.
    position_m : array_like (2,), optional
        The observation point; see `observation_point` for what stands in.
    settings : ExtractionSettings, optional
    floor_m : float, optional
        Height of the floor; found when left out.

    Raises
    ------
    InputError
        When there is no wall among them.

    Examples
    --------
    >>> x, z = (v.ravel() for v in np.meshgrid(np.arange(-2, 2, 0.02), np.arange(0, 2, 0.02)))
    >>> scan_from_points(np.column_stack([x, 0 * x + 1.5, z]), (0, 0)).walls_m.shape
    (1, 2, 2)
    """
    found = walls_from_points(points_m, settings, floor_m=floor_m)
    if not found:
        raise InputError(
            "points", expected="a wall among them", got=f"{len(np.asarray(points_m))} points, none",
            fix="say which axis is up and where the floor is, or scan nearer to walls",
        )  # fmt: skip
    walls = np.array([wall.ends_m for wall in found])
    return Scan(walls, observation_point(walls, position_m))


def observation_point(walls_m: FloatArray, position_m: npt.ArrayLike | None = None) -> FloatArray:
    """Return where a scan without a recorded place was taken from.

    Parameters
    ----------
    walls_m : ndarray (N, 2, 2)
        On the ground.
    position_m : array_like (2,), optional
        What is known.

    Returns
    -------
    ndarray (2,)
        What is known; else the origin of the session, when it lies among the walls; else
        their middle, with a warning.

    Examples
    --------
    >>> walls = np.array([[[-1.0, 2.0], [3.0, 2.0]], [[-1.0, -1.0], [3.0, -1.0]]])
    >>> observation_point(walls).tolist()
    [0.0, 0.0]
    """
    if position_m is not None:
        return check_finite(position_m, "the observation point", (2,))
    low, high = bounds(walls_m)
    if (low <= 0.5).all() and (high >= -0.5).all():
        return np.zeros(2)
    middle: FloatArray = (low + high) / 2
    warnings.warn(
        "the origin lies outside of the walls; their middle, "
        f"({middle[0]:.2f}, {middle[1]:.2f}), stands for the observation point; name a better one",
        PalmsWarning,
        stacklevel=3,
    )
    return middle


def scan_from_depth(
    frames: Sequence[DepthFrame],
    position_m: npt.ArrayLike | None = None,
    settings: ExtractionSettings | None = None,
    *,
    floor_m: float | None = None,
    step: int | None = None,
) -> Scan:
    """Make a scan of depth images: the walls that they show, the space that they prove empty.

    Parameters
    ----------
    frames : sequence of DepthFrame
    position_m : array_like (2,), optional
        The observation point; when left out the origin, or the camera's place nearest to
        the middle of all when that is further off than a user who turns.
    settings : ExtractionSettings, optional
    floor_m : float, optional
        Height of the floor; found when left out.
    step : int, optional
        Only every so manieth row and column of the images; as many as are enough when left
        out.

    Raises
    ------
    InputError
        When they show no wall.
    """
    settings = settings or ExtractionSettings()
    if not len(frames):
        raise InputError("depth images", expected="at least one", got="none")
    step = step or step_of(frames)
    eyes = np.array([frame.camera_m for frame in frames])
    points = points_of(frames, settings, step)
    if not len(points):
        raise InputError(
            "depth images", expected=f"depth up to {settings.range_m:g} m", got="no such pixel",
            fix="check the unit of depth: metres",
        )  # fmt: skip
    if floor_m is None:
        floor_m = floor_height_m(points[:, 2], float(np.median(eyes[:, 2])))
    if position_m is None:
        position_m = _stand(eyes[:, :2])
    scan = scan_from_points(points, position_m, settings, floor_m=floor_m)
    free = free_ranges(frames, scan.position_m, settings, step)
    return Scan(scan.walls_m, scan.position_m, free)


def _stand(eyes: FloatArray) -> FloatArray:
    """Return the origin, or the camera's place nearest to the middle when that is far off."""
    middle = eyes.mean(axis=0)
    if np.hypot(*middle) <= _ORIGIN_M:
        return np.zeros(2)
    return np.asarray(eyes[np.linalg.norm(eyes - middle, axis=1).argmin()])
