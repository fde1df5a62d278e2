"""What one would write first: baselines that do the same work plainly."""

import math

import numpy as np
from numba import njit


@njit(error_model="numpy")
def meets_any(x0, y0, x1, y1, walls):
    """Whether a move crosses any of the walls (M, 4): each is looked at."""
    for k in range(walls.shape[0]):
        ax, ay, bx, by = walls[k, 0], walls[k, 1], walls[k, 2], walls[k, 3]
        o1 = (x1 - x0) * (ay - y0) - (y1 - y0) * (ax - x0)
        o2 = (x1 - x0) * (by - y0) - (y1 - y0) * (bx - x0)
        o3 = (bx - ax) * (y0 - ay) - (by - ay) * (x0 - ax)
        o4 = (bx - ax) * (y1 - ay) - (by - ay) * (x1 - ax)
        if o1 * o2 <= 0 and o3 * o4 <= 0:
            return True
    return False


@njit(error_model="numpy")
def crossings(start, end, walls, out):
    """Fill out (N,): whether each move crosses a wall."""
    for i in range(start.shape[0]):
        out[i] = meets_any(start[i, 0], start[i, 1], end[i, 0], end[i, 1], walls)


@njit(error_model="numpy")
def step(position, drift, move, walls):
    """Move with numpy's normal numbers, look at all walls, replace those that hit."""
    n = position.shape[0]
    after, turned, hit = np.empty((n, 2)), np.empty(n), np.empty(n, np.bool_)
    length = math.hypot(move[0], move[1])
    for i in range(n):
        turned[i] = drift[i] + np.random.normal(0.0, 0.007)  # noqa: NPY002 - what numba has
        far, side = length + np.random.normal(0.0, 0.05), np.random.normal(0.0, 0.016)  # noqa: NPY002
        ux, uy = move[0] / length, move[1] / length
        x, y = far * ux - side * uy, far * uy + side * ux
        c, s = math.cos(turned[i]), math.sin(turned[i])
        after[i, 0] = position[i, 0] + c * x - s * y
        after[i, 1] = position[i, 1] + s * x + c * y
        hit[i] = meets_any(position[i, 0], position[i, 1], after[i, 0], after[i, 1], walls)
    alive = np.flatnonzero(~hit)
    if len(alive):
        for i in range(n):
            if hit[i]:
                j = alive[np.random.randint(0, len(alive))]  # noqa: NPY002
                after[i], turned[i] = after[j], turned[j]
    return after, turned


def resample(weights: np.ndarray, n: int, u: float) -> np.ndarray:
    """Systematic resampling in numpy."""
    return np.searchsorted(np.cumsum(weights), (np.arange(n) + u) / n * weights.sum())
