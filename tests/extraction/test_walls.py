import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.errors import InputError, PalmsWarning
from palms.extraction import (
    ExtractionSettings,
    floor_height_m,
    scan_from_points,
    walls_from_points,
)
from palms.geometry import distance_to_segments, lengths, rotate
from tests.extraction.clouds import ends, room, slab, turned, wall


def corners_of(found):
    return ends(found).reshape(-1, 2)


@settings(deadline=None, max_examples=25, derandomize=True)
@given(
    angle=st.floats(-3.2, 3.2),
    x=st.floats(-40, 40),
    y=st.floats(-40, 40),
    height=st.floats(-5, 5),
)
def test_a_room_is_found_however_it_lies(angle, x, y, height):
    found = walls_from_points(turned(room(), angle, (x, y, height)))
    assert len(found) == 4
    back = rotate(corners_of(found) - [x, y], -angle)
    np.testing.assert_allclose(np.abs(back), np.tile([2.5, 2.0], (8, 1)), atol=0.01)


def test_the_same_points_give_the_same_walls():
    points = room()
    np.testing.assert_array_equal(
        ends(walls_from_points(points)), ends(walls_from_points(points.copy()))
    )


def test_clutter_is_no_wall_and_hides_none():
    rng = np.random.default_rng(3)
    person = np.column_stack([rng.normal([0.5, 0.5], 0.12, (900, 2)), rng.random(900) * 1.8])
    table = slab([-1.5, -1.2], [-0.3, -0.4], 0.74)
    legs = np.concatenate([wall((x, -1.2), (x + 0.04, -1.2), high=0.74) for x in (-1.5, -0.3)])
    desk = np.concatenate(
        [wall((1.2, 1.4), (2.2, 1.4), high=0.75), slab([1.2, 1.4], [2.2, 2], 0.75)]
    )
    chair = wall((0.2, -0.6), (0.65, -0.6), low=0.4, high=0.95)
    strays = np.column_stack([rng.uniform(-2, 2, (400, 2)), rng.random(400) * 2.5])
    found = walls_from_points(np.concatenate([room(), person, table, legs, desk, chair, strays]))
    assert len(found) == 4
    np.testing.assert_allclose(np.abs(corners_of(found)), np.tile([2.5, 2.0], (8, 1)), atol=0.015)


@pytest.mark.parametrize(
    ("low", "high", "count"),
    [(0.0, 2.5, 1), (0.75, 2.3, 1), (0.0, 0.9, 0), (2.0, 2.5, 0), (1.6, 3.0, 0)],
    ids=["whole", "behind a desk", "counter", "lintel", "duct"],
)
def test_what_is_high_enough_and_comes_down_is_a_wall(low, high, count):
    points = np.concatenate(
        [wall((1, -2), (1, 2), low=low, high=high), slab([-2, -2], [2, 2], 0.0)]
    )
    assert len(walls_from_points(points)) == count


def test_a_wall_ends_at_a_doorway_and_goes_on_behind_it():
    points = np.concatenate([wall((0, 0), (2, 0)), wall((2.9, 0), (5, 0))])
    found = ends(walls_from_points(points))
    assert sorted(lengths(found).round(1).tolist()) == [2.0, 2.1]
    closed = walls_from_points(points, ExtractionSettings(gap_m=1.2))
    assert lengths(ends(closed)).round(1).tolist() == [5.0]


@pytest.mark.parametrize("recess", [0.04, 0.06, 0.1])
def test_a_door_that_is_set_back_is_a_wall_of_its_own(recess):
    parts = [wall((0, 0), (2, 0), noise=0.015), wall((2, recess), (2.95, recess), noise=0.015),
             wall((2.95, 0), (5, 0), noise=0.015)]  # fmt: skip
    found = ends(walls_from_points(np.concatenate(parts)))
    door = [each for each in found if abs(each[:, 0].mean() - 2.475) < 0.2]
    assert len(door) == 1
    np.testing.assert_allclose(door[0][:, 1], recess, atol=0.008)
    assert len(found) == 3


def test_both_faces_of_a_partition_are_found_and_noise_beside_a_wall_is_not():
    two = np.concatenate([wall((0, 0), (3, 0)), wall((0, 0.12), (3, 0.12))])
    assert len(walls_from_points(two)) == 2
    drifted = np.concatenate([wall((0, 0), (3, 0)), wall((0, 0.04), (3, 0.04), per_m2=100)])
    assert len(walls_from_points(drifted)) == 1


def test_short_walls_are_left_out_as_asked():
    points = np.concatenate([wall((0, 0), (3, 0)), wall((0, 2), (0.6, 2))])
    assert len(walls_from_points(points)) == 2
    assert len(walls_from_points(points, ExtractionSettings(min_length_m=0.8))) == 1


def test_a_curved_wall_becomes_chords():
    angle = np.linspace(0, np.pi / 2, 200)
    arc = 4 * np.column_stack([np.cos(angle), np.sin(angle)])
    parts = [wall(a, b, seed=k) for k, (a, b) in enumerate(itertools.pairwise(arc))]
    found = ends(walls_from_points(np.concatenate(parts)))
    assert len(found) >= 3
    assert lengths(found).sum() > 5.0
    radii = np.linalg.norm(found.mean(axis=1), axis=1)
    assert (np.abs(radii - 4) < 0.06).all()


def test_few_points_a_square_metre_are_enough():
    found = walls_from_points(room(per_m2=150))
    np.testing.assert_allclose(np.abs(corners_of(found)), np.tile([2.5, 2.0], (8, 1)), atol=0.02)


def test_no_points_no_walls():
    assert walls_from_points(np.empty((0, 3))) == []
    assert walls_from_points(slab([0, 0], [3, 3], 0.0)) == []
    assert walls_from_points([[0.0, 0.0, 1.0]]) == []
    with pytest.raises(InputError, match="a wall among them"):
        scan_from_points(slab([0, 0], [3, 3], 0.0))


@pytest.mark.parametrize(
    ("points", "words"),
    [([[0, 0]], "shape"), ([[0, 0, np.nan]], "finite"), ([[0, 0, 0], [3000, 0, 0]], "1000 m")],
)
def test_wrong_points_are_refused(points, words):
    with pytest.raises(InputError, match=words):
        walls_from_points(points)


def test_the_floor_is_the_lowest_level_with_little_below():
    heights = room()[:, 2]
    assert floor_height_m(heights) == pytest.approx(0.0, abs=0.01)
    strays = np.concatenate([heights, np.linspace(-3, -0.5, len(heights) // 100)])
    assert floor_height_m(strays) == pytest.approx(0.0, abs=0.01)
    no_floor = wall((0, 0), (3, 0), low=0.7)[:, 2]
    assert floor_height_m(no_floor) == pytest.approx(0.7, abs=0.02)
    assert floor_height_m(no_floor, camera_m=1.5) == pytest.approx(0.1)


def test_the_observation_point_is_the_origin_where_that_can_be():
    assert scan_from_points(room()).position_m.tolist() == [0.0, 0.0]
    assert scan_from_points(room(), (1, 0.5)).position_m.tolist() == [1.0, 0.5]
    with pytest.warns(PalmsWarning, match="stands for the observation point"):
        far = scan_from_points(turned(room(), 0.3, (30, 20, 0)))
    np.testing.assert_allclose(far.position_m, [30, 20], atol=0.01)
    assert distance_to_segments(far.position_m, far.walls_m).min() > 1.9
