"""Spoken numbers: "two fifteen", "two hundred fifteen" and "two one five" are all 215."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence

__all__ = ["folded", "spelled", "values_of"]

_PARTS = re.compile(r"[a-z]+|\d+")


def folded(text: str) -> list[str]:
    """Return the words of a text without case, accents and signs, letters and digits apart.

    Examples
    --------
    >>> folded("Büro A215, 2nd floor"), folded("Raum 2.15")
    (['buro', 'a', '215', '2nd', 'floor'], ['raum', '2', '15'])
    """
    plain = unicodedata.normalize("NFKD", text.casefold())
    plain = "".join(each for each in plain if not unicodedata.combining(each))
    words = re.findall(r"\d+(?:st|nd|rd|th)\b|[^\W\d_]+|\d+", plain.replace("'", " "))
    return [word for word in words if word]


def spelled(word: str, numbers: Mapping[str, int]) -> list[str]:
    """Return the words for numbers that a compound is made of; the word alone when it is none.

    Examples
    --------
    >>> numbers = {"zwei": 2, "ein": 1, "hundert": 100, "funf": 5, "zwanzig": 20}
    >>> spelled("zweihundertfunfundzwanzig", numbers), spelled("einsam", numbers)
    (['zwei', 'hundert', 'funf', 'und', 'zwanzig'], ['einsam'])
    """
    known = sorted([*numbers, "und"], key=len, reverse=True)
    parts: list[str] = []
    rest = word
    while rest:
        first = next((each for each in known if rest.startswith(each)), None)
        if first is None:
            return [word]
        parts.append(first)
        rest = rest[len(first) :]
    return parts if parts[-1] != "und" and parts[0] != "und" else [word]


def values_of(words: Sequence[str], numbers: Mapping[str, int]) -> list[str]:
    """Return words with their numbers as digits; numbers side by side stay apart.

    Parameters
    ----------
    words : sequence of str
        Folded.
    numbers : mapping of str to int

    Examples
    --------
    >>> numbers = {"two": 2, "fifteen": 15, "hundred": 100, "oh": 0, "five": 5, "and": -1}
    >>> del numbers["and"]
    >>> values_of("lab two hundred and fifteen".split(), numbers)
    ['lab', '215']
    >>> values_of("two oh five".split(), numbers), values_of("two fifteen".split(), numbers)
    (['2', '0', '5'], ['2', '15'])
    """
    parts = [part for word in words for part in spelled(word, numbers)]
    found: list[str] = []
    at = 0
    while at < len(parts):
        value, used = _cardinal(parts[at:], numbers)
        found.append(parts[at] if used == 0 else str(value))
        at += max(used, 1)
    return found


def _cardinal(parts: Sequence[str], numbers: Mapping[str, int]) -> tuple[int, int]:
    """Return the number that words begin with, and how many words that takes; 0 for none."""
    value, used, last = 0, 0, 10_000
    at = 0
    while at < len(parts):
        word = parts[at]
        if word in ("and", "und") and used and at + 1 < len(parts):
            following = numbers.get(parts[at + 1], -1)
            if word == "und" and 0 < value % 100 < 10 and 20 <= following < 100:
                return value + following, at + 2
            if last < 100 or not 0 < following < 100:
                break
            at += 1
            continue
        number = numbers.get(word)
        if number is None or not _follows(number, last, used):
            break
        value = value - value % 1000 + max(value % 1000, 1) * number if number >= 100 else (
            value + number
        )  # fmt: skip
        last, at, used = number, at + 1, at + 1
    return value, used


def _follows(number: int, last: int, used: int) -> bool:
    """Whether a word belongs to the same number as the one before it."""
    if not used:
        return True
    if number >= 100:
        return last < 100 or (number == 1000 and last == 100)
    if last >= 100:
        return number > 0
    return 20 <= last < 100 and 0 < number < 10
