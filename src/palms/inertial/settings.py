"""The numbers of dead reckoning, each with its unit and origin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from palms.errors import SettingsError

__all__ = ["HeadingMethod", "InertialSettings", "LengthMethod"]

LengthMethod = Literal["pendulum", "weinberg", "constant"]
HeadingMethod = Literal["gyro", "attitude"]


@dataclass(frozen=True, slots=True)
class InertialSettings:
    """How steps, their lengths and their headings are found.

    Parameters
    ----------
    low_hz, high_hz : float
        Band of the magnitude of acceleration that steps are looked for in; people take 1.4
        to 2.4 steps a second (usual in step counting, ours in detail).
    swing_m_s2 : float
        By how much a step's peak must stand out of that band (ours; a phone in the hand of
        a slow walker shows 2, one that is turned about while standing 0.5).
    apart_s : float
        Peaks nearer in time are one step (ours: nobody walks at more than 3.3 steps a
        second).
    length : {"pendulum", "weinberg", "constant"}
        How long a step is: from its swing and duration, from its swing alone (Weinberg 2002,
        Analog Devices AN-602), or always `step_m`.
    leg_m : float
        pendulum: length of the leg that swings over (fitted to the six walks of the mall's
        floor F2).
    weinberg : float
        weinberg: metres at a swing of 1 m/s2 (fitted to the same walks).
    step_m : float
        constant: a step's length (mean of 87 walks in a mall, 0.644 m).
    heading : {"gyro", "attitude"}
        Where a step goes: from the gyroscope alone, or from the platform's own estimate of the
        phone's attitude, which uses the compass.
    gravity_s : float
        Acceleration is averaged over about this long to find what is up (ours: several
        steps, less than a gyroscope needs to go astray).

    Raises
    ------
    SettingsError
        When a number is out of its range, or a method has another name.

    Examples
    --------
    >>> InertialSettings(length="constant", step_m=0.7).step_m
    0.7
    """

    low_hz: float = 0.7
    high_hz: float = 3.0
    swing_m_s2: float = 0.7
    apart_s: float = 0.3
    length: LengthMethod = "pendulum"
    leg_m: float = 0.82
    weinberg: float = 0.38
    step_m: float = 0.644
    heading: HeadingMethod = "gyro"
    gravity_s: float = 4.0

    def __post_init__(self) -> None:
        for name, low, high in _RANGES:
            value = getattr(self, name)
            if not low <= value <= high:
                expected = f"{low:g} to {high:g}"
                raise SettingsError(f"inertial {name}", expected=expected, got=str(value))
        if self.low_hz >= self.high_hz:
            raise SettingsError(
                "inertial low_hz", expected=f"below high_hz, {self.high_hz:g}", got=str(self.low_hz)
            )
        for name, known in (
            ("length", get_args(LengthMethod)),
            ("heading", get_args(HeadingMethod)),
        ):
            if getattr(self, name) not in known:
                raise SettingsError(
                    f"inertial {name}",
                    expected=f"one of {', '.join(known)}",
                    got=repr(getattr(self, name)),
                )


_RANGES = (
    ("low_hz", 0.05, 5.0),
    ("high_hz", 0.5, 20.0),
    ("swing_m_s2", 0.01, 50.0),
    ("apart_s", 0.05, 2.0),
    ("leg_m", 0.3, 1.5),
    ("weinberg", 0.05, 2.0),
    ("step_m", 0.1, 2.0),
    ("gravity_s", 0.2, 60.0),
)
