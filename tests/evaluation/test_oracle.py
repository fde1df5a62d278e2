"""The oracle's belief against the exact one: enumerated, and by rejection sampling."""

import numpy as np
import pytest
from scipy import stats

from palms.evaluation.oracle import oracle_settings
from palms.evaluation.simulation import draw_nuisances
from palms.geometry import rotate
from palms.heatmap import find_candidates, match, scan_drifts
from palms.motion import move_noise
from palms.odometry import Move
from palms.particles import advance, start_everywhere, start_from, with_scales
from palms.randomness import as_key
from palms.raster import rasterize
from palms.settings import MotionSettings, Settings
from tests.worlds import seen_from, two_rooms

RASTER = rasterize(two_rooms())
KEY = as_key(11)
MOVES = [Move(0.5 * k, *step, duration_s=0.5) for k, step in enumerate(
    [(0.5, 0.1)] * 4 + [(0.1, 0.5)] * 3 + [(-0.5, 0.0)] * 3, start=1)]  # fmt: skip


def filtered(particles, motion):
    for step, move in enumerate(MOVES):
        particles, info = advance(particles, move, RASTER, motion, KEY.child(step))
        assert info.n_survived > 0
    return particles


def test_without_noise_the_shares_are_those_of_the_enumerated_starts():
    scan = seen_from([5.0, 3.9], RASTER.plan.segments_m[[6, 10, 13]])
    found = find_candidates(match(scan, RASTER, scan_drifts(scan, RASTER)))
    still = MotionSettings(length_m=0, direction_rad=0, drift_rad=0, jitter_m=0)
    particles = filtered(start_from(found, 60_000, KEY, own_frame=False), still)

    within = (np.indices((4, 4)).reshape(2, -1).T + 0.5) / 4 - 0.5  # 16 spots in each cell
    at = (found.position_m[:, None] + within * RASTER.grid.cell_size_m).reshape(-1, 2)
    label = np.repeat(found.label, 16)
    alive = np.ones(len(at), bool)
    for move in MOVES:
        step = np.array([rotate([move.dx_m, move.dy_m], d) for d in found.drifts_rad])[label]
        alive &= ~RASTER.blocked(at, at + step)
        at = at + step
    exact = np.bincount(label[alive], minlength=4) / alive.sum()
    assert particles.label_shares() == pytest.approx(exact[: particles.label.max() + 1], abs=0.01)
    assert particles.mean_m() == pytest.approx(at[alive].mean(axis=0), abs=0.1)


def test_ranks_of_the_truth_are_uniform():
    """Truths drawn from the model itself, those that hit no wall kept: simulation-based
    calibration (Talts et al. 2018) with a fixed walk."""
    motion = MotionSettings(length_m=0.08, direction_rad=0.08, drift_rad=0.03, jitter_m=0.0)
    drifts = np.array([0.0, np.pi / 2, np.pi, -np.pi / 2])
    start = with_scales(start_everywhere(RASTER, 60_000, KEY, drifts), 0.05, KEY)
    posterior = filtered(start, motion)
    truths = rejection_sampled(motion, drifts, 60_000)
    assert len(truths) > 1000
    chosen = truths[:: len(truths) // 400]
    believed = np.column_stack([posterior.position_m, np.cos(posterior.drift_rad - 0.4)])
    for k in range(3):
        rank = np.searchsorted(np.sort(believed[:, k]), chosen[:, k]) / len(believed)
        assert stats.kstest(rank, "uniform").pvalue > 0.01


def rejection_sampled(motion, drifts, n):
    rng = np.random.default_rng(5)
    at = start_everywhere(RASTER, n, as_key(99), drifts).position_m
    drift, scale = rng.choice(drifts, n), rng.normal(1, 0.05, n)
    alive = np.ones(n, bool)
    for move in MOVES:
        noise = move_noise(move.length_m, motion)
        drift = drift + rng.normal(0, noise.drift_rad, n)
        along = move.length_m * scale + rng.normal(0, noise.along_m, n)
        across = rng.normal(0, noise.across_m, n)
        angle = np.arctan2(move.dy_m, move.dx_m) + drift
        c, s = np.cos(angle), np.sin(angle)
        end = at + np.stack([c * along - s * across, s * along + c * across], axis=1)
        alive &= ~RASTER.blocked(at, end)
        at = end
    return np.column_stack([at, np.cos(drift - 0.4)])[alive]


def test_the_oracle_is_our_method_told_the_noise():
    nuisances = draw_nuisances(np.random.default_rng(3))
    oracle, best = oracle_settings(nuisances), Settings()
    assert (oracle.template, oracle.candidates) == (best.template, best.candidates)
    assert oracle.convergence == best.convergence
    noise = move_noise(0.65, oracle.motion, duration_s=4.0)
    white = nuisances.vio_white_m_per_sqrt_m * np.sqrt(0.65)
    assert (noise.along_m, noise.across_m) == pytest.approx((white, white))
    assert noise.drift_rad == pytest.approx(2 * nuisances.vio_heading_rad_per_sqrt_s)
