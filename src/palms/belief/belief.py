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
from palms.geometry import FloatArray
from palms.odometry import Move
from palms.particles import Particles, thin
from palms.randomness import RandomKey
from palms.settings import ConvergenceSettings

__all__ = ["N_SPOTS", "Belief", "Spots", "Stage", "settle"]

N_SPOTS = 5  # ours: as many as are told, unless the settings ask for more
_SETTLE = 6  # purpose of random numbers, after those of palms.particles


class Stage(StrEnum):
    """How far the localization has come.

    Searching, then oriented (t1 of paper III-D), then localized (t2); lost when the filter
    has reason to think that its belief does not hold the truth.
    """

    SEARCHING = "searching"
    ORIENTED = "oriented"
    LOCALIZED = "localized"
    LOST = "lost"


class Spots(NamedTuple):
    """The few places that hold most of the weight.

    Attributes
    ----------
    radius_m : float
        Of each.
    place : (N,) int8
        The spot that each particle belongs to, or -1.
    shares : (K,)
        Weight of each spot; 0 of those that were not found.
    """

    radius_m: float
    place: npt.NDArray[np.int8]
    shares: FloatArray

    @classmethod
    def of(cls, particles: Particles, radius_m: float, n: int = N_SPOTS) -> Spots:
        """Find up to n spots, heaviest first."""
        place, shares = np.empty(len(particles), np.int8), np.empty(n)
        clusters.heaviest_places(particles.position_m, particles.weight, radius_m, place, shares)
        return cls(radius_m, place, shares)


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
    spots : Spots or None
        Where they were looked for; the first spot's particles then answer.
    """

    particles: Particles
    stage: Stage = Stage.SEARCHING
    label: int | None = None
    mode_m: FloatArray | None = None
    answering: npt.NDArray[np.bool_] | None = None
    age: int = 0
    doubt: float = 0.0
    spots: Spots | None = None

    @property
    def answer_m(self) -> FloatArray:
        """The best single answer (2,): the mean of the answering particles."""
        if self.mode_m is not None and self.answering is not None and not self._answers:
            return self.mode_m
        return self._pose[0]

    @property
    def drift_rad(self) -> float:
        """Mean drift of the answering particles, in (-pi, pi]."""
        return self._pose[1]

    @cached_property
    def _pose(self) -> tuple[FloatArray, float]:
        """Mean pose of the answering particles; of all where none answers."""
        if self.spots is not None and self.spots.shares[0] > 0:
            return self.spot_poses[0]
        return self.particles.mean_pose(self.answering if self._answers else None)

    @cached_property
    def _answers(self) -> bool:
        """Whether there are particles that answer for all."""
        return self.answering is not None and bool(self.answering.any())

    @cached_property
    def spot_poses(self) -> list[tuple[FloatArray, float]]:
        """Mean pose of each spot; none where spots were not looked for."""
        if self.spots is None:
            return []
        return self.particles.mean_poses(self.spots.place, len(self.spots.shares))

    @property
    def away_m(self) -> FloatArray:
        """Distance (N,) of each particle from the answer."""
        away, (x, y) = np.empty(len(self.particles)), self.answer_m
        clusters.distances(self.particles.position_m, x, y, away)
        return away

    def share_within(self, radius_m: float) -> float:
        """Share of the weight within a radius of the answer."""
        return self._share(self.away_m, radius_m)

    @property
    def radii_m(self) -> tuple[float, float]:
        """Radii of the discs around the answer that hold 68 % and 95 %, doubt taken off."""
        _, radii_m = self.nearness()
        return radii_m

    def nearness(self, *within_m: float) -> tuple[list[float], tuple[float, float]]:
        """Return the shares within some radii, and `radii_m`; the distances are found once."""
        away, sure = self.away_m, 1 - self.doubt
        shares = np.array([min(0.68 / sure, 1.0), min(0.95 / sure, 1.0)])
        radii = np.empty(2)
        clusters.weighted_quantiles(away, self.particles.weight, shares, radii)
        near = [self._share(away, radius_m) for radius_m in within_m]
        radius_68, radius_95 = radii.tolist()
        return near, (radius_68, radius_95)

    def _share(self, away_m: FloatArray, radius_m: float) -> float:
        share = float(clusters.weight_within(away_m, self.particles.weight, radius_m))
        return min(share, 1.0)  # weights sum to 1 but for rounding

    @cached_property
    def drift_spread_rad(self) -> float:
        """Circular standard deviation of all drifts, at most pi."""
        length = self.particles.drift_agreement()
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
    if belief.stage == Stage.SEARCHING:
        searching = Belief(particles, age=belief.age + 1)
        if not _agrees(searching, settings):
            return searching
    label = _dominant_label(particles, settings)
    withdrawn = settings.withdraw and belief.stage == Stage.LOCALIZED and label != belief.label
    before = replace(belief, stage=Stage.ORIENTED, age=0) if withdrawn else belief
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


def _agrees(belief: Belief, settings: ConvergenceSettings) -> bool:
    """Whether step 1 holds."""
    if settings.step1 == "dispersion":
        return belief.particles.dispersion_m(belief.answer_m) < settings.dispersion_m
    return bool(belief.particles.label_shares().max() >= settings.label_share)


def _dominant_label(particles: Particles, settings: ConvergenceSettings) -> int | None:
    return None if settings.step1 == "dispersion" else int(particles.label_shares().argmax())


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
    x, y = (particles.position_m - mode).T
    near = x * x + y * y <= bandwidth**2
    return Belief(particles, Stage.LOCALIZED, belief.label, mode, members & near, belief.age + 1)
