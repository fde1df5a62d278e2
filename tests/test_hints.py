"""Hints fade as the phone walks on; what walls cannot tell, the level, does not."""

from dataclasses import replace

import numpy as np
import pytest

from palms import Building, Hint, Localizer, Settings
from palms.floorplan import Room
from palms.hints import Said, faded, heard
from palms.levels import level_shares
from palms.odometry import Move
from palms.particles import Particles
from palms.population import mixed
from palms.raster import rasterize
from palms.settings import HintSettings
from tests.worlds import seen_from, two_rooms

OURS = Settings().with_particles(6000)
FADE_M = OURS.hint.fade_m
RASTER = rasterize(two_rooms())
START = np.array([5.0, 3.9])


def crowd(n=4):
    x = np.linspace(1.0, 9.0, n)
    zeros = np.zeros(n)
    return Particles(np.stack([x, x / 3], axis=1), zeros, np.ones(n), zeros, np.full(n, 1 / n))


def said(*ratio):
    return Said(np.array(ratio), np.log(ratio))


def test_what_was_said_is_taken_back_to_the_last_bit_that_counts():
    told, kept = heard(crowd(2), said(3.2, 0.2))
    assert told.weight == pytest.approx([3.2 / 3.4, 0.2 / 3.4])
    assert kept == pytest.approx(np.log(1.7))
    later = faded(told, 10 * FADE_M, OURS.hint)
    assert later.weight == pytest.approx([0.5, 0.5], abs=1e-3)
    assert later.hint_nats is None


def test_it_fades_by_the_metre_however_they_are_walked():
    told, _ = heard(crowd(), said(4.0, 1.0, 0.5, 0.1))
    at_once = faded(told, 13.0, OURS.hint)
    by_steps = told
    for _ in range(20):
        by_steps = faded(by_steps, 0.65, OURS.hint)
    assert by_steps.weight == pytest.approx(at_once.weight)
    standing = faded(told, 0.0, OURS.hint)
    assert standing.weight == pytest.approx(told.weight)


def test_two_hints_fade_together_and_what_walls_said_stays():
    told, _ = heard(*heard(crowd(2), said(3.0, 1.0))[:1], said(1.0, 2.0))
    assert told.hint_nats == pytest.approx(np.log([3.0, 2.0]))
    by_walls = replace(told, weight=told.weight * [1.0, 0.5] / (told.weight @ [1.0, 0.5]))
    later = faded(by_walls, 20 * FADE_M, OURS.hint)
    assert later.weight == pytest.approx([2 / 3, 1 / 3], abs=1e-6)


def test_particles_of_whom_nothing_was_said_keep_their_weight():
    told, _ = heard(crowd(2), said(3.0, 1.0))
    both = mixed(told, crowd(2), 0.4)
    later = faded(both, 20 * FADE_M, OURS.hint)
    assert both.hint_nats == pytest.approx([np.log(3.0), 0.0, 0.0, 0.0])
    assert later.weight[2:].sum() == pytest.approx(0.4 / (0.4 + 0.15 + 0.45 / 3))
    chosen = told.take(np.array([1, 0]), np.array([0.5, 0.5]))
    assert chosen.hint_nats == pytest.approx(np.log([1.0, 3.0]))


def test_a_room_fades_and_its_level_does_not():
    room = Room("Hall", [[0, 0], [7, 0], [7, 4], [0, 4]])
    levels = tuple(replace(two_rooms(), level=name, rooms=(room,)) for name in "01")
    atlas = Building(levels).atlas
    raster = atlas.raster(OURS.raster)
    here = np.array([[3.0, 2.0], [15.0, 8.0]])
    places = np.concatenate([here, here + atlas.shift_m[1]])
    only_level = Hint(level="1", probability=0.8).says(places, raster, atlas)
    assert only_level.fading_nats == pytest.approx(np.zeros(4))
    with_place = Hint((3.0, 2.0), 2.0, level="1", probability=0.8)
    ratio, fading = with_place.says(places, raster, atlas)
    assert ratio == pytest.approx(with_place.ratio(places, raster, atlas))
    lasting = ratio / np.exp(fading)
    assert lasting == pytest.approx(only_level.ratio)
    assert lasting[2:] == pytest.approx(np.full(2, 1.6), rel=0.02)  # 0.8 of half of the building


def test_a_wrong_hint_is_walked_off():
    """Up and down a room: no wall speaks, and yet the hint counts less and less."""
    plain, misled = (Localizer(RASTER, OURS, rng=4) for _ in range(2))
    near = np.linalg.norm(RASTER.plan.segments_m.mean(axis=1) - START, axis=1) < 4.5
    scan = seen_from(START, RASTER.plan.segments_m[near], 0.0)
    for localizer in (plain, misled):
        localizer.observe(scan)
    misled.hint(Hint((17.0, 9.0), radius_m=2.0, probability=0.98))
    shares = []
    for k in range(300):
        move = Move(k + 1.0, 0.4 if k % 2 else -0.4, 0.0)
        there = [localizer.move(move) for localizer in (plain, misled)]
        shares.append([each.p_within_1m for each in there])
    gap = np.abs(np.diff(shares, axis=1)[:, 0])
    assert gap[0] > 0.1
    assert gap[-1] < 0.05


def test_levels_stay_as_they_were_told_however_far_one_walks():
    levels = tuple(replace(two_rooms(), level=name) for name in "01")
    house = Building(levels)
    localizer = Localizer(house, OURS, rng=2)
    localizer.observe(seen_from(START, levels[0].segments_m[[6, 10, 13]], 0.0))
    told = localizer.hint(Hint(level="1", probability=0.95))
    for k in range(200):
        localizer.move(Move(k + 1.0, 0.4 if k % 2 else -0.4, 0.0))
    share = level_shares(localizer.belief.particles, house.atlas)[1]
    assert share == pytest.approx(told.p_level, abs=0.03)


def test_how_fast_hints_fade_is_a_setting():
    told, _ = heard(crowd(2), said(3.0, 1.0))
    slow = faded(told, 40.0, HintSettings(fade_m=400.0)).weight[0]
    fast = faded(told, 40.0, HintSettings(fade_m=4.0)).weight[0]
    assert fast < slow < 0.75
