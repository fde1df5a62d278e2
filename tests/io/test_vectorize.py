"""The quick ways through a mask are those of scipy.ndimage."""

import numpy as np
import pytest
from scipy import ndimage

from palms.io.vectorize import _long_runs, _Turn, _widened


def masks():
    rng = np.random.default_rng(0)
    for _ in range(40):
        yield rng.random(rng.integers(1, [20, 60], 2, endpoint=True)) < rng.uniform(0.3, 0.98)


@pytest.mark.parametrize("run", range(1, 9))
def test_long_runs_are_an_opening_by_a_row(run):
    for mask in masks():
        expected = ndimage.binary_opening(mask, np.ones((1, run)))
        np.testing.assert_array_equal(_long_runs(mask, run), expected)


def test_widening_is_a_dilation_by_a_square():
    for mask in masks():
        expected = ndimage.binary_dilation(mask, np.ones((3, 3)))
        np.testing.assert_array_equal(_widened(mask), expected)


def picture():
    """A blot with an edge in every direction, off the middle."""
    y, x = np.indices((50, 70))
    return np.hypot(x - 30, 1.5 * (y - 22)) < 18 + 4 * np.sin(5 * np.arctan2(y - 22, x - 30))


@pytest.mark.parametrize("angle_rad", [0.0, 0.3, np.pi / 2, 2.5])
def test_some_cells_turn_as_all_of_them_do(angle_rad):
    mask = picture()
    turn = _Turn.of(mask.shape, angle_rad)
    turned = turn.forth(mask)
    cells = np.nonzero(np.ones(turn.shape, bool))
    np.testing.assert_array_equal(turn.forth_at(mask, cells), turned[cells])
    there = np.nonzero(np.ones(mask.shape, bool))
    again = turn.back_at(turned, there).reshape(mask.shape)
    assert (again == mask)[3:-3, 3:-3].mean() > 0.98  # but where the edge falls between cells
    assert again.sum() == pytest.approx(mask.sum(), rel=0.02)
