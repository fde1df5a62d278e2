"""Particles that the speed benchmarks share."""

import dataclasses
from functools import cache

import numpy as np

from benchmarks.world import raster, scan
from palms.heatmap import find_candidates, match, scan_drifts
from palms.odometry import Move
from palms.particles import Particles, start_from
from palms.randomness import as_key

MOVE = Move(1.0, 0.6, 0.0, duration_s=0.5)
KEY = as_key(0)


@cache
def spread(n: int) -> Particles:
    """As the paper's method draws them from a scan: in hundreds of places."""
    found = find_candidates(match(scan(), raster(), scan_drifts(scan(), raster())))
    return start_from(found, n, KEY, own_frame=False)


@cache
def settled(n: int) -> Particles:
    """Gathered in one place."""
    near = np.random.default_rng(0).normal([31.0, 13.2], 0.3, (n, 2))
    return dataclasses.replace(spread(n), position_m=near, drift_rad=np.zeros(n))
