import dataclasses

import numpy as np
import pytest

from palms.floorplan import FloorPlan, SegmentClass
from palms.observation import blurred, see
from palms.raster import rasterize
from palms.settings import ObservationSettings
from tests.worlds import two_rooms

RASTER = rasterize(two_rooms())
OURS = ObservationSettings()


def test_what_a_plan_looks_like_is_kept_and_not_mixed_up():
    other = dataclasses.replace(OURS, wall_sd_m=0.4)
    assert see(RASTER, OURS) is see(RASTER, OURS)
    assert see(RASTER, OURS) is not see(RASTER, other)
    assert blurred(RASTER, OURS, 2) is blurred(RASTER, OURS, 2)
    assert blurred(RASTER, OURS, 2) is not blurred(RASTER, OURS, 3)


@pytest.mark.parametrize(
    ("kind", "supports", "costs"),
    [
        (SegmentClass.WALL, 1.0, 1.0),
        (SegmentClass.DOOR, 0.5, 0.0),
        (SegmentClass.GLASS, 0.5, 0.2),
        (SegmentClass.OPENING, 0.0, 0.0),
    ],
)
def test_a_wall_counts_as_its_class_says(kind, supports, costs):
    room = [[[0, 0], [8, 0]], [[8, 0], [8, 5]], [[8, 5], [0, 5]], [[0, 5], [0, 0]]]
    raster = rasterize(FloorPlan([*room, [[4, 0], [4, 5]]], [0, 0, 0, 0, kind]))
    sight = see(raster, OURS)
    row, column = raster.grid.cell_of([4.0, 2.5])
    rare = OURS.unexplained_share
    best = np.log((supports * (1 - rare) + rare) / rare)
    assert sight.support[row - 5 : row + 6, column - 1 : column + 2].max() == pytest.approx(
        best, abs=1e-5
    )
    crossing = sight.metres[row - 5 : row + 6, column - 2 : column + 3].sum(axis=1)
    np.testing.assert_allclose(crossing * raster.grid.cell_size_m, costs, rtol=0.02)
