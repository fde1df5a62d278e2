"""The scale of a leg: it wanders about the walk's, and never away from it."""

import dataclasses

import numpy as np
import pytest

from palms.evaluation.simulation import TrueWalk, inertial_odometry
from palms.evaluation.simulation.settings import InertialNoise
from palms.floorplan import FloorPlan
from palms.odometry import Move
from palms.particles import Particles, advance, with_scales
from palms.population import mixed
from palms.randomness import as_key
from palms.raster import rasterize
from palms.settings import MotionSettings, RasterSettings, Settings

KEY = as_key(5)
SIDE_M, STEP_M = 300.0, 0.65
CORNERS = np.array([[0, 0], [SIDE_M, 0], [SIDE_M, SIDE_M], [0, SIDE_M], [0, 0]], float)
OPEN = rasterize(
    FloorPlan(np.stack([CORNERS[:-1], CORNERS[1:]], axis=1)), RasterSettings(cell_size_m=1.0)
)
LEGS = MotionSettings(
    length_m=0.0, direction_rad=0.0, drift_rad=0.0, hit_weight=0.5, leg_scale_sd=0.1
)
OURS = Settings().resampling


def crowd(n=4000):
    n_zeros = np.zeros(n)
    middle = np.full((n, 2), SIDE_M / 2)
    start = Particles(middle, n_zeros, np.ones(n), n_zeros, np.full(n, 1 / n))
    return with_scales(start, LEGS, KEY)


def walked(metres, step_m=STEP_M, settings=LEGS):
    particles = crowd()
    for k in range(round(metres / step_m)):
        move = Move(k + 1.0, step_m, 0.0)
        particles, _ = advance(particles, move, OPEN, settings, KEY.child(k), OURS)
    return particles


def test_the_scale_of_a_leg_spreads_no_farther_however_long_the_walk():
    for metres in (0.65, 20.0, 120.0):
        assert np.std(walked(metres).leg_scale) == pytest.approx(LEGS.leg_scale_sd, rel=0.04)


def test_half_of_it_is_forgotten_after_seven_tenths_of_the_leg():
    before, after = (walked(m).leg_scale for m in (13.0, 13.0 + 0.693 * LEGS.leg_m))
    assert np.corrcoef(before, after)[0, 1] == pytest.approx(0.5, abs=0.04)


@pytest.mark.parametrize("metres", [15.0, 45.0, 90.0])
def test_walks_spread_as_those_of_inertial_odometry_whose_legs_have_scales(metres):
    noise = InertialNoise(0.0, 0.0, 1.0, 0.0, LEGS.leg_scale_sd, 2 * LEGS.leg_m)
    n = round(metres / STEP_M)
    along = np.column_stack([np.arange(1, n + 1) * STEP_M, np.zeros(n)])
    walk = TrueWalk(np.arange(n) + 1.0, along, np.zeros(n), np.zeros(2))
    rng = np.random.default_rng(2)
    lengths = [inertial_odometry(walk, noise, rng).walked_m[-1] for _ in range(800)]
    x = walked(metres).position_m[:, 0]
    # those legs begin with the walk: where one ends they spread by up to a quarter more
    assert np.std(lengths) * 0.7 < np.std(x) < np.std(lengths) * 1.1


def test_the_same_walk_in_finer_moves_spreads_the_same():
    coarse, fine = (np.std(walked(39.0, step).position_m[:, 0]) for step in (0.65, 0.13))
    assert fine == pytest.approx(coarse, rel=0.05)


def test_who_stands_keeps_the_scale_of_the_leg():
    particles = walked(13.0)
    stood, _ = advance(particles, Move(99.0, 0.0, 0.0), OPEN, LEGS, KEY, OURS)
    assert (stood.leg_scale == particles.leg_scale).all()


def test_odometry_without_legs_has_none():
    particles = crowd()
    assert particles.scale_now == pytest.approx(1 + particles.leg_scale)
    one_scale = dataclasses.replace(particles, leg_scale=None)
    assert one_scale.scale_now is one_scale.scale
    moved, _ = advance(one_scale, Move(1.0, 0.65, 0.0), OPEN, Settings().motion, KEY, OURS)
    assert moved.leg_scale is None
    both = mixed(one_scale, particles, 0.5)
    n = len(particles)
    assert (both.leg_scale[:n] == 0).all()
    assert (both.leg_scale[n:] == particles.leg_scale).all()
    chosen = particles.take(np.array([3, 1]), np.array([0.5, 0.5]))
    assert (chosen.leg_scale == particles.leg_scale[[3, 1]]).all()
