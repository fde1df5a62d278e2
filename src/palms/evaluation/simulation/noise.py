"""Odometry of a walk, from its truth: what the phone believes it did.

Noise is stated per metre and per second, so that a walk sampled once or sixty times a
second comes out with the same errors.
"""

from __future__ import annotations

import numpy as np

from palms.evaluation.simulation.settings import InertialNoise, VioNoise
from palms.evaluation.simulation.walker import TrueWalk
from palms.geometry import FloatArray
from palms.odometry import Odometry

__all__ = ["inertial_odometry", "vio_odometry"]


def vio_odometry(
    truth: TrueWalk, drift_rad: float, noise: VioNoise, rng: np.random.Generator
) -> Odometry:
    """Visual-inertial odometry in the frame of the scan.

    Parameters
    ----------
    truth : TrueWalk
        The walk, in the map frame.
    drift_rad : float
        The session's drift at time 0: odom vectors turned by it are map vectors.
    noise : VioNoise
    rng : numpy.random.Generator

    Returns
    -------
    Odometry
        In the odom frame, starting from (0, 0).

    Examples
    --------
    >>> truth = TrueWalk([0.5, 1.0], [[0.6, 0.0], [1.2, 0.0]], [0.0, 0.0], [0.0, 0.0])
    >>> quiet = VioNoise(0.0, 0.0, 0.0)
    >>> odometry = vio_odometry(truth, np.pi / 2, quiet, np.random.default_rng(0))
    >>> (odometry.position_m.round(6) + 0.0).tolist()
    [[0.0, -0.6], [0.0, -1.2]]
    """
    waited = np.diff(truth.time_s, prepend=0.0)
    walked = np.linalg.norm(truth.moves_m, axis=1)
    turned = (
        np.cumsum(rng.normal(size=len(waited)) * np.sqrt(waited)) * noise.heading_rad_per_sqrt_s
    )
    scale = rng.normal(1.0, noise.scale_sd)
    white = rng.normal(size=truth.moves_m.shape) * np.sqrt(walked)[:, None]
    moves = scale * _turned(truth.moves_m, turned - drift_rad) + noise.white_m_per_sqrt_m * white
    return Odometry(truth.time_s, np.cumsum(moves, axis=0))


def inertial_odometry(truth: TrueWalk, noise: InertialNoise, rng: np.random.Generator) -> Odometry:
    """Odometry from inertial sensors alone, in a frame of its own.

    Parameters
    ----------
    truth : TrueWalk
        The walk, in the map frame.
    noise : InertialNoise
    rng : numpy.random.Generator

    Returns
    -------
    Odometry
        Starting from (0, 0); its rotation to the map is uniform.

    Examples
    --------
    >>> truth = TrueWalk([0.5, 1.0], [[0.6, 0.0], [1.2, 0.0]], [0.0, 0.0], [0.0, 0.0])
    >>> quiet = InertialNoise(0.0, 0.0, 1.5, 0.0, 0.0)
    >>> odometry = inertial_odometry(truth, quiet, np.random.default_rng(0))
    >>> float(odometry.walked_m[-1].round(6)), odometry.frame
    (1.8, 'own')
    """
    walked = np.linalg.norm(truth.moves_m, axis=1)
    frame = rng.uniform(-np.pi, np.pi)
    rate = rng.normal(0.0, noise.rate_sd_rad_per_s)
    leg = (np.cumsum(walked) / noise.leg_m).astype(int)
    legs = rng.normal(1.0, noise.leg_scale_sd, leg.max() + 1)
    scale = rng.normal(noise.scale, noise.scale_sd) * legs[leg]
    sideways = (
        noise.sideways_m_per_sqrt_m
        * rng.normal(size=len(walked))
        / np.sqrt(np.maximum(walked, 1e-9))
    )
    across = np.column_stack([-truth.moves_m[:, 1], truth.moves_m[:, 0]])
    moves = scale[:, None] * (truth.moves_m + sideways[:, None] * across)
    position = np.cumsum(_turned(moves, rate * truth.time_s + frame), axis=0)
    return Odometry(truth.time_s, position, frame="own", source="inertial")


def _turned(moves: FloatArray, angle_rad: FloatArray) -> FloatArray:
    """Turn each of the moves (T, 2) by its own angle."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    x, y = moves.T
    return np.column_stack([c * x - s * y, s * x + c * y])
