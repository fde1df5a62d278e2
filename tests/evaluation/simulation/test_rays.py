import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.evaluation.simulation.rays import cast_rays, group_lines


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_rays_agree_with_shapely(seed):
    rng = np.random.default_rng(seed)
    segments = rng.uniform(-5, 5, (12, 2, 2))
    origins = rng.uniform(-3, 3, (20, 2))
    bearings = rng.uniform(-np.pi, np.pi, 20)
    ranges, index = cast_rays(origins, bearings, segments)
    ends = origins + 30 * np.column_stack([np.cos(bearings), np.sin(bearings)])
    rays = shapely.linestrings(np.stack([origins, ends], axis=1))
    met = shapely.intersection(rays[:, None], shapely.linestrings(segments)[None])
    away = shapely.distance(shapely.points(origins)[:, None], met)
    away = np.where(np.isnan(away), np.inf, away)
    np.testing.assert_allclose(ranges, away.min(axis=1), atol=1e-6)
    hit = np.isfinite(ranges)
    np.testing.assert_array_equal(index[hit], away.argmin(axis=1)[hit])
    assert (index[~hit] == -1).all()


def test_rays_without_segments_meet_nothing():
    ranges, index = cast_rays(np.zeros((3, 2)), np.zeros(3), np.empty((0, 2, 2)))
    assert np.isinf(ranges).all()
    assert (index == -1).all()


def test_lines_do_not_depend_on_which_end_comes_first():
    a, b = [[0, 0], [3, 1]], [[6, 2], [9, 3]]
    for other in (b, b[::-1]):
        assert len(set(group_lines(np.array([a, other], float), 0.05, 0.03))) == 1
    parallel = np.array([a, [[0, 0.2], [3, 1.2]]], float)
    assert len(set(group_lines(parallel, 0.05, 0.03))) == 2
