"""Lost and found, further scans: on whole walks in a small building."""

import numpy as np
import pytest

from palms.belief import Stage
from palms.errors import InputError
from palms.floorplan import FloorPlan, Room
from palms.geometry import rotate
from palms.hints import Hint
from palms.localizer import Localizer, track
from palms.odometry import Move
from palms.settings import Settings
from tests.worlds import seen_from, two_rooms, walk

PLAN = two_rooms()
START = np.array([5.0, 3.9])
DRIFT = 0.7
STEPS = [*[(0.5, 0.0)] * 4, *[(-0.5, 0.0)] * 7, *[(0.0, 0.6)] * 4, *[(0.6, 0.0)] * 20]
OURS = Settings().with_particles(6000)


def scan_at(point):
    near = np.linalg.norm(PLAN.segments_m.mean(axis=1) - point, axis=1) < 4.5
    return seen_from(point, PLAN.segments_m[near], DRIFT)


def off(estimate, truth):
    return np.linalg.norm(estimate.position_m - truth)


@pytest.mark.parametrize("seed", range(4))
def test_a_walk_is_followed_and_what_is_declared_is_right(seed):
    found = track(PLAN, scan_at(START), walk(STEPS, DRIFT), OURS, rng=seed)
    truth = START + np.cumsum(STEPS, axis=0)
    error = np.linalg.norm(found.position_m - truth, axis=1)
    declared = np.array([e.is_localized for e in found])
    assert declared[-1]
    assert error[declared].max() < 1.0


def test_a_jump_without_notice_is_noticed_and_a_new_scan_finds_it():
    localizer = Localizer(PLAN, OURS, rng=1)
    localizer.observe(scan_at(START))
    for move in walk(STEPS, DRIFT).moves():
        localizer.move(move)
    assert localizer.estimate.is_localized
    t, stages = localizer.estimate.time_s, []
    for k in range(20):  # twelve metres where no wall of the plan lets anybody walk so far
        dx, dy = rotate([0.0, -0.6], -DRIFT)
        stages.append(localizer.move(Move(t + 0.5 * (k + 1), dx, dy)).stage)
    assert Stage.LOST in stages
    assert stages[-1] is not Stage.LOCALIZED
    here = np.array([10.5, 9.2])
    estimate = localizer.observe(scan_at(here))
    assert off(estimate, here) < 0.5
    assert estimate.p_within_2m > 0.3  # the best of several places, from one scan


def test_a_second_scan_decides_between_places():
    alone = Localizer(PLAN, OURS, rng=3)
    alone.observe(scan_at(START))
    before = alone.estimate.p_within_2m
    again = alone.observe(scan_at(START))
    assert again.p_within_2m >= before
    assert off(again, START) < 0.3


def test_a_scan_that_contradicts_the_belief_raises_doubt():
    localizer = Localizer(PLAN, OURS, rng=3)
    localizer.observe(scan_at(START))
    for move in walk(STEPS[:20], DRIFT).moves():
        localizer.move(move)
    far = np.array([17.0, 9.5])
    estimate = localizer.observe(scan_at(far))
    assert off(estimate, far) < 0.5 or not estimate.is_localized


def test_an_unknown_frame_is_found_by_walking():
    odometry = walk(STEPS * 2, DRIFT + 1.9)
    odometry = type(odometry)(odometry.time_s, odometry.position_m, frame="own")
    settings = Settings().with_particles(20_000)
    found = track(PLAN, scan_at(START), odometry, settings, rng=2)
    truth = START + np.cumsum(STEPS * 2, axis=0)[: len(STEPS)]
    error = np.linalg.norm(found.position_m[: len(STEPS)] - truth, axis=1)
    declared = np.array([e.is_localized for e in found])[: len(STEPS)]
    assert not declared[0]
    assert (error[declared] < 1.5).all()
    last = found.estimates[len(STEPS) - 1]
    assert abs(np.angle(np.exp(1j * (last.drift_rad - DRIFT - 1.9)))) < 0.3


def test_a_right_hint_decides_between_places_and_a_wrong_one_does_not_lie():
    scan = scan_at(START)
    plain, helped, misled = (Localizer(PLAN, OURS, rng=4) for _ in range(3))
    for localizer in (plain, helped, misled):
        localizer.observe(scan)
    right = helped.hint(Hint(START, radius_m=3.0, probability=0.9))
    assert right.p_within_2m > plain.estimate.p_within_2m
    wrong = misled.hint(Hint((17.0, 9.0), radius_m=2.0, probability=0.8))
    assert off(wrong, START) < 0.5 or not wrong.is_localized
    for move in walk(STEPS, DRIFT).moves():
        misled.move(move)
    assert off(misled.estimate, START + np.sum(STEPS, axis=0)) < 1.0


def test_a_hint_before_the_scan_waits_for_it():
    early, late = Localizer(PLAN, OURS, rng=4), Localizer(PLAN, OURS, rng=4)
    hint = Hint(START, radius_m=3.0)
    assert early.hint(hint).position_m is None
    early.observe(scan_at(START))
    late.observe(scan_at(START))
    assert early.estimate.p_within_2m > late.estimate.p_within_2m
    assert off(early.estimate, START) < 0.3


def test_hints_that_cannot_be_are_refused():
    localizer = Localizer(PLAN, OURS)
    with pytest.raises(InputError, match="expected one of the plan's rooms"):
        localizer.hint(Hint(room="Attic"))
    with pytest.raises(InputError, match="a place in the building"):
        localizer.hint(Hint((500.0, 500.0)))
    with pytest.raises(InputError, match="a place or a room"):
        Hint()


def test_a_hint_names_a_room():
    hall = Room("Hall", [[8.0, 0.0], [20.0, 0.0], [20.0, 5.0], [8.0, 5.0]])
    plan = FloorPlan(PLAN.segments_m, rooms=(hall,))
    localizer = Localizer(plan, OURS, rng=4)
    localizer.observe(scan_at(START))
    estimate = localizer.hint(Hint(room="Hall", probability=0.999))
    share = localizer.belief.particles.weight[localizer.belief.particles.position_m[:, 0] > 7].sum()
    assert share > 0.5
    assert not estimate.is_localized
