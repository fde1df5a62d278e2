"""Two walks of the sample building, sentence by sentence."""

import json
from itertools import pairwise

import pytest

from palms.sample import sample_folder
from palms.voice.recorded import narrate
from tests.voice.refresh import FILE, PREFERENCES, recorded, simulated, told

WALKS = json.loads(FILE.read_text())


@pytest.mark.parametrize("number", range(len(PREFERENCES)))
@pytest.mark.parametrize(("name", "make"), [("recorded", recorded), ("simulated", simulated)])
def test_a_walk_is_told_as_it_was(name, make, number):
    walk = WALKS[name]
    plan = make()[0]
    assert told(walk["moments"], plan, PREFERENCES[number]) == walk["told"][number]


def test_the_golden_walks_have_all_that_is_said_on_the_way():
    lines = "\n".join(line for walk in WALKS.values() for line in walk["told"][0])
    for words in (
        "progress:",
        "oriented:",
        "localized: Found:",
        "place:",
        "o'clock",
        " or ",
    ):
        assert words in lines


def test_the_sample_is_told_from_its_files():
    assert (sample_folder() / "maps" / "sample.csv").is_file()
    heard = narrate(*recorded())
    kinds = [each.saying.kind for each in heard]
    assert kinds[0] == "scan"
    assert kinds.count("localized") == 1
    assert all(a.time_s + 5 <= b.time_s for a, b in pairwise(heard))
    assert any(each.saying.text.startswith("North corridor, near Room 25") for each in heard)
