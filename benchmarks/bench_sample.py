"""Particles from candidate cells."""

import numpy as np

from benchmarks.harness import Case
from benchmarks.world import raster, scan
from palms.heatmap import find_candidates, match, scan_drifts
from palms.particles import start_from
from palms.randomness import as_key


def cases() -> list[Case]:
    found = find_candidates(match(scan(), raster(), scan_drifts(scan(), raster())))
    weight, rng = np.exp(found.log_weight), np.random.default_rng(0)

    def plainly() -> None:
        index = rng.choice(len(found), 2000, p=weight / weight.sum())
        found.position_m[index] + rng.uniform(-0.05, 0.05, (2000, 2))

    return [
        Case("sample 2,000 particles", lambda: start_from(found, 2000, as_key(0), False), None,
             plainly, "numpy Generator.choice")
    ]  # fmt: skip
