"""The particle filter's loops: random numbers, walls, moves, copies, sums over places."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

TAIL = 3.442619855899  # Marsaglia and Tsang 2000: start of the tail, 128 blocks
AREA = 9.91256303526217e-3  # Marsaglia and Tsang 2000: area of a block
BLOCKS = 128
CHUNK = 128  # particles at a time: what one loop hands to the next stays in the nearest cache


def _ziggurat() -> tuple[np.ndarray, np.ndarray]:
    """Edges of the blocks under the normal density (Doornik 2005, ZIGNOR)."""
    x = np.zeros(BLOCKS + 1)
    density = math.exp(-0.5 * TAIL * TAIL)
    x[0], x[1] = AREA / density, TAIL
    for i in range(2, BLOCKS):
        x[i] = math.sqrt(-2.0 * math.log(AREA / x[i - 1] + density))
        density = math.exp(-0.5 * x[i] * x[i])
    return x, x[1:] / x[:-1]


X, RATIO = _ziggurat()
GAMMA = np.uint64(0x9E3779B97F4A7C15)
SPREAD = np.uint64(0xD1342543DE82EF95)
MIX_1, MIX_2 = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
S11, S27, S30, S31 = np.uint64(11), np.uint64(27), np.uint64(30), np.uint64(31)
LOW_7 = np.uint64(127)
OUTSIDE = 0  # clearance of a cell where no phone can be
SLACK_CELLS = 3.0  # ends may lie off their cell's centre by 0.71 cells, and walls off theirs
TOUCH_M = 1e-9  # a move that comes this near to a wall touches it
PER_QUARTER = 0.6366197723675814  # quarter turns per radian
QUARTER = (1.57079632673412561417, 6.07710050630396597660e-11, 2.02226624871116645580e-21)
SINE = (
    -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04,
    2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10,
)  # fmt: skip
COSINE = (
    4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05,
    -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11,
)  # fmt: skip


class Walls(NamedTuple):
    """What the loops know of the walls; all relative to the map's axes, metres.

    Attributes
    ----------
    segments : (M, 4) float64
        Blocking segments x0, y0, x1, y1.
    clearance : (R, C) uint8
        Distance from a cell to the nearest cell with a wall or outside, in half cells, at
        most 255; 1 in a cell with a wall, 0 outside, where no phone can be.
    start, items : int32
        Bucket b holds the segments items[start[b]:start[b + 1]].
    frame : (6,) float64
        x and y of the lower left corner of cells and buckets, cells per metre, buckets per
        metre, rows and columns of buckets.
    """

    segments: np.ndarray
    clearance: np.ndarray
    start: np.ndarray
    items: np.ndarray
    frame: np.ndarray


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _mixed(x):
    x = (x ^ (x >> S30)) * MIX_1
    x = (x ^ (x >> S27)) * MIX_2
    return x ^ (x >> S31)


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _stream(key, i):
    """First state of particle i's stream (SplitMix64; Steele, Lea, Flood 2014)."""
    return _mixed(key + np.uint64(i + 1) * SPREAD)


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _uniform(state):
    """Return a number in [0, 1) and the next state."""
    state = state + GAMMA
    return float(_mixed(state) >> S11) * 1.1102230246251565e-16, state


@njit(cache=True, nogil=True, error_model="numpy")
def _normal(state):
    """Return a standard normal number and the next state (Doornik 2005, ZIGNOR)."""
    while True:
        state = state + GAMMA
        bits = _mixed(state)
        i = int(bits & LOW_7)
        u = 2.0 * (float(bits >> S11) * 1.1102230246251565e-16) - 1.0
        if abs(u) < RATIO[i]:
            return u * X[i], state
        if i == 0:
            while True:
                v, state = _uniform(state)
                w, state = _uniform(state)
                x = math.log(1.0 - v) / TAIL
                y = math.log(1.0 - w)
                if -2.0 * y >= x * x:
                    return (x - TAIL if u < 0 else TAIL - x), state
        x = u * X[i]
        f0 = math.exp(-0.5 * (X[i] * X[i] - x * x))
        f1 = math.exp(-0.5 * (X[i + 1] * X[i + 1] - x * x))
        v, state = _uniform(state)
        if f1 + v * (f0 - f1) < 1.0:
            return x, state


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _sine_cosine(angle):
    """Of less than 100,000 turns, by the polynomials of fdlibm (Ng 1993).

    Faster than two calls, and the same on every machine.
    """
    k = np.floor(angle * PER_QUARTER + 0.5)
    r = ((angle - k * QUARTER[0]) - k * QUARTER[1]) - k * QUARTER[2]
    z = r * r
    s = SINE[2] + z * (SINE[3] + z * (SINE[4] + z * SINE[5]))
    s = r + r * z * (SINE[0] + z * (SINE[1] + z * s))
    c = COSINE[2] + z * (COSINE[3] + z * (COSINE[4] + z * COSINE[5]))
    c = 1.0 - 0.5 * z + z * z * (COSINE[0] + z * (COSINE[1] + z * c))
    quarter = np.int32(k)
    odd, turned = quarter & 1 != 0, quarter & 2 != 0
    s, c = c if odd else s, -s if odd else c
    return -s if turned else s, -c if turned else c


@njit(cache=True, nogil=True, error_model="numpy")
def normals(key, n, out):
    """Fill out (N, n): row i holds the first n normal numbers of particle i."""
    for i in range(out.shape[0]):
        state = _stream(key, i)
        for k in range(n):
            out[i, k], state = _normal(state)


@njit(cache=True, nogil=True, error_model="numpy")
def uniforms(key, n, out):
    """Fill out (N, n): row i holds the first n uniform numbers of particle i."""
    for i in range(out.shape[0]):
        state = _stream(key, i)
        for k in range(n):
            out[i, k], state = _uniform(state)


@njit(cache=True, nogil=True, error_model="numpy")
def _meets(s, i, x0, y0, x1, y1):
    """Whether a move touches segment i."""
    ax, ay, bx, by = s[i, 0], s[i, 1], s[i, 2], s[i, 3]
    if (
        max(ax, bx) < min(x0, x1) - TOUCH_M
        or min(ax, bx) > max(x0, x1) + TOUCH_M
        or max(ay, by) < min(y0, y1) - TOUCH_M
        or min(ay, by) > max(y0, y1) + TOUCH_M
    ):
        return False
    dx, dy = x1 - x0, y1 - y0
    ex, ey = bx - ax, by - ay
    near = TOUCH_M * math.sqrt(dx * dx + dy * dy)
    o1 = dx * (ay - y0) - dy * (ax - x0)
    o2 = dx * (by - y0) - dy * (bx - x0)
    if (o1 > near and o2 > near) or (o1 < -near and o2 < -near):
        return False
    near = TOUCH_M * math.sqrt(ex * ex + ey * ey)
    o3 = ex * (y0 - ay) - ey * (x0 - ax)
    o4 = ex * (y1 - ay) - ey * (x1 - ax)
    return not ((o3 > near and o4 > near) or (o3 < -near and o4 < -near))


@njit(cache=True, nogil=True, error_model="numpy", forceinline=True)
def _meets_any(segments, start, items, frame, x0, y0, x1, y1):
    """Whether a move touches a wall, bucket by bucket along it (Amanatides and Woo 1987)."""
    rows, columns = int(frame[4]), int(frame[5])
    u0, v0 = (x0 - frame[0]) * frame[3], (y0 - frame[1]) * frame[3]
    du = (x1 - x0) * frame[3]
    dv = (y1 - y0) * frame[3]
    c, r = int(math.floor(u0)), int(math.floor(v0))
    step_c = 1 if du > 0 else -1
    step_r = 1 if dv > 0 else -1
    delta_c = abs(1.0 / du) if du != 0 else math.inf
    delta_r = abs(1.0 / dv) if dv != 0 else math.inf
    next_c = math.inf
    if du != 0:
        next_c = ((c + 1 - u0) if du > 0 else (u0 - c)) * delta_c
    next_r = math.inf
    if dv != 0:
        next_r = ((r + 1 - v0) if dv > 0 else (v0 - r)) * delta_r
    t = 0.0
    while t <= 1.0:
        if 0 <= r < rows and 0 <= c < columns:
            b = r * columns + c
            for k in range(start[b], start[b + 1]):
                if _meets(segments, items[k], x0, y0, x1, y1):
                    return True
        if next_c <= next_r:
            t = next_c
            next_c += delta_c
            c += step_c
        else:
            t = next_r
            next_r += delta_r
            r += step_r
    return False


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _far_from_walls(clearance, frame, x0, y0, x1, y1):
    """Whether both ends lie so far from any wall that none can stand between them.

    False as well for a move that ends outside, which `_blocked` then judges.
    """
    rows, columns = clearance.shape
    c0 = int(math.floor((x0 - frame[0]) * frame[2]))
    r0 = int(math.floor((y0 - frame[1]) * frame[2]))
    c1 = int(math.floor((x1 - frame[0]) * frame[2]))
    r1 = int(math.floor((y1 - frame[1]) * frame[2]))
    if min(c0, r0, c1, r1) < 0 or max(c0, c1) >= columns or max(r0, r1) >= rows:
        return False
    dx, dy = x1 - x0, y1 - y0
    room = 0.5 * (float(clearance[r0, c0]) + float(clearance[r1, c1]))
    return room > math.sqrt(dx * dx + dy * dy) * frame[2] + SLACK_CELLS


@njit(cache=True, nogil=True, error_model="numpy", forceinline=True)
def _blocked(segments, clearance, start, items, frame, x0, y0, x1, y1):
    """Whether a move touches a wall or ends outside; standing still does neither."""
    if x0 == x1 and y0 == y1:
        return False
    rows, columns = clearance.shape
    c1 = math.floor((x1 - frame[0]) * frame[2])
    r1 = math.floor((y1 - frame[1]) * frame[2])
    if not (0 <= c1 < columns and 0 <= r1 < rows) or clearance[r1, c1] == OUTSIDE:
        return True
    return _meets_any(segments, start, items, frame, x0, y0, x1, y1)


@njit(cache=True, nogil=True, error_model="numpy")
def blocked(walls, start, end, out):
    """Fill out (N,): whether the move from start (N, 2) to end (N, 2) is blocked."""
    segments, clearance, first, items, frame = walls
    for i in range(start.shape[0]):
        x0, y0, x1, y1 = start[i, 0], start[i, 1], end[i, 0], end[i, 1]
        out[i] = not _far_from_walls(clearance, frame, x0, y0, x1, y1) and _blocked(
            segments, clearance, first, items, frame, x0, y0, x1, y1
        )


@njit(cache=True, nogil=True, error_model="numpy")
def _three_normals(key, first, z, quick):
    """Fill z (3, M) with the first normal numbers of M particles from `first` on.

    By the quick way of `_normal` for all of them, which becomes vector code; then anew for
    the few (3 %) that need the long way.
    """
    for j in range(quick.shape[0]):
        state = _stream(key, first + j)
        quick[j] = True
        for k in range(3):
            state = state + GAMMA
            bits = _mixed(state)
            i = int(bits & LOW_7)
            u = 2.0 * (float(bits >> S11) * 1.1102230246251565e-16) - 1.0
            z[k, j] = u * X[i]
            quick[j] &= abs(u) < RATIO[i]
    for j in range(quick.shape[0]):
        if not quick[j]:
            state = _stream(key, first + j)
            for k in range(3):
                z[k, j], state = _normal(state)


@njit(cache=True, nogil=True, error_model="numpy")
def move(position, drift, scale, step, noise, key, walls, new_position, new_drift, hit):
    """Move every particle by one step of the odometry; return how many hit a wall.

    Parameters
    ----------
    step : (dx, dy) in the odom frame.
    noise : standard deviations along the move, across it, and of the drift.
    """
    segments, clearance, start, items, frame = walls
    dx, dy = step
    along, across, turning = noise
    length = math.sqrt(dx * dx + dy * dy)
    ux, uy = (dx / length, dy / length) if length > 0 else (1.0, 0.0)
    z = np.empty((3, CHUNK))
    n_hit = 0
    for first in range(0, position.shape[0], CHUNK):
        last = min(first + CHUNK, position.shape[0])
        _three_normals(key, first, z, hit[first:last])
        for i in range(first, last):  # apart from the walls, so that it becomes vector code
            angle = drift[i] + turning * z[2, i - first]
            far = length * scale[i] + along * z[0, i - first]
            side = across * z[1, i - first]
            sx, sy = far * ux - side * uy, far * uy + side * ux
            s, c = _sine_cosine(angle)
            z[0, i - first] = position[i, 0] + c * sx - s * sy
            z[1, i - first] = position[i, 1] + s * sx + c * sy
            new_drift[i] = angle
        for i in range(first, last):
            x0, y0 = position[i, 0], position[i, 1]
            x1, y1 = z[0, i - first], z[1, i - first]
            new_position[i, 0], new_position[i, 1] = x1, y1
            hit[i] = not _far_from_walls(clearance, frame, x0, y0, x1, y1) and _blocked(
                segments, clearance, start, items, frame, x0, y0, x1, y1
            )
            n_hit += hit[i]
    return n_hit


@njit(cache=True, nogil=True, error_model="numpy")
def replace_hits(position, drift, scale, label, hit, spread, key, walls):
    """Replace, in place, each particle that hit by a copy of a random survivor.

    The copy's place is jittered by spread[0] without crossing a wall, its drift by
    spread[1]. With no survivor nothing changes.
    """
    segments, clearance, start, items, frame = walls
    n = position.shape[0]
    survivors = np.empty(n, np.int32)
    m = 0
    for i in range(n):
        if not hit[i]:
            survivors[m] = i
            m += 1
    if m == 0:
        return
    for i in range(n):
        if not hit[i]:
            continue
        state = _stream(key, i)
        u, state = _uniform(state)
        j = survivors[min(int(u * m), m - 1)]
        x0, y0 = position[j, 0], position[j, 1]
        x1, y1 = x0, y0
        for _ in range(8):
            z0, state = _normal(state)
            z1, state = _normal(state)
            x, y = x0 + spread[0] * z0, y0 + spread[0] * z1
            if not _blocked(segments, clearance, start, items, frame, x0, y0, x, y):
                x1, y1 = x, y
                break
        z0, state = _normal(state)
        position[i, 0], position[i, 1] = x1, y1
        drift[i] = drift[j] + spread[1] * z0
        scale[i], label[i] = scale[j], label[j]


@njit(cache=True, nogil=True, error_model="numpy")
def gathered(position, drift, weight, place, out):
    """Fill out (K, 5) with sums over the particles of each place, in order.

    Of the weight, and of it times x, y, cosine and sine of the drift. Particle i belongs to
    place[i]; those of -1 are left out.
    """
    out[:] = 0.0
    some, turn = np.empty(CHUNK, np.int64), np.empty(CHUNK)
    sines, cosines = np.empty(CHUNK), np.empty(CHUNK)
    for first in range(0, weight.shape[0], CHUNK):
        m = 0
        for i in range(first, min(first + CHUNK, weight.shape[0])):
            some[m], turn[m] = i, drift[i]
            m += place[i] >= 0
        for j in range(m):  # apart from the sums, so that it becomes vector code
            sines[j], cosines[j] = _sine_cosine(turn[j])
        for j in range(m):
            i = some[j]
            k, w = place[i], weight[i]
            out[k, 0] += w
            out[k, 1] += w * position[i, 0]
            out[k, 2] += w * position[i, 1]
            out[k, 3] += w * cosines[j]
            out[k, 4] += w * sines[j]


@njit(cache=True, nogil=True, error_model="numpy")
def place(cells, drifts, index, cell, origin, key, position, drift):
    """Place particles uniformly within cells (C, 2), each with its cell's drift."""
    for i in range(index.shape[0]):
        state = _stream(key, i)
        u, state = _uniform(state)
        v, state = _uniform(state)
        j = index[i]
        position[i, 0] = origin[0] + (cells[j, 1] + u) * cell
        position[i, 1] = origin[1] + (cells[j, 0] + v) * cell
        drift[i] = drifts[j]
