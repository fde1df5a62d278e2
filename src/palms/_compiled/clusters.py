"""Where the particles gather, and how far they lie from an answer."""

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def _binned(points, cell):
    """Sort points (N, 2) into square bins: corner, bins along y and x, start, order."""
    n = points.shape[0]
    left, bottom = points[0, 0], points[0, 1]
    right, top = left, bottom
    for i in range(n):
        left, right = min(left, points[i, 0]), max(right, points[i, 0])
        bottom, top = min(bottom, points[i, 1]), max(top, points[i, 1])
    columns = int((right - left) / cell) + 1
    rows = int((top - bottom) / cell) + 1
    start = np.zeros(rows * columns + 1, np.int64)
    home = np.empty(n, np.int64)
    for i in range(n):
        home[i] = int((points[i, 1] - bottom) / cell) * columns + int((points[i, 0] - left) / cell)
        start[home[i] + 1] += 1
    for b in range(rows * columns):
        start[b + 1] += start[b]
    order = np.empty(n, np.int64)
    for i in range(n - 1, -1, -1):  # from the back: each bin's end walks to its start
        start[home[i] + 1] -= 1
        order[start[home[i] + 1]] = i
    for b in range(rows * columns):
        start[b] = start[b + 1]
    start[rows * columns] = n
    return left, bottom, rows, columns, start, order


@njit(cache=True, nogil=True)
def _densest_first(density, m, n):
    """Order of the first m densities, 1 to n, densest first, ties as they come: counting sort.

    numpy's sorts would do, but take numba seconds to compile.
    """
    after = np.zeros(n + 2, np.int64)
    for j in range(m):
        after[density[j]] += 1
    for d in range(n, -1, -1):
        after[d] += after[d + 1]
    order = np.empty(m, np.int64)
    for j in range(m - 1, -1, -1):
        after[density[j]] -= 1
        order[after[density[j]]] = j
    return order


@njit(cache=True, nogil=True)
def _climbed(points, bandwidth, tolerance, max_iterations):
    """Where searches by mean shift end (M, 2), one from each occupied bin, and points there (M,).

    The points are brought into the order of their bins first: a window is then a few rows.
    """
    n = points.shape[0]
    left, bottom, rows, columns, start, order = _binned(points, bandwidth)
    px, py = np.empty(n), np.empty(n)
    for k in range(n):
        px[k], py[k] = points[order[k], 0], points[order[k], 1]
    modes, density, m = np.empty((n, 2)), np.empty(n, np.int64), 0
    for b in range(rows * columns):
        if start[b] == start[b + 1]:
            continue
        x, y = 0.0, 0.0
        for k in range(start[b], start[b + 1]):
            x += px[k]
            y += py[k]
        x /= start[b + 1] - start[b]
        y /= start[b + 1] - start[b]
        count = 0
        for _ in range(max_iterations):
            sx, sy, count = 0.0, 0.0, 0
            r = int(math.floor((y - bottom) / bandwidth))
            c = int(math.floor((x - left) / bandwidth))
            low, high = max(0, c - 1), min(columns, c + 2)
            for rr in range(max(0, r - 1), min(rows, r + 2)):
                for k in range(start[rr * columns + low], start[rr * columns + high]):
                    dx, dy = px[k] - x, py[k] - y
                    near = dx * dx + dy * dy <= bandwidth * bandwidth
                    sx += dx if near else 0.0
                    sy += dy if near else 0.0
                    count += near
            if count == 0:
                break
            x += sx / count
            y += sy / count
            if sx * sx + sy * sy <= (tolerance * count) ** 2:
                break
        modes[m, 0], modes[m, 1], density[m] = x, y, count
        m += 1
    return modes[:m], density[:m]


@njit(cache=True, nogil=True)
def _nearest(points, modes, cell):
    """Index (N,) of the mode (M, 2) nearest to each point (N, 2), and how many each has (M,).

    Squares of bins around a point are searched, each larger by one all around, until what
    was found is nearer than any bin left out. Of modes as near as each other, the first.
    """
    left, bottom, rows, columns, start, order = _binned(modes, cell)
    member, counts = np.empty(points.shape[0], np.int64), np.zeros(modes.shape[0], np.int64)
    for i in range(points.shape[0]):
        x, y = points[i, 0], points[i, 1]
        r, c = int(math.floor((y - bottom) / cell)), int(math.floor((x - left) / cell))
        best, nearest, reach = np.inf, 0, 0
        while best >= (0.999 * reach * cell) ** 2:
            reach += 1
            low = min(max(0, c - reach), columns)
            high = min(max(0, c + reach + 1), columns)
            for rr in range(max(0, r - reach), min(rows, r + reach + 1)):
                for k in range(start[rr * columns + low], start[rr * columns + high]):
                    j = order[k]
                    dx, dy = modes[j, 0] - x, modes[j, 1] - y
                    d = dx * dx + dy * dy
                    if d < best or (d == best and j < nearest):
                        best, nearest = d, j
        member[i] = nearest
        counts[nearest] += 1
    return member, counts


@njit(cache=True, nogil=True)
def mean_shift(points, bandwidth, tolerance, max_iterations):
    """Flat-kernel mean shift of points (N, 2), N at least 1 (Comaniciu and Meer 2002).

    Every occupied bin of one bandwidth starts a search at its centroid. Modes nearer than
    a bandwidth to a denser one are dropped; each point belongs to the nearest mode.

    Returns
    -------
    modes (M, 2), densest first; member (N,) the mode of each point; counts (M,).
    """
    modes, density = _climbed(points, bandwidth, tolerance, max_iterations)
    kept, n_kept = np.empty(modes.shape), 0
    for j in _densest_first(density, density.shape[0], points.shape[0]):
        alone = True
        for k in range(n_kept):
            dx, dy = kept[k, 0] - modes[j, 0], kept[k, 1] - modes[j, 1]
            if dx * dx + dy * dy < bandwidth * bandwidth:
                alone = False
                break
        if alone:
            kept[n_kept, 0], kept[n_kept, 1] = modes[j, 0], modes[j, 1]
            n_kept += 1
    member, counts = _nearest(points, kept[:n_kept], bandwidth)
    return kept[:n_kept], member, counts


@njit(cache=True, nogil=True)
def distances(points, x, y, out):
    """Fill out (N,) with the distances of points (N, 2) from (x, y)."""
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] - x, points[i, 1] - y
        out[i] = math.sqrt(dx * dx + dy * dy)


@njit(cache=True, nogil=True)
def variance(points, weight, x, y):
    """Weighted sum of the squared distances of points (N, 2) from (x, y)."""
    total = 0.0
    for i in range(points.shape[0]):
        dx, dy = points[i, 0] - x, points[i, 1] - y
        total += weight[i] * (dx * dx + dy * dy)
    return total


@njit(cache=True, nogil=True)
def weight_within(distance, weight, radius):
    """Weight of the particles within a radius."""
    total = 0.0
    for i in range(distance.shape[0]):
        if distance[i] <= radius:
            total += weight[i]
    return total


@njit(cache=True, nogil=True)
def weighted_quantiles(distance, weight, share, out):
    """Fill out (K,): the smallest distance within which each share (K,) of all weight lies."""
    n = distance.shape[0]
    bins = 512
    far, total = 0.0, 0.0
    for i in range(n):
        far = max(far, distance[i])
        total += weight[i]
    out[:] = far
    if far == 0.0:
        return
    factor = (bins - 1) / far
    mass = np.zeros(bins)
    for i in range(n):
        mass[int(distance[i] * factor)] += weight[i]
    inside = np.empty(n, np.int64)
    for q in range(share.shape[0]):
        wanted = share[q] * total * (1.0 - 1e-12)
        b, below = 0, 0.0
        while b < bins - 1 and below + mass[b] < wanted:
            below += mass[b]
            b += 1
        m = 0
        for i in range(n):
            if int(distance[i] * factor) == b:
                inside[m] = i
                m += 1
        gap = m // 2
        while gap > 0:  # shell sort: few members, and quick to compile
            for k in range(gap, m):
                i, j = inside[k], k
                while j >= gap and distance[inside[j - gap]] > distance[i]:
                    inside[j] = inside[j - gap]
                    j -= gap
                inside[j] = i
            gap //= 2
        for k in range(m):
            out[q] = distance[inside[k]]
            below += weight[inside[k]]
            if below >= wanted:
                break


@njit(cache=True, nogil=True)
def turn_shares(drift, weight, out):
    """Fill out (K,) with the weight of the drifts in each of K equal parts of a turn."""
    bins = out.shape[0]
    out[:] = 0.0
    for i in range(drift.shape[0]):
        turns = drift[i] / (2.0 * math.pi)
        out[min(int((turns - math.floor(turns)) * bins), bins - 1)] += weight[i]


@njit(cache=True, nogil=True)
def _around(mass, rows, columns, b):
    """Sum of the masses of a bin and its neighbours; 0 for a bin without any."""
    if mass[b] <= 0.0:
        return 0.0
    r, c = b // columns, b % columns
    total = 0.0
    for rr in range(max(0, r - 1), min(rows, r + 2)):
        for cc in range(max(0, c - 1), min(columns, c + 2)):
            total += mass[rr * columns + cc]
    return total


@njit(cache=True, nogil=True)
def _claim(points, weight, bins, at, spot, radius, mass, place):
    """Give the disc around the mean of what lies around bin `at` to a spot; return its share.

    Their bins lose what leaves. `bins` is what `_binned` returns.
    """
    _left, _bottom, rows, columns, start, order = bins
    x, y, total, share = 0.0, 0.0, 0.0, 0.0
    r, c = at // columns, at % columns
    for rr in range(max(0, r - 1), min(rows, r + 2)):
        first, last = rr * columns + max(0, c - 1), rr * columns + min(columns, c + 2)
        for k in range(start[first], start[last]):
            i = order[k]
            if place[i] < 0:
                x += weight[i] * points[i, 0]
                y += weight[i] * points[i, 1]
                total += weight[i]
    x /= total
    y /= total
    for rr in range(max(0, r - 2), min(rows, r + 3)):
        for b in range(rr * columns + max(0, c - 2), rr * columns + min(columns, c + 3)):
            mass[b] = 0.0
            for k in range(start[b], start[b + 1]):
                i = order[k]
                if place[i] >= 0:
                    continue
                dx, dy = points[i, 0] - x, points[i, 1] - y
                if dx * dx + dy * dy <= radius * radius:
                    place[i] = spot
                    share += weight[i]
                else:
                    mass[b] += weight[i]
    if share == 0.0:
        mass[at] = 0.0
    return share


@njit(cache=True, nogil=True)
def heaviest_places(points, weight, radius, place, shares):
    """Find up to K spots of most weight, greedily: members of a disc leave after each.

    Fill `place` (N,) int8: the spot that each particle belongs to, or -1; and `shares` (K,),
    0 when unused.
    """
    bins = _binned(points, radius)
    _left, _bottom, rows, columns, start, order = bins
    mass, near = np.zeros(rows * columns), np.zeros(rows * columns)
    some, n_some = np.empty(rows * columns, np.int64), 0
    for b in range(rows * columns):
        some[n_some] = b
        n_some += start[b] < start[b + 1]
        for k in range(start[b], start[b + 1]):
            mass[b] += weight[order[k]]
    for b in some[:n_some]:
        near[b] = _around(mass, rows, columns, b)
    place[:], shares[:] = -1, 0.0
    for spot in range(shares.shape[0]):
        best, at = 0.0, -1
        for b in some[:n_some]:
            if near[b] > best + 1e-12:
                best, at = near[b], b
        if at < 0:
            break
        shares[spot] = _claim(points, weight, bins, at, spot, radius, mass, place)
        for r in range(max(0, at // columns - 3), min(rows, at // columns + 4)):
            for c in range(max(0, at % columns - 3), min(columns, at % columns + 4)):
                near[r * columns + c] = _around(mass, rows, columns, r * columns + c)
