"""The oracle: our method told the noise of the case, with very many particles.

It tells what a filter loses: same scan likelihood, same stages and thresholds, but moved with
the true parameters of the odometry's noise (not its draws), and with so many particles that
more change nothing. Only cases whose noise was added say what it is: simulated ones, and
recorded walks with noise added to their reference.
"""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from typing import Any

from palms.evaluation.simulation.settings import InertialNoise, VioNoise
from palms.settings import MotionSettings, Settings

__all__ = ["ORACLE", "ORACLE_PARTICLES", "oracle_settings", "shared_settings"]

ORACLE = "oracle"
ORACLE_PARTICLES = 120_000  # ours: doubling them changes `useful` by less than 0.01
OF_THE_CASE = "of the case"


def oracle_settings(
    noise: VioNoise | InertialNoise, n_particles: int = ORACLE_PARTICLES
) -> Settings:
    """Return the settings of the oracle for one case.

    Parameters
    ----------
    noise : VioNoise or InertialNoise
        What the odometry's errors were drawn with. A scale that changes from leg to leg
        is told as one that wanders as far.
    n_particles : int

    Examples
    --------
    >>> oracle_settings(VioNoise(scale_sd=0.01)).motion.scale_sd
    0.01
    """
    best = Settings()
    motion, inertial = best.motion, best.inertial
    if isinstance(noise, VioNoise):
        motion = _visual(motion, noise)
    else:
        inertial = _inertial(inertial, noise)
    more = n_particles / best.start.n_particles
    start = replace(best.start, n_particles=n_particles)
    observation = replace(best.observation, n_proposals=round(more * best.observation.n_proposals))
    resampling = replace(
        best.resampling,
        min_particles=round(more * best.resampling.min_particles),
        per_bin=more * best.resampling.per_bin,
    )
    return replace(
        best, method=ORACLE, motion=motion, inertial=inertial, start=start, observation=observation,
        resampling=resampling,
    )  # fmt: skip


def _visual(motion: MotionSettings, noise: VioNoise) -> MotionSettings:
    white_m = noise.white_m_per_sqrt_m * motion.step_m**0.5
    return replace(
        motion,
        length_m=white_m,
        direction_rad=white_m / motion.step_m,  # as much across as along
        drift_rad=0.0,
        drift_rad_per_sqrt_s=noise.heading_rad_per_sqrt_s,
        jitter_m=0.0,
        scaling="distance",
        scale_sd=noise.scale_sd,
    )


def _inertial(motion: MotionSettings, noise: InertialNoise) -> MotionSettings:
    return replace(
        motion,
        length_m=0.0,
        direction_rad=noise.sideways_m_per_sqrt_m / math.sqrt(motion.step_m),
        drift_rad=0.0,
        drift_rad_per_sqrt_s=0.0,
        drift_rate_rad_per_s=noise.rate_sd_rad_per_s,
        jitter_m=0.0,
        scaling="distance",
        scale_sd=min(noise.scale_sd, 0.3),
        leg_scale_sd=min(noise.leg_scale_sd, 0.3),
        leg_m=noise.leg_m / 2,
    )


def shared_settings(n_particles: int = ORACLE_PARTICLES, source: str = "arkit") -> dict[str, Any]:
    """Return the oracle's settings as JSON; those that a case decides say so.

    Examples
    --------
    >>> found = shared_settings()
    >>> found["motion"]["scale_sd"], found["start"]["n_particles"]
    ('of the case', 120000)
    """
    noises: tuple[VioNoise | InertialNoise, ...] = (VioNoise(), VioNoise(0.01, 0.01, 0.01))
    if source == "ronin":
        noises = (InertialNoise(), InertialNoise(0.01, 0.01, 1.0, 0.01, 0.01, 1.0))
    some, others = (asdict(oracle_settings(noise, n_particles)) for noise in noises)
    return _common(some, others)


def _common(some: dict[str, Any], others: dict[str, Any]) -> dict[str, Any]:
    common: dict[str, Any] = {}
    for name, value in some.items():
        if isinstance(value, dict):
            common[name] = _common(value, others[name])
        else:
            common[name] = value if value == others[name] else OF_THE_CASE
    return common
