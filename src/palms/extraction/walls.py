"""Vertical walls among points."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.extraction.columns import find_columns, floor_height_m
from palms.extraction.corners import join_corners
from palms.extraction.lines import Wall, find_lines
from palms.extraction.settings import ExtractionSettings
from palms.geometry import check_finite

__all__ = ["Wall", "walls_from_points"]

MAX_EXTENT_M = 1000.0  # ours: beyond it, the unit is hardly the metre


def walls_from_points(
    points_m: npt.ArrayLike,
    settings: ExtractionSettings | None = None,
    *,
    floor_m: float | None = None,
) -> list[Wall]:
    """Find the vertical walls among points.

    Points between knee and head are gathered in columns; columns that reach over a wall's
    height stand in rows; lines are grown along the rows, fitted by robust least squares,
    cut where nothing is seen, and joined at corners. Nothing is random.

    Parameters
    ----------
    points_m : array_like (P, 3)
        x and y on the ground, and height.
    settings : ExtractionSettings, optional
    floor_m : float, optional
        Height of the floor; found among the points when left out.

    Returns
    -------
    list of Wall
        Longest first; empty when there is none.

    Raises
    ------
    InputError
        When the points are no array of finite numbers of that shape, or lie over more
        than a kilometre.

    Examples
    --------
    >>> x, z = (v.ravel() for v in np.meshgrid(np.arange(0, 3, 0.02), np.arange(0, 2.4, 0.02)))
    >>> (wall,) = walls_from_points(np.column_stack([x, 0 * x + 1.5, z]))
    >>> np.abs(wall.ends_m.round(2)).tolist()
    [[0.0, 1.5], [2.98, 1.5]]
    """
    settings = settings or ExtractionSettings()
    points = check_finite(points_m, "points", (None, 3))
    if not len(points):
        return []
    extent = np.ptp(points, axis=0).max()
    if extent > MAX_EXTENT_M:
        raise InputError(
            "points", expected=f"at most {MAX_EXTENT_M:g} m across", got=f"{extent:.4g} m",
            fix="check that their unit is the metre, and remove strays",
        )  # fmt: skip
    floor = floor_height_m(points[:, 2]) if floor_m is None else floor_m
    columns = find_columns(points - [0.0, 0.0, floor], settings)
    found = join_corners(find_lines(columns, settings), settings.corner_m)
    return sorted(found, key=lambda wall: -float(np.hypot(*(wall.ends_m[1] - wall.ends_m[0]))))
