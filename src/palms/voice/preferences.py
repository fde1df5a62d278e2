"""How somebody wants to be spoken to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from palms.errors import SettingsError

__all__ = ["MIN_GAP_S", "Directions", "Preferences", "Units"]

Units = Literal["metres", "feet", "steps"]
Directions = Literal["clock", "degrees", "words"]
MIN_GAP_S = 5.0  # ours: nobody is spoken to unasked more often


@dataclass(frozen=True, slots=True)
class Preferences:
    """How somebody wants to be spoken to.

    Parameters
    ----------
    units : {"metres", "feet", "steps"}
    step_m : float
        Length of a step, 0.2 to 1.5 m.
    language : str
        A language tag, such as ``de`` or ``de-AT``.
    directions : {"clock", "degrees", "words"}
        "2 o'clock", "60 degrees to the right" or "ahead on the right".
    every_s : float
        At most one unasked sentence in so many seconds, 5 to 600.
    details : bool
        Whether details are part of each text.
    quiet : bool
        Whether nothing is said unasked but that the place is known, unsure, lost or found.

    Raises
    ------
    SettingsError
        When a number is out of its range.

    Examples
    --------
    >>> Preferences(units="steps", step_m=0.6).every_s
    5.0
    """

    units: Units = "metres"
    step_m: float = 0.7
    language: str = "en"
    directions: Directions = "clock"
    every_s: float = MIN_GAP_S
    details: bool = False
    quiet: bool = False

    def __post_init__(self) -> None:
        for name, low, high in (("step_m", 0.2, 1.5), ("every_s", MIN_GAP_S, 600.0)):
            value = getattr(self, name)
            if not (math.isfinite(value) and low <= value <= high):
                raise SettingsError(
                    f"Preferences.{name}", expected=f"{low:g} to {high:g}", got=f"{value:g}"
                )
