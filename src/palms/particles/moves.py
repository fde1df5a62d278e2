"""Particles move, and meet walls (paper III-C)."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms._compiled import filter as loops
from palms._compiled import weights as by_weight
from palms.geometry import FloatArray
from palms.motion import MoveNoise, move_noise
from palms.odometry import Move
from palms.particles.draws import effective_sample_size, resample_systematic, reweight
from palms.particles.particles import Particles
from palms.particles.starts import normals
from palms.randomness import RandomKey
from palms.raster import PlanRaster
from palms.settings import MotionSettings, ResamplingSettings

__all__ = ["MoveInfo", "advance"]

_MOVE, _COPY, _RESAMPLE, _SCALE = 2, 3, 4, 7  # purposes of random numbers


class MoveInfo(NamedTuple):
    """What happened in a move, for those who watch.

    Attributes
    ----------
    n_hit : int
        Particles that hit a wall or left the plan.
    n_survived : int
        The others. When it is 0 the move contradicts the plan for every particle; then all
        of them make the move all the same, since the odometry is sure and the plan is not.
    effective_sample_size : float
        Of the weights after the move.
    evidence : float
        Logarithm of the share of its weight that the belief kept; 0 where hits are replaced.
    """

    n_hit: int
    n_survived: int
    effective_sample_size: float
    evidence: float = 0.0


def advance(
    particles: Particles,
    move: Move,
    raster: PlanRaster,
    settings: MotionSettings,
    key: RandomKey,
    resampling: ResamplingSettings | None = None,
) -> tuple[Particles, MoveInfo]:
    """Move all particles by one move of the odometry and let the walls judge (paper III-C).

    Parameters
    ----------
    particles : Particles
    move : Move
    raster : PlanRaster
    settings : MotionSettings
    key : RandomKey
        Of this step.
    resampling : ResamplingSettings, optional
        The paper's when left out.

    Returns
    -------
    particles : Particles
    info : MoveInfo
    """
    scheme = "survivors" if resampling is None else resampling.scheme
    if settings.leg_scale_sd > 0:
        particles = _on_its_leg(particles, move.length_m, settings, key)
    noise = move_noise(move.length_m, settings, move.duration_s or 0.0)
    position, drift, hit, n_hit = _moved(particles, move, raster, noise, key)
    n, scale, label = len(hit), particles.scale, particles.label
    if scheme == "survivors" and 0 < n_hit < n:
        scale, label = scale.copy(), label.copy()
        spread = np.array([settings.jitter_m, noise.drift_rad])
        copying = key.child(_COPY).word
        loops.replace_hits(position, drift, scale, label, hit, spread, copying, raster.walls)
    moved = replace(particles, position_m=position, drift_rad=drift, scale=scale, label=label)
    if scheme == "survivors":
        return moved, MoveInfo(n_hit, n - n_hit, effective_sample_size(moved.weight))
    moved, kept = reweight(moved, np.where(hit, settings.hit_weight, 1.0))
    if scheme == "every-step":
        moved = _resample_all(moved, settings, key)
    return moved, MoveInfo(n_hit, n - n_hit, effective_sample_size(moved.weight), kept)


def _moved(
    particles: Particles, move: Move, raster: PlanRaster, noise: MoveNoise, key: RandomKey
) -> tuple[FloatArray, FloatArray, npt.NDArray[np.bool_], int]:
    """Return positions and drifts after a move, which hit a wall or left the plan, how many."""
    n = len(particles)
    position, drift, hit = np.empty((n, 2)), np.empty(n), np.empty(n, np.bool_)
    n_hit = loops.move(
        particles.position_m, particles.turned_rad(move.duration_s or 0.0), particles.scale_now,
        (move.dx_m, move.dy_m), tuple(noise), key.child(_MOVE).word, raster.walls,
        position, drift, hit,
    )  # fmt: skip
    return position, drift, hit, n_hit


def _on_its_leg(
    particles: Particles, length_m: float, settings: MotionSettings, key: RandomKey
) -> Particles:
    """Let the scale of the leg wander: back to the walk's, and anew (Uhlenbeck, Ornstein 1930)."""
    kept = math.exp(-length_m / settings.leg_m)
    anew = settings.leg_scale_sd * math.sqrt(1 - kept * kept)
    z = normals(len(particles), key.child(_SCALE))
    before = 0.0 if particles.leg_scale is None else kept * particles.leg_scale
    return replace(particles, leg_scale=before + anew * z)


def _resample_all(particles: Particles, settings: MotionSettings, key: RandomKey) -> Particles:
    """Resample at every step and keep the weights as they are (authors' code)."""
    n = len(particles)
    index = resample_systematic(particles.weight, n, key.child(_RESAMPLE))
    offset = np.empty((n, 2))
    loops.normals(key.child(_COPY).word, 2, offset)
    weight = particles.weight[index]
    drawn = particles.take(index, weight / by_weight.moments(weight)[0])
    return replace(drawn, position_m=drawn.position_m + settings.jitter_m * offset)
