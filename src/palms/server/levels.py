"""Levels: what a phone's word that it is on another level means, now that it comes."""

from __future__ import annotations

from typing import NamedTuple

from palms.errors import InputError
from palms.hints import Hint
from palms.localizer import Localizer
from palms.localizer.live import CLEAR_M
from palms.server import messages
from palms.server.floor import Floor

__all__ = ["LevelKnown", "check_kept", "level_hint", "level_known", "level_told"]

SURE = 0.5  # ours: a change does not count from a level that is less sure


class LevelKnown(NamedTuple):
    """The level that a session was on when it was last off the stairs.

    Attributes
    ----------
    number : int
        From the lowest up.
    p : float
        How sure that was.
    """

    number: int
    p: float


def level_known(localizer: Localizer, before: LevelKnown | None) -> LevelKnown | None:
    """Return the level that a change counts from; on stairs that is the one from before.

    Parameters
    ----------
    localizer : Localizer
    before : LevelKnown or None
    """
    atlas, belief, found = localizer.atlas, localizer.belief, localizer.estimate
    if atlas is None or belief is None or found.level is None:
        return None if belief is None else before
    reach_m = localizer.settings.levels.reach_m + CLEAR_M
    if before is not None and bool(atlas.on_stairs(belief.answer_m[None], reach_m)[0]):
        return before
    return LevelKnown(atlas.names.index(found.level), found.p_level)


def level_told(hint: Hint, floor: Floor) -> LevelKnown | None:
    """Return the level that a hint names, for changes that count from there."""
    if hint.level is None or floor.building is None:
        return None
    return LevelKnown(floor.building.index(hint.level), hint.probability)


def check_kept(level: str, floor: Floor) -> None:
    """Refuse another level than the one that a session is kept to."""
    if level != floor.level:
        raise InputError(
            "level", expected=f"that which the session is kept to ({floor.level})",
            got=repr(level), fix="open a session without one_level",
        )  # fmt: skip


def level_hint(
    message: messages.LevelChange, floor: Floor, known: LevelKnown | None
) -> Hint | None:
    """Return what a message says of the level, as a hint; None where it says what is known.

    A change is as sure as the message and the level that it counts from together.

    Parameters
    ----------
    message : messages.LevelChange
    floor : Floor
    known : LevelKnown or None
        What a change counts from.

    Raises
    ------
    InputError
        When there is no such level, or none from which a change could count.
    """
    if floor.building is None:
        check_kept("another" if message.change else message.level or floor.level or "", floor)
        return None
    names, change = floor.building.names, message.change
    if change is None:
        return Hint(level=message.level, probability=message.probability)
    if known is None or known.p < SURE:
        raise InputError(
            "level", expected="a level that is known, to count from",
            got="none yet" if known is None else f"level {names[known.number]} at {known.p:.0%}",
            fix="name the level, or send a scan",
        )  # fmt: skip
    if not 0 <= known.number + change < len(names):
        raise InputError(
            "level", expected=f"one of the building's ({', '.join(names)})",
            got=f"{change:+d} from {names[known.number]}", fix="name the level",
        )  # fmt: skip
    return Hint(level=names[known.number + change], probability=message.probability * known.p)
