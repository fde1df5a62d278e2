import numpy as np
import pytest

from palms.evaluation.simulation import (
    DepthCamera,
    WorldNoise,
    make_world,
    sample_building,
    take_depth,
)
from palms.floorplan import FloorPlan
from palms.geometry import distance_to_segments, rotate

SQUARE = FloorPlan([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
HERE, DRIFT = np.array([2.5, 1.8]), 0.4


def turn(camera, seed=0, noise=None, plan=SQUARE, here=HERE):
    rng = np.random.default_rng(seed)
    world = make_world(plan, noise or WorldNoise.none(), rng)
    return take_depth(world, here, DRIFT, camera, rng)


def test_a_perfect_camera_sees_walls_floor_and_ceiling_where_they_are():
    taken = turn(DepthCamera.perfect(frames=8))
    assert len(taken.frames) == 8
    for frame in taken.frames:
        ends = frame.ends_m().reshape(-1, 3)
        ends = ends[np.isfinite(ends[:, 0])]
        on_map = rotate(ends[:, :2], DRIFT) + HERE
        off = np.array([distance_to_segments(point, SQUARE.segments_m).min() for point in on_map])
        level = np.minimum(np.abs(ends[:, 2]), np.abs(ends[:, 2] - 2.7))
        assert np.minimum(off, level).max() < 0.002  # depth is in whole millimetres


def test_what_was_seen_is_the_truth():
    taken = turn(DepthCamera.perfect())
    seen = rotate(taken.seen_m, DRIFT) + HERE
    assert len(seen) == 4
    for wall in seen:
        assert distance_to_segments(wall.mean(axis=0), SQUARE.segments_m).min() < 1e-9


def test_nothing_beyond_the_range_and_errors_as_stated():
    taken = turn(DepthCamera(range_m=3.0, missing_share=0.1, noise_m=0.02, noise_share=0.0))
    exact = turn(DepthCamera.perfect(range_m=3.0))
    far = [np.linalg.norm(f.ends_m() - f.camera_m, axis=-1) for f in exact.frames]
    assert np.nanmax(far) <= 3.001
    missing = np.mean([np.isnan(f.depth_m) for f in taken.frames])
    assert missing > np.mean([np.isnan(f.depth_m) for f in exact.frames]) + 0.05
    flat = np.concatenate([f.depth_m[:, 20:40].ravel() for f in taken.frames[:1]])
    assert np.nanstd(flat) > 0.01


def test_poses_drift_by_so_much():
    drifting, exact = turn(DepthCamera(drift_m=0.2)), turn(DepthCamera(drift_m=0.0))
    off = drifting.frames[-1].camera_m - exact.frames[-1].camera_m
    assert np.linalg.norm(off) == pytest.approx(0.2 * 47 / 48, abs=0.01)
    np.testing.assert_allclose(drifting.frames[0].pose, exact.frames[0].pose)


def test_low_furniture_hides_only_what_is_behind_it():
    noise = WorldNoise(furniture_per_m=0.8, furniture_tall_share=0.0)
    taken = turn(DepthCamera.perfect(), 3, noise, sample_building(), np.array([34.5, 25.1]))
    heights = np.concatenate([f.ends_m()[..., 2].ravel() for f in taken.frames])
    assert np.nanmin(heights) > -0.01
    assert len(taken.surfaces_m) < 60


def test_the_same_seed_gives_the_same_images():
    a, b = turn(DepthCamera(), 5), turn(DepthCamera(), 5)
    for first, second in zip(a.frames, b.frames, strict=True):
        np.testing.assert_array_equal(first.depth_m, second.depth_m)
