"""Our declaration: localized while it is probable, lost when the belief cannot hold the truth.

The probability is that of the particles around the answer, less the doubt whether the
particles hold the truth at all. Doubt falls while walls agree with the belief, and rises while
they do not (docs/explanation/declaration.md).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from palms._compiled import clusters
from palms.belief import Belief, Spots, Stage
from palms.particles import MoveInfo, Particles
from palms.settings import DeclarationSettings

__all__ = ["doubted", "evidence_of", "judge", "share_oriented"]

NEAR_M = 2.0  # ours: what p_within_2m asks
DRIFT_BINS = 72  # ours: 5 degrees each
MOST_DOUBT = 1 - 1e-6  # ours: nothing is impossible, and probabilities divide by the rest


def judge(
    belief: Belief, particles: Particles, settings: DeclarationSettings, nats: float = 0.0
) -> Belief:
    """Judge the particles after a move or a scan: how far has it come, and is it lost.

    Parameters
    ----------
    belief : Belief
        Before it.
    particles : Particles
        After it.
    settings : DeclarationSettings
    nats : float
        What it says for the belief as a whole; see `evidence_of`.
    """
    doubt = doubted(belief.doubt, nats, settings)
    judged = Belief(particles, belief.stage, doubt=doubt, spots=Spots.of(particles, NEAR_M))
    stage = _stage(judged, settings)
    return judged if stage is judged.stage else replace(judged, stage=stage)


def evidence_of(walked_m: float, info: MoveInfo, settings: DeclarationSettings) -> float:
    """Return what the walls say for a belief after a move, in nats.

    Against a belief in a wrong place, which loses about as much to walls with each metre
    wherever it is.

    Examples
    --------
    >>> settings = DeclarationSettings("probability")
    >>> free, stopped = MoveInfo(0, 9, 9.0, 0.0), MoveInfo(9, 0, 9.0, -3.5)
    >>> evidence_of(1.0, free, settings), evidence_of(1.0, stopped, settings)
    (0.2, -3.3)
    """
    return settings.stray_nats_per_m * walked_m + info.evidence


def doubted(doubt: float, nats: float, settings: DeclarationSettings) -> float:
    """Return the doubt after evidence of so many nats for the belief.

    Examples
    --------
    >>> settings = DeclarationSettings("probability")
    >>> round(doubted(0.5, -1.0, settings), 3), round(doubted(0.01, 5.0, settings), 3)
    (0.731, 0.005)
    """
    if doubt <= 0 or nats == 0:
        return max(doubt, settings.doubt_floor)
    odds = doubt / (1 - doubt) * math.exp(min(max(-nats, -50.0), 50.0))
    return min(max(odds / (1 + odds), settings.doubt_floor), MOST_DOUBT)


def _stage(belief: Belief, settings: DeclarationSettings) -> Stage:
    if belief.doubt > settings.lost:
        return Stage.LOST
    sure = 1 - belief.doubt
    near = sure * belief.share_within(NEAR_M)
    threshold = settings.leave if belief.stage is Stage.LOCALIZED else settings.enter
    if near >= threshold:
        return Stage.LOCALIZED
    if sure * share_oriented(belief.particles, settings.oriented_rad) >= settings.oriented_share:
        return Stage.ORIENTED
    return Stage.LOST if belief.stage is Stage.LOST else Stage.SEARCHING


def share_oriented(particles: Particles, within_rad: float) -> float:
    """Return the largest share of the weight whose drifts lie this near to one drift."""
    shares = np.empty(DRIFT_BINS)
    clusters.turn_shares(particles.drift_rad, particles.weight, shares)
    width = max(1, round(2 * within_rad / (2 * math.pi) * DRIFT_BINS))
    around = np.concatenate([[0.0], np.cumsum(np.concatenate([shares, shares[: width - 1]]))])
    return float((around[width:] - around[:-width]).max())
