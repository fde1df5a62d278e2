import numpy as np
import pytest

from palms.convergence import dominant_cluster, estimated_bandwidth_m, mean_shift


def test_the_dominant_cluster_is_the_one_with_most_points():
    rng = np.random.default_rng(0)
    points = np.concatenate([rng.normal(0, 0.3, (300, 2)), rng.normal(9, 0.2, (200, 2))])
    cluster = dominant_cluster(points, 1.0)
    assert cluster.share == pytest.approx(0.6)
    assert cluster.mode_m == pytest.approx([0, 0], abs=0.1)
    assert cluster.member[:300].all()
    assert not cluster.member[300:].any()


def test_modes_move_with_the_points():
    rng = np.random.default_rng(1)
    points = rng.normal(0, 3, (400, 2))
    a, b = mean_shift(points, 1.0)[0], mean_shift(points + np.array([100.0, -50.0]), 1.0)[0]
    assert b - [100, -50] == pytest.approx(a, abs=1e-6)


def test_the_estimated_bandwidth_grows_with_the_cloud():
    rng = np.random.default_rng(2)
    points = rng.uniform(0, 1, (2000, 2))
    small, large = estimated_bandwidth_m(points), estimated_bandwidth_m(60 * points)
    assert large == pytest.approx(60 * small, rel=1e-6)
    assert large > 15  # what makes the authors' step 2 easy to pass
