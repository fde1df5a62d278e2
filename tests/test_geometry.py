import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.errors import InputError
from palms.geometry import (
    check_finite,
    check_points,
    check_segments,
    circular_mean,
    distance_to_segments,
    rotate,
    wrap_angle,
)

angles = st.floats(-50, 50)


@settings(derandomize=True, deadline=None)
@given(angles)
def test_wrapped_angles_lie_in_the_half_open_circle_and_point_the_same_way(angle):
    wrapped = wrap_angle(angle)
    assert -np.pi < wrapped <= np.pi
    assert np.exp(1j * wrapped) == pytest.approx(np.exp(1j * angle), abs=1e-9)
    assert wrapped == wrap_angle([angle])[0]


def test_pi_stays_pi_and_minus_pi_becomes_pi():
    assert wrap_angle(np.pi) == wrap_angle(-np.pi) == np.pi


@settings(derandomize=True, deadline=None)
@given(angles, st.floats(-9, 9), st.floats(-9, 9))
def test_turning_there_and_back(angle, x, y):
    assert rotate(rotate([x, y], angle), -angle) == pytest.approx([x, y], abs=1e-9)


def test_turning_is_counter_clockwise():
    assert rotate([[1.0, 0.0]], np.pi / 2) == pytest.approx(np.array([[0.0, 1.0]]))


@pytest.mark.parametrize(
    ("value", "word"),
    [
        ([[1, 2, 3]], "shape"),
        ([[1, 2], [3]], "numbers"),
        ("walls", "shape (N, 2)"),
        ([[1, np.nan]], "NaN"),
        ([[1, np.inf]], "NaN or infinity in row 0"),
    ],
)
def test_bad_points_are_refused_in_one_line(value, word):
    with pytest.raises(InputError, match="points: expected") as caught:
        check_points(value)
    assert word in str(caught.value)
    assert "\n" not in str(caught.value)


def test_single_numbers_are_checked_too():
    for bad in (np.nan, 10**400):
        with pytest.raises(InputError, match="time"):
            check_finite(bad, "time", ())


def test_checked_values_are_copies_that_cannot_be_written_to():
    mine = np.zeros((3, 2, 2))
    checked = check_segments(mine)
    mine[:] = 5
    assert not checked.any()
    with pytest.raises(ValueError, match="read-only"):
        checked[0] = 1


def test_empty_lists_have_the_shape_asked_for():
    assert check_finite([], "points", (None, 2)).shape == (0, 2)


def test_distance_to_ends_and_middles_of_segments():
    walls = np.array([[[0.0, 0], [4, 0]], [[0, 0], [0, 0]]])
    assert distance_to_segments([7.0, 4.0], walls) == pytest.approx([5.0, np.hypot(7, 4)])


def test_the_mean_of_angles_crosses_the_cut():
    mean = circular_mean(np.array([np.pi - 0.2, -np.pi + 0.1]), np.ones(2))
    assert mean == pytest.approx(np.pi - 0.05)
