"""Lengths and directions in words: uncertainty is rounded up, directions only where known."""

from __future__ import annotations

import math

from palms.geometry import wrap_angle
from palms.voice.catalogue import Catalogue
from palms.voice.moments import Moment
from palms.voice.preferences import Preferences

__all__ = ["accuracy_m", "ahead", "direction", "length", "rounded_up"]

FOOT_M = 0.3048
WARY = 2.0  # ours: so many times the 95 % radius; benchmarks.voice says why
LEAST_M = 1.0  # ours: nobody is told that it is nearer
FACING_RAD = math.radians(15.0)  # ours: clock directions need the facing to this
SIGMAS = 2.0  # ours: a facing is known to two standard deviations
REACH = 2.0  # ours: what is nearer than so many 95 % radii may lie anywhere around
ROUND_FROM = 20  # ours: larger numbers are told in fives
ROUND_DEGREES = 30


def _unit_m(preferences: Preferences) -> float:
    return {"metres": 1.0, "feet": FOOT_M, "steps": preferences.step_m}[preferences.units]


def accuracy_m(moment: Moment) -> float:
    """Return how accurate a place is told to be, before it is rounded up.

    Examples
    --------
    >>> accuracy_m(Moment("localized", radius_95_m=0.9))
    1.8
    """
    assert moment.radius_95_m is not None
    return max(WARY * moment.radius_95_m, LEAST_M)


def rounded_up(length_m: float, preferences: Preferences) -> float:
    """Return an uncertainty as it is told, in metres: whole units, never fewer.

    Examples
    --------
    >>> rounded_up(1.01, Preferences())
    2.0
    """
    return _whole_up(length_m, preferences) * _unit_m(preferences)


def _whole_up(length_m: float, preferences: Preferences) -> int:
    number = math.ceil(length_m / _unit_m(preferences) - 1e-9)
    return number if number <= ROUND_FROM else 5 * math.ceil(number / 5)


def _whole(length_m: float, preferences: Preferences) -> int:
    number = round(length_m / _unit_m(preferences))
    return number if number <= ROUND_FROM else 5 * round(number / 5)


def length(
    length_m: float, preferences: Preferences, texts: Catalogue, up: bool = False
) -> str | None:
    """Return a length in words; None when it is less than half a unit.

    Parameters
    ----------
    length_m : float
    preferences : Preferences
    texts : Catalogue
    up : bool
        Whether it is an uncertainty.

    Examples
    --------
    >>> from palms.voice.catalogue import read_catalogue
    >>> texts = read_catalogue("en")
    >>> length(3.2, Preferences(), texts), length(3.2, Preferences(units="feet"), texts, up=True)
    ('3 metres', '11 feet')
    """
    number = (_whole_up if up else _whole)(length_m, preferences)
    return texts.say(f"length.{preferences.units}", n=number) if number else None


def ahead(moment: Moment, bearing_rad: float, away_m: float) -> float | None:
    """Return how far left of the phone's facing something lies; None unless that is known.

    The facing must be known to 15 degrees, and the place well enough for so short a way.

    Examples
    --------
    >>> here = Moment("localized", 0.0, (0.0, 0.0), 1.0, facing_rad=1.0, spread_rad=0.1)
    >>> ahead(here, 1.5, 4.0), ahead(here, 1.5, 1.0)
    (0.5, None)
    """
    facing, spread, radius = moment.facing_rad, moment.spread_rad, moment.radius_95_m
    if facing is None or spread is None or radius is None:
        return None
    if not (math.isfinite(facing) and SIGMAS * spread <= FACING_RAD and away_m >= REACH * radius):
        return None
    return float(wrap_angle(bearing_rad - facing))


def direction(left_rad: float, preferences: Preferences, texts: Catalogue) -> str:
    """Return a direction in words, by how far left of the facing it is.

    Examples
    --------
    >>> from palms.voice.catalogue import read_catalogue
    >>> texts = read_catalogue("en")
    >>> [direction(math.radians(a), Preferences(), texts) for a in (0, 50, 90, 180, -60)]
    ["12 o'clock", "10 o'clock", "9 o'clock", "6 o'clock", "2 o'clock"]
    """
    if preferences.directions == "clock":
        hour = round(-left_rad / (math.pi / 6)) % 12 or 12
        return texts.say("direction.clock", hour=hour)
    if preferences.directions == "words":
        return texts.say(f"direction.words.{round(left_rad / (math.pi / 4)) % 8}")
    degrees = ROUND_DEGREES * round(math.degrees(left_rad) / ROUND_DEGREES)
    if degrees == 0:
        return texts.say("direction.straight")
    return texts.say("direction.left" if degrees > 0 else "direction.right", n=abs(degrees))
