from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

from palms.errors import InputError, PalmsWarning, SettingsError
from palms.geometry import rotate
from palms.inertial import InertialLog, InertialSettings, dead_reckon, find_steps, step_lengths_m
from tests.inertial.walker import Phone, corners, sense

HELD = {
    "before the chest": Phone(),
    "flat in the hand": Phone(tilt_deg=0.0),
    "upright, as for a photograph": Phone(tilt_deg=90.0),
    "landscape": Phone(tilt_deg=20.0, roll_deg=90.0),
    "screen to the thigh": Phone(tilt_deg=-80.0, sway_deg=5.0),
    "at 200 Hz": Phone(rate_hz=200.0),
    "at 50 Hz": Phone(rate_hz=50.0),
}


def end_error(walk, sensed) -> float:
    """Share of the distance by which the end is off, its rotation fitted to all steps."""
    time = np.concatenate([[0.0], walk.time_s])
    path = np.concatenate([[[0.0, 0.0]], walk.position_m])
    found = np.column_stack([np.interp(sensed.step_s, time, path[:, k]) for k in (0, 1)])
    cross = found[:, 0] * sensed.step_m[:, 1] - found[:, 1] * sensed.step_m[:, 0]
    turned = rotate(found, np.arctan2(cross.sum(), (found * sensed.step_m).sum()))
    distance = np.linalg.norm(np.diff(sensed.step_m, axis=0), axis=1).sum()
    return float(np.linalg.norm(turned[-1] - sensed.step_m[-1]) / distance)


@pytest.mark.parametrize("phone", HELD.values(), ids=HELD)
@pytest.mark.parametrize("heading", ["gyro", "attitude"])
def test_a_walk_around_corners_comes_out(phone, heading):
    sensed = sense(*corners(), phone, np.random.default_rng(3))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # held steady: no warning
        walk = dead_reckon(sensed.log, InertialSettings(heading=heading))
    assert abs(len(walk) - len(sensed.step_s)) <= 1
    assert walk.walked_m[-1] == pytest.approx(120 * 0.65, rel=0.04)
    assert end_error(walk, sensed) < 0.03
    assert (walk.frame, walk.source) == ("own", "inertial")


def test_left_is_left():
    sensed = sense(*corners(), Phone(), np.random.default_rng(3))
    moves = dead_reckon(sensed.log).displacements_m
    first, second = moves[5:15].sum(axis=0), moves[25:38].sum(axis=0)
    turn = np.arctan2(first[0] * second[1] - first[1] * second[0], first @ second)
    assert turn == pytest.approx(np.pi / 2, abs=0.1)


@pytest.mark.parametrize("step_m", [0.45, 0.65, 0.85])
def test_lengths_follow_the_walker(step_m):
    sensed = sense(*corners(step_m=step_m), Phone(), np.random.default_rng(4))
    walk = dead_reckon(sensed.log)
    assert walk.walked_m[-1] / len(walk) == pytest.approx(step_m, rel=0.05)


def test_a_leg_twice_as_long_makes_steps_longer_by_its_root():
    sensed = sense(*corners(), Phone(), np.random.default_rng(4))
    steps = find_steps(sensed.log.resampled(), InertialSettings())
    short, long = (step_lengths_m(steps, InertialSettings(leg_m=m)) for m in (0.6, 1.2))
    np.testing.assert_allclose(long / short, np.sqrt(2))


def test_without_gyroscope_the_attitude_serves_and_without_both_it_is_said():
    sensed = sense(*corners(), Phone(), np.random.default_rng(5))
    walk = dead_reckon(replace(sensed.log, rate_rad_s=None))
    assert end_error(walk, sensed) < 0.03
    with pytest.raises(InputError, match="expected a gyroscope or the platform's rotation vector"):
        dead_reckon(replace(sensed.log, rate_rad_s=None, attitude=None))


SWUNG = {
    "in a pocket": (25.0, 0.4, 0.12),
    "in a hand": (30.0, 0.6, 0.13),
    "widely": (45.0, 0.6, 0.32),
}


@pytest.mark.parametrize(("sway_deg", "arm_m", "too_long"), SWUNG.values(), ids=SWUNG)
def test_a_swinging_phone_is_said_and_constant_lengths_serve(sway_deg, arm_m, too_long):
    """By how much steps come out too long stands in the explanation."""
    phone = Phone(tilt_deg=-70.0, sway_deg=sway_deg, arm_m=arm_m)
    sensed = sense(*corners(), phone, np.random.default_rng(6))
    with pytest.warns(PalmsWarning, match=r"log.txt: the phone sways by \d+ degrees"):
        walk = dead_reckon(sensed.log, name="log.txt")
    assert walk.walked_m[-1] / (120 * 0.65) - 1 == pytest.approx(too_long, abs=0.015)
    with pytest.warns(PalmsWarning):
        constant = dead_reckon(sensed.log, InertialSettings(length="constant", step_m=0.65))
    assert abs(len(constant) - 120) <= 2
    assert end_error(constant, sensed) < 0.03


def test_a_phone_that_is_put_away_on_the_way_is_said():
    time, place = corners()
    before = sense(time, place, Phone(), np.random.default_rng(7)).log
    after = sense(time, place, Phone(tilt_deg=-80.0), np.random.default_rng(7)).log
    late = before.time_s > 40.0
    felt = np.where(late[:, None], after.acceleration_m_s2, before.acceleration_m_s2)
    attitude = np.where(late[:, None], after.attitude, before.attitude)
    log = InertialLog(before.time_s, felt, attitude=attitude)
    with pytest.warns(PalmsWarning, match=r"turned over by \d+ degrees about \d+ s"):
        dead_reckon(log)


def test_who_stands_takes_no_steps():
    rng = np.random.default_rng(8)
    felt = [0, 0, 9.81] + 0.15 * rng.standard_normal((1000, 3))
    log = InertialLog(np.arange(1000) / 50, felt, rate_rad_s=np.zeros((1000, 3)))
    with pytest.raises(InputError, match="expected at least two steps, got 0 in 20 s"):
        dead_reckon(log)


def test_standing_between_walking_adds_nothing():
    time, place = corners(100)
    late = np.where(np.arange(101) > 30, time + 20.0, time)
    sensed = sense(late, place, Phone(), np.random.default_rng(9))
    steps = find_steps(sensed.log.resampled(), InertialSettings())
    assert 98 <= len(steps) <= 102


def test_faster_sensors_and_odd_times_give_the_same_walk():
    sensed = sense(*corners(), Phone(rate_hz=200.0), np.random.default_rng(10))
    log, rng = sensed.log, np.random.default_rng(11)
    kept = np.sort(rng.permutation(len(log.time_s))[: len(log.time_s) // 2])
    felt = log.time_s[kept], log.acceleration_m_s2[kept]
    shuffled = rng.permutation(len(log.time_s))
    rate = log.time_s[shuffled], log.rate_rad_s[shuffled]
    walk = dead_reckon(InertialLog.of_sensors(felt, rate))
    assert end_error(walk, sensed) < 0.03


def test_an_attitude_and_its_negative_are_one():
    sensed = sense(*corners(100), Phone(), np.random.default_rng(12))
    log = sensed.log
    signs = np.where(np.arange(len(log.time_s)) % 3 == 0, -1.0, 1.0)[:, None]
    flipped = replace(log, attitude=log.attitude * signs)
    settings = InertialSettings(heading="attitude")
    np.testing.assert_allclose(
        dead_reckon(flipped, settings).position_m, dead_reckon(log, settings).position_m
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"time_s": [0.0, 0.0, 3.0]}, "times that increase"),
        ({"time_s": [0.0, 1.0, 1.5]}, "2 s to 6 h"),
        ({"time_s": [0.0, 1.0, 1e6]}, "2 s to 6 h"),
        ({"acceleration_m_s2": np.ones((3, 2))}, "shape"),
        ({"rate_rad_s": np.full((3, 3), np.nan)}, "finite"),
        ({"attitude": np.ones((2, 4))}, "shape"),
    ],
)
def test_logs_that_cannot_be_are_refused(change, message):
    good = {"time_s": [0.0, 1.0, 3.0], "acceleration_m_s2": np.ones((3, 3))}
    with pytest.raises(InputError, match=message):
        InertialLog(**(good | change))


def test_attitudes_that_are_none_are_refused():
    log = InertialLog(np.arange(500) / 50, np.tile([0, 0, 9.81], (500, 1)))
    wobble = 3 * np.sin(2 * np.pi * 2 * log.time_s)
    walking = replace(log, acceleration_m_s2=np.outer(9.81 + wobble, [0, 0, 1]))
    with pytest.raises(InputError, match="unit quaternions"):
        dead_reckon(replace(walking, attitude=np.zeros((500, 4))))


@pytest.mark.parametrize(
    "wrong",
    [
        {"length": "long"}, {"heading": "north"}, {"step_m": 0.0}, {"leg_m": float("nan")},
        {"low_hz": 3.0, "high_hz": 2.0},
    ],
)  # fmt: skip
def test_settings_out_of_range_are_refused(wrong):
    with pytest.raises(SettingsError, match="expected"):
        InertialSettings(**wrong)
