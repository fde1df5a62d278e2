"""Places in words: a room, two, or a part of the building; directions only where known."""

import math

import pytest

from palms.floorplan import FloorPlan, Room
from palms.voice import Surroundings, Voice
from tests.voice.places import at, voice


def told(moment, *levels, **preferences):
    placed = voice(*levels, **preferences).placed(moment)
    return placed.text, placed.details


def test_the_sentences_of_the_issue():
    assert told(at(4.9, 1.0, facing_rad=math.pi)) == (
        "East corridor, near Room 215", "Room 215: 3 metres, 1 o'clock. Accurate to 2 metres.",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("moment", "text"),
    [
        (at(2.5, 4.0), "Room 215"),
        (at(7.5, 4.0), "room 217"),
        (at(7.5, 2.1), "217 or East corridor"),
        (at(15.0, 4.0), "a place that the plan has no name for"),
        (at(15.0, 1.0), "East corridor"),
        (at(11.0, 4.0), "near room 217"),
        (at(4.0, 1.0, 3.5), "within 7 metres of East corridor"),
        (at(25.0, 4.0, 3.9), "East corridor or Lab"),
        (at(25.0, 6.0, 3.5), "somewhere in Lab"),
        (at(15.0, 50.0, 9.0), "a place that the plan has no name for"),
    ],
)
def test_rooms_corridors_and_parts(moment, text):
    found, _ = told(moment)
    assert found == text.replace("217 or", "room 217 or")


@pytest.mark.parametrize(
    "moment",
    [
        at(4.9, 1.0, facing_rad=None), at(4.9, 1.0, spread_rad=None),
        at(4.9, 1.0, spread_rad=math.radians(8)), at(4.9, 1.0, 1.5),
    ],
)  # fmt: skip
def test_a_direction_is_told_only_where_facing_and_place_allow_it(moment):
    _, details = told(moment)
    assert "o'clock" not in details
    assert "metres" in details


def test_a_wide_radius_has_no_direction():
    assert told(at(15.0, 1.0, 4.0))[1] == "Accurate to 8 metres."


@pytest.mark.parametrize(
    ("preferences", "details"),
    [
        ({"units": "feet"}, "Room 215: 9 feet, 1 o'clock. Accurate to 6 feet."),
        ({"units": "steps", "step_m": 0.5}, "Room 215: 5 steps, 1 o'clock. Accurate to 4 steps."),
        ({"directions": "degrees"}, "Room 215: 3 metres, 30 degrees right. Accurate to 2 metres."),
        ({"directions": "words"}, "Room 215: 3 metres, ahead on the right. Accurate to 2 metres."),
        ({"language": "de"}, "Room 215: 3 Meter, 1 Uhr. Auf 2 Meter genau."),
    ],
)
def test_units_directions_and_languages(preferences, details):
    assert told(at(4.9, 1.0, facing_rad=math.pi), **preferences)[1] == details


def test_levels_are_told_where_there_are_several():
    assert told(at(2.5, 4.0, level="2"), "1", "2")[0] == "level 2, Room 215"
    assert told(at(2.5, 4.0, level="Upper floor"), "1", "Upper floor")[0].startswith("Upper floor,")
    assert told(at(2.5, 4.0, level="2"))[0] == "Room 215"


def test_what_is_not_sure_is_said_to_be_probable():
    speaks = voice()
    assert speaks.placed(at(2.5, 4.0), is_sure=False).text == "probably Room 215"
    assert speaks.around(at(2.5, 4.0), is_sure=False).startswith("Probably")


def test_what_is_around_is_told_nearest_first():
    assert voice().around(at(4.9, 1.0)) == (
        "Room 215: 3 metres, 7 o'clock. Room 217: 3 metres, 11 o'clock. Accurate to 2 metres."
    )
    assert voice().around(at(4.9, 1.0, 4.0)).startswith("Within 8 metres")
    assert voice().around(at(15.0, 40.0)) == (
        "Nothing with a name is near. Accurate to 2 metres."
    )  # fmt: skip


def test_names_are_one_line_that_can_be_spoken():
    rooms = (Room("Hall\n\x1b[31m\u202e A", [[0, 0], [9, 0], [9, 9], [0, 9]]),)
    around = Surroundings.of(FloorPlan([[[0, 0], [9, 0]]], rooms=rooms))
    assert Voice(around).placed(at(4.0, 4.0)).text == "Hall [31m A"
    assert around.rooms[0].room == rooms[0].name


def test_a_plan_without_rooms_is_spoken_of():
    speaks = Voice(Surroundings.of(FloorPlan([[[0, 0], [9, 0]]])))
    placed = speaks.placed(at(4.0, 4.0))
    assert placed.text == "a place that the plan has no name for"
    assert placed.details == "Accurate to 2 metres."
