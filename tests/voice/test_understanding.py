"""Free words: rooms by name and number, however they are said; what is not sure is asked back."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palms.voice import Named, understand
from palms.voice.catalogue import lexicon
from palms.voice.numbers import folded, values_of

NAMES = (
    "South corridor", "North corridor", "East corridor", "Room 201", "Room 215", "Room 251",
    "Lobby", "Lab 230", "Lab 231", "Kitchen", "Kitchen 2", "Room 2", "Room A12", "2.07 Büro", "WC",
)  # fmt: skip
ROOMS = [*(Named("2", name) for name in NAMES), Named("3", "Room 315"), Named("3", "WC")]


def heard(text):
    return understand(text, ROOMS, ["2", "3"])


@pytest.mark.parametrize(
    ("text", "room"),
    [
        ("room 215", "Room 215"), ("two fifteen", "Room 215"), ("215!!!", "Room 215"),
        ("I'm near room two hundred and fifteen", "Room 215"), ("2 1 5", "Room 215"),
        ("two oh one", "Room 201"), ("to fifteen", "Room 215"),
        ("the east coridor", "East corridor"),
        ("kitchen", "Kitchen"), ("kitchen two", "Kitchen 2"), ("two", "Room 2"),
        ("lab two thirty one", "Lab 231"), ("a twelve", "Room A12"), ("lobby, please", "Lobby"),
        ("zwei punkt null sieben", "2.07 Büro"), ("das BÜRO", "2.07 Büro"),
        ("ich stehe vor Raum zweihundertfünfzehn", "Room 215"), ("zwei einundfünfzig", "Room 251"),
        ("room 315 on level three", "Room 315"), ("wc", "WC"),
    ],
)  # fmt: skip
def test_a_room_is_understood(text, room):
    found = heard(text)
    assert (found.kind, found.room) == ("room", room)


def test_a_level_is_understood_alone_and_beside_a_room():
    assert [heard(text).level for text in ("second floor", "Level 3", "zweiter Stock")] == [
        "2", "3", "2",
    ]  # fmt: skip
    assert heard("third floor").kind == "level"
    assert heard("level 3, the WC") == understand("wc", ROOMS[-1:], ["2", "3"])
    assert heard("wc").level is None  # on both
    assert heard("room 315 on level 2").kind == "none"


def test_what_several_rooms_fit_is_asked_back():
    assert [each.room for each in heard("corridor").choices] == list(NAMES[:3])
    assert heard("the lab").kind == "several"


@pytest.mark.parametrize("text", ["the moon", "", "room", "room 216", "!?", "0", "\x00" * 200])
def test_what_is_not_there_is_not_found(text):
    assert heard(text).kind == "none"


def test_what_was_guessed_counts_less():
    assert heard("kitschen").probability < heard("kitchen").probability
    assert heard("to fifteen").probability < heard("two fifteen").probability


ENGLISH = """one two three four five six seven eight nine ten eleven twelve thirteen fourteen
fifteen sixteen seventeen eighteen nineteen twenty thirty forty fifty sixty seventy eighty ninety"""
GERMAN = """ein zwei drei vier fünf sechs sieben acht neun zehn elf zwölf dreizehn vierzehn
fünfzehn sechzehn siebzehn achtzehn neunzehn zwanzig dreißig vierzig fünfzig sechzig siebzig
achtzig neunzig"""
ONES, TENS = ENGLISH.split()[:19], ENGLISH.split()[19:]
EINS, ZIGS = GERMAN.split()[:19], GERMAN.split()[19:]


def english(n):
    if n >= 1000:
        return f"{english(n // 1000)} thousand {english(n % 1000)}".strip()
    if n >= 100:
        return f"{ONES[n // 100 - 1]} hundred {english(n % 100)}".strip()
    if n >= 20:
        return f"{TENS[n // 10 - 2]}-{english(n % 10)}".strip("-")
    return ONES[n - 1] if n else ""


def german(n):
    if n >= 1000:
        return f"{german(n // 1000)}tausend{german(n % 1000)}"
    if n >= 100:
        return f"{EINS[n // 100 - 1]}hundert{german(n % 100)}"
    if n >= 20:
        return (f"{EINS[n % 10 - 1]}und" if n % 10 else "") + ZIGS[n // 10 - 2]
    return EINS[n - 1] if n else ""


@pytest.mark.parametrize("spell", [english, german])
def test_all_numbers_are_heard_as_they_are_spelled(spell):
    for n in (*range(1, 1000), 1001, 1015, 1200, 2105, 9999):
        assert values_of(folded(spell(n)), lexicon().numbers) == [str(n)], spell(n)


@given(st.lists(st.sampled_from(NAMES), min_size=1, unique=True))
def test_each_room_is_understood_by_its_own_name(names):
    rooms = [Named("2", name) for name in names]
    for name in names:
        found = understand(name, rooms, ["2"])
        assert (found.kind, found.room) == ("room", name)


@given(st.text(max_size=60), st.lists(st.text(max_size=12), max_size=5))
def test_whatever_is_said_of_whatever_rooms_is_answered(text, names):
    rooms = [Named("1", name) for name in names]
    found = understand(text, rooms, ["1"])
    assert {each.room for each in found.choices} <= set(names)
    assert found.room is None or found.room in names
    assert 0 < found.probability < 1
