"""Small worlds that several tests share."""

from __future__ import annotations

import numpy as np

from palms.floorplan import FloorPlan
from palms.odometry import Odometry
from palms.scan import Scan


def closed(corners) -> np.ndarray:
    """Segments (N, 2, 2) of a closed polygon."""
    corners = np.asarray(corners, float)
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)


L_ROOM = closed([[0, 0], [7, 0], [7, 3], [4, 3], [4, 5], [0, 5]])  # no symmetry


def two_rooms() -> FloorPlan:
    """An L-shaped room, a corridor and a hall, joined by doors."""
    walls = [
        *closed([[0, 0], [20, 0], [20, 12], [0, 12]]),
        [[0, 5], [3, 5]], [[4, 5], [11, 5]], [[12, 5], [20, 5]],
        [[0, 7], [6, 7]], [[7, 7], [15, 7]], [[16, 7], [20, 7]],
        [[8, 0], [8, 5]], [[8, 7], [8, 12]], [[13, 7], [13, 10]], [[4, 3], [8, 3]],
    ]  # fmt: skip
    return FloorPlan(np.array(walls, float), name="two rooms")


def seen_from(point, walls, drift_rad: float = 0.0) -> Scan:
    """A noiseless scan of whole walls from a map point, in an odom frame turned by -drift."""
    rel = np.asarray(walls, float) - point
    c, s = np.cos(-drift_rad), np.sin(-drift_rad)
    return Scan(rel @ np.array([[c, s], [-s, c]]))


def walk(steps, drift_rad: float = 0.0, dt: float = 0.55) -> Odometry:
    """A walk by map displacements (T, 2), in an odom frame turned by -drift."""
    c, s = np.cos(-drift_rad), np.sin(-drift_rad)
    moves = np.asarray(steps, float) @ np.array([[c, s], [-s, c]])
    return Odometry(dt * np.arange(1, len(moves) + 1), np.cumsum(moves, axis=0))
