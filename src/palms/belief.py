"""Belief: what is known, and how sure (paper III-D)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms._compiled import clusters
from palms.convergence import Cluster, dominant_cluster
from palms.geometry import FloatArray, circular_mean, wrap_angle
from palms.odometry import Move
from palms.particles import Particles, thin
from palms.randomness import RandomKey
from palms.settings import AnswerSettings, ConvergenceSettings

__all__ = ["Belief", "Estimate", "Hypothesis", "Stage", "settle", "summarize"]

_SETTLE = 6  # purpose of random numbers, after those of particles.py


class Stage(StrEnum):
    """How far the localization has come.

    Searching, then oriented (t1 of paper III-D), then localized (t2); lost when the filter
    has reason to think that its belief does not hold the truth.
    """

    SEARCHING = "searching"
    ORIENTED = "oriented"
    LOCALIZED = "localized"
    LOST = "lost"


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


@dataclass(frozen=True)
class Belief:
    """Particles and the verdict on them.

    Parameters
    ----------
    particles : Particles
    stage : Stage
    label : int or None
        The dominant label, from t1 on; None before, or where labels do not count.
    mode_m : (2,) or None
        The dominant cluster's mode, from t2 on, moved along between clusterings.
    answering : (N,) bool
        The particles whose mean is the answer.
    age : int
        Steps since the last clustering.
    doubt : float
        Probability that the particles do not hold the truth; 0 where nobody asks.
    """

    particles: Particles
    stage: Stage = Stage.SEARCHING
    label: int | None = None
    mode_m: FloatArray | None = None
    answering: npt.NDArray[np.bool_] | None = None
    age: int = 0
    doubt: float = 0.0

    @cached_property
    def answer_m(self) -> FloatArray:
        """The best single answer (2,): the mean of the answering particles."""
        if self.answering is not None and not self.answering.any() and self.mode_m is not None:
            return self.mode_m
        return self.particles.mean_m(self.answering)

    @cached_property
    def away_m(self) -> FloatArray:
        """Distance (N,) of each particle from the answer."""
        away, (x, y) = np.empty(len(self.particles)), self.answer_m
        clusters.distances(self.particles.position_m, x, y, away)
        return away

    def share_within(self, radius_m: float) -> float:
        """Share of the weight within a radius of the answer."""
        share = float(clusters.weight_within(self.away_m, self.particles.weight, radius_m))
        return min(share, 1.0)  # weights sum to 1 but for rounding

    @cached_property
    def drift_rad(self) -> float:
        """Mean drift of the answering particles, in (-pi, pi]."""
        p, answering = self.particles, self.answering
        if answering is None or not answering.any():
            return circular_mean(p.drift_rad, p.weight)
        return circular_mean(p.drift_rad[answering], p.weight[answering])

    @cached_property
    def drift_spread_rad(self) -> float:
        """Circular standard deviation of all drifts, at most pi."""
        drift, weight = self.particles.drift_rad, self.particles.weight
        east, north = float(weight @ np.cos(drift)), float(weight @ np.sin(drift))
        length = math.hypot(east, north) / float(weight.sum())
        return min(math.sqrt(max(-2 * math.log(max(length, 1e-12)), 0.0)), math.pi)


def settle(
    belief: Belief, particles: Particles, move: Move, settings: ConvergenceSettings, key: RandomKey
) -> Belief:
    """Judge the particles after a move: oriented (t1)? localized (t2)? (paper III-D).

    Parameters
    ----------
    belief : Belief
        Before the move.
    particles : Particles
        After it.
    move : Move
    settings : ConvergenceSettings
    key : RandomKey
        Of this step.
    """
    label, agreed = _dominant_label(particles, settings)
    withdrawn = settings.withdraw and belief.stage == Stage.LOCALIZED and label != belief.label
    before = replace(belief, stage=Stage.ORIENTED, age=0) if withdrawn else belief
    if before.stage == Stage.SEARCHING and not agreed:
        return replace(before, particles=particles, age=before.age + 1)
    if before.stage == Stage.SEARCHING and settings.divide_particles:
        n_labels = max(1, len(particles.label_shares()))
        particles = thin(particles, max(1, len(particles) // n_labels), key.child(_SETTLE))
    members = np.ones(len(particles), np.bool_) if label is None else particles.label == label
    if before.stage == Stage.LOCALIZED and before.age + 1 < settings.recluster_steps:
        return _follow(before, particles, members, move, settings)
    due = before.stage != Stage.ORIENTED or before.age + 1 >= settings.search_steps
    cluster = dominant_cluster(particles.position_m[members], settings.bandwidth_m) if due else None
    if before.stage != Stage.LOCALIZED and (
        cluster is None or cluster.share < settings.cluster_share
    ):
        age = 0 if due else before.age + 1
        return Belief(particles, Stage.ORIENTED, label, None, members, age)
    assert cluster is not None
    return _declare(particles, members, label, cluster)


def _dominant_label(particles: Particles, settings: ConvergenceSettings) -> tuple[int | None, bool]:
    """Return the dominant label, and whether step 1 holds."""
    if settings.step1 == "dispersion":
        return None, particles.dispersion_m() < settings.dispersion_m
    shares = particles.label_shares()
    label = int(shares.argmax())
    return label, bool(shares[label] >= settings.label_share)


def _declare(
    particles: Particles, members: npt.NDArray[np.bool_], label: int | None, cluster: Cluster
) -> Belief:
    answering = members.copy()
    answering[members] = cluster.member
    return Belief(particles, Stage.LOCALIZED, label, cluster.mode_m, answering)


def _follow(
    belief: Belief, particles: Particles, members: npt.NDArray[np.bool_], move: Move,
    settings: ConvergenceSettings,
) -> Belief:  # fmt: skip
    """Between clusterings: move the mode along, answer with the particles around it."""
    assert belief.mode_m is not None
    drift = belief.drift_rad
    c, s = math.cos(drift), math.sin(drift)
    step = np.array([c * move.dx_m - s * move.dy_m, s * move.dx_m + c * move.dy_m])
    mode = belief.mode_m + step
    bandwidth = settings.bandwidth_m or 1.0
    near = ((particles.position_m - mode) ** 2).sum(axis=1) <= bandwidth**2
    return Belief(particles, Stage.LOCALIZED, belief.label, mode, members & near, belief.age + 1)


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
    particles, drift, sure = belief.particles, belief.drift_rad, 1 - belief.doubt
    away, weight = belief.away_m, particles.weight
    heading = None if heading_odom_rad is None else float(wrap_angle(heading_odom_rad + drift))
    return Estimate(
        time_s, belief.stage, belief.answer_m, heading, drift,
        sure * belief.share_within(1.0), sure * belief.share_within(2.0),
        clusters.weighted_quantile(away, weight, min(0.68 / sure, 1.0)),
        clusters.weighted_quantile(away, weight, min(0.95 / sure, 1.0)),
        hypotheses(particles, settings.hypotheses, settings.hypothesis_radius_m),
    )  # fmt: skip


def hypotheses(particles: Particles, n: int = 5, radius_m: float = 2.0) -> tuple[Hypothesis, ...]:
    """Return up to n places that hold most of the belief, most probable first."""
    if n == 0:
        return ()
    place, shares = clusters.heaviest_places(particles.position_m, particles.weight, radius_m, n)
    found = []
    for k in np.flatnonzero(shares > 0):
        member = np.flatnonzero(place == k)
        weight = particles.weight[member]
        x, y = weight @ particles.position_m[member] / weight.sum()
        drift = circular_mean(particles.drift_rad[member], weight)
        found.append(Hypothesis(float(x), float(y), float(shares[k]), drift))
    return tuple(sorted(found, key=lambda h: -h.share))
