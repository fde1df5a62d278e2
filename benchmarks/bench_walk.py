"""Whole walks of 252 steps, heatmaps apart."""

from benchmarks import naive
from benchmarks.harness import Case
from benchmarks.populations import spread
from benchmarks.world import raster, scan, walk
from palms.localizer import Localizer, locate
from palms.settings import Settings


def cases() -> list[Case]:
    settings, plan, moves = Settings.paper(), raster(), list(walk().moves())
    candidates = locate(plan, scan(), settings)

    def follow() -> None:
        localizer = Localizer(plan, settings, 0)
        localizer.start(candidates, scan())
        for move in moves:
            localizer.move(move)

    def plainly() -> None:
        start = spread(2000)
        position, drift = start.position_m, start.drift_rad
        for move in moves:
            by = (move.dx_m, move.dy_m)
            position, drift = naive.step(position, drift, by, plan.walls.segments)

    return [
        Case("walk of 252 steps, method paper, 2,000 particles", follow, 50.0, plainly,
             "naive numba, the moves alone")
    ]  # fmt: skip
