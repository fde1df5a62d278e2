"""Templates, correlation, threshold, sampling."""

import numpy as np
from scipy.signal import fftconvolve

from benchmarks.harness import Case
from benchmarks.world import raster, scan
from palms._compiled import select
from palms.heatmap import find_candidates, match, scan_drifts
from palms.particles import start_from
from palms.randomness import as_key
from palms.template import build_template


def cases() -> list[Case]:
    plan, drifts = raster(), scan_drifts(scan(), raster())
    four = match(scan(), plan, drifts)
    circle = match(scan(), plan, np.arange(72) * 2 * np.pi / 72)
    scores = np.stack(list(four)).ravel()
    candidates = find_candidates(four)

    def slow_maps() -> None:
        for k in range(4):
            fftconvolve(plan.density, four.template(k).values[::-1, ::-1], mode="same")

    return [
        Case("template RW - alpha CES", lambda: build_template(scan(), float(drifts[1]), 0.1)),
        Case("4 heatmaps, templates included", lambda: list(four), 25.0, slow_maps,
             "scipy.signal.fftconvolve"),
        Case("72 heatmaps, one at a time", lambda: sum(1 for _ in circle)),
        Case("99 % threshold of 4 maps",
             lambda: select.nth_largest(scores, scores.size // 100), None,
             lambda: np.partition(scores, scores.size - scores.size // 100), "np.partition"),
        Case("candidates of 4 maps, all included", lambda: find_candidates(four)),
        Case("sample 2,000 particles", lambda: start_from(candidates, 2000, as_key(0), False)),
    ]  # fmt: skip
