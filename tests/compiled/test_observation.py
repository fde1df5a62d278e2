import math

import numpy as np
import pytest

from palms._compiled import observation as loops


def test_lookup_equals_its_twin():
    rng = np.random.default_rng(3)
    field = rng.normal(size=(40, 30)).astype(np.float32)
    position, drift = rng.uniform(-2, 9, (200, 2)), rng.uniform(-9, 9, 200)
    points, weight = rng.normal(0, 2, (17, 2)), rng.uniform(0, 1, 17)
    frame = np.array([-0.7, 0.3, 4.0])
    out = np.empty(200)
    loops.lookup(position, drift, points, weight, field, frame, out)
    for i in range(200):
        c, s = math.cos(drift[i]), math.sin(drift[i])
        total = 0.0
        for (x, y), w in zip(points, weight, strict=True):
            column = math.floor((position[i, 0] + c * x - s * y - frame[0]) * frame[2])
            row = math.floor((position[i, 1] + s * x + c * y - frame[1]) * frame[2])
            if 0 <= row < 40 and 0 <= column < 30:
                total += w * field[row, column]
        assert out[i] == pytest.approx(total, abs=1e-9)


def test_splat_keeps_weight_and_first_moments():
    rng = np.random.default_rng(4)
    points, weight = rng.uniform(-1.5, 1.5, (50, 2)), rng.uniform(0, 1, 50)
    out = np.zeros((41, 41))
    loops.splat(points, weight, 0.7, 0.1, out)
    assert out.sum() == pytest.approx(weight.sum())
    c, s = math.cos(0.7), math.sin(0.7)
    turned = points @ np.array([[c, s], [-s, c]])
    axis = (np.arange(41) - 20) * 0.1
    assert out.sum(axis=0) @ axis == pytest.approx(weight @ turned[:, 0])
    assert out.sum(axis=1) @ axis == pytest.approx(weight @ turned[:, 1])


def test_occupied_counts_bins_as_a_set_does():
    rng = np.random.default_rng(5)
    position, drift = rng.normal(0, 4, (3000, 2)), rng.uniform(-20, 20, 3000)
    weight = rng.uniform(0, 1, 3000)
    bins = {
        (math.floor(x / 0.5), math.floor(y / 0.5), int((a % (2 * math.pi)) / 0.3))
        for (x, y), a, w in zip(position, drift, weight, strict=True)
        if w >= 0.2
    }
    assert loops.occupied(position, drift, weight, 0.2, 0.5, 0.3) == len(bins)
    assert loops.occupied(position, drift, weight, 2.0, 0.5, 0.3) == 0
