"""Estimate: the answer that a belief gives, and how sure it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from palms.belief.belief import N_SPOTS, Belief, Spots, Stage
from palms.geometry import FloatArray, wrap_angle
from palms.settings import AnswerSettings

__all__ = ["Estimate", "Hypothesis", "gathered_m", "hypotheses", "summarize", "whole_m"]

LOCAL_M = 2.0  # ours: what lies nearer to the answer is the same place, as in p_within_2m


class Hypothesis(NamedTuple):
    """A place where the phone may be.

    Attributes
    ----------
    x_m, y_m : float
        In the map frame.
    share : float
        Probability that the phone is within 2 m of it.
    drift_rad : float
        Mean drift there, in (-pi, pi].
    level : str or None
        In a building of several levels.
    """

    x_m: float
    y_m: float
    share: float
    drift_rad: float
    level: str | None = None


@dataclass(frozen=True, slots=True)
class Estimate:
    """Where the phone is, and how sure that is.

    Attributes
    ----------
    time_s : float
        On the walk's clock.
    stage : Stage
    position_m : (2,) or None
        The best single answer in the map frame, whatever the stage; None where there is no
        belief at all.
    heading_rad : float or None
        Direction of travel in the map, of the last move longer than 5 cm.
    drift_rad : float or None
        Of the belief behind the position.
    p_within_1m, p_within_2m : float
        Probability that the phone is that near to it.
    radius_68_m, radius_95_m : float or None
        Discs around it that hold 68 % and 95 % of the belief.
    hypotheses : tuple of Hypothesis
        The places that hold most of the belief, most probable first.
    level : str or None
        In a building of several levels; the radii then hold what lies on other levels, too,
        and are very large while the level is open.
    p_level : float
        Probability that the phone is on it; 1 where there is only one.

    Examples
    --------
    >>> Estimate(0.0).is_localized
    False
    """

    time_s: float
    stage: Stage = Stage.SEARCHING
    position_m: FloatArray | None = None
    heading_rad: float | None = None
    drift_rad: float | None = None
    p_within_1m: float = 0.0
    p_within_2m: float = 0.0
    radius_68_m: float | None = None
    radius_95_m: float | None = None
    hypotheses: tuple[Hypothesis, ...] = ()
    level: str | None = None
    p_level: float = 1.0

    @property
    def is_localized(self) -> bool:
        """Whether the filter says that it knows."""
        return self.stage == Stage.LOCALIZED


def summarize(
    belief: Belief,
    time_s: float,
    heading_odom_rad: float | None,
    settings: AnswerSettings | None = None,
) -> Estimate:
    """Turn a belief into an answer that says how sure it is.

    Parameters
    ----------
    belief : Belief
    time_s : float
    heading_odom_rad : float or None
        Direction of the last move long enough to have one, in the odom frame.
    settings : AnswerSettings, optional
    """
    settings = settings or AnswerSettings()
    drift, sure = belief.drift_rad, 1 - belief.doubt
    heading = None if heading_odom_rad is None else float(wrap_angle(heading_odom_rad + drift))
    local, core = settings.local_spread, min(settings.core_spread, settings.local_spread)
    (near, nearly), (radius_68, radius_95) = belief.nearness(1.0 / local, 2.0)
    return Estimate(
        time_s, belief.stage, belief.answer_m, heading, drift,
        sure * near, sure * nearly,
        gathered_m(radius_68, core), gathered_m(radius_95, local),
        hypotheses(belief, settings.hypotheses, settings.hypothesis_radius_m),
    )  # fmt: skip


def gathered_m(radius_m: float, local_spread: float) -> float:
    """Return a radius of the belief as it is stated: what is local counts in part.

    Within 2 m it counts by `local_spread`, from 4 m on, where other places lie, in full.

    Examples
    --------
    >>> [round(gathered_m(radius_m, 0.6), 2) for radius_m in (1.0, 2.0, 3.0, 4.0, 25.0)]
    [0.6, 1.2, 2.6, 4.0, 25.0]
    """
    if radius_m <= LOCAL_M:
        return local_spread * radius_m
    beyond = min(radius_m / LOCAL_M - 1, 1.0)
    return radius_m - (1 - beyond) * (1 - local_spread) * LOCAL_M


def whole_m(stated_m: float, local_spread: float) -> float:
    """Return the radius of the belief behind a stated one: the other way than `gathered_m`.

    A voice, which must not be wrong once in twenty times, goes by this.

    Examples
    --------
    >>> [round(whole_m(stated_m, 0.6), 2) for stated_m in (0.6, 1.2, 2.6, 4.0, 25.0)]
    [1.0, 2.0, 3.0, 4.0, 25.0]
    """
    if stated_m <= local_spread * LOCAL_M:
        return stated_m / local_spread
    if stated_m >= 2 * LOCAL_M:
        return stated_m
    return (stated_m + 2 * (1 - local_spread) * LOCAL_M) / (2 - local_spread)


def hypotheses(belief: Belief, n: int = N_SPOTS, radius_m: float = 2.0) -> tuple[Hypothesis, ...]:
    """Return up to n places that hold most of the belief, most probable first."""
    if n == 0:
        return ()
    spots = belief.spots
    if spots is None or spots.radius_m != radius_m or len(spots.shares) < n:
        spots = Spots.of(belief.particles, radius_m, n)
        belief = Belief(belief.particles, spots=spots)
    found = [
        Hypothesis(float(x), float(y), share, drift)
        for share, ((x, y), drift) in zip(
            spots.shares[:n].tolist(), belief.spot_poses[:n], strict=True
        )
        if share > 0
    ]
    return tuple(sorted(found, key=lambda h: -h.share))
