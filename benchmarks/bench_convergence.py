"""The verdict on the particles, and what every step reports."""

import numpy as np

from benchmarks.bench_filter import KEY, MOVE, settled, spread
from benchmarks.harness import Case
from palms.belief import Belief, settle, summarize
from palms.convergence import mean_shift
from palms.settings import ConvergenceSettings


def cases() -> list[Case]:
    wide, near, paper = spread(2000), settled(2000), ConvergenceSettings()
    belief = settle(Belief(near), near, MOVE, paper, KEY)
    return [
        Case("mean shift, 2,000 spread", lambda: mean_shift(wide.position_m, 1.0)),
        Case("mean shift, 2,000 settled", lambda: mean_shift(near.position_m, 1.0)),
        Case("verdict between two clusterings", lambda: settle(belief, near, MOVE, paper, KEY)),
        Case("answer, probabilities, radii, hypotheses", lambda: summarize(belief, 0.0, np.pi)),
    ]
