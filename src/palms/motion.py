"""What a move may have been: noise per metre."""

from __future__ import annotations

import math
from typing import NamedTuple

from palms.settings import MotionSettings

__all__ = ["MoveNoise", "move_noise"]


class MoveNoise(NamedTuple):
    """Standard deviations of one move.

    Attributes
    ----------
    along_m, across_m : float
        Along the move and across it.
    drift_rad : float
        Of the drift's change.
    """

    along_m: float
    across_m: float
    drift_rad: float


def move_noise(length_m: float, settings: MotionSettings, duration_s: float = 0.0) -> MoveNoise:
    """Return the noise of a move of some length and duration (paper III-C).

    With ``scaling="distance"`` variances grow with the length: two moves of half the length
    spread the particles as much as one.

    Examples
    --------
    >>> whole, half = (move_noise(m, MotionSettings()) for m in (0.65, 0.325))
    >>> round(2 * half.along_m**2 / whole.along_m**2, 6)
    1.0
    """
    steps = 1.0 if settings.scaling == "sample" else math.sqrt(length_m / settings.step_m)
    lever = length_m if settings.scaling == "sample" else settings.step_m
    return MoveNoise(
        settings.length_m * steps,
        settings.direction_rad * lever * steps,
        math.hypot(
            settings.drift_rad * steps, settings.drift_rad_per_sqrt_s * math.sqrt(duration_s)
        ),
    )
