"""A whole walk of 252 steps, heatmaps apart."""

from benchmarks.harness import Case
from benchmarks.world import raster, scan, walk
from palms.localizer import Localizer, locate
from palms.settings import Settings


def cases() -> list[Case]:
    settings = Settings.paper()
    candidates, moves = locate(raster(), scan(), settings), list(walk().moves())

    def follow() -> None:
        localizer = Localizer(raster(), settings, 0)
        localizer.start(candidates, scan())
        for move in moves:
            localizer.move(move)

    return [Case("walk of 252 steps, method paper, 2,000 particles", follow)]
