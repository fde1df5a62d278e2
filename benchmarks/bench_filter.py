"""One step of the filter, and its parts."""

import dataclasses

import numpy as np

from benchmarks.harness import Case
from benchmarks.world import raster, scan
from palms._compiled import filter as loops
from palms.heatmap import find_candidates, match, scan_drifts
from palms.odometry import Move
from palms.particles import Particles, advance, resample_systematic, start_from
from palms.randomness import as_key
from palms.settings import MotionSettings

MOVE = Move(1.0, 0.6, 0.0)
KEY = as_key(0)


def spread(n: int) -> Particles:
    found = find_candidates(match(scan(), raster(), scan_drifts(scan(), raster())))
    return start_from(found, n, KEY, own_frame=False)


def settled(n: int) -> Particles:
    near = np.random.default_rng(0).normal([31.0, 13.2], 0.3, (n, 2))
    return dataclasses.replace(spread(n), position_m=near, drift_rad=np.zeros(n))


def numpy_move(particles: Particles) -> None:
    """The move alone in numpy: no walls, no resampling."""
    rng = np.random.default_rng(0)
    n = len(particles)
    angle = particles.drift_rad + rng.normal(0, 0.007, n)
    along, across = 0.6 + rng.normal(0, 0.05, n), rng.normal(0, 0.016, n)
    c, s = np.cos(angle), np.sin(angle)
    particles.position_m + np.stack([c * along - s * across, s * along + c * across], axis=1)


def cases() -> list[Case]:
    plan, motion = raster(), MotionSettings()
    out = []
    for name, goal, particles in (
        ("step of 2,000 particles, spread", 0.2, spread(2000)),
        ("step of 2,000 particles, settled", 0.2, settled(2000)),
        ("step of 200,000 particles, spread", None, spread(200_000)),
    ):
        out.append(
            Case(name, lambda p=particles: advance(p, MOVE, plan, motion, KEY), goal,
                 lambda p=particles: numpy_move(p), "numpy, the move alone")
        )  # fmt: skip
    start = spread(2000).position_m
    end, hit = start + np.array([0.6, 0.0]), np.empty(2000, np.bool_)
    weights = np.random.default_rng(0).random(2000)
    normals = np.empty((2000, 3))
    generator = np.random.default_rng(0)
    return [
        *out,
        Case("walls along 2,000 moves", lambda: loops.blocked(plan.walls, start, end, hit)),
        Case("6,000 normal numbers", lambda: loops.normals(KEY.word, 3, normals), None,
             lambda: generator.normal(size=(2000, 3)), "numpy Generator"),
        Case("systematic resampling of 2,000", lambda: resample_systematic(weights, 2000, KEY)),
    ]  # fmt: skip
