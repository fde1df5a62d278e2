"""Random numbers and resampling."""

import numpy as np

from benchmarks import naive
from benchmarks.harness import Case
from benchmarks.populations import KEY
from palms._compiled import filter as loops
from palms.particles import resample_systematic


def cases() -> list[Case]:
    generator, normals = np.random.default_rng(0), np.empty((2000, 3))
    weights = generator.random(2000)
    return [
        Case("6,000 normal numbers", lambda: loops.normals(KEY.word, 3, normals), None,
             lambda: generator.normal(size=(2000, 3)), "numpy Generator"),
        Case("systematic resampling of 2,000", lambda: resample_systematic(weights, 2000, KEY),
             None, lambda: naive.resample(weights, 2000, 0.5), "numpy searchsorted"),
    ]  # fmt: skip
