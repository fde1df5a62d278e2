"""The verdict on the particles, and what every step reports."""

import importlib.util
from collections.abc import Callable

import numpy as np

from benchmarks.harness import Case
from benchmarks.populations import KEY, MOVE, settled, spread
from palms.belief import Belief, settle, summarize
from palms.convergence import mean_shift
from palms.particles import Particles
from palms.settings import ConvergenceSettings


def cases() -> list[Case]:
    wide, near, paper = spread(2000), settled(2000), ConvergenceSettings()
    before = settle(Belief(near), near, MOVE, paper, KEY)

    def report(particles: Particles) -> None:
        summarize(settle(before, particles, MOVE, paper, KEY), 0.0, np.pi)

    return [
        *(
            Case(f"re-clustering of 2,000 particles, {name}",
                 lambda p=particles: mean_shift(p.position_m, 1.0), 0.5, sklearns(particles),
                 "scikit-learn MeanShift")
            for name, particles in (("spread", wide), ("settled", near))
        ),
        Case("report: answer, stage, probabilities, radii", lambda: report(near), 0.1),
    ]  # fmt: skip


def sklearns(particles: Particles) -> Callable[[], object] | None:
    """The same by scikit-learn, where it is installed."""
    if importlib.util.find_spec("sklearn") is None:
        return None

    def plainly() -> None:
        from sklearn.cluster import MeanShift

        MeanShift(bandwidth=1.0, bin_seeding=True).fit(particles.position_m)

    return plainly
