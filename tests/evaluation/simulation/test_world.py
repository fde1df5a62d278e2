import numpy as np
import shapely

from palms.evaluation.simulation import WorldNoise, make_world
from palms.evaluation.simulation.world import inside_of
from palms.floorplan import FloorPlan, SegmentClass


def test_without_noise_the_world_is_the_plan(plan):
    world = make_world(plan, WorldNoise.none(), np.random.default_rng(0))
    solid = plan.of_class(SegmentClass.WALL, SegmentClass.GLASS)
    assert sorted(world.seen_m.tolist()) == sorted(solid.tolist())
    assert world.is_glass.sum() == len(plan.of_class(SegmentClass.GLASS))
    assert sorted(world.blocking_m.tolist()) == sorted(solid.tolist())


def test_faces_stay_near_the_plan(plan):
    noise = WorldNoise(furniture_per_m=0.0, missing_walls=0)
    world = make_world(plan, noise, np.random.default_rng(3))
    walls = shapely.union_all(shapely.linestrings(plan.segments_m))
    middles = shapely.points(world.seen_m.mean(axis=1))
    assert shapely.distance(middles, walls).max() < noise.offset_max_m + 0.11


def test_six_of_ten_doors_are_shut(plan):
    doors = len(plan.of_class(SegmentClass.DOOR))
    counts = []
    for share in (0.0, 0.6, 1.0):
        noise = WorldNoise(furniture_per_m=0.0, door_shut_share=share, missing_walls=0)
        counts.append(len(make_world(plan, noise, np.random.default_rng(0)).seen_m))
    assert counts[2] - counts[0] == doors
    assert abs((counts[1] - counts[0]) / doors - 0.6) < 0.2


def test_furniture_leaves_room_at_doors(plan, world):
    doors = shapely.union_all(shapely.linestrings(plan.of_class(SegmentClass.DOOR)))
    bare = make_world(plan, WorldNoise(furniture_per_m=0.0), np.random.default_rng(1))
    panes = int(world.is_glass.sum())
    boxes = shapely.linestrings(world.blocking_m[len(bare.blocking_m) - panes : -panes])
    assert len(boxes) > 100
    assert shapely.distance(boxes, doors).min() > 0.4


def test_walls_that_are_missing_are_not_there(room, plan):
    kept, gone = (
        make_world(plan, WorldNoise(missing_walls=n, furniture_per_m=0), np.random.default_rng(5))
        for n in (0, 3)
    )
    length = [
        np.linalg.norm(w.blocking_m[:, 1] - w.blocking_m[:, 0], axis=1).sum() for w in (kept, gone)
    ]
    assert 5 < length[0] - length[1] < 45
    everything = WorldNoise(missing_walls=9, furniture_per_m=0)
    assert len(make_world(room, everything, np.random.default_rng(0)).seen_m)


def test_same_seed_same_world(plan, world):
    again = make_world(plan, WorldNoise(), np.random.default_rng(1))
    np.testing.assert_array_equal(again.seen_m, world.seen_m)
    other = make_world(plan, WorldNoise(), np.random.default_rng(2))
    assert other.seen_m.shape != world.seen_m.shape or not np.allclose(other.seen_m, world.seen_m)


def test_without_rooms_the_inside_is_what_walls_enclose():
    corners = np.array([[0, 0], [30, 0], [30, 8], [10, 8], [10, 30], [0, 30]], float)
    ell = np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
    ell[0] = [[1.5, 0.0], [30.0, 0.0]]  # a way in
    inside = inside_of(FloorPlan(ell))
    assert abs(inside.area - shapely.Polygon(corners).area) < 6
    assert not shapely.contains_xy(inside, 20.0, 20.0)
    assert shapely.contains_xy(inside, 5.0, 20.0)
