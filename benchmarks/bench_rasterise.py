"""Plan to cells."""

import numpy as np
from scipy import ndimage

from benchmarks.harness import Case
from benchmarks.world import plan, raster
from palms.raster import rasterize


def cases() -> list[Case]:
    walls = np.asarray(raster().density > 0)

    def distances() -> None:
        for mask in (~walls, ~raster().inside):
            ndimage.distance_transform_edt(mask)

    return [
        Case("rasterise 110 x 60 m, 377 walls", lambda: rasterize(plan()), None, distances,
             "its two distance transforms by scipy")
    ]  # fmt: skip
