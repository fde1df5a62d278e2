import dataclasses

import numpy as np
import pytest
import shapely

from palms.errors import InputError
from palms.heatmap import find_candidates, match, scan_drifts
from palms.odometry import Move
from palms.particles import (
    Particles,
    advance,
    effective_sample_size,
    resample_systematic,
    start_everywhere,
    start_from,
    thin,
)
from palms.randomness import as_key
from palms.raster import rasterize
from palms.settings import CandidateSettings, MotionSettings, Settings
from tests.compiled import twins
from tests.worlds import seen_from, two_rooms

KEY = as_key(3)


@pytest.fixture(scope="module")
def raster():
    return rasterize(two_rooms())


@pytest.fixture(scope="module")
def candidates(raster):
    scan = seen_from([5.0, 3.9], raster.plan.segments_m[[6, 10, 13]])
    return find_candidates(match(scan, raster, scan_drifts(scan, raster)))


def crowd(position, n=500, drift=0.0):
    return Particles(
        np.tile(position, (n, 1)), np.full(n, drift), np.ones(n), np.zeros(n), np.full(n, 1 / n)
    )


def test_particles_start_in_candidate_cells_with_their_drift_and_label(candidates):
    particles = start_from(candidates, 4000, KEY, own_frame=False)
    cells = candidates.grid.cell_of(particles.position_m)
    known = set(zip(candidates.label.tolist(), *candidates.cells.T.tolist(), strict=True))
    assert set(zip(particles.label.tolist(), *cells.T.tolist(), strict=True)) <= known
    assert (particles.drift_rad == candidates.drifts_rad[particles.label]).all()
    assert particles.weight.sum() == pytest.approx(1)


def test_particles_are_as_many_in_each_map_as_its_cells_say(candidates):
    particles = start_from(candidates, 4000, KEY, own_frame=False)
    expected = np.bincount(candidates.label, minlength=4) / len(candidates)
    assert particles.label_shares() == pytest.approx(
        expected[: particles.label.max() + 1], abs=2e-3
    )


def test_the_captions_way_gives_each_map_as_many_particles(raster):
    scan = seen_from([5.0, 3.9], raster.plan.segments_m[[6, 10, 13]])
    maps = match(scan, raster, scan_drifts(scan, raster))
    found = find_candidates(maps, CandidateSettings(per_map=True))
    assert start_from(found, 2000, KEY, False).label_shares() == pytest.approx(np.full(4, 0.25))


def test_in_a_frame_of_its_own_the_drift_is_anything(candidates):
    drift = start_from(candidates, 4000, KEY, own_frame=True).drift_rad
    counts = np.histogram(drift, 8, (-np.pi, np.pi))[0]
    assert counts.min() > 400


def test_uniform_particles_fill_the_inside_and_the_circle(raster):
    particles = start_everywhere(raster, 8000, KEY)
    rows, columns = raster.grid.cell_of(particles.position_m).T
    assert raster.inside[rows, columns].all()
    quadrant = (particles.position_m > [10, 6]) @ [1, 2]
    assert np.bincount(quadrant) == pytest.approx(np.full(4, 2000), rel=0.06)
    assert np.histogram(particles.drift_rad, 4, (-np.pi, np.pi))[0].min() > 1800
    assert (particles.label == 0).all()


def test_uniform_with_orientation_has_equal_groups(raster):
    particles = start_everywhere(raster, 2000, KEY, np.array([0.0, 1.0, 2.0, 3.0]))
    assert particles.label_shares() == pytest.approx(np.full(4, 0.25))
    assert (particles.drift_rad == particles.label).all()
    west = particles.position_m[:, 0] < 10  # groups are spread alike
    shares = np.bincount(particles.label[west]) / west.sum()
    assert shares == pytest.approx(np.full(4, 0.25), abs=0.05)


@pytest.mark.parametrize("speed", [0.2, 0.65, 3.0, 15.0])
def test_no_kept_particle_crosses_a_wall(raster, speed):
    lines = shapely.linestrings(raster.plan.blocking_m)
    particles = start_everywhere(raster, 800, KEY)
    for step in range(6):
        moved, info = advance(
            particles, Move(step, speed, 0.0), raster, MotionSettings(jitter_m=0.0),
            KEY.child(step),
        )  # fmt: skip
        if info.n_survived == 0:
            break
        parents = np.full(len(moved), -1)
        noise_free = particles.position_m
        for i in range(len(moved)):  # every kept particle is a survivor or sits on one
            same = np.flatnonzero((moved.position_m == moved.position_m[i]).all(axis=1))
            parents[i] = same[0]
        survivor = parents == np.arange(len(moved))
        crossed = twins.blocked(lines, noise_free, moved.position_m)
        clean = [
            not crossed[np.flatnonzero(parents == parents[i])].all() for i in range(len(moved))
        ]
        assert all(clean)
        assert survivor.sum() <= info.n_survived
        particles = moved


def test_hits_are_replaced_by_survivors(raster):
    half = crowd([5.0, 4.7], 200)
    position = half.position_m.copy()
    position[100:] = [5.0, 1.0]
    label = np.repeat([0, 1], 100)
    particles = dataclasses.replace(half, position_m=position, label=label)
    moved, info = advance(particles, Move(1, 0.0, 0.6), raster, MotionSettings(), KEY)
    assert (info.n_hit, info.n_survived) == (100, 100)
    assert (moved.label == 1).all()
    assert moved.mean_m() == pytest.approx([5.0, 1.6], abs=0.05)
    assert moved.weight.sum() == pytest.approx(1)


def test_when_nobody_survives_all_make_the_move(raster):
    moved, info = advance(crowd([5.0, 4.7]), Move(1, 0.0, 0.6), raster, MotionSettings(), KEY)
    assert info.n_survived == 0
    assert moved.mean_m() == pytest.approx([5.0, 5.3], abs=0.05)


def test_the_spread_of_a_walk_does_not_depend_on_its_sampling(raster):
    spread = []
    for n in (1, 4, 16):
        particles = crowd([10.0, 6.0], 4000)
        for step in range(n):
            particles, _ = advance(
                particles, Move(step, 2.6 / n, 0.0), raster, MotionSettings(), KEY.child(n, step)
            )
        spread.append([particles.position_m[:, 0].std(), particles.drift_rad.std()])
    assert np.array(spread) == pytest.approx(np.tile(np.mean(spread, axis=0), (3, 1)), rel=0.08)


def test_standing_still_does_not_spread_the_particles(raster):
    before = crowd([10.0, 6.0])
    after, info = advance(before, Move(1, 0.0, 0.0), raster, MotionSettings(), KEY)
    assert (after.position_m == before.position_m).all()
    assert info.n_hit == 0


def test_the_authors_particles_pass_through_walls_at_a_price(raster):
    authors = Settings.authors()
    position = np.tile([5.0, 4.9], (600, 1))
    position[300:] = [5.0, 1.0]
    particles = dataclasses.replace(crowd([5.0, 4.9], 600), position_m=position)
    moved, info = advance(
        particles, Move(1, 0.0, 0.65), raster, authors.motion, KEY, authors.resampling
    )
    beyond = moved.position_m[:, 1] > 4.0
    assert 0.1 < beyond.mean() < 0.4  # 0.3 against 1, drawn anew
    assert info.n_survived < 600
    assert moved.weight.sum() == pytest.approx(1)
    assert len(np.unique(moved.weight)) == 2  # weights are not reset


def test_systematic_resampling_keeps_shares_to_within_one():
    weights = np.array([0.1, 0.2, 0.3, 0.4])
    for seed in range(20):
        counts = np.bincount(resample_systematic(weights, 1001, as_key(seed)), minlength=4)
        assert (np.abs(counts - 1001 * weights) <= 1).all()


def test_thinning_keeps_the_shares_of_the_labels(raster):
    particles = start_everywhere(raster, 4000, KEY, np.arange(4.0))
    fewer = thin(particles, 1000, KEY)
    assert len(fewer) == 1000
    assert fewer.label_shares() == pytest.approx(np.full(4, 0.25), abs=0.03)


def test_effective_sample_size_counts_equal_weights():
    assert effective_sample_size(np.full(10, 0.3)) == pytest.approx(10)
    assert effective_sample_size(np.array([1.0, 0, 0])) == pytest.approx(1)


def test_particles_need_as_many_of_each():
    with pytest.raises(InputError, match="particles"):
        Particles(np.zeros((0, 2)), [], [], [], [])
