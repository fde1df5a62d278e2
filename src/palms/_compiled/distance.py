"""How far each cell lies from others, and which cells are enclosed."""

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def to_clear(mask, out):
    """Fill out (R, C) with the distance of each set cell of a mask to the nearest that is not.

    In cells, exact (Meijster, Roerdink and Hesselink 2000); infinite where all are set.
    """
    rows, columns = mask.shape
    none = rows + columns
    up = np.empty((rows, columns), np.int32)
    for c in range(columns):
        up[0, c] = none if mask[0, c] else 0
    for r in range(1, rows):
        for c in range(columns):
            up[r, c] = min(up[r - 1, c] + 1, none) if mask[r, c] else 0
    for r in range(rows - 2, -1, -1):
        for c in range(columns):
            up[r, c] = min(up[r, c], up[r + 1, c] + 1)
    site, start = np.empty(columns, np.int64), np.empty(columns, np.int64)
    for r in range(rows):
        q = -1
        for u in range(columns):  # the lower envelope of the parabolas of all columns
            gu = np.int64(up[r, u])
            if gu == none:
                continue
            begin = np.int64(0)
            while q >= 0:
                i, at = site[q], start[q]
                gi = np.int64(up[r, i])
                if (at - i) * (at - i) + gi * gi > (at - u) * (at - u) + gu * gu:
                    q -= 1
                    continue
                begin = 1 + (u * u - i * i + gu * gu - gi * gi) // (2 * (u - i))
                break
            if q < 0 or begin < columns:
                q += 1
                site[q] = u
                start[q] = 0 if q == 0 else begin
        for c in range(columns - 1, -1, -1):
            if q < 0:
                out[r, c] = math.inf
                continue
            i = site[q]
            g = np.int64(up[r, i])
            out[r, c] = math.sqrt(float((c - i) * (c - i) + g * g))
            if c == start[q]:
                q -= 1


@njit(cache=True, nogil=True)
def enclosed(walls, out):
    """Fill out (R, C): the walls, and the cells that no way over sides of cells leads out of."""
    rows, columns = walls.shape
    out[:] = 1
    stack = np.empty(rows * columns, np.int64)
    n = 0
    for r in range(rows):
        for c in range(columns):
            border = r == 0 or c == 0 or r == rows - 1 or c == columns - 1
            if border and not walls[r, c]:
                out[r, c] = 0
                stack[n] = r * columns + c
                n += 1
    while n > 0:
        n -= 1
        r, c = stack[n] // columns, stack[n] % columns
        for k in range(4):
            rr, cc = r + (k == 0) - (k == 1), c + (k == 2) - (k == 3)
            if 0 <= rr < rows and 0 <= cc < columns and out[rr, cc] and not walls[rr, cc]:
                out[rr, cc] = 0
                stack[n] = rr * columns + cc
                n += 1
