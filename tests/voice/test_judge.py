"""The judge of the benchmark: true sentences pass, each kind of false one is found."""

import pytest

from benchmarks.voice.__main__ import table
from benchmarks.voice.judge import Judge, Truth
from benchmarks.voice.walks import Sentence, Walk
from palms.voice import Saying, Surroundings
from tests.voice.places import at, corridor, voice

JUDGE = Judge(Surroundings([corridor()]))
HERE = Truth(4.9, 1.0, 0.0, 0.3)


def judged(text, details="Accurate to 2 metres.", truth=HERE):
    return JUDGE.judge(Saying("place", text, details), truth)


@pytest.mark.parametrize("x", [1.0, 4.9, 8.0, 15.0, 24.0])
@pytest.mark.parametrize("y", [1.0, 2.1, 4.0])
@pytest.mark.parametrize("radius", [0.5, 1.0, 2.5, 4.0, 9.0])
def test_what_is_said_of_the_truth_is_true(x, y, radius):
    placed = voice().placed(at(x, y, radius))
    text = placed.text[:1].upper() + placed.text[1:] + "."
    verdict = judged(text, placed.details, Truth(x, y, 0.0, 0.0))
    assert verdict.wrong == ()
    assert verdict.is_sure
    assert not verdict.names_other_room


@pytest.mark.parametrize(
    ("text", "details", "wrong"),
    [
        ("Lab.", "Accurate to 2 metres.", ("place",)),
        ("Lab or room 217.", "Accurate to 1 metre.", ("place",)),
        ("Found again: probably somewhere in Lab.", "Accurate to 7 metres.", ("place",)),
        ("Within 9 metres of Lab.", "Accurate to 7 metres.", ("place",)),
        ("East corridor, near Lab.", "Accurate to 2 metres.", ("place",)),
        ("Near Room 215.", "Room 215: 8 metres. Accurate to 2 metres.", ("distance",)),
        ("Near Room 215.", "Room 215: right here. Accurate to 1 metre.", ("distance",)),
        ("Near Room 215.", "Room 215: 3 metres, 10 o'clock. Accurate to 2 metres.", ("direction",)),
        ("Near Room 215.", "Room 215: 3 metres, 7 o'clock. Accurate to 2 metres.", ()),
        ("Near Room 215.", "Room 215: 3 metres, 6 o'clock. Accurate to 2 metres.", ()),
    ],
)
def test_a_false_claim_is_found(text, details, wrong):
    assert judged(text, details).wrong == wrong


def test_an_answer_that_is_farther_off_than_it_says_is_false():
    assert judged("East corridor.", truth=HERE._replace(error_m=2.1)).wrong == ("accuracy",)


def test_a_wall_between_is_noted_and_probably_is_heard():
    assert judged("Room 215.").names_other_room
    assert not judged("Probably East corridor.").is_sure
    assert not judged("Found: probably East corridor.").is_sure


def test_the_table_counts_what_was_false():
    sentences = tuple(
        Sentence(seed, 1.0, 9.0, Saying("place", text, "Accurate to 2 metres."), judged(text), 0.3)
        for seed, text in [(1, "Lab."), (1, "East corridor."), (2, "Probably Lab.")]
    )
    walks = [Walk(1, 50.0, sentences[:2]), Walk(2, 50.0, sentences[2:]), Walk(3, 40.0, ())]
    text = table(walks)
    assert '| **said without "probably"; of these false** | 2; **1** |' in text
    assert '| said with "probably"; of these false | 1; 1 |' in text
    assert "| walks with a false sentence | 2 |" in text
    assert '| walks that are told a place; without "probably" | 2; 1 |' in text
