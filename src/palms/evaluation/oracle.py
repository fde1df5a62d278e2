"""The oracle: our method told the noise of the case, with very many particles.

It tells what a filter loses: same scan likelihood, same stages and thresholds, but moved with
the true parameters of the odometry's noise (not its draws), and with so many particles that
more change nothing. Only simulated cases say what their noise is.
"""

from __future__ import annotations

from dataclasses import replace

from palms.evaluation.simulation.nuisances import Nuisances
from palms.settings import MotionSettings, Settings

__all__ = ["ORACLE_PARTICLES", "oracle_settings"]

ORACLE_PARTICLES = 32_000  # ours: doubling them changes `useful` by less than 0.01


def oracle_settings(nuisances: Nuisances, n_particles: int = ORACLE_PARTICLES) -> Settings:
    """Return the settings of the oracle for one case with visual-inertial odometry.

    Parameters
    ----------
    nuisances : Nuisances
        The parameters that the case's noise was drawn with.
    n_particles : int

    Examples
    --------
    >>> import numpy as np
    >>> from palms.evaluation.simulation import draw_nuisances
    >>> nuisances = draw_nuisances(np.random.default_rng(0))
    >>> oracle_settings(nuisances).motion.scale_sd == nuisances.vio_scale_sd
    True
    """
    best, vio = Settings(), nuisances.vio
    step_m = best.motion.step_m
    white_m = vio.white_m_per_sqrt_m * step_m**0.5
    motion = MotionSettings(
        step_m=step_m,
        length_m=white_m,
        direction_rad=white_m / step_m,  # as much across as along
        drift_rad=0.0,
        drift_rad_per_sqrt_s=vio.heading_rad_per_sqrt_s,
        jitter_m=0.0,
        hit_weight=best.motion.hit_weight,
        scale_sd=vio.scale_sd,
    )
    start = replace(best.start, n_particles=n_particles)
    return replace(best, method="oracle", motion=motion, start=start)
