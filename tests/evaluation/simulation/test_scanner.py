from dataclasses import replace

import numpy as np
import pytest
import shapely

from palms.evaluation.simulation import ScannerNoise, WorldNoise, make_world, take_scan
from palms.evaluation.simulation.patches import noisy_planes
from palms.geometry import directions, lengths, wrap_angle

HERE, DRIFT = np.array([1.7, 1.2]), 0.8


@pytest.fixture
def empty_room(room):
    return make_world(room, WorldNoise.none(), np.random.default_rng(0))


def test_an_empty_room_without_noise_gives_exactly_its_walls(empty_room, room):
    taken = take_scan(empty_room, HERE, DRIFT, ScannerNoise.none(), np.random.default_rng(0))
    found = taken.to_map(taken.scan.walls_m)
    assert len(found) == 4
    for wall in room.segments_m:
        errors = [min(abs(f - wall).max(), abs(f[::-1] - wall).max()) for f in found]
        assert min(errors) < 1e-6


def test_coverage_is_what_is_free(empty_room):
    taken = take_scan(empty_room, HERE, DRIFT, ScannerNoise.none(), np.random.default_rng(1))
    bearings = np.radians(np.arange(360) + 0.5) + DRIFT
    far = HERE + 9 * np.column_stack([np.cos(bearings), np.sin(bearings)])
    walls = shapely.box(0, 0, 4, 3)
    rays = shapely.linestrings(np.stack([np.broadcast_to(HERE, far.shape), far], axis=1))
    true = shapely.length(shapely.intersection(rays, walls))
    free = taken.scan.coverage_m
    assert (free <= true + 0.03).all()
    assert np.median(true - free) < 0.05


def test_a_part_of_a_turn_sees_a_part(empty_room):
    noise = replace(ScannerNoise.none(), turn_rad=np.pi / 2)
    taken = take_scan(empty_room, HERE, DRIFT, noise, np.random.default_rng(2))
    looked = np.isfinite(taken.scan.coverage_m)
    assert abs(looked.sum() - 150) <= 2
    assert np.abs(np.diff(looked.astype(int), append=int(looked[0]))).sum() == 2
    assert lengths(taken.scan.walls_m).sum() < 14.0


def test_nothing_beyond_the_range_is_seen(world, plan):
    middle = plan.segments_m.reshape(-1, 2).mean(axis=0)
    noise = ScannerNoise.none()
    taken = take_scan(world, middle, 0.0, noise, np.random.default_rng(0))
    reach = np.linalg.norm(taken.scan.walls_m, axis=2).max()
    assert reach < noise.range_m + 2 * noise.circle_max_m + 0.1
    assert taken.scan.coverage_m.max() <= noise.range_m


def test_planes_are_as_noisy_as_stated():
    wall = np.array([[[2.0, -1.5], [2.0, 1.5]]])
    noise = replace(ScannerNoise(), spurious_count=0.0)
    rng = np.random.default_rng(0)
    drawn = [noisy_planes(wall, np.zeros(2), noise, rng) for _ in range(4000)]
    planes = np.concatenate(drawn)
    assert 1 - len(planes) / len(drawn) == pytest.approx(0.12, abs=0.02)
    turned = wrap_angle(directions(planes) - np.pi / 2)
    assert np.degrees(turned.std()) == pytest.approx(1.2, rel=0.05)
    assert lengths(planes).std() == pytest.approx(np.hypot(0.12, 0.12), rel=0.05)
    along = planes[:, 1] - planes[:, 0]
    normal = np.column_stack([-along[:, 1], along[:, 0]]) / lengths(planes)[:, None]
    offset = ((planes[:, 0] - [2.0, 0.0]) * normal).sum(axis=1)
    assert np.abs(offset).max() < 0.3
    centre = planes.mean(axis=1)[:, 0] - 2.0
    assert centre.std() == pytest.approx(0.04, rel=0.1)


def test_planes_at_grazing_incidence_are_missed_more():
    wall = np.array([[[2.0, 0.2], [5.0, 0.2]]])
    noise = replace(ScannerNoise(), spurious_count=0.0)
    rng = np.random.default_rng(0)
    missed = np.mean([len(noisy_planes(wall, np.zeros(2), noise, rng)) == 0 for _ in range(1000)])
    assert missed > 0.3


def test_spurious_planes_come_at_their_rate():
    wall = np.array([[[2.0, -1.5], [2.0, 1.5]]])
    noise = replace(ScannerNoise.none(), spurious_count=0.8)
    rng = np.random.default_rng(0)
    extra = [len(noisy_planes(wall, np.zeros(2), noise, rng)) - 1 for _ in range(3000)]
    assert np.mean(extra) == pytest.approx(0.8, rel=0.1)


def test_same_seed_same_scan(world):
    spot = np.array([68.2, 39.2])
    a, b = (take_scan(world, spot, 1.0, ScannerNoise(), np.random.default_rng(9)) for _ in "ab")
    np.testing.assert_array_equal(a.scan.walls_m, b.scan.walls_m)
    np.testing.assert_array_equal(a.scan.coverage_m, b.scan.coverage_m)
