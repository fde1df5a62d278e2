"""Slow twins of the compiled loops: as plain as possible, in Python and numpy."""

from __future__ import annotations

import math

import numpy as np
import shapely

MASK = (1 << 64) - 1
GAMMA, SPREAD = 0x9E3779B97F4A7C15, 0xD1342543DE82EF95
TAIL, AREA, BLOCKS = 3.442619855899, 9.91256303526217e-3, 128


def mixed(x: int) -> int:
    x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & MASK
    return x ^ (x >> 31)


class Stream:
    """Random numbers of one particle."""

    def __init__(self, key: int, i: int) -> None:
        self.state = mixed((key + (i + 1) * SPREAD) & MASK)
        density = math.exp(-0.5 * TAIL**2)
        self.x = [AREA / density, TAIL]
        while len(self.x) < BLOCKS:
            self.x.append(math.sqrt(-2 * math.log(AREA / self.x[-1] + density)))
            density = math.exp(-0.5 * self.x[-1] ** 2)
        self.x.append(0.0)

    def bits(self) -> int:
        self.state = (self.state + GAMMA) & MASK
        return mixed(self.state)

    def uniform(self) -> float:
        return (self.bits() >> 11) * 2.0**-53

    def normal(self) -> float:
        while True:
            bits = self.bits()
            i, u = bits & 127, 2 * ((bits >> 11) * 2.0**-53) - 1
            if abs(u) < self.x[i + 1] / self.x[i]:
                return u * self.x[i]
            if i == 0:
                return self.tail(u)
            x = u * self.x[i]
            f0 = math.exp(-0.5 * (self.x[i] ** 2 - x**2))
            f1 = math.exp(-0.5 * (self.x[i + 1] ** 2 - x**2))
            if f1 + self.uniform() * (f0 - f1) < 1:
                return x

    def tail(self, u: float) -> float:
        while True:
            x = math.log(1 - self.uniform()) / TAIL
            y = math.log(1 - self.uniform())
            if -2 * y >= x * x:
                return x - TAIL if u < 0 else TAIL - x


def add_lengths(segments, weights, cell, shape, spread=False):
    out = np.zeros((shape[0] + 4, shape[1] + 4))  # two cells more on each side
    for (x0, y0, x1, y1), weight in zip(segments, weights, strict=True):
        line = shapely.LineString([(x0, y0), (x1, y1)])
        for r in range(-2, shape[0] + 2):
            for c in range(-2, shape[1] + 2):
                box = shapely.box(c * cell, r * cell, (c + 1) * cell, (r + 1) * cell)
                piece = shapely.intersection(line, box)
                amount = weight * piece.length / cell
                if not spread or amount == 0:
                    out[r + 2, c + 2] += amount
                    continue
                u, v = piece.centroid.x / cell - 0.5, piece.centroid.y / cell - 0.5
                for rr in range(r - 1, r + 2):
                    for cc in range(c - 1, c + 2):
                        share = max(0, 1 - abs(u - cc)) * max(0, 1 - abs(v - rr))
                        if -2 <= rr < shape[0] + 2 and -2 <= cc < shape[1] + 2:
                            out[rr + 2, cc + 2] += amount * share
    return out[2:-2, 2:-2]


def fill_triangles(triangles, cell, shape):
    rows, columns = np.indices(shape)
    out = np.zeros(shape, bool)
    for corners in triangles.reshape(-1, 3, 2):
        polygon = shapely.Polygon(corners)
        out |= shapely.intersects_xy(polygon, (columns + 0.5) * cell, (rows + 0.5) * cell)
    return out


def blocked(walls, start, end):
    """Whether each move touches a wall, by shapely."""
    lines = shapely.linestrings(np.stack([start, end], axis=1))
    return np.array([bool(shapely.intersects(line, walls).any()) for line in lines])


def move(position, drift, scale, step, noise, key):
    new_position, new_drift = np.empty_like(position), np.empty_like(drift)
    length, heading = math.hypot(*step), math.atan2(step[1], step[0])
    for i in range(len(position)):
        stream = Stream(key, i)
        z = [stream.normal() for _ in range(3)]
        new_drift[i] = drift[i] + noise[2] * z[2]
        along, across = length * scale[i] + noise[0] * z[0], noise[1] * z[1]
        a = heading + new_drift[i]
        new_position[i] = position[i] + (
            along * math.cos(a) - across * math.sin(a),
            along * math.sin(a) + across * math.cos(a),
        )
    return new_position, new_drift


def systematic(weights, n, u):
    edges = np.cumsum(weights / weights.sum())
    return np.minimum(np.searchsorted(edges, (np.arange(n) + u) / n, "right"), len(weights) - 1)


def mean_shift(points, bandwidth):
    """Every occupied bin's centroid climbs; modes are merged, densest first."""
    bins = np.floor((points - points.min(axis=0)) / bandwidth).astype(int)
    seeds = sorted({tuple(b) for b in bins[:, ::-1]})
    found = []
    for seed in seeds:
        mode = points[(bins[:, ::-1] == seed).all(axis=1)].mean(axis=0)
        for _ in range(300):
            near = points[np.linalg.norm(points - mode, axis=1) <= bandwidth]
            if not len(near):
                break
            moved = near.mean(axis=0) - mode
            mode = near.mean(axis=0)
            if np.linalg.norm(moved) <= 1e-3 * bandwidth:
                break
        found.append((len(near), mode))
    modes = []
    for _, mode in sorted(found, key=lambda f: -f[0]):
        if all(np.linalg.norm(mode - other) >= bandwidth for other in modes):
            modes.append(mode)
    modes = np.array(modes)
    member = np.linalg.norm(points[:, None] - modes[None], axis=2).argmin(axis=1)
    return modes, member, np.bincount(member, minlength=len(modes))


def heaviest_places(points, weight, radius, n_places):
    """Disc after disc, each about the mean of the three by three bins that weigh most."""
    bins = ((points - points.min(axis=0)) / radius).astype(int)
    place, shares = np.full(len(points), -1), np.zeros(n_places)
    for spot in range(n_places):
        free = place < 0
        around = [
            (weight[free & (np.abs(bins - each) <= 1).all(axis=1)].sum(), -each[1], -each[0])
            for each in np.unique(bins[free], axis=0)
        ]
        if not around:
            break
        _, row, column = max(around)
        near = free & (np.abs(bins - (-column, -row)) <= 1).all(axis=1)
        centre = weight[near] @ points[near] / weight[near].sum()
        member = free & (((points - centre) ** 2).sum(axis=1) <= radius**2)
        place[member], shares[spot] = spot, weight[member].sum()
    return place, shares


def weighted_quantile(distance, weight, share):
    order = np.argsort(distance)
    reached = np.cumsum(weight[order]) >= share * weight.sum() * (1 - 1e-12)
    return distance[order][np.argmax(reached)]


def correlate(plan, template, anchor):
    """Score of the anchor lying on each cell, by four loops; no walls beyond the border."""
    rows, columns = plan.shape
    out = np.zeros(plan.shape)
    for r in range(rows):
        for c in range(columns):
            for i in range(template.shape[0]):
                for j in range(template.shape[1]):
                    rr, cc = r + i - anchor[0], c + j - anchor[1]
                    if 0 <= rr < rows and 0 <= cc < columns:
                        out[r, c] += plan[rr, cc] * template[i, j]
    return out
