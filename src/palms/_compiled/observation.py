"""What a scan says about poses: points looked up in fields of the plan."""

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _again(position, drift, i):
    """Whether a pose is the one before it, as when it was drawn twice."""
    return (
        i > 0
        and position[i, 0] == position[i - 1, 0]
        and position[i, 1] == position[i - 1, 1]
        and drift[i] == drift[i - 1]
    )


@njit(cache=True, nogil=True, error_model="numpy")
def lookup(position, drift, points, weight, field, frame, out):
    """Fill out (N,): the weighted sum of a field (R, C) at points (P, 2) seen from each pose.

    A point counts with the cell that it lies in, and not at all off the field. `frame` is
    x and y of the field's lower left corner and cells per metre.
    """
    rows, columns = field.shape
    flat, at = field.ravel(), np.empty(points.shape[0], np.int32)
    for i in range(position.shape[0]):
        if _again(position, drift, i):
            out[i] = out[i - 1]
            continue
        c, s = math.cos(drift[i]) * frame[2], math.sin(drift[i]) * frame[2]
        u0 = (position[i, 0] - frame[0]) * frame[2]
        v0 = (position[i, 1] - frame[1]) * frame[2]
        for k in range(points.shape[0]):
            u = math.floor(u0 + c * points[k, 0] - s * points[k, 1])
            v = math.floor(v0 + s * points[k, 0] + c * points[k, 1])
            on = (u >= 0.0) & (u < columns) & (v >= 0.0) & (v < rows)
            at[k] = np.int32(v * columns + u) if on else -1
        total = 0.0
        for k in range(points.shape[0]):
            if at[k] >= 0:
                total += weight[k] * flat[at[k]]
        out[i] = total


@njit(cache=True, nogil=True, error_model="numpy")
def walls(
    position, drift, points, weight, first, normal, shift, share, unplanned, field, frame,
    out,
):  # fmt: skip
    """Fill out (N,): what walls seen from poses say, in nats, each wall off as a whole.

    Wall w has the points first[w] to first[w + 1] and lies off by shift[j] along its normal
    with probability share[j]; with `unplanned` the plan does not have it, which says nothing.
    `field` (R, C) is what a metre of wall says, 0 off the field; `frame` is x and y of its
    lower left corner and cells per metre.
    """
    rows, columns = field.shape
    n = shift.shape[0]
    flat, at, total = field.ravel(), np.empty(n, np.int32), np.empty(n)
    sum_ = unplanned
    for j in range(n):
        sum_ += (1.0 - unplanned) * share[j]
    nothing = math.log(sum_)
    for i in range(position.shape[0]):
        if _again(position, drift, i):
            out[i] = out[i - 1]
            continue
        c, s = math.cos(drift[i]) * frame[2], math.sin(drift[i]) * frame[2]
        u0 = (position[i, 0] - frame[0]) * frame[2]
        v0 = (position[i, 1] - frame[1]) * frame[2]
        out[i] = 0.0
        for w in range(first.shape[0] - 1):
            across = c * normal[w, 0] - s * normal[w, 1]
            along = s * normal[w, 0] + c * normal[w, 1]
            total[:] = 0.0
            for k in range(first[w], first[w + 1]):
                u = u0 + c * points[k, 0] - s * points[k, 1]
                v = v0 + s * points[k, 0] + c * points[k, 1]
                for j in range(n):  # apart from the sums, so that it becomes vector code
                    column = math.floor(u + shift[j] * across)
                    row = math.floor(v + shift[j] * along)
                    on = (column >= 0.0) & (column < columns) & (row >= 0.0) & (row < rows)
                    at[j] = np.int32(row * columns + column) if on else -1
                for j in range(n):
                    if at[j] >= 0:
                        total[j] += weight[k] * flat[at[j]]
            top = 0.0
            for j in range(n):
                top = max(top, total[j])
            if top == 0.0:
                out[i] += nothing
                continue
            none = math.exp(-top)
            sum_ = unplanned * none
            for j in range(n):
                term = math.exp(total[j] - top) if total[j] > 0.0 else none
                sum_ += (1.0 - unplanned) * share[j] * term
            out[i] += top + math.log(sum_)


@njit(cache=True, nogil=True, error_model="numpy")
def empties(position, drift, points, area, wall, metres, n_walls, per_m, missing, frame, out):
    """Fill out (N,): what the plan's walls in space that is seen empty say, in nats.

    Each of the plan's walls counts by its own metres (R, C: per square metre, and the number
    of the wall, -1 for none) and says that it does not stand there, unless it is `missing`.
    """
    rows, columns = wall.shape
    seen, touched = np.zeros(n_walls), np.empty(n_walls, np.int64)
    for i in range(position.shape[0]):
        if _again(position, drift, i):
            out[i] = out[i - 1]
            continue
        c, s = math.cos(drift[i]) * frame[2], math.sin(drift[i]) * frame[2]
        u0 = (position[i, 0] - frame[0]) * frame[2]
        v0 = (position[i, 1] - frame[1]) * frame[2]
        n = 0
        for k in range(points.shape[0]):
            u = math.floor(u0 + c * points[k, 0] - s * points[k, 1])
            v = math.floor(v0 + s * points[k, 0] + c * points[k, 1])
            if 0 <= u < columns and 0 <= v < rows:
                w = wall[int(v), int(u)]
                if w >= 0:
                    if seen[w] == 0.0:
                        touched[n] = w
                        n += 1
                    seen[w] += area * metres[int(v), int(u)]
        out[i] = 0.0
        for j in range(n):
            w = touched[j]
            out[i] += math.log(missing + (1.0 - missing) * math.exp(-per_m * seen[w]))
            seen[w] = 0.0


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
    last = -1
    for i in range(position.shape[0]):
        if weight[i] < least:
            continue
        x = int(math.floor(position[i, 0] / bin_m)) & 0xFFFFF
        y = int(math.floor(position[i, 1] / bin_m)) & 0xFFFFF
        a = drift[i] - turn * math.floor(drift[i] / turn)
        key = (x << 40) | (y << 20) | int(a / bin_rad)
        if key == last:  # neighbours in the arrays are often neighbours in the building
            continue
        last = key
        at = ((key * 0x2545F4914F6CDD1D) >> 40) & (size - 1)  # bits that x reaches, too
        while table[at] != -1 and table[at] != key:
            at = (at + 1) & (size - 1)
        if table[at] == -1:
            table[at] = key
            n += 1
    return n
