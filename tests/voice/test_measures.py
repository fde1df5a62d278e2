"""Lengths and directions: uncertainty is never rounded down."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palms.errors import SettingsError
from palms.voice import Moment, Preferences, read_catalogue
from palms.voice.measures import accuracy_m, ahead, direction, length, rounded_up

ENGLISH = read_catalogue("en")
UNITS = {"metres": 1.0, "feet": 0.3048, "steps": 0.55}


@given(st.floats(0.01, 1e4), st.sampled_from(list(UNITS)))
def test_uncertainty_is_rounded_up_by_less_than_a_unit_or_five(length_m, units):
    preferences = Preferences(units=units, step_m=0.55)
    told = length(length_m, preferences, ENGLISH, up=True)
    number = int(told.split()[0])
    assert number * UNITS[units] >= length_m - 1e-6
    assert number * UNITS[units] == pytest.approx(rounded_up(length_m, preferences))
    assert (number - length_m / UNITS[units]) < (1 if number <= 20 else 5)


@given(st.floats(0.0, 1e3))
def test_accuracy_covers_the_disc(radius):
    assert accuracy_m(Moment("localized", radius_95_m=radius)) >= max(radius, 1.0)


def test_lengths_have_their_plurals():
    assert length(1.2, Preferences(), ENGLISH) == "1 metre"
    assert length(0.4, Preferences(), ENGLISH) is None
    assert length(33.0, Preferences(), ENGLISH) == "35 metres"
    assert length(1.0, Preferences(language="de"), read_catalogue("de")) == "1 Meter"


@given(st.floats(-math.pi, math.pi))
def test_directions_are_right_to_half_a_sector(left):
    hour = int(direction(left, Preferences(), ENGLISH).split()[0])
    assert abs(math.remainder(left + hour * math.pi / 6, 2 * math.pi)) <= math.pi / 12 + 1e-9
    words = direction(left, Preferences(directions="words"), ENGLISH)
    assert ("left" in words) <= (left > 0)
    assert ("ahead" in words) == (abs(left) <= math.radians(67.5) + 1e-9) or abs(
        abs(left) - math.radians(67.5)
    ) < 1e-6  # on the edge either is right


def test_degrees_are_told_in_thirties():
    degrees = Preferences(directions="degrees")
    told = [direction(math.radians(a), degrees, ENGLISH) for a in (5, 50, -80, 179)]
    assert told == ["straight ahead", "60 degrees left", "90 degrees right", "180 degrees left"]


@pytest.mark.parametrize("facing", [None, math.nan, math.inf])
def test_no_direction_without_a_facing(facing):
    assert ahead(Moment("localized", 0, (0, 0), 1.0, facing, 0.0), 0.0, 9.0) is None


@pytest.mark.parametrize("wrong", [{"step_m": 0}, {"every_s": 4.9}, {"every_s": math.nan}])
def test_preferences_have_their_ranges(wrong):
    with pytest.raises(SettingsError, match="Preferences"):
        Preferences(**wrong)
