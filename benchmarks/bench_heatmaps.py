"""Correlation of plan and scan, templates included."""

import numpy as np
from scipy.signal import fftconvolve

from benchmarks.harness import Case
from benchmarks.world import campus, raster, scan
from palms.heatmap import Heatmaps, match, scan_drifts
from palms.settings import RasterSettings

KILOMETRE = RasterSettings(cell_size_m=0.2, max_cells=30_000_000)


def plainly(maps: Heatmaps) -> None:
    """As scipy does it, in single precision."""
    for k in range(len(maps)):
        turned = np.ascontiguousarray(maps.template(k).values[::-1, ::-1])
        fftconvolve(maps.raster.density, turned, mode="same")


def cases() -> list[Case]:
    floor = raster()
    wide = campus(1000.0, KILOMETRE)
    circle = match(scan(), floor, np.arange(72) * 2 * np.pi / 72)
    four, large = (match(scan(), plan, scan_drifts(scan(), floor)) for plan in (floor, wide))
    return [
        Case(name, lambda m=maps: sum(1 for _ in m), goal, lambda m=maps: plainly(m),
             "scipy.signal.fftconvolve")
        for name, goal, maps in (
            ("4 heatmaps, 1100 x 600 cells", 12.0, four),
            ("72 heatmaps, 1100 x 600 cells", 200.0, circle),
            ("4 heatmaps, 1 km x 1 km at 0.2 m", 1500.0, large),
        )
    ]  # fmt: skip
