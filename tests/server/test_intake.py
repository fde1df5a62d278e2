"""Clocks, late samples, frames."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palms.errors import InputError
from palms.server.intake import Intake, clocked, ground_pose, taken
from palms.server.messages import Pose, Sample


def fed(samples, intake=None):
    intake, moves = intake or Intake(), []
    for sample in samples:
        intake, move = taken(intake, sample)
        moves += [] if move is None else [move]
    return intake, moves


def at(t_s, x=0.0, y=0.0):
    return Sample(t_s=t_s, position_m=(x, y))


def by(t_s, dx=0.0, dy=0.0):
    return Sample(t_s=t_s, displacement_m=(dx, dy))


@given(st.floats(-1e10, 1e10), st.lists(st.floats(0.05, 2.0), min_size=1, max_size=20))
def test_the_phones_clock_may_show_any_time(start_s, steps_s):
    times = np.concatenate([[0.0], np.cumsum(steps_s)])
    _, moves = fed([at(start_s + t, 0.1 * i) for i, t in enumerate(times.tolist())])
    assert [move.time_s for move in moves] == pytest.approx(times[1:], abs=1e-4)


@pytest.mark.parametrize("jump_s", [-500.0, 1e6, -1e9])
def test_a_clock_that_is_set_stops_nothing(jump_s):
    before = [at(10.0 + 0.5 * i, 0.3 * i) for i in range(6)]
    after = [at(10.0 + 0.5 * i + jump_s, 0.3 * i) for i in range(6, 12)]
    intake, moves = fed([*before, *after])
    times = [move.time_s for move in moves]
    assert times == sorted(times)
    assert times[-1] < 10
    assert intake.walked_m == pytest.approx(3.3)


def test_late_positions_are_left_out_and_late_displacements_are_added_later():
    _, moves = fed([at(0.0), at(1.0, 1.0), at(0.5, 0.4), at(2.0, 2.0)])
    assert [(m.time_s, m.dx_m) for m in moves] == [(1.0, 1.0), (2.0, 1.0)]
    intake, moves = fed([by(0.0, 0.1), by(1.0, 1.0), by(0.5, 0.25), by(2.0, 1.0)])
    assert sum(m.dx_m for m in moves) == pytest.approx(2.35)
    assert intake.n_late == 1


def test_positions_and_displacements_tell_the_same():
    places = np.random.default_rng(1).normal(0, 0.5, (30, 2)).cumsum(axis=0)
    _, one = fed([at(i, *p) for i, p in enumerate(places.tolist())])
    moves = np.diff(places, axis=0).tolist()
    _, other = fed([by(i, *m) for i, m in enumerate(moves, 1)], Intake(offset_s=0.0))
    assert np.allclose([m[1:3] for m in one], [m[1:3] for m in other])


def test_a_jump_of_the_frame_is_no_move():
    intake, moves = fed([at(0.0), at(1.0, 1.0), at(2.0, 5000.0), at(3.0, 5001.0)])
    assert [m.dx_m for m in moves] == [1.0, 1.0]
    assert intake.position_m == (5001.0, 0.0)


def test_the_same_time_again_is_late():
    intake, moves = fed([at(0.0), at(1.0, 1.0), at(1.0, 1.5), at(2.0, 2.0)])
    assert (len(moves), intake.n_late) == (2, 1)


@given(st.floats(-math.pi, math.pi), st.floats(-0.9, 0.9), st.floats(-0.5, 0.5))
def test_facing_is_the_camera_s_whatever_its_tilt_and_roll(yaw, pitch, roll):
    def turn(axis, angle):
        half = np.array(axis) * math.sin(angle / 2)
        return np.array([*half, math.cos(angle / 2)])

    def times(a, b):
        v = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
        return np.array([*v, a[3] * b[3] - a[:3] @ b[:3]])

    q = times(times(turn([0, 1, 0], yaw), turn([1, 0, 0], pitch)), turn([0, 0, 1], roll))
    ground = ground_pose(Pose(position=(1.0, 9.0, 2.0), orientation=tuple(q.tolist())))
    assert ground.position_m == (1.0, -2.0)
    off = (ground.facing_rad - (math.pi / 2 + yaw) + math.pi) % (2 * math.pi) - math.pi
    assert abs(off) < 1e-6


def test_a_matrix_says_what_position_and_quaternion_say():
    half = math.sqrt(0.5)
    pose = Pose(position=(3.0, 1.0, -4.0), orientation=(0.0, half, 0.0, half))
    matrix = [0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 3, 1, -4, 1]
    one, other = ground_pose(pose), ground_pose(Pose(matrix=tuple(map(float, matrix))))
    assert one.position_m == other.position_m == (3.0, 4.0)
    assert math.cos(one.facing_rad - other.facing_rad) == pytest.approx(1)


def test_who_looks_down_faces_nowhere_and_a_matrix_that_is_none_is_refused():
    half = math.sqrt(0.5)
    assert ground_pose(Pose(position=(0, 0, 0), orientation=(-half, 0, 0, half))).facing_rad is None
    with pytest.raises(InputError):
        ground_pose(Pose(matrix=(1.0,) * 16))
    assert clocked(Intake(), 5.0).offset_s == 5.0
