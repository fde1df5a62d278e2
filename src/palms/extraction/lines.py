"""Columns to walls: lines grown from where columns stand in a row."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms.extraction.columns import Columns, height_of_bits_m
from palms.extraction.settings import ExtractionSettings
from palms.geometry import FloatArray

__all__ = ["Wall", "find_lines"]

_SEED_M = 0.25  # ours: columns within this tell the direction of a seed
_SEED_LINEAR = 0.4  # ours: how much longer than wide they must lie
_MANY_PAIRS, _NEAREST, _CHUNK = 8_000_000, 48, 50_000  # ours: some 200 MB at a time
_ROUNDS = 30  # ours: growing settles within about 10
_SETTLING = 2  # ours: times that points are chosen anew by the line fitted to them
_PIECE_M = 0.05  # ours: pieces that must lie on one straight line
_STRETCH_M = 0.1  # ours: pieces of a wall that are looked at one by one
_PAIR_SPACING, _MAX_PAIRS = 4, 2000  # ours: pairs of pieces that lines are tried through
_SIDE = 4  # ours: pieces on either side of a step
_STEP_M, _STEP_GAIN = 0.02, 0.4  # ours: two lines with such a step fit so much better
_SOLID_SHARE = 0.5  # ours: so much of a wall's length is filled over its height
_ENOUGH = 10_000  # ours: points that fix a line to far less than a millimetre
_TUKEY = 4.685  # of the biweight, 95 % efficient for normal errors
_MIN_SCALE_M = 0.002  # ours: no sensor is better

Mask = npt.NDArray[np.bool_]


class Wall(NamedTuple):
    """A wall among points.

    Attributes
    ----------
    ends_m : ndarray (2, 2)
        On the ground.
    spread_m : float
        Standard deviation of its points across it.
    points : int
        How many they are.
    """

    ends_m: FloatArray
    spread_m: float
    points: int


class _Line(NamedTuple):
    """A point and a unit vector."""

    foot: FloatArray
    along: FloatArray

    def places(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Coordinates (N,) along and across."""
        off = points - self.foot
        return off @ self.along, off @ np.array([-self.along[1], self.along[0]])


def find_lines(columns: Columns, settings: ExtractionSettings) -> list[Wall]:
    """Grow lines from the columns that stand most clearly in a row, and fit them.

    Parameters
    ----------
    columns : Columns
    settings : ExtractionSettings

    Returns
    -------
    list of Wall
        In the order found: the clearest first.
    """
    walls: list[Wall] = []
    if len(columns) < 2:
        return walls
    free, hopeless = np.ones(len(columns), bool), np.zeros(len(columns), bool)
    seeds, directions = _seeds(columns)
    for seed in seeds:
        if hopeless[seed] or not free[seed]:
            continue
        line = _Line(columns.centre_m[seed], directions[seed])
        line, members = _grow(line, columns, free, settings)
        wall = _measured(line, members, columns, free, settings)
        if wall is None:
            near = np.abs(columns.centre_m - columns.centre_m[seed]).max(axis=1) <= _STRETCH_M
            hopeless |= near
            continue
        free &= ~_consumed(wall, columns.centre_m, settings)
        free[seed] = False
        beside = [other for other in walls if _is_beside(wall, other, settings)]
        if all(wall.points > other.points for other in beside):
            walls = [other for other in walls if not any(other is one for one in beside)]
            walls.append(wall)
    return walls


def _seeds(columns: Columns) -> tuple[npt.NDArray[np.int64], FloatArray]:
    """Columns by how clearly their surroundings lie on a line; directions (N, 2) there."""
    moments = np.zeros((3, len(columns)))
    for i, j in _neighbours(columns.centre_m):
        x, y = (columns.centre_m[j] - columns.centre_m[i]).T
        for k, product in enumerate((x * x, x * y, y * y)):
            moments[k] += np.bincount(i, columns.weight[j] * product, len(columns))
    xx, xy, yy = moments
    angle = 0.5 * np.arctan2(2 * xy, xx - yy)
    total = np.maximum(xx + yy, 1e-12)
    linear = np.hypot(2 * xy, xx - yy) / total
    strength = np.where(linear >= _SEED_LINEAR, linear * (xx + yy), 0.0)
    order = np.argsort(-strength, kind="stable")
    return order[strength[order] > 0], np.column_stack([np.cos(angle), np.sin(angle)])


def _neighbours(
    centre: FloatArray,
) -> Iterator[tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]]:
    """Pairs of columns that are near to each other; of very dense ones the nearest of each."""
    from scipy.spatial import cKDTree

    tree = cKDTree(centre)
    if tree.count_neighbors(tree, _SEED_M) <= _MANY_PAIRS:
        pairs = tree.query_pairs(_SEED_M, output_type="ndarray")
        yield pairs[:, 0], pairs[:, 1]
        yield pairs[:, 1], pairs[:, 0]
        return
    for start in range(0, len(centre), _CHUNK):
        part = centre[start : start + _CHUNK]
        distance, j = tree.query(part, _NEAREST, distance_upper_bound=_SEED_M)
        i = np.repeat(np.arange(start, start + len(part)), _NEAREST)
        known = np.isfinite(distance.ravel())
        yield i[known], j.ravel()[known]


def _grow(
    line: _Line, columns: Columns, free: Mask, settings: ExtractionSettings
) -> tuple[_Line, Mask]:
    """Take in what lies on a line without a gap, fit it, and again until nothing changes."""
    members = np.zeros(len(columns), bool)
    reach = (-_SEED_M, _SEED_M)
    for _ in range(_ROUNDS):
        along, across = line.places(columns.centre_m)
        near = free & (np.abs(across) <= settings.off_m)
        run = _run(along, near, reach, settings.gap_m)
        if not run.any() or np.array_equal(run, members):
            break
        members = run
        line = _fit(columns.centre_m[members], columns.weight[members], line)
        along = line.places(columns.centre_m[members])[0]
        reach = float(along.min()), float(along.max())
    return line, members


def _run(along: FloatArray, near: Mask, reach: tuple[float, float], gap_m: float) -> Mask:
    """Those of the near ones that join what is within reach without a gap."""
    places = np.sort(along[near])
    if not len(places):
        return near
    cuts = np.flatnonzero(np.diff(places) > gap_m)
    starts, ends = places[np.r_[0, cuts + 1]], places[np.r_[cuts, len(places) - 1]]
    inside = (ends >= reach[0]) & (starts <= reach[1])
    overlap = np.minimum(ends, reach[1]) - np.maximum(starts, reach[0])
    best = int(np.where(inside, overlap, -np.inf).argmax())
    if not inside[best]:
        return np.zeros_like(near)
    return np.asarray(near & (along >= starts[best]) & (along <= ends[best]))


def _fit(points: FloatArray, weight: FloatArray, like: _Line) -> _Line:
    """Line of least squares across, in the sense of direction of another."""
    total = weight.sum()
    foot = weight @ points / total
    off = points - foot
    xx, xy, yy = weight @ off[:, 0] ** 2, weight @ (off[:, 0] * off[:, 1]), weight @ off[:, 1] ** 2
    if xx + yy <= 1e-12:
        return _Line(foot, like.along)
    angle = 0.5 * np.arctan2(2 * xy, xx - yy)
    along = np.array([np.cos(angle), np.sin(angle)])
    return _Line(foot, along if along @ like.along >= 0 else -along)


class _Settled(NamedTuple):
    """A line fitted to points (P, 2), their spread across it, and the column of each."""

    line: _Line
    spread_m: float
    points: FloatArray
    column: npt.NDArray[np.int64]


def _settle(
    line: _Line, members: Mask, columns: Columns, free: Mask, settings: ExtractionSettings
) -> _Settled | None:
    """Fit the points of those pieces of a line that are straight, and choose them anew by it."""
    settled, reach = None, columns.centre_m[members]
    for first in (True, *[False] * _SETTLING):
        along, across = line.places(columns.centre_m)
        ends = line.places(reach)[0]
        near = free & (np.abs(across) <= settings.off_m)
        near &= (along >= ends.min()) & (along <= ends.max())
        mine = near[columns.column]
        points, of_column = columns.points_m[mine], columns.column[mine]
        if len(points) < 3:
            return None
        straight = _straight(line, points, settings.straight_m, first)
        if straight.sum() < 3:
            return None
        points, of_column = points[straight], of_column[straight]
        line, spread = _robust(line, points)
        settled = _Settled(line, spread, points, of_column)
    return settled


def _measured(
    line: _Line, members: Mask, columns: Columns, free: Mask, settings: ExtractionSettings
) -> Wall | None:
    """Fit the points themselves, and cut the line to where it is a wall's height."""
    settled = _settle(line, members, columns, free, settings) if members.sum() >= 3 else None
    if settled is None:
        return None
    line, scale, points, of_column = settled
    along, across = line.places(points)
    kept = np.abs(across) <= max(3 * scale, 0.01)
    stretch = _solid(along[kept], columns.layers[of_column[kept]], settings)
    if stretch is None:
        return None
    inside = kept & (along >= stretch[0]) & (along <= stretch[1])
    ends = np.array([along[inside].min(), along[inside].max()])
    if ends[1] - ends[0] < settings.min_length_m:
        return None
    wall = Wall(line.foot + ends[:, None] * line.along, scale, int(inside.sum()))
    return wall if _stands_out(wall, columns, settings) else None


def _stands_out(wall: Wall, columns: Columns, settings: ExtractionSettings) -> bool:
    """Whether the strip on one side of a wall is clear, as the room before it is."""
    along, across, length = _on(wall, columns.band_m)
    off = across[(along >= 0) & (along <= length)]
    itself = np.sum(np.abs(off) <= settings.off_m)
    left = np.sum((off > settings.off_m) & (off <= 3 * settings.off_m))
    right = np.sum((off < -settings.off_m) & (off >= -3 * settings.off_m))
    return bool(min(left, right) <= settings.clear_share * itself)


def _straight(line: _Line, points: FloatArray, off_m: float, search: bool) -> Mask:
    """Points of those pieces that lie on a line; of the best line nearby, when it is searched.

    Noise hides a door that is set back by a few centimetres from each point, but not from
    the median of a piece.
    """
    along, across = line.places(points)
    piece = ((along - along.min()) / _PIECE_M).astype(np.int64)
    order = np.lexsort((across, piece))
    counts = np.bincount(piece)
    some = np.flatnonzero(counts)
    middle = across[order][(np.cumsum(counts) - counts + counts // 2)[some]]
    if len(some) < 3:
        return np.ones(len(points), bool)
    if not search:
        return np.isin(piece, some[np.abs(middle) < off_m])
    trust = np.sqrt(np.minimum(counts[some], np.median(counts[some])))
    chosen = np.abs(_best_line(some, middle, trust, off_m)) < off_m
    chosen[chosen] = _larger_side(some[chosen], middle[chosen], trust[chosen])
    return np.isin(piece, some[chosen])


def _best_line(
    place: npt.NDArray[np.int64], middle: FloatArray, trust: FloatArray, off_m: float
) -> FloatArray:
    """Distances (K,) of pieces from the line through two of them that most lie near to."""
    i, j = np.triu_indices(len(place), k=max(1, len(place) // _PAIR_SPACING))
    i, j = i[:: len(i) // _MAX_PAIRS + 1], j[:: len(j) // _MAX_PAIRS + 1]
    slope = (middle[j] - middle[i]) / (place[j] - place[i])
    off = middle - middle[i, None] - slope[:, None] * (place - place[i, None])
    agreement = np.clip(1 - (off / off_m) ** 2, 0.0, None) @ trust
    return np.asarray(off[int(agreement.argmax())])


def _larger_side(place: npt.NDArray[np.int64], middle: FloatArray, trust: FloatArray) -> Mask:
    """Pieces (K,) on the larger side of a step: a wall and a door that one line crosses."""
    whole, _ = _residue(place, middle, trust)
    best, at = np.inf, 0
    for split in range(_SIDE, len(place) - _SIDE + 1):
        left, a = _residue(place[:split], middle[:split], trust[:split])
        right, b = _residue(place[split:], middle[split:], trust[split:])
        between = 0.5 * (place[split - 1] + place[split])
        step = abs(np.polyval(a, between) - np.polyval(b, between))
        if step >= _STEP_M and left + right < best:
            best, at = left + right, split
    if best > _STEP_GAIN * whole:
        return np.ones(len(place), bool)
    first = np.arange(len(place)) < at
    return first if 2 * at >= len(place) else ~first


def _residue(
    place: npt.NDArray[np.int64], middle: FloatArray, trust: FloatArray
) -> tuple[float, FloatArray]:
    """Weighted sum of squares about the best line, and that line."""
    x = place - place.mean()
    mean = trust @ middle / trust.sum()
    centre = trust @ x / trust.sum()
    slope = (trust * (x - centre)) @ (middle - mean) / max(trust @ (x - centre) ** 2, 1e-9)
    off = middle - mean - slope * (x - centre)
    return float(trust @ off**2), np.array([slope, mean - slope * (centre + place.mean())])


def _robust(line: _Line, points: FloatArray) -> tuple[_Line, float]:
    """Line and spread by iterated weights: what stands before or behind counts less."""
    points, scale = points[:: len(points) // _ENOUGH + 1], 0.0
    for _ in range(8):
        across = line.places(points)[1]
        middle = np.median(across)
        scale = max(1.4826 * float(np.median(np.abs(across - middle))), _MIN_SCALE_M)
        share = np.clip(1 - ((across - middle) / (_TUKEY * scale)) ** 2, 0.0, None)
        line = _fit(points, share**2 + 1e-12, line)
    return line, scale


def _solid(
    along: FloatArray, layers: npt.NDArray[np.int64], settings: ExtractionSettings
) -> tuple[float, float] | None:
    """First and last place of the part that is filled over its height; None for little."""
    if not len(along):
        return None
    start = along.min()
    piece = ((along - start) / _STRETCH_M).astype(np.int64)
    order = np.argsort(piece, kind="stable")
    pieces, first = np.unique(piece[order], return_index=True)
    solid = pieces[height_of_bits_m(np.bitwise_or.reduceat(layers[order], first), settings) > 0]
    if not len(solid):
        return None
    cuts = np.flatnonzero(np.diff(solid) * _STRETCH_M > settings.gap_m + _STRETCH_M) + 1
    part = max(np.split(solid, cuts), key=len)
    if len(part) < _SOLID_SHARE * (part[-1] - part[0] + 1):
        return None
    return start + part[0] * _STRETCH_M, start + (part[-1] + 1) * _STRETCH_M


def _consumed(wall: Wall, centre: FloatArray, settings: ExtractionSettings) -> Mask:
    """Columns that a wall explains."""
    along, across, length = _on(wall, centre)
    slack = settings.cell_m
    within = (along >= -slack) & (along <= length + slack)
    return within & (np.abs(across) <= settings.off_m + settings.cell_m / 2)


def _on(wall: Wall, points: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Coordinates of points along and across a wall from its first end, and its length."""
    run = wall.ends_m[1] - wall.ends_m[0]
    length = float(np.hypot(*run))
    along, across = _Line(wall.ends_m[0], run / length).places(points)
    return along, across, length


def _is_beside(wall: Wall, other: Wall, settings: ExtractionSettings) -> bool:
    """Whether a wall runs right beside another: the same, seen with an error."""
    places = wall.ends_m[0] + np.linspace(0, 1, 21)[:, None] * (wall.ends_m[1] - wall.ends_m[0])
    along, across, length = _on(other, places)
    same = (along >= -0.02) & (along <= length + 0.02) & (np.abs(across) <= settings.apart_m)
    return bool(same.mean() > 0.5)
