import numpy as np
import pytest
from scipy import ndimage

from palms._compiled import distance


def masks():
    rng = np.random.default_rng(0)
    for shape in ((1, 1), (1, 9), (7, 1), (2, 2), (40, 60), (61, 33)):
        for share in (0.02, 0.5, 0.97, 0.998):
            mask = rng.random(shape) < share
            mask[rng.integers(shape[0]), rng.integers(shape[1])] = False
            yield mask


@pytest.mark.parametrize("mask", list(masks()), ids=lambda m: f"{m.shape} {m.mean():.2f}")
def test_distances_are_scipys_to_the_bit(mask):
    out = np.empty(mask.shape)
    distance.to_clear(mask, out)
    assert (out == ndimage.distance_transform_edt(mask)).all()


def test_where_all_is_set_it_is_infinitely_far():
    out = np.empty((3, 4))
    distance.to_clear(np.ones((3, 4), np.bool_), out)
    assert np.isinf(out).all()


@pytest.mark.parametrize("mask", list(masks()), ids=lambda m: f"{m.shape} {m.mean():.2f}")
def test_what_is_enclosed_is_what_scipy_fills(mask):
    for walls in (mask, ~mask):
        out = np.empty(walls.shape, np.bool_)
        distance.enclosed(walls, out)
        assert (out == ndimage.binary_fill_holes(walls)).all()
