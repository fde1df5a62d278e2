"""What is said before the place is known: no names, but how far it has come and what helps."""

from __future__ import annotations

import math
from typing import NamedTuple

from palms.advice import View
from palms.geometry import wrap_angle
from palms.voice.measures import length
from palms.voice.moments import Moment
from palms.voice.places import Voice

__all__ = ["Seen", "scanned", "searching"]

WALK_M = 10.0  # ours: after so many metres most places are told apart
POOR = 0.25  # ours: a scan that has seen less than the rest can be better
BEHIND_RAD = math.radians(135.0)


class Seen(NamedTuple):
    """A scan that was taken.

    Attributes
    ----------
    view : View
    facing_rad : float or None
        Where the phone looked then, odom frame.
    """

    view: View
    facing_rad: float | None


def searching(voice: Voice, moment: Moment) -> tuple[str, str | None]:
    """Say how many places are possible, and what helps.

    Examples
    --------
    >>> from palms.floorplan import FloorPlan
    >>> from palms.voice.surroundings import Surroundings
    >>> voice = Voice(Surroundings.of(FloorPlan([[[0, 0], [9, 0]]])))
    >>> searching(voice, Moment("searching", 0.0, (1.0, 1.0), 20.0, shares=(0.4, 0.3, 0.2)))
    ('Three places possible.', 'Walk on 10 metres.')
    """
    texts = voice.texts
    if moment.position_m is None:
        return texts.say("scan.first"), None
    if moment.stage == "lost":
        return texts.say("lost"), _tell_me(voice)
    if moment.stage == "localized":
        return texts.say("settle"), None
    n = moment.n_places
    text = texts.say("places.unknown") if n is None else texts.say("places.many", n=n)
    return text[:1].upper() + text[1:], _walk_on(voice)


def _tell_me(voice: Voice) -> str | None:
    return voice.texts.say("lost.named") if voice.surroundings.rooms else None


def _walk_on(voice: Voice) -> str:
    distance = length(WALK_M, voice.preferences, voice.texts)
    key = "walk.or_tell" if voice.surroundings.rooms else "walk"
    return voice.texts.say(key, distance=distance)


def scanned(voice: Voice, seen: Seen, moment: Moment) -> tuple[str, str | None]:
    """Say how much a scan tells, and what it did not look at.

    Examples
    --------
    >>> from palms.advice import Gap
    >>> from palms.floorplan import FloorPlan
    >>> from palms.voice.surroundings import Surroundings
    >>> voice = Voice(Surroundings.of(FloorPlan([[[0, 0], [9, 0]]])))
    >>> seen = Seen(View(1, True, (Gap(-1.5, 3.0),)), 0.0)
    >>> scanned(voice, seen, Moment("searching"))[0]
    'Only one wall seen. Turn further to the right.'
    """
    view, texts = seen.view, voice.texts
    known = view.n_walls > 0
    taken = texts.say("scan.taken.many", n=view.n_walls) if known else texts.say("scan.none")
    places, advice = searching(voice, moment)
    if view.n_walls <= 1 or view.unseen > POOR:
        return f"{taken} {texts.say(_turn(seen))}", places if known else None
    if view.one_way:
        advice = texts.say("scan.one_way")
    return f"{taken} {places}", advice


def _turn(seen: Seen) -> str:
    """Return the key of what to do about the widest gap."""
    if seen.facing_rad is None or not seen.view.gaps:
        return "scan.turn.around"
    left = float(wrap_angle(seen.view.gaps[0].middle_rad - seen.facing_rad))
    if abs(left) > BEHIND_RAD:
        return "scan.turn.behind"
    return "scan.turn.left" if left > 0 else "scan.turn.right"
