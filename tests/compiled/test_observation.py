import math

import numpy as np
import pytest

from palms._compiled import observation as loops

FRAME = np.array([-0.7, 0.3, 4.0])


def cell_under(position, drift, point, shift=(0.0, 0.0)):
    """(row, column) of a point, given in metres, and shifted, seen from a pose."""
    c, s = math.cos(drift), math.sin(drift)
    x, y = point[0] + shift[0], point[1] + shift[1]
    column = math.floor((position[0] + c * x - s * y - FRAME[0]) * FRAME[2])
    return math.floor((position[1] + s * x + c * y - FRAME[1]) * FRAME[2]), column


def on(cell, field):
    return 0 <= cell[0] < field.shape[0] and 0 <= cell[1] < field.shape[1]


def test_walls_equal_their_twin():
    rng = np.random.default_rng(3)
    field = rng.uniform(0, 3, size=(40, 30)).astype(np.float32)
    position, drift = rng.uniform(-2, 9, (100, 2)), rng.uniform(-9, 9, 100)
    points, weight = rng.normal(0, 2, (17, 2)), rng.uniform(0, 1, 17)
    first, angle = np.array([0, 5, 6, 17]), rng.uniform(0, 6, 3)
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    shift, share, unplanned = np.array([-0.4, 0.0, 0.4]), np.array([0.2, 0.5, 0.3]), 0.1
    out = np.empty(100)
    loops.walls(
        position, drift, points, weight, first, normal, shift, share, unplanned, field, FRAME, out
    )
    for i in range(100):
        expected = 0.0
        for w in range(3):
            chance = unplanned
            for by, part in zip(shift, share, strict=True):
                nats = 0.0
                for k in range(first[w], first[w + 1]):
                    cell = cell_under(position[i], drift[i], points[k], by * normal[w])
                    nats += weight[k] * field[cell] if on(cell, field) else 0.0
                chance += (1 - unplanned) * part * math.exp(nats)
            expected += math.log(chance)
        assert out[i] == pytest.approx(expected, abs=1e-6)


def test_empties_equal_their_twin():
    rng = np.random.default_rng(6)
    wall = rng.integers(-1, 4, (40, 30)).astype(np.int32)
    metres = rng.uniform(0.1, 3, size=(40, 30)).astype(np.float32)
    position, drift = rng.uniform(-2, 9, (100, 2)), rng.uniform(-9, 9, 100)
    points, out = rng.normal(0, 2, (23, 2)), np.empty(100)
    loops.empties(position, drift, points, 0.04, wall, metres, 4, 2.0, 0.1, FRAME, out)
    for i in range(100):
        seen = np.zeros(4)
        for point in points:
            cell = cell_under(position[i], drift[i], point)
            if on(cell, wall) and wall[cell] >= 0:
                seen[wall[cell]] += 0.04 * metres[cell]
        expected = np.log(0.1 + 0.9 * np.exp(-2.0 * seen)).sum()
        assert out[i] == pytest.approx(expected, abs=1e-6)


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
