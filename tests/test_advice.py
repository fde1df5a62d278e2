"""How much one scan tells: what it has seen, and how many places are left."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from palms import FloorPlan, Settings, locate
from palms.advice import LEAST_GAP_RAD, advise, view_of
from palms.geometry import distance_to_segments
from palms.scan import Scan
from tests.worlds import L_ROOM, closed

ROOM = closed([[0, 0], [6, 0], [6, 4], [0, 4]])
HERE = np.array([2.0, 1.0])


def test_a_whole_room_is_seen_all_round():
    view = view_of(Scan(ROOM - HERE))
    assert (view.n_walls, view.one_way, view.gaps, view.unseen) == (4, False, (), 0)


def test_what_was_not_looked_at_is_a_gap():
    view = view_of(Scan(ROOM[:2] - HERE))  # below and on the right
    (gap,) = view.gaps
    unseen = math.radians(360) - (math.atan2(3, 4) - math.atan2(-1, -2))
    assert gap.width_rad == pytest.approx(unseen, abs=math.radians(8))
    assert gap.middle_rad == pytest.approx(math.radians(120), abs=math.radians(15))


def test_walls_that_run_one_way_are_known_as_such():
    walls = np.array([[[0, 0], [9, 0]], [[0, 2], [9, 2.2]], [[3, 0], [3, 0.2]]]) - (4.0, 1.0)
    assert view_of(Scan(walls)).one_way
    assert not view_of(Scan(L_ROOM - HERE)).one_way


def test_coverage_counts_as_seen_where_it_is_a_number():
    wall = np.array([[[2.0, -2.0], [2.0, 2.0]]])
    half = np.where(np.arange(36) < 18, 3.0, np.nan)
    assert view_of(Scan(wall)).unseen == pytest.approx(0.75, abs=0.03)
    assert view_of(Scan(wall, coverage_m=half)).unseen == pytest.approx(0.375, abs=0.03)
    assert view_of(Scan(wall, coverage_m=np.full(36, 3.0))).gaps == ()


WALLS = arrays(np.float64, st.tuples(st.integers(1, 6), st.just(2), st.just(2)),
               elements=st.floats(-7, 7).map(lambda v: round(v, 2)))  # fmt: skip


@given(WALLS, st.integers(-35, 35))
def test_gaps_turn_with_the_scan_and_fill_no_more_than_the_circle(walls, turn):
    long = np.linalg.norm(walls[:, 1] - walls[:, 0], axis=1) > 0.2
    away = distance_to_segments(np.zeros(2), walls).min()
    if not long.any() or away < 0.5:
        return  # a wall through the observation point is seen from no side
    view = view_of(Scan(walls))
    assert 0 <= view.unseen <= 1 + 1e-9
    assert all(gap.width_rad >= LEAST_GAP_RAD - 1e-9 for gap in view.gaps)
    c, s = math.cos(math.radians(5 * turn)), math.sin(math.radians(5 * turn))
    turned = view_of(Scan(walls @ np.array([[c, s], [-s, c]])))
    assert abs(turned.unseen - view.unseen) <= 0.1 * (1 + len(view.gaps))  # bins at the edges


def test_places_that_look_alike_are_counted():
    scan = Scan(ROOM - HERE)
    assert advise(scan, locate(FloorPlan(ROOM), scan)).n_places == 2  # and turned by half a turn
    odd = Scan(L_ROOM - HERE)
    one = advise(odd, locate(FloorPlan(L_ROOM), odd))
    assert one.n_places == 1
    assert 0.8 < one.mass <= 1


def test_the_papers_candidates_are_counted_too():
    scan = Scan(L_ROOM - HERE)
    advice = advise(scan, locate(FloorPlan(L_ROOM), scan, Settings.paper()))
    assert advice.n_places >= 1
    assert advice.mass == pytest.approx(1)
