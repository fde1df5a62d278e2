"""The default method: a scan, a step with its judgement, a whole walk."""

from itertools import islice

from benchmarks import naive
from benchmarks.harness import Case
from benchmarks.populations import KEY, MOVE
from benchmarks.world import raster, scan, walk
from palms.belief import Belief, summarize
from palms.declaration import evidence_of, judge
from palms.localizer import Localizer, locate
from palms.observation import scan_points, search
from palms.particles import advance
from palms.population import adapted, start_posterior
from palms.posterior import Posterior, judged
from palms.settings import Settings


def on_the_way(found: Posterior, n: int) -> Belief:
    """The belief after some moves."""
    localizer = Localizer(raster(), Settings(), 0)
    localizer.start(found, scan())
    for move in islice(walk().moves(), n):
        localizer.move(move)
    assert localizer.belief is not None
    return localizer.belief


def cases() -> list[Case]:
    ours, plan = Settings(), raster()
    roughly, points = search(scan(), plan), scan_points(scan())
    found = judged(roughly, points, plan, ours.observation)
    start = start_posterior(found, plan, ours, KEY)
    moves = list(walk().moves())
    belief = on_the_way(found, 20)

    def step() -> None:
        moved, info = advance(belief.particles, MOVE, plan, ours.motion, KEY, ours.resampling)
        same = adapted(moved, plan, ours.resampling, len(start), KEY, count=False)
        nats = evidence_of(MOVE.length_m, info, ours.declaration)
        summarize(judge(belief, same, ours.declaration, nats), 1.0, 0.0, ours.answer)

    def follow() -> None:
        localizer = Localizer(plan, ours, 0)
        localizer.start(found, scan())
        for move in moves:
            localizer.move(move)

    by = (MOVE.dx_m, MOVE.dy_m)
    return [
        Case("heatmaps of a scan, all drifts, searched", lambda: search(scan(), plan), 100.0),
        Case("60,000 poses looked at, 20,000 judged",
             lambda: judged(roughly, points, plan, ours.observation)),
        Case("all that a scan takes", lambda: locate(plan, scan(), ours)),
        Case("start: 30,000 particles drawn", lambda: start_posterior(found, plan, ours, KEY)),
        Case("step of 30,000 particles, with its report", step, 3.0,
             lambda: naive.step(start.position_m, start.drift_rad, by, plan.walls.segments),
             "naive numba, the move alone"),
        Case("walk of 252 steps where nothing is decided", follow),
    ]  # fmt: skip
