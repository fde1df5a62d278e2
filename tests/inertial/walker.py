"""What a phone's sensors read while somebody walks: a simulated walker, drawn from a seed.

The body swings over its legs as a pendulum upside down and turns smoothly; the phone tilts a
little with each step, as phones in hands do, or much, as in a pocket.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from palms.inertial import InertialLog
from palms.inertial.log import GRAVITY_M_S2

LEG_M = 0.82


@dataclass(frozen=True)
class Phone:
    """How the phone is carried and how good its sensors are.

    tilt_deg is that of its top above the horizon, roll_deg about its long axis; sway_deg is
    the amplitude of tilting, at the rate of strides, on an arm or leg of arm_m; noises are
    standard deviations of single readings, the bias is the gyroscope's.
    """

    tilt_deg: float = 30.0
    roll_deg: float = 0.0
    sway_deg: float = 3.0
    arm_m: float = 0.0
    rate_hz: float = 100.0
    acceleration_noise_m_s2: float = 0.1
    rate_noise_rad_s: float = 0.01
    bias_rad_s: float = 0.001


@dataclass(frozen=True)
class Sensed:
    """Readings with their truth: the log, and the end of each step in time and place."""

    log: InertialLog
    step_s: np.ndarray
    step_m: np.ndarray


def sense(time_s, position_m, phone: Phone, rng: np.random.Generator) -> Sensed:
    """Return what a phone reads on a walk whose samples (S,), (S, 2) are ends of steps.

    The first sample is where the walk begins; before it the walker stands for two seconds.
    """
    t = np.arange(time_s[0] - 2.0, time_s[-1] + 1.0, 1 / phone.rate_hz)
    length = np.linalg.norm(np.diff(position_m, axis=0), axis=1)
    phase = np.interp(t, time_s, np.arange(len(time_s)))  # steps done so far
    attitude = _attitude(t, time_s, position_m, phase, phone)
    world = _acceleration(t, time_s, length, phase) + _swinging(t, attitude, phase, phone)
    felt = attitude.inv().apply(world)
    turns = (attitude[:-1].inv() * attitude[1:]).as_rotvec() * phone.rate_hz
    rate = np.concatenate([turns, turns[-1:]]) + phone.bias_rad_s
    log = InertialLog(
        t - t[0],
        felt + phone.acceleration_noise_m_s2 * rng.standard_normal(felt.shape),
        rate + phone.rate_noise_rad_s * rng.standard_normal(rate.shape),
        attitude.as_quat(),
    )
    return Sensed(log, np.asarray(time_s[1:]) - t[0], np.asarray(position_m[1:]) - position_m[0])


def _attitude(t, time_s, position_m, phase, phone: Phone) -> Rotation:
    moves = np.diff(position_m, axis=0)
    heading = np.unwrap(np.arctan2(moves[:, 1], moves[:, 0]))
    middle = 0.5 * (np.asarray(time_s)[1:] + np.asarray(time_s)[:-1])
    yaw = gaussian_filter1d(np.interp(t, middle, heading), 0.15 * phone.rate_hz)
    stride = np.sin(np.pi * phase)
    ahead = Rotation.from_euler("z", (yaw - np.pi / 2 + np.radians(2) * stride)[:, None])
    tilt = np.radians(phone.tilt_deg + phone.sway_deg * stride)
    roll = Rotation.from_euler("y", phone.roll_deg, degrees=True)
    return ahead * Rotation.from_euler("x", tilt[:, None]) * roll


def _acceleration(t, time_s, length, phase):
    """Acceleration with gravity (N, 3) in axes with z up: bobbing that fits the steps' lengths."""
    middle = 0.5 * (np.asarray(time_s)[1:] + np.asarray(time_s)[:-1])
    duration = np.diff(time_s)
    swing = length**2 / (8 * LEG_M) * (2 * np.pi / duration) ** 2
    smooth = PchipInterpolator(middle, swing)(np.clip(t, middle[0], middle[-1]))
    walking = (t >= time_s[0]) & (t <= time_s[-1])
    up = GRAVITY_M_S2 + walking * 0.5 * smooth * np.cos(2 * np.pi * phase)
    return np.column_stack([0 * t, 0 * t, up])


def _swinging(t, attitude, phase, phone: Phone):
    """Acceleration (N, 3) of a phone at the end of an arm that swings to and fro."""
    angle = np.radians(phone.sway_deg) * np.sin(np.pi * phase)
    ahead, down = phone.arm_m * np.sin(angle), phone.arm_m * np.cos(angle)
    yaw = np.unwrap(np.arctan2(*attitude.apply([1.0, 0.0, 0.0])[:, 1::-1].T)) + np.pi / 2
    place = np.column_stack([ahead * np.cos(yaw), ahead * np.sin(yaw), -down])
    return np.gradient(np.gradient(place, t, axis=0), t, axis=0)


def corners(steps: int = 120, step_m: float = 0.65, step_s: float = 0.54):
    """A walk around corners, to the left and to the right: times (S,) and places (S, 2)."""
    turns = np.zeros(steps)
    turns[[20, 40, 41, 60, 90]] = np.radians([90, 45, 45, -90, -90])
    heading = np.cumsum(turns)
    moves = step_m * np.column_stack([np.cos(heading), np.sin(heading)])
    place = np.concatenate([[[0.0, 0.0]], np.cumsum(moves, axis=0)])
    return step_s * np.arange(steps + 1), place
