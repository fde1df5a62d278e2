"""What walkers do besides walking: stand still, look about; and how often they are sampled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palms.evaluation.simulation.walker import TrueWalk
from palms.geometry import FloatArray, wrap_angle

__all__ = ["resampled", "with_facing", "with_pause", "with_stops"]

_TICK_S = 0.5  # ours: somebody who stands is sampled about as often as one who walks
_STOP_EVERY_M = 40.0  # simulation
_STOP_S = (3.0, 20.0)  # simulation
_HELD_SD_RAD = np.deg2rad(6.0)  # simulation: how far off the way the phone is held
_SWAY_SD_RAD = np.deg2rad(3.0)  # simulation: and how it sways from step to step
_LOOK_STEPS = 2.0  # simulation: people look round corners so many steps ahead and back


def with_pause(truth: TrueWalk, after: int, duration_s: float) -> TrueWalk:
    """Let somebody stand still for a while.

    Parameters
    ----------
    truth : TrueWalk
    after : int
        The step after which they stand.
    duration_s : float

    Examples
    --------
    >>> truth = TrueWalk([1, 2], [[1, 0], [2, 0]], [0, 0], [0, 0])
    >>> paused = with_pause(truth, 0, 1.0)
    >>> paused.time_s.tolist(), paused.position_m[:, 0].tolist()
    ([1.0, 1.5, 2.0, 3.0], [1.0, 1.0, 1.0, 2.0])
    """
    count = max(1, round(duration_s / _TICK_S))
    ticks = truth.time_s[after] + np.arange(1, count + 1) * duration_s / count
    index = np.concatenate(
        [np.arange(after + 1), np.full(count, after), np.arange(after + 1, len(truth.time_s))]
    )
    time = np.concatenate(
        [truth.time_s[: after + 1], ticks, truth.time_s[after + 1 :] + duration_s]
    )
    facing = None if truth.facing_rad is None else truth.facing_rad[index]
    return replace(
        truth,
        time_s=time,
        position_m=truth.position_m[index],
        heading_rad=truth.heading_rad[index],
        facing_rad=facing,
        level=tuple(truth.level[i] for i in index) if truth.level else (),
    )


def with_stops(truth: TrueWalk, rng: np.random.Generator) -> TrueWalk:
    """Let somebody stop now and then, some seconds each time.

    Examples
    --------
    >>> position = np.column_stack([np.arange(1.0, 201.0), np.zeros(200)])
    >>> truth = TrueWalk(np.arange(1.0, 201.0), position, np.zeros(200), np.zeros(2))
    >>> stopped = with_stops(truth, np.random.default_rng(0))
    >>> stopped.length_m == truth.length_m, bool(stopped.time_s[-1] > 203)
    (True, True)
    """
    count = max(1, int(rng.poisson(truth.length_m / _STOP_EVERY_M)))
    places = np.sort(rng.integers(0, max(len(truth.time_s) - 1, 1), count))[::-1]
    for place, duration in zip(places, rng.uniform(*_STOP_S, count), strict=True):
        truth = with_pause(truth, int(place), float(duration))
    return truth


def with_facing(truth: TrueWalk, rng: np.random.Generator) -> TrueWalk:
    """Say where the phone looks: along the way, held a little off it, swaying.

    Examples
    --------
    >>> truth = TrueWalk([1, 2, 3], [[1, 0], [2, 0], [3, 0]], [0, 0, 0], [0, 0])
    >>> bool(abs(with_facing(truth, np.random.default_rng(0)).facing_rad).max() < 0.6)
    True
    """
    from scipy.ndimage import gaussian_filter1d

    way = gaussian_filter1d(np.unwrap(truth.heading_rad), _LOOK_STEPS, mode="nearest")
    held = rng.normal(0.0, _HELD_SD_RAD)
    sway = rng.normal(0.0, _SWAY_SD_RAD, len(way))
    return replace(truth, facing_rad=np.asarray(wrap_angle(way + held + sway)))


def resampled(truth: TrueWalk, rate_hz: float, start_s: float) -> TrueWalk:
    """Sample a walk evenly in time, whatever its steps.

    Parameters
    ----------
    truth : TrueWalk
    rate_hz : float
        Samples a second.
    start_s : float
        When the first step began.

    Examples
    --------
    >>> truth = TrueWalk([1.0, 2.0], [[1, 0], [2, 0]], [0, 0], [0, 0])
    >>> resampled(truth, 2.0, 0.0).position_m[:, 0].tolist()
    [0.5, 1.0, 1.5, 2.0]
    """
    count = int((truth.time_s[-1] - start_s) * rate_hz + 1e-6)
    time = start_s + np.arange(1, count + 1) / rate_hz
    knots = np.concatenate([[start_s], truth.time_s])
    points = np.concatenate([truth.start_m[None], truth.position_m])
    position = np.column_stack([np.interp(time, knots, points[:, k]) for k in (0, 1)])
    step = np.minimum(np.searchsorted(truth.time_s, time - 1e-9), len(truth.time_s) - 1)
    facing = None
    if truth.facing_rad is not None:
        unwrapped = np.unwrap(truth.facing_rad)
        facing = wrap_angle(np.interp(time, truth.time_s, unwrapped))
    level = tuple(truth.level[i] for i in step) if truth.level else ()
    heading: FloatArray = truth.heading_rad[step]
    return TrueWalk(time, position, heading, truth.start_m, facing, level)
