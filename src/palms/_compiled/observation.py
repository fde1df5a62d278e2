"""What a scan says about poses: points looked up in fields."""

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def lookup(position, drift, points, weight, field, frame, out):
    """Fill out (N,): the weighted sum of a field (R, C) at points (P, 2) seen from each pose.

    A point counts with the cell that it lies in, and not at all off the field. `frame` is
    x and y of the field's lower left corner and cells per metre.
    """
    rows, columns = field.shape
    for i in range(position.shape[0]):
        c, s = math.cos(drift[i]) * frame[2], math.sin(drift[i]) * frame[2]
        u0 = (position[i, 0] - frame[0]) * frame[2]
        v0 = (position[i, 1] - frame[1]) * frame[2]
        total = 0.0
        for k in range(points.shape[0]):
            u = math.floor(u0 + c * points[k, 0] - s * points[k, 1])
            v = math.floor(v0 + s * points[k, 0] + c * points[k, 1])
            if 0 <= u < columns and 0 <= v < rows:
                total += weight[k] * field[int(v), int(u)]
        out[i] = total


@njit(cache=True, nogil=True, error_model="numpy")
def splat(points, weight, angle, cell, out):
    """Add points (P, 2), turned by an angle about the middle cell's centre, to a square raster.

    Each is shared between the four cells whose centres surround it; none may lie off the
    raster.
    """
    half = out.shape[0] // 2
    c, s = math.cos(angle) / cell, math.sin(angle) / cell
    for k in range(points.shape[0]):
        u = c * points[k, 0] - s * points[k, 1] + half
        v = s * points[k, 0] + c * points[k, 1] + half
        left, below = int(math.floor(u)), int(math.floor(v))
        u, v = u - left, v - below
        out[below, left] += weight[k] * (1.0 - u) * (1.0 - v)
        out[below, left + 1] += weight[k] * u * (1.0 - v)
        out[below + 1, left] += weight[k] * (1.0 - u) * v
        out[below + 1, left + 1] += weight[k] * u * v


@njit(cache=True, nogil=True, error_model="numpy")
def occupied(position, drift, weight, least, bin_m, bin_rad):
    """Count the bins of place and drift that hold a particle of at least so much weight.

    A hash table of open addressing, since the bins of a building may be millions.
    """
    size = 16
    while size < 2 * position.shape[0]:
        size *= 2
    table = np.full(size, -1, np.int64)
    turn = 2.0 * math.pi
    n = 0
    for i in range(position.shape[0]):
        if weight[i] < least:
            continue
        x = int(math.floor(position[i, 0] / bin_m)) & 0xFFFFF
        y = int(math.floor(position[i, 1] / bin_m)) & 0xFFFFF
        a = drift[i] - turn * math.floor(drift[i] / turn)
        key = (x << 40) | (y << 20) | int(a / bin_rad)
        at = ((key * 0x2545F4914F6CDD1D) >> 20) & (size - 1)
        while table[at] != -1 and table[at] != key:
            at = (at + 1) & (size - 1)
        if table[at] == -1:
            table[at] = key
            n += 1
    return n
