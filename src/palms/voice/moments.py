"""Moment: what the voice needs to know of where the phone is."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from palms.advice import HELD

__all__ = ["Moment"]


@dataclass(frozen=True, slots=True)
class Moment:
    """What is known of where the phone is, at one time.

    Parameters
    ----------
    stage : str
        ``searching``, ``oriented``, ``localized`` or ``lost``.
    walked_m : float
        So far.
    position_m : (float, float) or None
        The best single answer, map frame.
    radius_95_m : float or None
        Disc around it that holds 95 % of the belief.
    facing_rad : float or None
        Where the phone looks, map frame.
    spread_rad : float or None
        Standard deviation of the drift, which the facing has too.
    level : str or None
    shares : tuple of float
        Probabilities of the most probable places, the highest first.
    p_within_2m : float
        Probability that the phone is within 2 m of the answer.

    Examples
    --------
    >>> Moment("searching", shares=(0.4, 0.3, 0.2, 0.01)).n_places
    3
    >>> Moment("searching", shares=(0.6, 0.05, 0.02)).n_places is None  # and many more
    True
    """

    stage: str
    walked_m: float = 0.0
    position_m: tuple[float, float] | None = None
    radius_95_m: float | None = None
    facing_rad: float | None = None
    spread_rad: float | None = None
    level: str | None = None
    shares: tuple[float, ...] = ()
    p_within_2m: float = 1.0

    @property
    def n_places(self) -> int | None:
        """How many places are possible; None when they are more than are known."""
        held = itertools.accumulate(self.shares)
        counts = (n for n, share in enumerate(held, start=1) if share >= HELD - 1e-9)
        return next(counts, None)

    @property
    def is_placed(self) -> bool:
        """Whether it has a place that may be named: localized, and all of it numbers."""
        numbers = (*(self.position_m or (math.nan,)), self.radius_95_m)
        return self.stage == "localized" and all(
            number is not None and math.isfinite(number) for number in numbers
        )
