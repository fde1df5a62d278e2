import numpy as np
import pytest
import shapely

from palms._compiled import raster
from tests.compiled import twins


@pytest.mark.parametrize("seed", range(4))
def test_lengths_equal_those_that_shapely_cuts(seed):
    rng = np.random.default_rng(seed)
    segments = rng.uniform(-0.5, 2.5, (12, 4))
    segments[0] = [0.2, 0.35, 1.9, 0.35]  # along x
    segments[1] = [0.75, 0.1, 0.75, 1.4]  # along y
    segments[2] = [0.3, 0.3, 0.3, 0.3]  # no length
    weights = rng.uniform(0.5, 2, 12)
    out = np.zeros((9, 11), np.float64)
    raster.add_lengths(segments, weights, 0.2, False, out)
    assert out == pytest.approx(twins.add_lengths(segments, weights, 0.2, (9, 11)), abs=1e-9)
    spread = np.zeros((9, 11), np.float64)
    raster.add_lengths(segments, weights, 0.2, True, spread)
    slow = twins.add_lengths(segments, weights, 0.2, (9, 11), spread=True)
    assert spread == pytest.approx(slow, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_triangles_fill_the_cells_whose_centre_they_hold(seed):
    rng = np.random.default_rng(seed)
    triangles = rng.uniform(-0.5, 2.5, (6, 6))
    out = np.zeros((25, 31), np.uint8)
    raster.fill_triangles(triangles, 0.07, out)
    assert (out == twins.fill_triangles(triangles, 0.07, (25, 31))).all()


def test_triangles_that_share_an_edge_leave_no_hole_and_count_once():
    square = np.array([[0.0, 0, 1, 0, 1, 1], [0, 0, 1, 1, 0, 1], [0, 0, 1, 0, 1, 1]])
    out = np.zeros((10, 10), np.uint8)
    raster.fill_triangles(square, 0.1, out)
    assert (out == 1).all()


def test_buckets_hold_every_segment_that_comes_near_them():
    rng = np.random.default_rng(0)
    segments = rng.uniform(-0.2, 3.2, (40, 4))
    start, items = raster.bucket_segments(segments, 0.5, 6, 6, 1e-6)
    lines = shapely.linestrings(segments.reshape(-1, 2, 2))
    for b in range(36):
        r, c = divmod(b, 6)
        box = shapely.box(c * 0.5, r * 0.5, c * 0.5 + 0.5, r * 0.5 + 0.5)
        expected = np.flatnonzero(shapely.distance(box, lines) <= 1e-6)
        assert sorted(items[start[b] : start[b + 1]]) == list(expected)


def test_number_marks_what_a_segment_runs_through_and_what_lies_beside():
    rng = np.random.default_rng(8)
    segments = rng.uniform(0, 5, (12, 4))
    out = np.full((20, 20), -1, np.int32)
    raster.number(segments, 0.25, out)
    for i, (x0, y0, x1, y1) in enumerate(segments):
        along = np.linspace(0, 1, 400)[:, None]
        on = np.floor(((1 - along) * [x0, y0] + along * [x1, y1]) / 0.25).astype(int)
        through = out[np.minimum(on[:, 1], 19), np.minimum(on[:, 0], 19)]
        assert (through >= 0).all()
        assert (through[through != i] > i).mean() > 0.8 if (through != i).any() else True
    one = np.full((20, 20), -1, np.int32)
    raster.number(segments[:1], 0.25, one)
    marked = np.argwhere(one == 0)
    centre = (marked[:, ::-1] + 0.5) * 0.25
    line = shapely.LineString(segments[0].reshape(2, 2))
    assert max(line.distance(shapely.Point(p)) for p in centre) < 0.25 * 2.2
