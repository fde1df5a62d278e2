"""A hundred phones in one process, on a clock that is computed: nobody sleeps.

A phone starts each second, by a scan, and sends two steps a second along the sample building's
walk; each second's work is timed by the processor's clock.
"""

import gc
import heapq
import statistics
import time
from functools import cache
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from benchmarks.harness import Case
from benchmarks.world import raster, scan, walk
from palms.floorplan import FloorPlan
from palms.io import open_dataset
from palms.localizer import Localizer
from palms.raster import PlanRaster, rasterize
from palms.sample import sample_folder
from palms.settings import Settings

PHONES, STEP_S, UNTIL_S = 100, 0.5, 130.0


class Load(NamedTuple):
    """Mean time of a step, and the busiest ten seconds' share of one core, scans included."""

    step_ms: float
    share: float
    kept_mb: float


@cache
def load() -> Load:
    """Serve a hundred phones."""
    case, settings = open_dataset(sample_folder()).cases[0], Settings()
    plan, seen = rasterize(case.plan()), case.scan()
    moves = list(case.walk().odometry().moves())
    busy_s = np.zeros(int(UNTIL_S) + 1)
    steps, phones, kept = [], {}, []
    Localizer(plan, settings, 0).observe(seen)  # loops and fields are ready
    events = [(float(i), i, 0) for i in range(PHONES)]
    while events:
        now_s, i, k = heapq.heappop(events)
        start = time.process_time()
        if k == 0:
            phones[i] = Localizer(plan, settings, i)
            phones[i].observe(seen)
        else:
            phones[i].move(moves[k - 1])
            steps.append(time.process_time() - start)
        busy_s[int(now_s)] += time.process_time() - start
        if k == round(60 / STEP_S):
            kept.append(kept_bytes(phones[i]))
        if k < len(moves) and now_s + STEP_S < UNTIL_S:
            heapq.heappush(events, (now_s + STEP_S, i, k + 1))
    tens = [busy_s[s : s + 10].mean() for s in range(int(UNTIL_S) - 10)]
    return Load(1e3 * statistics.mean(steps), max(tens), max(kept) / 1e6)


def kept_bytes(localizer: Localizer) -> int:
    """Bytes of the arrays that only this localizer holds on to."""
    shared = (PlanRaster, FloorPlan, Settings, type, type(gc))
    seen: set[int] = set()
    waiting: list[Any] = [localizer]
    total = 0
    while waiting:
        each = waiting.pop()
        if id(each) in seen or isinstance(each, shared) or callable(each):
            continue
        seen.add(id(each))
        if isinstance(each, np.ndarray) and each.base is None:
            total += each.nbytes
        waiting.extend(gc.get_referents(each))
    return total


def undecided_mb() -> float:
    """What is kept after a minute where no step has told places apart."""
    localizer = Localizer(raster(), Settings(), 0)
    localizer.observe(scan())
    for move in islice(walk().moves(), 120):
        localizer.move(move)
    return kept_bytes(localizer) / 1e6


def cases() -> list[Case]:
    return [
        Case("100 live localizers: mean step", lambda: load().step_ms, 3.0, unit="ms mean"),
        Case("100 live localizers: busiest ten seconds", lambda: load().share, 1.0, unit="cores"),
        Case("a live localizer keeps, after a minute", lambda: load().kept_mb, 2.0, unit="MB"),
        Case("the same where nothing is decided", undecided_mb, 2.0, unit="MB"),
    ]
