import numpy as np
import pytest

from palms.errors import InputError
from palms.floorplan import FloorPlan
from palms.raster import rasterize
from palms.settings import RasterSettings
from tests.worlds import L_ROOM, closed, two_rooms


def drawn(mask, step=1):
    """A mask as text, top row first."""
    return ["".join(".#"[int(v)] for v in row[::step]) for row in mask[::-step]]


def test_the_wall_in_the_cells_adds_up_to_the_walls_length():
    raster = rasterize(two_rooms())
    total = np.linalg.norm(np.diff(raster.plan.segments_m, axis=1), axis=2).sum()
    assert raster.density.sum() * 0.1 == pytest.approx(total, rel=0.01)


def test_classes_weigh_as_they_should():
    long_wall = [[-3, -3], [9, -3]]
    for kind, weight in ((0, 1.0), (1, 0.5), (2, 0.0), (3, 0.5)):
        plan = FloorPlan([long_wall, [[0, 0], [4, 0]]], classes=[0, kind])
        raster = rasterize(plan)
        row = raster.grid.cell_of([0.0, 0.0])[0]
        assert raster.density[row - 1 : row + 1].sum() * 0.1 == pytest.approx(4 * weight, abs=1e-4)


def test_no_cell_holds_more_than_one_straight_wall():
    twice = FloorPlan([[[0, 0], [5, 0]]] * 7)
    assert rasterize(twice).density.max() <= np.float32(np.sqrt(2))


def test_the_inside_is_what_the_walls_enclose_with_the_walls():
    house = FloorPlan(closed([[0.5, 0.5], [5.5, 0.5], [5.5, 3.5], [0.5, 3.5]]))
    raster = rasterize(house, RasterSettings(cell_size_m=1.0, margin_m=1.0))
    assert drawn(raster.inside) == [
        "........",
        ".######.",
        ".######.",
        ".######.",
        ".######.",
        "........",
    ]


def test_gaps_of_doors_do_not_let_the_inside_out():
    house = closed([[0, 0], [9, 0], [9, 7], [0, 7]])
    house[0] = [[1.2, 0], [9, 0]]  # a door at the corner
    inside = rasterize(FloorPlan(house)).inside
    full = rasterize(FloorPlan(closed([[0, 0], [9, 0], [9, 7], [0, 7]]))).inside
    assert inside.sum() == pytest.approx(full.sum(), rel=0.03)


def test_the_outline_of_the_plan_is_its_inside():
    plan = FloorPlan(L_ROOM, outline_m=[[0, 0], [7, 0], [7, 3], [0, 3]])
    assert rasterize(plan).inside.sum() * 0.01 == pytest.approx(21, rel=0.05)


def test_scattered_walls_have_their_hull_as_inside():
    rng = np.random.default_rng(0)
    start = rng.uniform(0, 40, (30, 2))
    plan = FloorPlan(np.stack([start, start + rng.normal(0, 0.5, (30, 2))], axis=1))
    assert 600 < rasterize(plan).inside.sum() * 0.01 < 1700


def test_a_plan_too_large_for_its_cells_is_refused_before_any_memory_is_taken():
    huge = FloorPlan([[[0, 0], [4000, 3000]]])
    with pytest.raises(InputError, match=r"4004 x 3004 m, 1,202,801,600 cells.*cell size of 0\.78"):
        rasterize(huge)
    wing = FloorPlan([[[0, 0], [60, 40]]])
    few = RasterSettings(max_cells=20_000)
    with pytest.raises(InputError, match=r"cell size of 0\.38 m"):
        rasterize(wing, few)
    assert rasterize(wing, RasterSettings(cell_size_m=0.38, max_cells=20_000)).grid.size <= 20_000


def test_clearance_never_exceeds_the_distance_to_a_wall():
    raster = rasterize(two_rooms())
    rng = np.random.default_rng(1)
    points = rng.uniform([0, 0], [20, 12], (2000, 2))
    rows, columns = raster.grid.cell_of(points).T
    clearance = raster.walls.clearance[rows, columns] * 0.5 * raster.grid.cell_size_m
    from palms.geometry import distance_to_segments

    true = np.array([distance_to_segments(p, raster.plan.blocking_m).min() for p in points])
    assert (clearance <= true + 1.5 * 0.1).all()  # as the loops assume: 3 cells for both
