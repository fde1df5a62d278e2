import numpy as np
import pytest

from palms._compiled import select


@pytest.mark.parametrize("seed", range(6))
def test_the_nth_largest_is_what_sorting_gives(seed):
    rng = np.random.default_rng(seed)
    kinds = [
        rng.normal(0, 1, 50_000),
        np.repeat(rng.normal(0, 1, 40), 500),  # ties
        np.zeros(20_000),
        rng.exponential(1, 30_000) ** 8,  # nearly all in one bin
        np.concatenate([np.zeros(30_000), [1e9]]),
        np.array([3.0]),
    ]
    values = kinds[seed].astype(np.float32)
    for n in {1, 2, len(values) // 100 + 1, len(values) // 2 + 1, len(values)}:
        if n <= len(values):
            assert select.nth_largest(values, n) == np.sort(values)[-n]


def test_cells_at_or_above_a_threshold_come_in_order():
    scores = np.array([[1, 5, 2], [5, 0, 7]], np.float32)
    assert select.at_least(scores, np.float32(5)).tolist() == [1, 3, 5]
