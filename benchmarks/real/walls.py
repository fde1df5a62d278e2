"""Walls from laser returns: lines grown through a grid of hits, without any randomness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter
from scipy.spatial import KDTree

from palms.geometry import FloatArray, directions, distance_to_segments, lengths

CELL_M = 0.05  # of the hit grid
MIN_SCANS = 2  # a cell counts when so many scans hit it,
RIDGE_CELLS = 7  # and at least
RIDGE_SHARE = 0.4  # this share of the hits of the busiest cell in a window of so many cells
NEAR_M = 0.4  # neighbourhood that gives a cell its direction
SEED_RESIDUAL_M = 0.05  # a seed's neighbourhood is this straight
THICK_M = 0.08  # cells this near to a line belong to it
CLAIM_M = 0.14  # and those this near give rise to no other line
GAP_M = 0.35  # lines are split at wider gaps
MIN_LENGTH_M = 0.5
MIN_FILL = 0.65  # share of a line's length that has hits
SCALES = (1.0, 2.0)  # second look at what is left: walls smeared by poses that are off
ROUNDS = 8  # refits while a line grows
PARALLEL_RAD = np.radians(10.0)  # duplicates: more parallel than this,
TWIN_M = 0.2  # nearer than this,
TWIN_SHARE = 0.6  # and this much of the shorter one beside the longer one
SHORT_M, TOUCH_M = 1.0, 0.35  # shorter walls that touch no longer one are furniture


@dataclass(frozen=True)
class _Cells:
    """Centres of gravity of the hits in each cell, with the local direction."""

    at: FloatArray  # (N, 2)
    direction: FloatArray  # (N, 2)
    support: FloatArray  # (N,): neighbours on the local line, 0 where it is not straight


def fit_walls(hits_m: FloatArray, scans: FloatArray) -> FloatArray:
    """Fit wall segments (W, 2, 2) to laser returns (H, 2) of scans (H,), longest first."""
    at = _cells(hits_m, scans)
    walls: list[FloatArray] = []
    for scale in SCALES:
        found = _lines(_with_directions(at, scale), scale)
        at = at[~np.any([_beside(at, wall, scale) for wall in found], axis=0)] if found else at
        walls += found
    return _without_furniture(_without_twins(np.array(walls))) if walls else np.empty((0, 2, 2))


def _lines(cells: _Cells, scale: float) -> list[FloatArray]:
    free = np.ones(len(cells.at), bool)
    walls = []
    for seed in np.argsort(-cells.support, kind="stable"):
        if cells.support[seed] < MIN_LENGTH_M / CELL_M / 2:
            break
        if not free[seed]:
            continue
        wall = _grow(cells, int(seed), free, scale)
        if wall is None:
            free[seed] = False
        else:
            walls.append(wall)
            free &= ~_beside(cells.at, wall, scale)
    return walls


def _cells(hits_m: FloatArray, scans: FloatArray) -> FloatArray:
    """Grid the hits and keep the cells (N, 2) hit by several scans, where walls are densest."""
    index = np.floor(hits_m / CELL_M).astype(np.int64)
    index -= index.min(axis=0)
    shape = tuple(index.max(axis=0) + 1)
    cell = np.ravel_multi_index(tuple(index.T), shape)
    pair = np.unique(np.stack([cell, scans], axis=1), axis=0)
    n_scans = np.bincount(pair[:, 0], minlength=shape[0] * shape[1])
    busiest = maximum_filter(n_scans.reshape(shape), RIDGE_CELLS).ravel()
    kept = np.flatnonzero((n_scans >= MIN_SCANS) & (n_scans >= RIDGE_SHARE * busiest))
    count = np.bincount(cell, minlength=len(n_scans))
    sums = [np.bincount(cell, hits_m[:, k], len(n_scans)) for k in (0, 1)]
    return np.stack([total[kept] / count[kept] for total in sums], axis=1)


def _with_directions(at: FloatArray, scale: float) -> _Cells:
    """Find the direction and the support of each cell's neighbourhood."""
    pairs = KDTree(at).query_pairs(scale * NEAR_M, output_type="ndarray")
    i = np.concatenate([pairs[:, 0], pairs[:, 1], np.arange(len(at))])
    j = np.concatenate([pairs[:, 1], pairs[:, 0], np.arange(len(at))])
    n = np.bincount(i, minlength=len(at))
    mean = np.stack([np.bincount(i, at[j, k], len(at)) / n for k in (0, 1)], axis=1)
    dx, dy = (at[j] - mean[i]).T
    sxx, sxy, syy = (np.bincount(i, v, len(at)) / n for v in (dx * dx, dx * dy, dy * dy))
    angle = 0.5 * np.arctan2(2 * sxy, sxx - syy)
    half = np.hypot((sxx - syy) / 2, sxy)
    residual = np.sqrt(np.maximum((sxx + syy) / 2 - half, 0))
    straight = (residual < scale * SEED_RESIDUAL_M) & (half > 0)
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return _Cells(at, direction, np.where(straight, n, 0))


def _grow(cells: _Cells, seed: int, free: FloatArray, scale: float) -> FloatArray | None:
    """Grow a line from a seed until it stays as it is; None when it is no wall."""
    origin, along = cells.at[seed], cells.direction[seed]
    at = cells.at[free]
    before = None
    for _ in range(ROUNDS):
        rel = at - origin
        t, side = rel @ along, rel @ np.array([-along[1], along[0]])
        member = _run(t, np.abs(side) < scale * THICK_M)
        if member.sum() < 3:
            return None
        if before is not None and np.array_equal(member, before):
            break
        origin, along, before = *_line(at[member]), member
    t = (at[member] - origin) @ along
    length = float(np.ptp(t))
    fill = len(np.unique(np.floor(t / CELL_M))) * CELL_M
    if length < scale * MIN_LENGTH_M or fill < MIN_FILL * length:
        return None
    return np.stack([origin + t.min() * along, origin + t.max() * along])


def _run(t: FloatArray, near: FloatArray) -> FloatArray:
    """Which cells belong to the stretch without a gap that holds, or is next to, t = 0."""
    index = np.flatnonzero(near)
    if not len(index):
        return near
    index = index[np.argsort(t[index], kind="stable")]
    piece = np.concatenate([[0], np.cumsum(np.diff(t[index]) > GAP_M)])
    mine = piece[np.abs(t[index]).argmin()]
    member = np.zeros(len(t), bool)
    member[index[piece == mine]] = True
    return member


def _line(at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Total least squares: a point on the line and its direction."""
    mean = at.mean(axis=0)
    _, vectors = np.linalg.eigh(np.cov((at - mean).T))
    return mean, vectors[:, -1]


def _beside(at: FloatArray, wall: FloatArray, scale: float) -> FloatArray:
    """Which points lie so near to a wall that they are explained by it."""
    d = wall[1] - wall[0]
    length = np.linalg.norm(d)
    rel = at - wall[0]
    t, side = rel @ d / length, np.abs(rel @ np.array([-d[1], d[0]])) / length
    claim = scale * CLAIM_M
    return (side < claim) & (t > -claim) & (t < length + claim)


def _without_twins(walls: FloatArray) -> FloatArray:
    """Drop walls that run beside a longer one: the same wall, seen from a shifted pose."""
    walls = walls[np.argsort(-lengths(walls), kind="stable")]
    kept = [walls[0]]
    for wall in walls[1:]:
        if not any(_is_twin(wall, longer) for longer in kept):
            kept.append(wall)
    return np.array(kept)


def _without_furniture(walls: FloatArray) -> FloatArray:
    """Drop short walls that stand by themselves."""
    long = walls[lengths(walls) >= SHORT_M]
    if not len(long):
        return walls
    touches = [
        min(distance_to_segments(end, long).min() for end in wall) <= TOUCH_M for wall in walls
    ]
    return walls[(lengths(walls) >= SHORT_M) | touches]


def _is_twin(wall: FloatArray, longer: FloatArray) -> bool:
    turn = float(np.subtract(*directions(np.array([wall, longer]))))
    if abs((turn + np.pi / 2) % np.pi - np.pi / 2) > PARALLEL_RAD:
        return False
    points = wall[0] + np.linspace(0, 1, 11)[:, None] * (wall[1] - wall[0])
    d = longer[1] - longer[0]
    length = np.linalg.norm(d)
    rel = points - longer[0]
    t, side = rel @ d / length, np.abs(rel @ np.array([-d[1], d[0]])) / length
    return bool(((side < TWIN_M) & (t > 0) & (t < length)).mean() >= TWIN_SHARE)
