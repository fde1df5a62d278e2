"""What is said to free words: what was understood, the choices, or that it is not here."""

from __future__ import annotations

from palms.voice.places import Voice
from palms.voice.understanding import Named, Understood

__all__ = ["noted"]

SHOWN = 40  # ours: characters of what was said that are said back
CHOICES = 4  # ours: as many as one remembers


def noted(voice: Voice, text: str, heard: Understood) -> str:
    """Say what free words were understood as.

    Parameters
    ----------
    voice : Voice
    text : str
        The words.
    heard : Understood

    Examples
    --------
    >>> from palms.floorplan import FloorPlan
    >>> from palms.voice.surroundings import Surroundings
    >>> voice = Voice(Surroundings.of(FloorPlan([[[0, 0], [9, 0]]])))
    >>> labs = (Named("2", "Lab 230"), Named("2", "Lab 231"))
    >>> noted(voice, "the lab", Understood("several", choices=labs))
    'Which one: Lab 230 or Lab 231?'
    >>> noted(voice, "the moon", Understood("none"))
    'I know no "the moon" here. Try another name or number.'
    """
    texts = voice.texts
    if heard.kind == "none":
        return texts.say("hint.none", text=" ".join(text.split())[:SHOWN])
    if heard.kind == "several":
        return texts.say("hint.several", list=_choices(voice, heard.choices))
    place = voice.name(heard.room) if heard.room is not None else texts.say(
        "level", level=heard.level
    )  # fmt: skip
    return texts.say("hint.noted", area=place)


def _choices(voice: Voice, choices: tuple[Named, ...]) -> str:
    """Return rooms as a list: by name, the level beside it where names are the same."""
    texts = voice.texts
    names = list(dict.fromkeys(voice.name(each.room) for each in choices))
    told = names[:CHOICES] if len(names) > CHOICES else names[:-1]
    text = told[0]
    for name in told[1:]:
        text = texts.say("choice.next", list=text, item=name)
    if len(names) > CHOICES:
        return texts.say("choice.more.many", list=text, n=len(names) - CHOICES)
    return texts.say("choice.last", list=text, item=names[-1])
