"""Scan: the walls seen from one point, as segments on the ground plane."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

from palms.errors import InputError, PalmsWarning
from palms.geometry import (
    FloatArray,
    as_readonly,
    check_finite,
    check_segments,
    distance_to_segments,
    lengths,
)
from palms.settings import LIMITS

__all__ = ["Scan"]


@dataclass(frozen=True, slots=True)
class Scan:
    """Vertical planes of one LiDAR scan, projected on the ground (paper III-A).

    Parameters
    ----------
    walls_m : array_like (N, 2, 2)
        End points of the walls, in the odom frame; N at least 1.
    position_m : array_like (2,)
        The observation point, in the odom frame.
    coverage_m : array_like (B,), optional
        Range in metres that is known to be free, by bearing: entry b covers the bearings
        from ``2 pi b / B`` to ``2 pi (b + 1) / B`` of the odom frame, seen from
        `position_m`; NaN where nobody looked. None when the scan does not say.
    time_s : float
        When it was taken, on the walk's clock.
    session : str, optional
        Name of the phone session that it shares its frame with.

    Raises
    ------
    InputError
        When there is no wall, a number is not finite, or every wall lies beyond the
        scanner's range, or one is longer than any (its unit is then hardly the metre).

    Examples
    --------
    >>> Scan([[[2, -2], [2, 2]]]).walls_m.shape
    (1, 2, 2)
    """

    walls_m: FloatArray
    position_m: FloatArray = (0.0, 0.0)  # type: ignore[assignment]
    coverage_m: FloatArray | None = None
    time_s: float = 0.0
    session: str | None = None

    def __post_init__(self) -> None:
        walls = check_segments(self.walls_m, "scan")
        position = check_finite(self.position_m, "the scan's position", (2,))
        object.__setattr__(self, "position_m", position)
        object.__setattr__(self, "walls_m", _within_range(walls, position))
        if self.coverage_m is not None:
            coverage = as_readonly(self.coverage_m)
            if coverage.ndim != 1 or np.isinf(coverage).any() or (coverage < 0).any():
                raise InputError(
                    "the scan's coverage",
                    expected="ranges >= 0 in metres or NaN",
                    got="something else",
                )
            object.__setattr__(self, "coverage_m", coverage)
        if not np.isfinite(self.time_s):
            raise InputError("the scan's time", expected="seconds", got=str(self.time_s))

    @property
    def relative_m(self) -> FloatArray:
        """Walls (N, 2, 2) seen from the observation point, axes of the odom frame."""
        return self.walls_m - self.position_m


def _within_range(walls: FloatArray, position: FloatArray) -> FloatArray:
    long_enough = lengths(walls) >= LIMITS.min_wall_m
    if not long_enough.any():
        raise InputError(
            "scan",
            expected="at least one vertical wall",
            got="none",
            fix="scan again, turning all the way round near walls",
        )
    walls = walls[long_enough]
    distance = distance_to_segments(position, walls)
    near = distance <= LIMITS.max_scan_range_m
    if not near.any():
        raise InputError(
            "scan",
            expected=f"walls within {LIMITS.max_scan_range_m:g} m of the observation point",
            got=f"the nearest at {distance.min():.4g} m",
            fix="check that its unit is the metre and its position is right",
        )
    if not near.all():
        warnings.warn(
            f"scan: {np.sum(~near)} of {len(walls)} walls lie beyond "
            f"{LIMITS.max_scan_range_m:g} m and are left out",
            PalmsWarning,
            stacklevel=4,
        )
    longest = float(lengths(walls[near]).max())
    if longest > LIMITS.max_wall_m:
        raise InputError(
            "scan",
            expected=f"walls of at most {LIMITS.max_wall_m:g} m",
            got=f"one of {longest:.4g} m",
            fix="check that its unit is the metre",
        )
    return as_readonly(walls[near])
