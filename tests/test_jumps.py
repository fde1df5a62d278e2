"""Jumps of the odometry: nobody went there, and where somebody is stays known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palms.jumps import Pace, jumped, jumps_of
from palms.localizer import Localizer, track
from palms.odometry import Move, Odometry
from palms.particles import MoveInfo, advance
from palms.randomness import as_key
from palms.recovery import Conditions
from palms.settings import JumpSettings, Settings
from tests.test_localizer import DRIFT, PLAN, START, STEPS
from tests.test_localizer import scan as scan_at_start
from tests.test_restart import CONDITIONS, OURS, RASTER, sure
from tests.worlds import walk

JUMP = JumpSettings()
TRUTH = START + np.cumsum(STEPS, axis=0)


def with_jump(odometry, at, shift_m, turn_rad=0.0):
    """The odometry jumps during one move, and goes on in a frame turned by so much."""
    moves = odometry.displacements_m.copy()
    c, s = math.cos(turn_rad), math.sin(turn_rad)
    moves[at + 1 :] = moves[at + 1 :] @ np.array([[c, s], [-s, c]])
    moves[at] += shift_m
    return Odometry(odometry.time_s, np.cumsum(moves, axis=0))


@given(
    st.lists(st.tuples(st.floats(0.0, 4.0), st.floats(0.005, 5.0)), min_size=1, max_size=60),
    st.floats(-math.pi, math.pi),
)
def test_who_moves_as_people_do_never_jumps(legs, heading):
    pace = Pace(0.0)
    for speed, seconds in legs:
        dx, dy = (speed * seconds * f(heading) for f in (math.cos, math.sin))
        pace = pace.after(Move(0.0, dx, dy, None, seconds), JUMP)
        assert not pace.jumps


@given(st.floats(0.1, 60.0), st.floats(0.01, 1.0), st.integers(1, 40))
def test_a_jump_is_one_in_any_number_of_slices(beyond_m, lasts_s, slices):
    """The share of it that is taken for the phone's is no more than the slack and one slice."""
    length = JUMP.slack_m + JUMP.speed_m_s * lasts_s + beyond_m
    pace, believed = Pace(0.0), 0.0
    for _ in range(slices):
        pace = pace.after(Move(0.0, length / slices, 0.0, None, lasts_s / slices), JUMP)
        believed += 0.0 if pace.jumps else length / slices
    assert pace.jumps
    assert believed <= JUMP.slack_m + JUMP.speed_m_s * lasts_s + 1e-9
    assert not pace.after(Move(0.0, 0.7, 0.0, None, 0.5), JUMP).jumps  # it walks on


def test_the_velocity_is_that_before_the_jump():
    pace = Pace().after(Move(0.0, 0.6, -0.2, None, 0.5), JUMP)
    assert pace.velocity_m_s == (1.2, -0.4)
    assert pace.after(Move(0.0, 30.0, 0.0, None, 0.5), JUMP).velocity_m_s == (1.2, -0.4)
    assert pace.after(Move(0.0, 0.0, 0.0, None, 0.0), JUMP).velocity_m_s == (1.2, -0.4)
    assert pace.after(Move(0.0, 0.3, 0.0, None, 1 / 60), JUMP).velocity_m_s == (1.2, -0.4)


def test_nobody_knows_how_long_the_first_move_took():
    """A log may begin far from where the session did, at the time 0."""
    first = Odometry([0.0, 0.5, 1.0], [[6.0, 2.0], [6.6, 2.0], [26.0, 2.0]])
    assert [move.time_s for move in jumps_of(first, JUMP)] == [1.0]
    localizer = Localizer(PLAN, OURS, rng=1)
    localizer.observe(scan_at_start())
    before = localizer.estimate.position_m
    way = 2.0 * math.cos(DRIFT), -2.0 * math.sin(DRIFT)  # east on the map
    localizer.move(Move(0.0, *way))
    assert localizer.estimate.position_m - before == pytest.approx([2.0, 0.0], abs=0.3)


def test_a_new_frame_begins_anew():
    localizer = Localizer(PLAN, OURS, rng=1)
    localizer.observe(scan_at_start())
    localizer.move(Move(0.5, 0.3, 0.0))
    localizer.restart()
    size = len(localizer.belief.particles)
    localizer.move(Move(0.5, 3.0, 0.0))
    assert len(localizer.belief.particles) == size  # a jump mixes what stays with what moved


def after_jump(shift_m, duration_s=0.5, before=Pace(), conditions=CONDITIONS):  # noqa: B008
    belief, key = sure(), as_key(5)
    move = Move(1.0, *shift_m, None, duration_s)
    gone = advance(
        belief.particles, move, RASTER, OURS.motion, key.child(1), OURS.resampling
    )  # fmt: skip
    return belief, jumped(belief, gone, duration_s, before, conditions, key)


def test_most_of_the_belief_walks_on_as_before_and_through_no_wall():
    velocity = (0.9, 0.0)
    before, after = after_jump((20.0, 0.0), before=Pace(0.0, False, velocity))
    p, drift = after.particles, 0.7
    ahead = before.particles.mean_m() + 0.45 * np.array([math.cos(drift), math.sin(drift)])
    near = np.linalg.norm(p.position_m - ahead, axis=1) < 1.5
    assert p.weight[near].sum() > 0.95
    mean = (p.weight[near] @ p.position_m[near]) / p.weight[near].sum()
    assert mean == pytest.approx(ahead, abs=0.1)
    assert p.weight.sum() == pytest.approx(1.0)
    cells = RASTER.grid.cell_of(p.position_m[near])
    assert RASTER.inside[tuple(cells.T)].all()
    assert after.doubt >= OURS.declaration.doubt_at_start


def test_the_frame_may_have_turned_but_once():
    first = after_jump((20.0, 0.0))[1].particles
    sliced = after_jump((20.0, 0.0), before=Pace(1.0, True))[1].particles
    turned = np.abs(first.drift_rad - 0.7) > 0.05
    expected = JUMP.turned_share * math.erfc(0.05 / JUMP.turn_rad / math.sqrt(2))
    assert first.weight[turned].sum() == pytest.approx(expected, abs=0.05)
    assert sliced.weight[np.abs(sliced.drift_rad - 0.7) > 0.05].sum() < 0.05


def test_somebody_may_be_that_fast_unless_walls_object():
    belief, key = sure(), as_key(5)
    conditions = Conditions(RASTER, OURS, False)
    share = []
    for evidence in (0.0, -3.5):
        there = np.tile([17.0, 9.5], (len(belief.particles), 1))
        moved = replace(belief.particles, position_m=there)
        gone = (moved, MoveInfo(0, len(moved), float(len(moved)), evidence))
        p = jumped(belief, gone, 0.5, Pace(), conditions, key).particles
        share.append(p.weight[p.position_m[:, 0] > 15.0].sum())
    assert share[0] == pytest.approx(JUMP.real_share)
    assert share[1] < 0.01


@pytest.mark.parametrize("turn_rad", [0.0, 0.2])
@pytest.mark.parametrize("way", [0.3, 2.4, -1.9])
def test_where_it_is_stays_known(way, turn_rad):
    at = 30
    shift = 20.0 * np.array([math.cos(way), math.sin(way)])
    odometry = with_jump(walk(STEPS, DRIFT), at, shift, turn_rad)
    found = track(PLAN, scan_at_start(), odometry, OURS, rng=2)
    error = np.linalg.norm(found.position_m - TRUTH, axis=1)
    assert found.estimates[at - 1].is_localized
    assert error[at:].max() < 2.0
    assert all(each.p_within_2m > 0.5 for each in found.estimates[at:])
    assert [move.time_s for move in jumps_of(odometry, JUMP)] == [odometry.time_s[at]]


def test_a_jump_in_slices_takes_no_more_than_the_slack_along():
    """Fifteen metres in half a second, at sixty samples a second."""
    localizer = Localizer(PLAN, OURS, rng=2)
    localizer.observe(scan_at_start())
    for move in walk(STEPS[:30], DRIFT).moves():
        localizer.move(move)
    assert localizer.estimate.is_localized
    before, time_s = localizer.estimate.position_m, localizer.estimate.time_s
    for k in range(1, 31):
        localizer.move(Move(time_s + k / 60, 0.3, -0.4))
    assert np.linalg.norm(localizer.estimate.position_m - before) < JUMP.slack_m + 0.7
    assert localizer.estimate.p_within_2m > 0.5


def test_the_heading_is_that_of_the_last_move_of_the_phone():
    localizer = Localizer(PLAN, OURS, rng=1)
    localizer.observe(scan_at_start())
    localizer.move(Move(0.5, 0.6, 0.0))
    before = localizer.estimate.heading_rad
    jumping = localizer.move(Move(1.0, 0.0, -25.0)).heading_rad
    assert abs(math.remainder(jumping - before, 2 * math.pi)) < 0.2


@pytest.mark.parametrize("method", ["paper", "authors", "uniform"])
def test_other_methods_take_it_as_it_comes(method):
    settings = Settings.for_method(method).with_particles(300)
    unaware = replace(settings, jump=JumpSettings(speed_m_s=1e9))
    odometry = with_jump(walk(STEPS, DRIFT), 20, (8.0, 3.0))
    one, other = (track(PLAN, scan_at_start(), odometry, s, rng=1) for s in (settings, unaware))
    assert np.array_equal(one.position_m, other.position_m, equal_nan=True)
