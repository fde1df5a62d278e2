"""Judges sentences by their words alone: what do they claim, and is it so?

A sentence about place is false when one of its claims is:

- *accurate to N*: the answer is farther than N from the truth;
- *A*, *somewhere in A*, *A or B*: the truth is farther than N from all that is named;
- *near B*: the truth is farther than N and 6 m from B, which is what near means;
- *within D of B*: the truth is farther than D from B;
- *B: D metres*: no door of B is so far, within N and half a metre;
- *B: D metres, ... o'clock*: no such door lies within an hour's 30 degrees of that, seen from the
  truth.

N is the accuracy that the sentence states.
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from palms.geometry import wrap_angle
from palms.voice import Saying, Surroundings, Voice
from palms.voice.places import NEAR_M
from palms.voice.surroundings import Area

HALF_M = 0.5  # what rounding to metres may change
HOUR_RAD = math.radians(30.0)
_TEXT = re.compile(r"(?:Found(?: again)?: )?(?P<sure>[Pp]robably )?(?P<place>.+)\.")
_PLACES = (
    ("within", re.compile(r"within (?P<reach>\d+) metres? of (?P<a>.+)", re.IGNORECASE)),
    ("in", re.compile(r"somewhere in (?P<a>.+)", re.IGNORECASE)),
    ("near", re.compile(r"near (?P<b>.+)", re.IGNORECASE)),
    ("in", re.compile(r"(?P<a>.+), near (?P<b>.+)")),
    ("in", re.compile(r"(?P<a>.+) or (?P<c>.+)")),
    ("none", re.compile(r"a place that the plan has no name for", re.IGNORECASE)),
    ("in", re.compile(r"(?P<a>.+)")),
)
_ACCURACY = re.compile(r"Accurate to (\d+) metres?\.")
_TOWARDS = re.compile(
    r"(?P<b>[^.:]+): (?P<away>right here|\d+ metres?)(?:, (?P<hour>\d+) o'clock)?\."
)


class Truth(NamedTuple):
    """Where the walker is, where the phone looks, and how far off the answer is."""

    x_m: float
    y_m: float
    facing_rad: float
    error_m: float


class Verdict(NamedTuple):
    """What is wrong with a sentence; `is_sure` when it did not say probably."""

    wrong: tuple[str, ...]
    is_sure: bool
    names_other_room: bool

    @property
    def is_false(self) -> bool:
        return bool(self.wrong)


class Judge:
    """Knows the rooms of a plan by their names."""

    def __init__(self, around: Surroundings) -> None:
        (self._level,) = around.levels
        self._around = around
        self._areas: dict[str, list[Area]] = {}
        for area in around.areas(self._level):
            name = Voice(around).name(area.name).casefold()
            self._areas.setdefault(name, []).append(area)

    def judge(self, saying: Saying, truth: Truth) -> Verdict:
        """Return what is wrong with a sentence about place."""
        details = saying.details or ""
        accuracy = float(_found(_ACCURACY, details).group(1))
        said = _found(_TEXT, saying.text)
        wrong = [] if truth.error_m <= accuracy else ["accuracy"]
        if not self._is_there(said["place"], truth, accuracy):
            wrong.append("place")
        for towards in _TOWARDS.finditer(_ACCURACY.sub("", details)):
            wrong += self._wrong_way(towards, truth, accuracy)
        return Verdict(
            tuple(wrong), said["sure"] is None, self._is_other_room(said["place"], truth)
        )

    def _away_m(self, name: str, truth: Truth) -> float:
        areas = self._areas[name.strip().casefold()]
        return min(area.away_m(truth.x_m, truth.y_m) for area in areas)

    def _is_there(self, place: str, truth: Truth, accuracy_m: float) -> bool:
        kind, named = _kind(place)
        if kind == "none":
            return True
        if kind == "within":
            return self._away_m(named["a"], truth) <= float(named["reach"])
        inside = [self._away_m(named[k], truth) for k in ("a", "c") if named.get(k)]
        if inside and min(inside) > accuracy_m:
            return False
        return not named.get("b") or self._away_m(named["b"], truth) <= accuracy_m + NEAR_M

    def _is_other_room(self, place: str, truth: Truth) -> bool:
        """Whether a wall lies between: none of the rooms that it names holds the truth."""
        kind, named = _kind(place)
        if kind != "in":
            return False
        return all(self._away_m(named[k], truth) > 0 for k in ("a", "c") if named.get(k))

    def _wrong_way(self, towards: re.Match[str], truth: Truth, accuracy_m: float) -> list[str]:
        areas = self._areas[towards["b"].strip().casefold()]
        doors = [door for area in areas for door in area.doors_m.tolist()]
        doors = doors or [area.target_m(truth.x_m, truth.y_m) for area in areas]
        number = towards["away"].split()[0]
        told_m = float(number) if number.isdigit() else 0.0
        wrongs = []
        for door in doors:
            x, y = door[0] - truth.x_m, door[1] - truth.y_m
            wrong = []
            if abs(math.hypot(x, y) - told_m) > accuracy_m + HALF_M:
                wrong.append("distance")
            if towards["hour"] is not None:
                left = float(wrap_angle(math.atan2(y, x) - truth.facing_rad))
                if abs(wrap_angle(left + HOUR_RAD * float(towards["hour"]))) > HOUR_RAD:
                    wrong.append("direction")
            wrongs.append(wrong)
        return min(wrongs, key=len)


def _kind(place: str) -> tuple[str, dict[str, str]]:
    for kind, pattern in _PLACES:
        found = pattern.fullmatch(place)
        if found is not None:
            return kind, found.groupdict()
    raise AssertionError(place)


def _found(pattern: re.Pattern[str], text: str) -> re.Match[str]:
    found = pattern.search(text)
    assert found is not None, text
    return found
