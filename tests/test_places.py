import numpy as np
import pytest

from palms.grid import Grid
from palms.heatmap import Candidates
from palms.places import find_places

GRID = Grid((0.0, 0.0), 0.1, (200, 200))


def candidates(cells, score, label=None, weight=None, mass=1.0):
    n = len(cells)
    weight = np.full(n, 1 / max(n, 1)) if weight is None else np.asarray(weight, float)
    return Candidates(
        GRID,
        np.array([0.1, 3.5]),
        np.asarray(cells, np.int32).reshape(-1, 2),
        np.asarray([0] * n if label is None else label, np.int32),
        np.asarray(score, np.float32),
        np.log(weight),
        mass,
    )


def test_cells_within_the_separation_are_one_place_at_the_best_of_them():
    (place,) = find_places(candidates([[10, 10], [10, 14], [13, 10]], [1, 5, 2]))
    assert (place.x_m, place.y_m) == pytest.approx((1.45, 1.05))
    assert place.p == pytest.approx(1.0)
    assert place.score == 5


def test_drifts_are_kept_apart_and_wrapped():
    places = find_places(candidates([[10, 10], [10, 10]], [2, 1], label=[0, 1]))
    assert [place.drift_rad for place in places] == pytest.approx([0.1, 3.5 - 2 * np.pi])


def test_a_cell_goes_to_the_nearest_peak_that_came_before_it():
    # peaks at columns 0 and 18 (1.8 m apart); column 10 is nearer to the second, which is
    # higher than the cell; column 8 is nearer to the first
    places = find_places(candidates([[5, 0], [5, 18], [5, 10], [5, 8]], [9, 8, 7, 6]))
    assert sorted(round(4 * place.p) for place in places) == [2, 2]
    # the peak at column 18 comes after the cell at column 10: it stays with the first
    places = find_places(candidates([[5, 0], [5, 10], [5, 18]], [9, 8, 7]))
    assert [(round(place.x_m, 2), round(3 * place.p)) for place in places] == [(0.05, 2), (1.85, 1)]


def test_most_probable_first_and_ties_by_score():
    cells = [[10, 10], [10, 60], [10, 120]]
    places = find_places(candidates(cells, [1, 2, 3], weight=[0.5, 0.25, 0.25]))
    assert [place.score for place in places] == [1, 3, 2]


@pytest.mark.parametrize("seed", range(3))
def test_against_a_slow_twin(seed):
    rng = np.random.default_rng(seed)
    cells = rng.permutation(np.stack(np.indices((40, 40)), -1).reshape(-1, 2))[:300]
    weight = rng.random(300)
    found = candidates(cells, rng.permutation(300), rng.integers(0, 2, 300), weight / weight.sum())
    expected = slow_places(found, 1.0)
    places = find_places(found, 1.0)
    got = sorted((round(p.x_m, 3), round(p.y_m, 3), round(p.p, 9)) for p in places)
    assert got == expected


@pytest.mark.parametrize("shape", [(1900, 12), (12, 1900)])
def test_places_far_apart_along_either_axis(shape):
    rng = np.random.default_rng(7)
    cells = rng.integers(0, shape, (2000, 2))
    cells = np.unique(cells, axis=0)
    weight = rng.random(len(cells))
    found = candidates(
        cells, rng.permutation(len(cells)), rng.integers(0, 2, len(cells)), weight / weight.sum()
    )
    got = sorted((round(p.x_m, 3), round(p.y_m, 3), round(p.p, 9)) for p in find_places(found, 1.0))
    assert got == slow_places(found, 1.0)


def slow_places(found, separation):
    shares = np.exp(found.log_weight)
    result = []
    for label in (0, 1):
        peaks = []
        for i in np.argsort(-found.score):
            if found.label[i] != label:
                continue
            here = found.position_m[i]
            near = [p for p in peaks if np.linalg.norm(p[0] - here) <= separation]
            if near:
                min(near, key=lambda p: np.linalg.norm(p[0] - here))[1].append(shares[i])
            else:
                peaks.append((here, [shares[i]]))
        result += [(round(x, 3), round(y, 3), round(sum(p), 9)) for (x, y), p in peaks]
    return sorted(result)


def test_probabilities_sum_to_the_mass():
    places = find_places(candidates([[10, 10], [10, 60]], [2, 1], mass=0.8))
    assert sum(place.p for place in places) == pytest.approx(0.8)


def test_vanishing_weights_do_no_harm():
    places = find_places(candidates([[1, 1], [90, 90]], [2, 1], weight=[1.0, 1e-300]))
    assert [place.p for place in places] == pytest.approx([1.0])  # dust is left out


def test_no_candidates_no_places():
    assert find_places(candidates([], [])) == ()
