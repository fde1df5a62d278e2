"""The oracle: our method told the noise of the case, with very many particles.

It tells what a filter loses: same scan likelihood, same stages and thresholds, but moved with
the true parameters of the odometry's noise (not its draws), and with so many particles that
more change nothing. Only cases whose noise was added say what it is: simulated ones, and
recorded walks with noise added to their reference.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

from palms.evaluation.simulation.settings import VioNoise
from palms.settings import Settings

__all__ = ["ORACLE", "ORACLE_PARTICLES", "oracle_settings", "shared_settings"]

ORACLE = "oracle"
ORACLE_PARTICLES = 120_000  # ours: doubling them changes `useful` by less than 0.01
OF_THE_CASE = "of the case"


def oracle_settings(noise: VioNoise, n_particles: int = ORACLE_PARTICLES) -> Settings:
    """Return the settings of the oracle for one case with visual-inertial odometry.

    Parameters
    ----------
    noise : VioNoise
        What the odometry's errors were drawn with.
    n_particles : int

    Examples
    --------
    >>> oracle_settings(VioNoise(scale_sd=0.01)).motion.scale_sd
    0.01
    """
    best = Settings()
    step_m = best.motion.step_m
    white_m = noise.white_m_per_sqrt_m * step_m**0.5
    motion = replace(
        best.motion,
        length_m=white_m,
        direction_rad=white_m / step_m,  # as much across as along
        drift_rad=0.0,
        drift_rad_per_sqrt_s=noise.heading_rad_per_sqrt_s,
        jitter_m=0.0,
        scaling="distance",
        scale_sd=noise.scale_sd,
    )
    more = n_particles / best.start.n_particles
    start = replace(best.start, n_particles=n_particles)
    observation = replace(best.observation, n_proposals=round(more * best.observation.n_proposals))
    resampling = replace(
        best.resampling,
        min_particles=round(more * best.resampling.min_particles),
        per_bin=more * best.resampling.per_bin,
    )
    return replace(
        best, method=ORACLE, motion=motion, start=start, observation=observation,
        resampling=resampling,
    )  # fmt: skip


def shared_settings(n_particles: int = ORACLE_PARTICLES) -> dict[str, Any]:
    """Return the oracle's settings as JSON; those that a case decides say so.

    Examples
    --------
    >>> found = shared_settings()
    >>> found["motion"]["scale_sd"], found["start"]["n_particles"]
    ('of the case', 120000)
    """
    some, others = (
        asdict(oracle_settings(noise, n_particles))
        for noise in (VioNoise(), VioNoise(0.01, 0.01, 0.01))
    )
    return _common(some, others)


def _common(some: dict[str, Any], others: dict[str, Any]) -> dict[str, Any]:
    common: dict[str, Any] = {}
    for name, value in some.items():
        if isinstance(value, dict):
            common[name] = _common(value, others[name])
        else:
            common[name] = value if value == others[name] else OF_THE_CASE
    return common
