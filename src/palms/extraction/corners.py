"""Walls joined where they meet."""

from __future__ import annotations

import numpy as np

from palms.extraction.lines import Wall
from palms.geometry import FloatArray

__all__ = ["join_corners"]


def join_corners(walls: list[Wall], corner_m: float) -> list[Wall]:
    """Move ends to where two walls' lines meet, when both have an end near there.

    Examples
    --------
    >>> a = Wall(np.array([[0.0, 0.0], [2.98, 0.0]]), 0.01, 9)
    >>> b = Wall(np.array([[3.0, 0.03], [3.0, 2.0]]), 0.01, 9)
    >>> join_corners([a, b], 0.15)[0].ends_m.tolist()
    [[0.0, 0.0], [3.0, 0.0]]
    """
    ends = [wall.ends_m.copy() for wall in walls]
    taken = np.full((len(walls), 2), np.inf)
    for i, a in enumerate(walls):
        for j in range(i):
            meeting = _meeting(a.ends_m, walls[j].ends_m)
            if meeting is None:
                continue
            for_a = np.linalg.norm(a.ends_m - meeting, axis=1)
            for_b = np.linalg.norm(walls[j].ends_m - meeting, axis=1)
            if max(for_a.min(), for_b.min()) > corner_m:
                continue
            for k, distance in ((i, for_a), (j, for_b)):
                end = int(distance.argmin())
                if distance[end] < taken[k, end]:
                    ends[k][end], taken[k, end] = meeting, distance[end]
    return [wall._replace(ends_m=moved) for wall, moved in zip(walls, ends, strict=True)]


def _meeting(a: FloatArray, b: FloatArray) -> FloatArray | None:
    """Where the lines of two walls meet; None when they run within 30 degrees."""
    u, v = a[1] - a[0], b[1] - b[0]
    cross = u[0] * v[1] - u[1] * v[0]
    if abs(cross) < 0.5 * np.hypot(*u) * np.hypot(*v):
        return None
    off = b[0] - a[0]
    share = (off[0] * v[1] - off[1] * v[0]) / cross
    return np.asarray(a[0] + share * u)
