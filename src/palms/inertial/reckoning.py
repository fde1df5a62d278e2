"""Dead reckoning: from an inertial log to odometry."""

from __future__ import annotations

import warnings

import numpy as np

from palms.errors import InputError, PalmsWarning
from palms.inertial.carriage import how_carried
from palms.inertial.heading import step_headings_rad
from palms.inertial.length import step_lengths_m
from palms.inertial.level import level_attitude
from palms.inertial.log import InertialLog
from palms.inertial.settings import InertialSettings
from palms.inertial.steps import find_steps
from palms.odometry import Odometry

__all__ = ["dead_reckon"]


def dead_reckon(
    log: InertialLog, settings: InertialSettings | None = None, name: str = "inertial log"
) -> Odometry:
    """Return the walk that an inertial log tells of: one sample for each step.

    The walk begins at the origin, lies in a frame of its own, and its first direction is
    arbitrary.

    Parameters
    ----------
    log : InertialLog
    settings : InertialSettings, optional
    name : str
        What to call the log in messages.

    Raises
    ------
    InputError
        When there are fewer than two steps, or neither gyroscope nor attitude.

    Warns
    -----
    PalmsWarning
        When the phone was not held steady, so that the walk is less sure.

    Examples
    --------
    >>> t = np.arange(1000) / 50
    >>> bobbing = np.outer(9.81 + 3 * np.sin(2 * np.pi * 1.8 * t), [0, 0, 1])
    >>> walk = dead_reckon(InertialLog(t, bobbing, rate_rad_s=np.zeros((1000, 3))))
    >>> len(walk), walk.frame, walk.source, round(float(walk.walked_m[-1]))
    (36, 'own', 'inertial', 20)
    """
    settings = settings or InertialSettings()
    even = log.resampled()
    steps = find_steps(even, settings)
    if len(steps) < 2:
        raise InputError(
            name, expected="at least two steps",
            got=f"{len(steps)} in {log.duration_s:.0f} s", fix="record while walking",
        )  # fmt: skip
    attitude = level_attitude(even, settings)
    doubts = how_carried(even, attitude, steps).doubts()
    if doubts is not None:
        warnings.warn(f"{name}: {doubts}", PalmsWarning, stacklevel=2)
    heading = step_headings_rad(even, attitude, steps)
    length = step_lengths_m(steps, settings)
    moves = length[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
    return Odometry(steps.end_s, np.cumsum(moves, axis=0), frame="own", source="inertial")
