"""Odometry of a walk, from its truth: what the phone believes it did.

Noise is stated per metre and per second, so that a walk sampled once or sixty times a
second comes out with the same errors.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palms.errors import InputError
from palms.evaluation.simulation.settings import InertialNoise, VioNoise
from palms.evaluation.simulation.walker import TrueWalk
from palms.geometry import FloatArray, rotate, wrap_angle
from palms.odometry import Odometry

__all__ = ["drift_of", "inertial_odometry", "vio_odometry", "with_jump"]


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
        In the odom frame, starting from (0, 0); with the phone's facing when the truth has it.

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
    facing = None if truth.facing_rad is None else truth.facing_rad + turned - drift_rad
    position = np.cumsum(moves, axis=0)
    return Odometry(truth.time_s, position, None if facing is None else wrap_angle(facing))


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


def with_jump(
    odometry: Odometry, at: int, shift_m: tuple[float, float], turn_rad: float
) -> Odometry:
    """Let the odometry jump during one move, without notice.

    Parameters
    ----------
    odometry : Odometry
    at : int
        The move.
    shift_m : tuple of float
        Added to it, in the odom frame.
    turn_rad : float
        By this all that follows is turned.

    Examples
    --------
    >>> straight = Odometry([1.0, 2.0, 3.0], [[1.0, 0.0], [2.0, 0.0], [3.0, 0.0]])
    >>> with_jump(straight, 1, (0.0, 5.0), np.pi / 2).position_m.round(6).tolist()
    [[1.0, 0.0], [2.0, 5.0], [2.0, 6.0]]
    """
    moves = odometry.displacements_m.copy()
    moves[at + 1 :] = rotate(moves[at + 1 :], turn_rad)
    moves[at] += shift_m
    facing = odometry.facing_rad
    if facing is not None:
        later = np.arange(len(facing)) >= at
        facing = wrap_angle(facing + turn_rad * later)
    position = odometry.start_m + np.cumsum(moves, axis=0)
    return replace(odometry, position_m=position, facing_rad=facing)


def drift_of(odometry: Odometry, truth: TrueWalk) -> FloatArray:
    """Return the true drift (T,) of an odometry at each of its samples, from both facings.

    Raises
    ------
    InputError
        When one of them has no facing.

    Examples
    --------
    >>> truth = TrueWalk([1, 2], [[1, 0], [2, 0]], [0, 0], [0, 0], facing_rad=[0.5, 0.5])
    >>> odometry = vio_odometry(truth, 0.3, VioNoise(0.0, 0.0, 0.0), np.random.default_rng(0))
    >>> drift_of(odometry, truth).round(6).tolist()
    [0.3, 0.3]
    """
    if odometry.facing_rad is None or truth.facing_rad is None:
        raise InputError("drift of an odometry", expected="facings", got="none")
    return np.asarray(wrap_angle(truth.facing_rad - odometry.facing_rad))


def _turned(moves: FloatArray, angle_rad: FloatArray) -> FloatArray:
    """Turn each of the moves (T, 2) by its own angle."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    x, y = moves.T
    return np.column_stack([c * x - s * y, s * x + c * y])
