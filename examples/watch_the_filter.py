"""Look at the particles and at wall hits while the filter runs."""

import numpy as np

import palms
from palms.belief import Belief, Estimate
from palms.io import open_dataset
from palms.particles import MoveInfo
from palms.sample import sample_folder

steps: list[tuple[float, int, float]] = []


def watch(estimate: Estimate, belief: Belief, info: MoveInfo) -> None:
    """Keep time, wall hits and spread of each move; nothing is changed by watching."""
    steps.append((estimate.time_s, info.n_hit, belief.particles.dispersion_m()))


case = open_dataset(sample_folder()).cases[0]
palms.track(case.plan(), case.scan(), case.walk().odometry(), rng=0, watch=watch)

time_s, hits, spread_m = np.array(steps).T
for at in range(0, len(steps), 25):
    print(f"{time_s[at]:6.1f} s  {hits[at]:4.0f} hits  spread {spread_m[at]:5.1f} m")
print(f"moves that no particle survived: {np.sum(hits == 2000)}")
