import dataclasses

import numpy as np
import pytest

from palms.particles import Particles
from palms.population import adapted, anywhere, mixed, pushed, start_posterior
from palms.posterior import posterior
from palms.randomness import as_key
from palms.raster import rasterize
from palms.settings import Settings
from tests.worlds import seen_from, two_rooms

PLAN = two_rooms()
RASTER = rasterize(PLAN)
POINT = np.array([5.0, 3.9])
NEAR = PLAN.segments_m[np.linalg.norm(PLAN.segments_m.mean(axis=1) - POINT, axis=1) < 4.5]
SCAN = seen_from(POINT, NEAR, 0.4)
KEY = as_key(2)
FEW = Settings().with_particles(4000)


def crowd(weight, position=None):
    n = len(weight)
    place = np.zeros((n, 2)) if position is None else position
    return Particles(place, np.zeros(n), np.ones(n), np.zeros(n), np.array(weight) / np.sum(weight))


def test_the_start_is_the_posterior_and_some_of_anywhere():
    start = start_posterior(posterior(SCAN, RASTER), RASTER, FEW, KEY)
    assert len(start) == 4000
    assert start.weight.sum() == pytest.approx(1)
    near = np.linalg.norm(start.position_m - POINT, axis=1) < 0.5
    assert start.weight[near].sum() > 0.6
    spare = start.weight[2000:]
    assert spare.sum() == pytest.approx(FEW.observation.elsewhere)
    assert np.ptp(start.position_m[2000:], axis=0).min() > 10


def test_weights_and_numbers_together_say_what_the_posterior_says():
    """Drawn by roots or not, means are the same within Monte-Carlo error."""
    rng = np.random.default_rng(0)
    position = rng.normal(0, 3, (20_000, 2)) + 10
    weight = np.exp(-0.5 * ((position - 10.5) ** 2).sum(axis=1))
    before = crowd(weight, np.clip(position, 0.5, 19))
    settings = dataclasses.replace(FEW.resampling, ess_share=1.0, jitter_m=0.0)
    after = adapted(before, RASTER, settings, 5000, KEY)
    assert len(after) <= 5000
    assert after.mean_m() == pytest.approx(before.mean_m(), abs=0.05)
    assert after.dispersion_m() == pytest.approx(before.dispersion_m(), rel=0.05)


def test_an_unlikely_place_keeps_particles():
    weight = [1.0] * 1000 + [1e-4] * 1000
    position = np.repeat([[5.0, 2.0], [15.0, 2.0]], 1000, axis=0)
    settings = dataclasses.replace(FEW.resampling, ess_share=1.0, min_particles=2000)
    after = adapted(crowd(weight, position), RASTER, settings, 2000, KEY)
    there = after.position_m[:, 0] > 10
    assert 10 <= there.sum() <= 40  # by weight alone it would be none
    assert after.weight[there].sum() == pytest.approx(1e-4, rel=0.2)


def test_numbers_follow_what_the_belief_occupies():
    rng = np.random.default_rng(1)
    gathered = crowd(np.ones(20_000), rng.normal(0, 0.3, (20_000, 2)) + 3)
    spread = crowd(np.ones(20_000), rng.uniform(0.5, 11, (20_000, 2)))
    settings = FEW.resampling
    few, many = (adapted(p, RASTER, settings, 20_000, KEY) for p in (gathered, spread))
    assert len(few) == settings.min_particles < len(many)
    assert adapted(gathered, RASTER, settings, 20_000, KEY, count=False) is gathered


def test_copies_are_spread_through_no_wall():
    along = np.column_stack([np.linspace(0.5, 7.5, 3000), np.full(3000, 4.98)])
    weight = np.where(np.arange(3000) % 7, 1e-6, 1.0)
    settings = dataclasses.replace(FEW.resampling, jitter_m=0.2)
    after = adapted(crowd(weight, along), RASTER, settings, 3000, KEY)
    in_a_door = (after.position_m[:, 0] > 2.2) & (after.position_m[:, 0] < 4.8)
    assert (after.position_m[~in_a_door, 1] < 5).all()


def test_what_a_scan_says_is_carried_along():
    moved = pushed(posterior(SCAN, RASTER), 4000, np.array([2.0, 0.0]), KEY)
    expected = POINT + 2 * np.array([np.cos(0.4), np.sin(0.4)])
    near = np.linalg.norm(moved.position_m - expected, axis=1) < 0.6
    assert moved.weight[near].sum() > 0.5


def test_anywhere_is_inside_with_the_drifts_asked_for():
    spread = anywhere(RASTER, 2000, np.array([0.0, 1.0]), 0.1, KEY)
    cell = RASTER.grid.cell_of(spread.position_m)
    assert RASTER.inside[tuple(cell.T)].all()
    off = np.minimum(np.abs(spread.drift_rad), np.abs(spread.drift_rad - 1))
    assert off.max() <= 0.05
    assert np.ptp(anywhere(RASTER, 2000, None, 0.0, KEY).drift_rad) > 6


def test_a_mixture_keeps_both_sides():
    one, two = crowd([1.0, 3.0]), crowd([1.0])
    both = mixed(one, two, 0.2)
    assert both.weight == pytest.approx([0.2, 0.6, 0.2])


def test_a_frame_that_turns_and_one_that_does_not_mix():
    still = crowd([1.0, 3.0])
    turning = dataclasses.replace(still, drift_rate_rad_per_s=np.array([0.1, -0.2]))
    assert mixed(still, still, 0.5).drift_rate_rad_per_s is None
    assert mixed(turning, still, 0.5).turned_rad(2.0) == pytest.approx([0.2, -0.4, 0.0, 0.0])
    assert mixed(still, turning, 0.5).turned_rad(2.0) == pytest.approx([0.0, 0.0, 0.2, -0.4])
    one = np.array([1]), np.ones(1)
    assert still.take(*one).drift_rate_rad_per_s is None
    assert turning.take(*one).turned_rad(1.0).tolist() == [-0.2]
    assert still.turned_rad(5.0) is still.drift_rad
