import numpy as np
import pytest
import shapely

from palms.evaluation.simulation import (
    PlanNoise,
    Stretch,
    draw_plan,
    draw_stretch,
    generate_building,
)
from palms.floorplan import SegmentClass
from palms.geometry import lengths


def drawn(plan, seed=0, **noise):
    quiet = dict.fromkeys(PlanNoise.__slots__, 0.0) | noise
    return draw_plan(plan, PlanNoise(**quiet), Stretch(), np.random.default_rng(seed))


def metres(plan, *kinds):
    return float(lengths(plan.of_class(*kinds or (SegmentClass.WALL,))).sum())


def test_without_noise_the_drawing_is_the_plan(plan):
    same = drawn(plan)
    np.testing.assert_array_equal(same.segments_m, plan.segments_m)
    np.testing.assert_array_equal(same.classes, plan.classes)
    assert [room.name for room in same.rooms] == [room.name for room in plan.rooms]


def test_partitions_are_missing_or_moved(plan):
    missing = drawn(plan, missing_share=0.5)
    assert 0.6 < metres(missing) / metres(plan) < 0.95
    moved = drawn(plan, moved_share=0.5, moved_m=1.0)
    assert metres(moved) == pytest.approx(metres(plan))
    shift = np.linalg.norm(moved.segments_m.mean(axis=1) - plan.segments_m.mean(axis=1), axis=1)
    assert 10 < (shift > 0).sum() < 60
    assert 0.25 <= shift[shift > 0].min() < shift.max() <= 1.0
    corridors = [r for r in plan.rooms if "corridor" in r.name]
    rings = shapely.union_all([shapely.LinearRing(r.polygon_m) for r in corridors])
    on_corridor = shapely.covered_by(
        shapely.linestrings(plan.segments_m), shapely.buffer(rings, 0.01)
    )
    assert not shift[on_corridor].any()


def test_rooms_are_merged_and_keep_one_name(plan):
    merged = drawn(plan, merged_share=0.3)
    assert len(merged.rooms) < len(plan.rooms)
    assert metres(merged) < metres(plan)
    area = [sum(shapely.Polygon(r.polygon_m).area for r in p.rooms) for p in (plan, merged)]
    assert area[0] == pytest.approx(area[1], abs=0.5)
    assert {r.name for r in merged.rooms} < {r.name for r in plan.rooms}


def test_undrawn_doors_are_walls(plan):
    doors = len(plan.of_class(SegmentClass.DOOR))
    kept = len(drawn(plan, door_undrawn_share=0.4).of_class(SegmentClass.DOOR))
    assert 0.45 * doors < kept < 0.75 * doors


def test_columns_are_left_out():
    plan = generate_building("office", 5)
    sides = np.isclose(lengths(plan.segments_m), 0.45, atol=0.002).sum()
    assert sides >= 8
    assert len(drawn(plan, column_undrawn_share=1.0).segments_m) == len(plan.segments_m) - sides


def test_walls_as_two_faces_enclose_the_lines(plan):
    faces = drawn(plan, two_faces_share=1.0)
    assert 1.8 < metres(faces) / metres(plan) < 2.4
    assert len(faces.of_class(SegmentClass.DOOR)) == len(plan.of_class(SegmentClass.DOOR))
    lines = shapely.union_all(shapely.linestrings(plan.of_class(SegmentClass.WALL)))
    middles = shapely.points(faces.of_class(SegmentClass.WALL).mean(axis=1))
    away = shapely.distance(middles, lines)
    assert away.max() < 0.2
    assert np.median(away) > 0.04


def test_the_scale_is_off_by_a_percent_sometimes_one_way_only(plan):
    noise = PlanNoise(scale_sd=0.01, one_way_share=0.5)
    rng = np.random.default_rng(0)
    values = [
        np.linalg.svd(draw_stretch(plan, noise, rng).matrix, compute_uv=False) for _ in range(600)
    ]
    off = np.array(values) - 1.0
    one_way = np.isclose(np.abs(off).min(axis=1), 0.0, atol=1e-9)
    assert 0.4 < one_way.mean() < 0.6
    worst = np.where(np.abs(off[:, 0]) > np.abs(off[:, 1]), off[:, 0], off[:, 1])
    assert worst.std() == pytest.approx(0.01, rel=0.1)


def test_places_move_with_the_drawing(plan):
    stretch = Stretch((50.0, 30.0), [[1.02, 0.0], [0.0, 1.0]])
    noise = PlanNoise.none()
    wide = draw_plan(plan, noise, stretch, np.random.default_rng(0))
    np.testing.assert_allclose(wide.segments_m, stretch.apply(plan.segments_m))
    room = plan.rooms[20]
    inside = shapely.Polygon(room.polygon_m).representative_point()
    assert wide.room_at(stretch.apply([inside.x, inside.y])) == room.name
