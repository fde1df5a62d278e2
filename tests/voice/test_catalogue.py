"""Texts: each language whole, plural forms as Unicode has them, nothing unused or promised."""

import json
import re
from importlib.resources import files
from pathlib import Path
from string import Formatter

import pytest

import palms.voice
from palms.voice import languages, read_catalogue
from palms.voice.catalogue import lexicon
from palms.voice.numbers import folded
from palms.voice.plurals import categories, plural

CODE = "".join(path.read_text() for path in Path(palms.voice.__file__).parent.glob("*.py"))
CONTENT = {
    name: json.loads((files("palms.voice") / "texts" / f"{name}.json").read_text("utf-8"))
    for name in languages()
}


def placeholders(text):
    return {name for _, name, _, _ in Formatter().parse(text) if name is not None}


def forms(text):
    return text if isinstance(text, dict) else {"": text}


@pytest.mark.parametrize("name", languages())
def test_a_language_has_all_texts_with_the_placeholders_of_english(name):
    english, other = CONTENT["en"]["texts"], CONTENT[name]["texts"]
    assert set(english) == set(other)
    assert CONTENT[name]["language"] == name
    assert set(CONTENT[name]["heard"]) == set(CONTENT["en"]["heard"])
    for key, text in english.items():
        wanted = placeholders(forms(text).get("other", "")) or placeholders(
            next(iter(forms(text).values()))
        )
        for form, translated in forms(other[key]).items():
            found = placeholders(translated)
            assert found == wanted or (form == "one" and found == wanted - {"n"}), key


@pytest.mark.parametrize("name", languages())
def test_a_text_with_a_number_has_all_plural_forms_of_its_language(name):
    for key, text in CONTENT[name]["texts"].items():
        assert isinstance(text, dict) == ("{n}" in str(text)), key
        if isinstance(text, dict):
            assert set(text) == categories(name), key


def test_every_text_is_used_and_every_one_that_is_used_is_there():
    texts = CONTENT["en"]["texts"]
    literals = set(re.findall(r'"([a-z_]+(?:\.[a-z_0-9]+)*)"', CODE))
    starts = tuple(re.findall(r'f"([a-z_.]+\.)\{', CODE))
    unused = [key for key in texts if key not in literals and not key.startswith(starts)]
    assert unused == []
    said = set(re.findall(r'\.say\(\s*"([^"]+)"', CODE))
    assert said <= set(texts)


@pytest.mark.parametrize("name", languages())
def test_nothing_says_that_a_way_is_free(name):
    words = set(folded(json.dumps(CONTENT[name]["texts"], ensure_ascii=False)))
    assert not words & {"free", "clear", "safe", "safely", "frei", "sicherer", "gefahrlos"}


@pytest.mark.parametrize("name", languages())
def test_what_is_heard_is_folded_as_speech_will_be(name):
    for words in CONTENT[name]["heard"].values():
        for word in words:
            assert folded(word) == [word]


def test_a_language_falls_back_on_its_parent_then_on_english():
    assert read_catalogue("de-CH-1996").language == "de"
    assert read_catalogue("EN").language == "en"
    assert read_catalogue("xx").say("pause") == "Paused."


CLDR = {  # examples of the CLDR's own charts
    "en": {"one": [1], "other": [0, 2, 11, 21]},
    "de": {"one": [1], "other": [0, 2, 101]},
    "fr": {"one": [0, 1], "other": [2, 17, 100]},
    "ru": {"one": [1, 21, 101], "few": [2, 4, 22, 104], "many": [0, 5, 11, 14, 100, 111]},
    "pl": {"one": [1], "few": [2, 4, 22], "many": [0, 5, 12, 21, 101]},
    "cs": {"one": [1], "few": [2, 3, 4], "other": [0, 5, 22]},
    "ar": {"zero": [0], "one": [1], "two": [2], "few": [3, 10, 103], "many": [11, 99, 111],
           "other": [100, 102, 202]},
    "ja": {"other": [0, 1, 2, 100]},
}  # fmt: skip


@pytest.mark.parametrize("language", CLDR)
def test_plural_categories_are_those_of_unicode(language):
    for category, numbers in CLDR[language].items():
        assert {plural(n, language) for n in numbers} == {category}
    assert categories(language) == set(CLDR[language])


def test_words_of_all_languages_are_heard():
    assert {"fifteen", "funfzehn"} <= set(lexicon().numbers)
    assert {"floor", "etage"} <= lexicon().levels
