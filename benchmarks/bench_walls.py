"""Whether moves meet walls, exactly."""

import numpy as np

from benchmarks import naive
from benchmarks.harness import Case
from benchmarks.populations import spread
from benchmarks.world import raster
from palms._compiled import filter as loops


def cases() -> list[Case]:
    walls, start = raster().walls, spread(2000).position_m
    end, hit = start + np.array([0.6, 0.0]), np.empty(2000, np.bool_)
    return [
        Case("walls along 2,000 moves", lambda: loops.blocked(walls, start, end, hit), None,
             lambda: naive.crossings(start, end, walls.segments, hit), "naive numba, all walls")
    ]  # fmt: skip
