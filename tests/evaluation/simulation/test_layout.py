import numpy as np
import pytest
import shapely

from palms.errors import InputError
from palms.evaluation.simulation.layout import (
    OUTSIDE,
    Passage,
    Pose,
    box,
    plan_of_rooms,
    split_row,
)
from palms.floorplan import SegmentClass
from palms.geometry import lengths


def test_a_wall_is_drawn_once_and_doors_are_cut_out():
    rooms = split_row(["A", "B"], [3.0, 4.0], (0.0, 0.0), 5.0)
    plan = plan_of_rooms(rooms, [Passage("A", "B", width_m=0.9)], Pose())
    assert lengths(plan.of_class(SegmentClass.WALL)).sum() == pytest.approx(7 * 2 + 5 * 3 - 0.9)
    assert plan.of_class(SegmentClass.DOOR).tolist() == [[[3.0, 2.05], [3.0, 2.95]]]


def test_a_door_wins_over_the_glass_around_it():
    rooms = {"A": box(0, 0, 6, 4)}
    glass = Passage("A", OUTSIDE, width_m=None, kind=SegmentClass.GLASS)
    plan = plan_of_rooms(rooms, [glass, Passage("A", OUTSIDE, width_m=2.0)], Pose())
    assert lengths(plan.of_class(SegmentClass.GLASS)).sum() == pytest.approx(18.0)
    assert lengths(plan.of_class(SegmentClass.DOOR)).tolist() == [2.0]
    assert not len(plan.of_class(SegmentClass.WALL))


def test_rooms_that_share_no_wall_cannot_have_a_door():
    rooms = {"A": box(0, 0, 2, 2), "B": box(5, 0, 7, 2)}
    with pytest.raises(InputError, match="passage between 'A' and 'B'"):
        plan_of_rooms(rooms, [Passage("A", "B")], Pose())


class TestSampleBuilding:
    def test_it_is_70_by_45_metres_and_turned(self, plan):
        hull = shapely.MultiPoint(plan.segments_m.reshape(-1, 2)).minimum_rotated_rectangle
        corners = shapely.get_coordinates(hull)
        sides = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        np.testing.assert_allclose(np.sort(sides)[[0, -1]], [45.0, 70.0], atol=0.01)
        walls = plan.of_class(SegmentClass.WALL)
        angles = np.degrees(np.arctan2(*(walls[:, 1] - walls[:, 0]).T[::-1])) % 90
        np.testing.assert_allclose(angles[lengths(walls) > 1], 17.0, atol=0.1)

    def test_no_two_segments_overlap(self, plan):
        lines = shapely.linestrings(plan.segments_m)
        total = shapely.union_all(shapely.buffer(lines, 0.005, cap_style="flat")).area
        assert total == pytest.approx(0.01 * lengths(plan.segments_m).sum(), rel=2e-3)

    def test_rooms_cover_the_inside_without_overlap(self, plan):
        shapes = [shapely.Polygon(room.polygon_m) for room in plan.rooms]
        assert all(shape.is_valid for shape in shapes)
        areas = sum(shape.area for shape in shapes)
        assert areas == pytest.approx(70 * 45, abs=0.1)
        assert shapely.union_all(shapes).area == pytest.approx(areas, abs=0.1)
        assert len({room.name for room in plan.rooms}) == len(plan.rooms)

    def test_doors_are_as_wide_as_doors(self, plan):
        wide = lengths(plan.of_class(SegmentClass.DOOR))
        single = wide[wide < 1.2]
        assert (abs(single - 0.95) < 0.06).all()
        assert len(wide) - len(single) >= 4
        assert len(plan.of_class(SegmentClass.OPENING)) == 2
        assert len(plan.of_class(SegmentClass.GLASS)) >= 2

    def test_every_room_can_be_reached(self, plan, free):
        from palms.evaluation.simulation import find_ways

        start = shapely.Polygon(plan.rooms[0].polygon_m).representative_point()
        cost = find_ways(free, [start.x, start.y]).cost
        centres = free.grid.position_of(np.argwhere(np.ones(free.grid.shape)))
        for room in plan.rooms:
            inside = shapely.contains_xy(shapely.Polygon(room.polygon_m), centres)
            assert np.isfinite(cost[inside]).any(), room.name
