"""How the phone was carried: steady before the walker, swinging along, or moved on the way."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from palms.geometry import FloatArray
from palms.inertial.log import RATE_HZ, InertialLog
from palms.inertial.steps import Steps

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

__all__ = ["Carriage", "how_carried"]

STEADY_RAD: Final = math.radians(10)  # ours: 18 held phones sway by 2.3 to 3.3 degrees
MOVED_RAD: Final = math.radians(45)  # ours: held phones tilt by at most 9
_SWAY_S = 1.0  # ours: slower tilting is no swaying; two strides
_TILT_S = 2.0


@dataclass(frozen=True, slots=True)
class Carriage:
    """How a phone was carried.

    Parameters
    ----------
    sway_rad : float
        How far it tilts to and fro while the walker steps: root mean square.
    moved_rad : float
        The largest angle between how it hung at some time and how it hung mostly.
    moved_at_s : float
        When that was.

    Examples
    --------
    >>> Carriage(0.05, 0.1, 12.0).kind, Carriage(0.4, 0.1, 12.0).kind
    ('held', 'swung')
    """

    sway_rad: float
    moved_rad: float
    moved_at_s: float

    @property
    def kind(self) -> Literal["held", "swung", "moved"]:
        """Held steady; swung with the arm or the leg; or moved to another place on the way."""
        if self.sway_rad > STEADY_RAD:
            return "swung"
        return "moved" if self.moved_rad > MOVED_RAD else "held"

    def doubts(self) -> str | None:
        """Return why dead reckoning may be off, for a warning; None when there is no reason."""
        if self.kind == "swung":
            return (
                f"the phone sways by {math.degrees(self.sway_rad):.0f} degrees, as in a swinging "
                "hand or a trouser pocket; dead reckoning is measured for phones held steady, and "
                "steps come out too long unless their length is constant"
            )
        if self.kind == "moved":
            return (
                f"the phone was turned over by {math.degrees(self.moved_rad):.0f} degrees about "
                f"{self.moved_at_s:.0f} s; directions before and after may not fit together"
            )
        return None


def how_carried(log: InertialLog, attitude: Rotation, steps: Steps) -> Carriage:
    """Return how the phone was carried while its bearer walked.

    Parameters
    ----------
    log : InertialLog
        At `RATE_HZ`.
    attitude : scipy Rotation
        From `palms.inertial.level_attitude`.
    steps : Steps
        At least one.

    Examples
    --------
    >>> from scipy.spatial.transform import Rotation
    >>> t = np.arange(500) / 50
    >>> swinging = Rotation.from_euler("x", 0.6 * np.sin(6 * t)[:, None])
    >>> log = InertialLog(t, np.tile([0, 0, 9.81], (500, 1)))
    >>> steps = Steps(np.array([0.0]), np.array([9.0]), np.ones(1), np.ones(1))
    >>> how_carried(log, swinging, steps).kind
    'swung'
    """
    walking = (log.time_s >= steps.start_s[0]) & (log.time_s <= steps.end_s[-1])
    up = attitude.inv().apply([0.0, 0.0, 1.0])
    sway = _between(up, _averaged(up, _SWAY_S))[walking]
    hung = _averaged(up, _TILT_S)[walking]
    usual = np.median(hung, axis=0)
    moved = _between(hung, np.broadcast_to(usual / np.linalg.norm(usual), hung.shape))
    at = int(moved.argmax())
    return Carriage(
        float(np.sqrt(np.mean(sway**2))), float(moved[at]), float(log.time_s[walking][at])
    )  # fmt: skip


def _averaged(directions: FloatArray, seconds: float) -> FloatArray:
    from scipy.ndimage import gaussian_filter1d

    mean = gaussian_filter1d(directions, seconds * RATE_HZ, axis=0, mode="nearest")
    return np.asarray(mean / np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-9))


def _between(one: FloatArray, other: FloatArray) -> FloatArray:
    return np.asarray(np.arccos(np.clip((one * other).sum(axis=1), -1.0, 1.0)))
