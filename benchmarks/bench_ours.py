"""Our method: the search of a scan, the start, a step with its judgement, a whole walk."""

from benchmarks.harness import Case
from benchmarks.world import raster, scan, walk
from palms.belief import Belief
from palms.declaration import evidence_of, judge
from palms.localizer import Localizer
from palms.observation import scan_points, search
from palms.odometry import Move
from palms.particles import advance
from palms.population import adapted, start_posterior
from palms.posterior import judged
from palms.randomness import as_key
from palms.settings import Settings

MOVE = Move(1.0, 0.6, 0.0, duration_s=0.5)
KEY = as_key(0)


def cases() -> list[Case]:
    ours, plan = Settings(), raster()
    roughly, points = search(scan(), plan), scan_points(scan())
    found = judged(roughly, points, plan, ours.observation)
    start = start_posterior(found, plan, ours, KEY)
    belief, moves = Belief(start), list(walk().moves())

    def step() -> None:
        moved, info = advance(start, MOVE, plan, ours.motion, KEY, ours.resampling)
        few = adapted(moved, plan, ours.resampling, len(start), KEY)
        judge(belief, few, ours.declaration, evidence_of(MOVE.length_m, info, ours.declaration))

    def follow() -> None:
        localizer = Localizer(plan, ours, 0)
        localizer.start(found, scan())
        for move in moves:
            localizer.move(move)

    return [
        Case("search of a scan, all drifts", lambda: search(scan(), plan), 100.0),
        Case("60,000 poses judged", lambda: judged(roughly, points, plan, ours.observation)),
        Case("start: 30,000 particles drawn", lambda: start_posterior(found, plan, ours, KEY)),
        Case("first step of 30,000 particles, judged", step),
        Case("walk of 252 steps, method palms", follow),
    ]
