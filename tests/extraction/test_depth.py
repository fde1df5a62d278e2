import numpy as np
import pytest

from palms.errors import InputError, SettingsError
from palms.evaluation.simulation import (
    DepthCamera,
    WorldNoise,
    cast_rays,
    make_world,
    sample_building,
    take_depth,
)
from palms.extraction import (
    DepthFrame,
    ExtractionSettings,
    free_ranges,
    points_of,
    scan_from_depth,
)
from palms.floorplan import FloorPlan
from palms.geometry import rotate

SQUARE = FloorPlan([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
HERE, DRIFT = np.array([2.5, 1.8]), 0.4
LEVEL = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 1.4], [0, 0, 0, 1]])  # looks along +y


def turn(camera, plan=SQUARE, here=HERE, noise=None, seed=0):
    rng = np.random.default_rng(seed)
    world = make_world(plan, noise or WorldNoise.none(), rng)
    return take_depth(world, here, DRIFT, camera, rng)


@pytest.fixture(scope="module")
def square():
    return turn(DepthCamera())


def true_ranges(surfaces, position, count=360):
    bearing = (np.arange(count) + 0.5) * 2 * np.pi / count
    return cast_rays(np.broadcast_to(position, (count, 2)), bearing, surfaces)[0]


def test_pixels_go_where_the_camera_looks():
    depth = np.full((5, 7), 2.0)
    depth[0, 0] = np.nan
    ends = DepthFrame(depth, [4, 4], [3, 2], LEVEL).ends_m()
    np.testing.assert_allclose(ends[2, 3], [0, 2, 1.4])  # ahead
    np.testing.assert_allclose(ends[2, 6], [1.5, 2, 1.4])  # right
    np.testing.assert_allclose(ends[4, 3], [0, 2, 0.4])  # down
    assert np.isnan(ends[0, 0]).all()


def test_edges_between_two_surfaces_and_what_is_far_are_no_points():
    depth = np.full((6, 10), 2.0)
    depth[:, 5] = 2.6  # a pixel between the two
    depth[:, 6:] = 3.2
    depth[5, :] = 9.0
    points = points_of([DepthFrame(depth, [60, 60], [5, 3], LEVEL)], ExtractionSettings())
    assert set(points[:, 1].round(3)) == {2.0, 3.2}
    assert len(points) == 4 * 4 + 4 * 3


@pytest.mark.parametrize(
    "changes",
    [
        {"depth_m": [1.0, 2.0]},
        {"pose": 2 * LEVEL},
        {"pose": np.diag([1.0, 1, -1, 1])},
        {"focal_px": [0, 1]},
        {"centre_px": [np.nan, 1]},
    ],
)
def test_a_frame_that_cannot_be_is_refused(changes):
    good = {"depth_m": np.ones((2, 2)), "focal_px": [1, 1], "centre_px": [0, 0], "pose": LEVEL}
    DepthFrame(**good)
    with pytest.raises(InputError):
        DepthFrame(**(good | changes))


def test_a_turn_in_a_room_finds_it_and_its_empty_space(square):
    scan = scan_from_depth(square.frames)
    truth = rotate(SQUARE.segments_m - HERE, -DRIFT)
    assert len(scan.walls_m) == 4
    for wall in scan.walls_m:
        off = np.linalg.norm(truth.reshape(-1, 2)[:, None] - wall, axis=-1).min(axis=0)
        assert (off < 0.03).all()
    np.testing.assert_array_equal(scan.position_m, [0, 0])
    expected = np.minimum(true_ranges(truth, (0, 0)), 5.0)
    off = scan.coverage_m - expected
    assert np.isfinite(scan.coverage_m).all()
    assert off.max() < 0.03  # never beyond a wall
    assert np.median(off) > -0.1
    assert off.min() > -0.3


def test_nobody_looked_where_no_ray_went(square):
    half = [f for f in square.frames if f.pose[1, 2] < 0]  # those that look along +y
    free = free_ranges(half)
    middle = (np.arange(360) + 0.5) * 2 * np.pi / 360
    known = np.isfinite(free)
    assert known[np.abs(middle - np.pi / 2) < 1.2].all()
    assert not known[np.abs(middle - 3 * np.pi / 2) < 0.7].any()


def test_space_beyond_an_open_door_is_empty_and_beyond_a_shut_one_is_not():
    segments = [*SQUARE.segments_m[:3], [[0, 4], [0, 2.3]], [[0, 1.3], [0, 0]]]
    west = np.abs((np.arange(360) + 0.5) * np.pi / 180 - (np.pi - DRIFT)) < 0.1
    open_door = free_ranges(turn(DepthCamera(), FloorPlan(segments)).frames)
    shut = free_ranges(turn(DepthCamera()).frames)
    assert (open_door[west] > 3.5).all()
    assert (shut[west] < 2.6).all()


def test_the_empty_space_of_furnished_rooms_holds_no_wall():
    plan, over = sample_building(), []
    for seed, here in enumerate([(34.5, 25.1), (59.9, 51.0), (66.3, 47.3)]):
        camera = DepthCamera(pitch_rad=0.2)
        taken = turn(camera, plan, np.array(here), WorldNoise(), seed)
        free = free_ranges(taken.frames)
        beyond = free - true_ranges(taken.surfaces_m, (0, 0))
        over.append(beyond[np.isfinite(free)])
    over = np.concatenate(over)
    assert np.quantile(over, 0.99) < 0.05
    assert (over > 0.3).mean() < 0.005


def test_the_place_is_the_cameras_when_the_session_began_elsewhere(square):
    moved = []
    for frame in square.frames:
        pose = frame.pose.copy()
        pose[:2, 3] += [20.0, -7.0]
        moved.append(DepthFrame(frame.depth_m, frame.focal_px, frame.centre_px, pose))
    scan = scan_from_depth(moved)
    assert np.linalg.norm(scan.position_m - [20, -7]) < 0.5
    here = scan_from_depth(moved, (20, -7))
    np.testing.assert_allclose(here.coverage_m, free_ranges(square.frames), atol=0.021)


def test_a_coarser_grid_of_pixels_finds_the_same(square):
    fine, coarse = scan_from_depth(square.frames), scan_from_depth(square.frames, step=2)
    assert len(fine.walls_m) == len(coarse.walls_m)


@pytest.mark.parametrize("frames", [[], [DepthFrame(np.zeros((4, 4)), [3, 3], [1, 1], LEVEL)]])
def test_nothing_to_see(frames):
    with pytest.raises(InputError, match="depth images"):
        scan_from_depth(frames)
    if not frames:
        with pytest.raises(InputError, match="at least one"):
            free_ranges(frames)
    else:
        assert np.isnan(free_ranges(frames)).all()


def test_settings_out_of_range_are_refused():
    for change in ({"cell_m": 0}, {"high_m": 0.5}, {"range_m": float("nan")}):
        with pytest.raises(SettingsError, match=r"extraction\."):
            ExtractionSettings(**change)
