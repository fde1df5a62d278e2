"""Catalogue: the texts of a language, and its words for numbers."""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

from palms.voice.plurals import plural

__all__ = ["Catalogue", "Lexicon", "languages", "lexicon", "read_catalogue"]

FALLBACK = "en"


@dataclass(frozen=True)
class Catalogue:
    """The texts of a language.

    Parameters
    ----------
    language : str
        Its tag.
    name : str
        What the language calls itself.
    texts : dict
        A text for each key, or one for each plural category.

    Examples
    --------
    >>> read_catalogue("en").say("length.metres", n=1), read_catalogue("de").say("unsure")
    ('1 metre', 'Der Ort ist nicht mehr sicher. Geh weiter.')
    """

    language: str
    name: str
    texts: dict[str, str | dict[str, str]]

    def say(self, key: str, **values: object) -> str:
        """Return a text with its placeholders filled; `n` also chooses the plural."""
        text = self.texts[key]
        if isinstance(text, dict):
            number = values["n"]
            assert isinstance(number, int)
            text = text[plural(number, self.language)]
            values["n"] = self.texts.get(f"number.{number}", number) if "many" in key else number
        return text.format_map(values)


@dataclass(frozen=True)
class Lexicon:
    """The words of all languages that somebody may say where the phone is with.

    Parameters
    ----------
    numbers : dict
        Value of each word for a number, folded.
    ordinals : dict
        The same for ordinal numbers.
    fillers : frozenset of str
        Words that say nothing of which room.
    levels : frozenset of str
        Words for a floor.
    homophones : dict
        Words that sound like numbers.
    """

    numbers: dict[str, int]
    ordinals: dict[str, int]
    fillers: frozenset[str]
    levels: frozenset[str]
    homophones: dict[str, int]


@functools.cache
def languages() -> tuple[str, ...]:
    """Return the languages that there are texts in.

    Examples
    --------
    >>> languages()
    ('de', 'en')
    """
    return tuple(sorted(p.name.removesuffix(".json") for p in _folder() if p.name.endswith("json")))


def _folder() -> list[Any]:
    return list(files("palms.voice").joinpath("texts").iterdir())


@functools.cache
def _content(language: str) -> dict[str, Any]:
    path = files("palms.voice").joinpath("texts", f"{language}.json")
    content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return content


@functools.cache
def read_catalogue(language: str) -> Catalogue:
    """Return the texts of a language, of its parent, or of English where there are none.

    Examples
    --------
    >>> read_catalogue("de-AT").language, read_catalogue("tlh").language
    ('de', 'en')
    """
    wanted = language.lower()
    while wanted and wanted not in languages():
        wanted = wanted.rpartition("-")[0]
    content = _content(wanted or FALLBACK)
    return Catalogue(wanted or FALLBACK, content["name"], content["texts"])


@functools.cache
def lexicon() -> Lexicon:
    """Return the words of all languages together: what was said does not say its language.

    Examples
    --------
    >>> lexicon().numbers["fifteen"], lexicon().numbers["zwei"]
    (15, 2)
    """
    heard = [_content(language)["heard"] for language in languages()]

    def joined(name: str) -> dict[str, int]:
        return {word: value for each in heard for word, value in each[name].items()}

    def together(name: str) -> frozenset[str]:
        return frozenset(word for each in heard for word in each[name])

    return Lexicon(
        joined("numbers"), joined("ordinals"), together("fillers"), together("levels"),
        joined("homophones"),
    )  # fmt: skip
