"""Plan to cells."""

from benchmarks.harness import Case
from benchmarks.world import plan
from palms.raster import rasterize


def cases() -> list[Case]:
    return [Case("rasterise 110 x 60 m, 377 walls", lambda: rasterize(plan()))]
