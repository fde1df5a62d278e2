import dataclasses

import numpy as np
import pytest
from scipy.ndimage import distance_transform_edt

import palms.raster as raster_module
from palms.floorplan import FloorPlan, SegmentClass
from palms.observation import blurred, see, sight
from palms.raster import rasterize
from palms.settings import ObservationSettings, RasterSettings
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


@pytest.mark.parametrize("cell_size_m", [0.1, 0.23])
def test_support_falls_with_the_distance_from_a_wall(cell_size_m):
    raster = rasterize(two_rooms(), RasterSettings(cell_size_m=cell_size_m))
    away_m = cell_size_m * distance_transform_edt(see(raster, OURS).metres == 0)
    for field, sd, rare in (
        (see(raster, OURS), OURS.wall_sd_m, OURS.unexplained_share),
        (blurred(raster, OURS), OURS.search_sd_m, OURS.search_share),
    ):
        likely = (1 - rare) * np.exp(-0.5 * (away_m / sd) ** 2) + rare
        np.testing.assert_allclose(field.support, np.log(likely / rare), rtol=1e-6, atol=1e-15)


def test_all_that_a_scan_is_looked_up_in_is_made_at_once(monkeypatch):
    measured = []
    monkeypatch.setattr(
        sight, "away_cells", lambda mask: measured.append(mask) or raster_module.away_cells(mask)
    )
    raster = rasterize(two_rooms(), RasterSettings(cell_size_m=0.1))
    coarse = sight.coarseness(raster.grid, OURS)
    assert coarse == 2
    poses, maps, cells = see(raster, OURS), blurred(raster, OURS, coarse), blurred(raster, OURS)
    assert len(measured) == 1  # a plan of one class of walls
    assert poses.metres is cells.metres
    assert maps.grid.shape == tuple(-(-n // 2) for n in raster.grid.shape)
