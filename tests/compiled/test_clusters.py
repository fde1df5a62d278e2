import numpy as np
import pytest

from palms._compiled import clusters
from tests.compiled import twins


def clouds(seed):
    rng = np.random.default_rng(seed)
    centres = rng.uniform(0, 30, (6, 2))
    sizes = rng.integers(20, 120, 6)
    near = [c + rng.normal(0, 0.4, (n, 2)) for c, n in zip(centres, sizes, strict=True)]
    return np.concatenate([*near, rng.uniform(0, 30, (60, 2))])


@pytest.mark.parametrize("seed", range(8))
def test_mean_shift_equals_its_twin(seed):
    points = clouds(seed)
    modes, member, counts = clusters.mean_shift(points, 1.0, 1e-3, 300)
    slow_modes, slow_member, slow_counts = twins.mean_shift(points, 1.0)
    assert modes == pytest.approx(slow_modes, abs=1e-6)
    assert (member == slow_member).all()
    assert (counts == slow_counts).all()


def test_mean_shift_of_one_place_is_one_cluster():
    modes, member, counts = clusters.mean_shift(np.full((50, 2), 3.0), 1.0, 1e-3, 300)
    assert modes.tolist() == [[3.0, 3.0]]
    assert counts.tolist() == [50]
    assert (member == 0).all()


@pytest.mark.parametrize("seed", range(8))
def test_the_nearest_mode_is_found_from_anywhere_and_the_first_of_equals(seed):
    rng = np.random.default_rng(seed)
    modes = np.round(rng.uniform(0, 1 + 5 * seed, (1 + 12 * seed, 2)))  # with ties, some twice
    points = np.concatenate([np.round(rng.uniform(-30, 60, (300, 2))), rng.normal(size=(99, 2))])
    member, counts = clusters._nearest(points, modes, 1.0)
    away = ((points[:, None] - modes) ** 2).sum(axis=2)
    assert (member == away.argmin(axis=1)).all()
    assert (counts == np.bincount(member, minlength=len(modes))).all()


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("share", [0.01, 0.5, 0.68, 0.95, 1.0])
def test_quantiles_of_distance_equal_sorting(seed, share):
    rng = np.random.default_rng(seed)
    distance = np.round(rng.exponential(2, 700), 1)  # with ties
    weight = rng.random(700)
    fast = np.empty(2)
    clusters.weighted_quantiles(distance, weight, np.array([share, 0.5]), fast)
    slow = [twins.weighted_quantile(distance, weight, each) for each in (share, 0.5)]
    assert fast == pytest.approx(slow)


def test_the_quantile_of_particles_in_one_place_is_zero():
    radius = np.full(1, 9.0)
    clusters.weighted_quantiles(np.zeros(4), np.ones(4), np.array([0.95]), radius)
    assert radius[0] == 0.0


def test_distances_and_weights_within():
    points = np.array([[0.0, 0.0], [3.0, 4.0], [1.0, 0.0]])
    away = np.empty(3)
    clusters.distances(points, 0.0, 0.0, away)
    assert away.tolist() == [0.0, 5.0, 1.0]
    assert clusters.weight_within(away, np.array([0.2, 0.5, 0.3]), 1.0) == pytest.approx(0.5)


def heaviest_places(points, weight, n):
    place, shares = np.full(len(points), 9, np.int8), np.full(n, 9.0)  # nothing of this stays
    clusters.heaviest_places(points, weight, 2.0, place, shares)
    return place, shares


@pytest.mark.parametrize("seed", range(5))
def test_the_heaviest_places_are_disjoint_and_ranked(seed):
    rng = np.random.default_rng(seed)
    points = np.concatenate(
        [rng.normal([5, 5], 0.3, (500, 2)), rng.normal([20, 9], 0.3, (300, 2)),
         rng.uniform(0, 30, (100, 2))]
    )  # fmt: skip
    weight = np.full(len(points), 1 / len(points))
    place, shares = heaviest_places(points, weight, 5)
    assert shares[0] == pytest.approx(500 / 900, abs=0.03)
    assert shares[1] == pytest.approx(300 / 900, abs=0.03)
    assert shares.sum() <= 1 + 1e-9
    for k in range(5):
        assert shares[k] == pytest.approx(weight[place == k].sum())
        if (place == k).any():
            member = points[place == k]
            assert np.ptp(member, axis=0).max() <= 4.0 + 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_the_heaviest_places_equal_their_twin(seed):
    points = clouds(seed)
    weight = np.random.default_rng(seed).random(len(points)) ** 3
    for n in (1, 5):
        place, shares = heaviest_places(points, weight / weight.sum(), n)
        slow_place, slow_shares = twins.heaviest_places(points, weight / weight.sum(), 2.0, n)
        assert (place == slow_place).all()
        assert shares == pytest.approx(slow_shares, abs=1e-12)


def test_the_variance_about_a_point_is_the_weighted_mean_square():
    rng = np.random.default_rng(1)
    points, weight = rng.normal(size=(900, 2)), rng.random(900)
    away = ((points - (0.5, -1.0)) ** 2).sum(axis=1)
    found = clusters.variance(points, weight, 0.5, -1.0)
    assert found == pytest.approx(float((weight * away).sum()))


def test_shares_of_a_turn_are_numpys_histogram():
    rng = np.random.default_rng(5)
    drift, weight, found = rng.uniform(-20, 20, 4000), rng.random(4000), np.empty(72)
    drift[:3] = 0.0, 2 * np.pi, -2 * np.pi
    clusters.turn_shares(drift, weight, found)
    index = np.minimum((np.mod(drift / (2 * np.pi), 1.0) * 72).astype(int), 71)
    assert (found == np.bincount(index, weight, 72)).all()
