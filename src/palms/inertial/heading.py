"""Where steps go."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from palms.geometry import FloatArray
from palms.inertial.level import level_axis
from palms.inertial.log import InertialLog
from palms.inertial.steps import Steps

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

__all__ = ["step_headings_rad"]


def step_headings_rad(log: InertialLog, attitude: Rotation, steps: Steps) -> FloatArray:
    """Return the direction (S,) of each step, in level axes, continuous over half turns.

    People walk where they turn to, and the phone turns with them: the direction is that of
    the phone's most level axis, averaged from the beginning of the step before to the end of
    the step, since hips and hands sway once in two steps. Between that axis and the walk is an
    angle that nobody knows; it stays the same as long as the phone is carried the same way.

    Parameters
    ----------
    log : InertialLog
    attitude : scipy Rotation
        From `palms.inertial.level_attitude`.
    steps : Steps

    Examples
    --------
    >>> from scipy.spatial.transform import Rotation
    >>> t = np.arange(500) / 50
    >>> left = Rotation.from_euler("z", 0.1 * t[:, None])
    >>> log = InertialLog(t, np.tile([0, 0, 9.81], (500, 1)))
    >>> steps = Steps(np.array([2.0, 4.0]), np.array([4.0, 6.0]), np.ones(2), np.ones(2))
    >>> np.diff(step_headings_rad(log, left, steps)).round(2).tolist()
    [0.1]
    """
    ahead = attitude.apply(level_axis(attitude))
    angle = np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
    total = np.concatenate([[0.0], np.cumsum(angle)])
    start = np.concatenate([steps.start_s[:1], steps.start_s[:-1]])
    start = np.maximum(start, steps.start_s - (steps.end_s - steps.start_s))
    first = np.searchsorted(log.time_s, start)
    after = np.maximum(np.searchsorted(log.time_s, steps.end_s, side="right"), first + 1)
    return np.asarray((total[after] - total[first]) / (after - first))
