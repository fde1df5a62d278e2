"""How long steps are."""

from __future__ import annotations

import numpy as np

from palms.geometry import FloatArray
from palms.inertial.settings import InertialSettings
from palms.inertial.steps import Steps

__all__ = ["step_lengths_m"]


def step_lengths_m(steps: Steps, settings: InertialSettings) -> FloatArray:
    """Return the length (S,) of each step in metres.

    "pendulum": the hip swings over the leg that stands as a pendulum upside down (Zijlstra
    and Hof, Gait and Posture 1997) and thereby rises by h, and the step is 2 sqrt(2 leg h).
    Bobbing by h at the step's rate makes accelerations that swing by h (2 pi / duration)^2,
    which gives h. "weinberg": the fourth root of the swing, scaled.

    Parameters
    ----------
    steps : Steps
    settings : InertialSettings

    Examples
    --------
    >>> steps = Steps(*np.array([[0.0], [0.5], [0.5], [9.0]]))
    >>> step_lengths_m(steps, InertialSettings()).round(2).tolist()
    [0.6]
    >>> step_lengths_m(steps, InertialSettings(length="constant")).tolist()
    [0.644]
    """
    if settings.length == "constant":
        return np.full(len(steps), settings.step_m)
    if settings.length == "weinberg":
        return np.asarray(settings.weinberg * steps.swing_m_s2**0.25)
    rise_m = steps.swing_m_s2 * (steps.duration_s / (2 * np.pi)) ** 2
    return np.asarray(2 * np.sqrt(2 * settings.leg_m * rise_m))
