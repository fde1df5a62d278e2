"""What free words say of where the phone is: a room, a level, several rooms, or nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import Literal, NamedTuple

from palms.voice.catalogue import Lexicon, lexicon
from palms.voice.numbers import folded, values_of

__all__ = ["Named", "Understood", "understand"]

ALIKE = 0.8  # ours: words that are this alike may be the same, misheard
SURE, LIKELY = 0.9, 0.75  # ours: how often a hint is true; one that had to be guessed
LONGEST = 40  # ours: words that are listened to


class Named(NamedTuple):
    """A room, by its level and its name."""

    level: str
    room: str


@dataclass(frozen=True, slots=True)
class Understood:
    """What somebody said of where the phone is.

    Parameters
    ----------
    kind : {"room", "level", "several", "none"}
    room, level : str or None
        As the plan has them.
    choices : tuple of Named
        The rooms that it may be, when there are several.
    probability : float
        How often such a hint is true.
    """

    kind: Literal["room", "level", "several", "none"]
    room: str | None = None
    level: str | None = None
    choices: tuple[Named, ...] = ()
    probability: float = SURE


class _Heard(NamedTuple):
    """Words without fillers, numbers as digits; and those that only help to decide."""

    words: tuple[str, ...]
    numbers: tuple[str, ...]
    fillers: frozenset[str]


def understand(text: str, rooms: Iterable[Named], levels: Sequence[str] = ()) -> Understood:
    """Find the room or the level that free words mean.

    A number must be that of the room; a word may be misheard by a letter or two. What several
    rooms fit is not guessed.

    Parameters
    ----------
    text : str
        Of any language that there are texts in.
    rooms : iterable of Named
        All rooms of the building.
    levels : sequence of str
        Names of its levels, from the lowest up.

    Examples
    --------
    >>> rooms = [Named("2", name) for name in ("Room 215", "Lab 230", "Lab 231", "Kitchen")]
    >>> understand("I am near room two fifteen", rooms).room
    'Room 215'
    >>> understand("the lab", rooms).choices, understand("kitschen", rooms).room
    ((Named(level='2', room='Lab 230'), Named(level='2', room='Lab 231')), 'Kitchen')
    >>> understand("room 216", rooms).kind
    'none'
    """
    words = lexicon()
    said = folded(text)[:LONGEST]
    level, said = _level(said, levels, words)
    known = list(dict.fromkeys(rooms))
    some = [each for each in known if level is None or each.level == level]
    found, probability = _rooms(_heard(said, words), some, words), SURE
    if not found:
        sounds = [str(words.homophones.get(word, word)) for word in said]
        found, probability = _rooms(_heard(sounds, words), some, words), LIKELY
    if not found:
        rest = _heard(said, words)
        unknown = level is None or rest.words or rest.numbers
        return Understood("none" if unknown else "level", level=level)
    best = max(score for score, _ in found)
    choices = tuple(each for score, each in found if score == best)
    if best[0] < 1:
        probability = LIKELY
    names = {each.room for each in choices}
    if len(names) > 1:
        return Understood("several", level=level, choices=choices)
    where = {each.level for each in choices}
    return Understood("room", choices[0].room, where.pop() if len(where) == 1 else level,
                      choices, probability)  # fmt: skip


def _heard(said: Sequence[str], words: Lexicon) -> _Heard:
    values = values_of(said, words.numbers)
    return _Heard(
        tuple(each for each in values if not each.isdigit() and each not in words.fillers),
        tuple(each for each in values if each.isdigit()),
        frozenset(each for each in values if each in words.fillers),
    )


def _rooms(
    heard: _Heard, rooms: Sequence[Named], words: Lexicon
) -> list[tuple[tuple[float, bool, int], Named]]:
    """Return the rooms that fit all that was heard, each with how well."""
    if not heard.words and not heard.numbers:
        return []
    scored = []
    for each in rooms:
        score = _fit(heard, values_of(folded(each.room), words.numbers), words)
        if score is not None:
            scored.append((score, each))
    return scored


def _fit(heard: _Heard, name: Sequence[str], words: Lexicon) -> tuple[float, bool, int] | None:
    """Return how alike the words are, whether that is the whole name, and its fillers that fit."""
    numbers = [each for each in name if each.isdigit()]
    if heard.numbers and not _same_number(heard.numbers, numbers):
        return None
    letters = [each for each in name if not each.isdigit()]
    alike = [max((_alike(word, other) for other in letters), default=0.0) for word in heard.words]
    if any(each < ALIKE for each in alike):
        return None
    whole = len(heard.words) == sum(each not in words.fillers for each in letters)
    whole = whole and "".join(heard.numbers) == "".join(numbers)
    mean = round(sum(alike) / len(alike), 3) if alike else 1.0
    return mean, whole, len(heard.fillers & set(name))


def _same_number(said: Sequence[str], numbers: Sequence[str]) -> bool:
    """Whether numbers are those of a name: one by one, or all of both in one."""
    if "".join(said) == "".join(numbers):
        return bool(numbers)
    return all(each in numbers for each in said)


def _alike(word: str, other: str) -> float:
    if word == other:
        return 1.0
    if min(len(word), len(other)) < 4:  # short words are not misheard into others
        return 0.0
    return SequenceMatcher(None, word, other, autojunk=False).ratio()


def _level(
    said: Sequence[str], levels: Sequence[str], words: Lexicon
) -> tuple[str | None, list[str]]:
    """Return the level that is named, and the other words."""
    for at, word in enumerate(said):
        if word not in words.levels:
            continue
        for start, stop in ((at - 1, at + 1), (at, at + 2), (at, at + 1)):
            if start < 0:
                continue
            spoken = [each for each in said[start:stop] if each != word or stop - start == 1]
            found = _named_level(spoken, levels, words)
            if found is not None:
                return found, [*said[:start], *said[stop:]]
    return None, list(said)


def _named_level(spoken: Sequence[str], levels: Sequence[str], words: Lexicon) -> str | None:
    numbers = words.numbers | words.ordinals
    values = {str(numbers.get(word, word)) for word in spoken}
    for level in levels:
        name = {str(numbers.get(word, word)) for word in folded(level)} - words.levels
        if name and name == values - words.levels:
            return level
    return None
