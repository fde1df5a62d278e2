"""Points on surfaces, for tests."""

import numpy as np

from palms.geometry import rotate


def wall(a, b, *, low=0.0, high=2.5, per_m2=400, noise=0.004, seed=0):
    """Points (P, 3) on an upright rectangle between two points of the ground."""
    rng = np.random.default_rng(seed)
    a, b = np.asarray(a, float), np.asarray(b, float)
    count = int(per_m2 * np.linalg.norm(b - a) * (high - low))
    ground = a + rng.random((count, 1)) * (b - a) + rng.normal(0, noise, (count, 2))
    return np.column_stack([ground, low + rng.random(count) * (high - low)])


def slab(low, high, at, per_m2=400, seed=1):
    """Points on a level rectangle."""
    rng = np.random.default_rng(seed)
    low, high = np.asarray(low, float), np.asarray(high, float)
    count = int(per_m2 * np.prod(high - low))
    ground = low + rng.random((count, 2)) * (high - low)
    return np.column_stack([ground, at + rng.normal(0, 0.004, count)])


def room(width=5.0, depth=4.0, **changes):
    """Four walls and a floor around the origin."""
    x, y = width / 2, depth / 2
    corners = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
    parts = [wall(a, b, seed=k, **changes) for k, (a, b) in enumerate(sides)]
    return np.concatenate([*parts, slab([-x, -y], [x, y], 0.0)])


def turned(points, angle, shift=(0.0, 0.0, 0.0)):
    """Points turned about the vertical and moved."""
    return np.column_stack([rotate(points[:, :2], angle), points[:, 2]]) + shift


def ends(found):
    """Ends (N, 2, 2) of walls."""
    return np.array([each.ends_m for each in found]).reshape(-1, 2, 2)
