"""The best cells of the maps (paper III-C)."""

import numpy as np

from benchmarks.harness import Case
from benchmarks.world import raster, scan
from palms._compiled import select
from palms.heatmap import find_candidates, match, scan_drifts


def cases() -> list[Case]:
    four = match(scan(), raster(), scan_drifts(scan(), raster()))
    scores = np.stack(list(four)).ravel()
    n = scores.size // 100
    return [
        Case("99 % threshold of 4 maps", lambda: select.nth_largest(scores, n), 7.0,
             lambda: np.argpartition(scores, scores.size - n), "np.argpartition"),
        Case("candidates of 4 maps, all included", lambda: find_candidates(four)),
    ]  # fmt: skip
