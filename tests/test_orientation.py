import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import gaussian_filter1d

from palms.geometry import rotate, wrap_angle
from palms.orientation import (
    _smoothed,
    candidate_drifts,
    principal_orientation,
    smallest_alignment,
)
from tests.worlds import L_ROOM, two_rooms

QUARTER = np.pi / 2


def fold(angle):
    return (angle + QUARTER / 2) % QUARTER - QUARTER / 2


@settings(derandomize=True, deadline=None)
@given(st.floats(-7, 7))
def test_turning_the_walls_turns_their_orientation(angle):
    walls = two_rooms().segments_m
    turned = principal_orientation(rotate(walls, angle))
    assert fold(turned - principal_orientation(walls) - angle) == pytest.approx(0, abs=1e-6)


def test_noise_and_a_few_slanted_walls_do_not_matter():
    rng = np.random.default_rng(0)
    walls = np.concatenate([L_ROOM] * 3) + rng.normal(0, 0.03, (18, 2, 2))
    slanted = [[[0, 0], [1.5, 1.5]], [[2, 0], [3, 1]]]
    found = principal_orientation(rotate(np.concatenate([walls, slanted]), 0.3))
    assert found == pytest.approx(0.3, abs=np.radians(0.5))


@settings(derandomize=True, deadline=None)
@given(st.floats(-9, 9), st.floats(-9, 9))
def test_theta_is_the_smallest_angle_that_aligns(a, b):
    theta = smallest_alignment(a, b)
    assert -QUARTER / 2 <= theta < QUARTER / 2
    assert fold(a + theta - b) == pytest.approx(0, abs=1e-9)


def test_the_four_drifts_are_quarter_turns_apart():
    drifts = candidate_drifts(0.2)
    assert len(drifts) == 4
    assert wrap_angle(np.diff(drifts)) == pytest.approx(QUARTER)
    assert (np.abs(drifts) <= np.pi).all()
    assert len(candidate_drifts(0.0, 72)) == 72


@pytest.mark.parametrize(("n", "sd"), [(90, 2.0), (30, 0.6), (17, 3.3)])
def test_values_around_a_circle_are_blurred_as_by_a_library(n, sd):
    values = np.random.default_rng(n).random(n)
    expected = gaussian_filter1d(values, sd, mode="wrap")
    np.testing.assert_allclose(_smoothed(values, sd), expected, rtol=1e-13)
