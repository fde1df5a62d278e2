"""Walls in a picture become segments: straight bars of dark cells, one orientation after another.

For the orientation that most edges share, the picture is turned so that these walls lie along
rows. Long runs of dark cells are bars, and a bar's middle line is a wall. What bars cover counts
as explained, and the next orientation follows, until little is left.

Points are (x, y) in cells: cell (row, column) reaches from (column, row) to (column + 1, row + 1).
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from palms.geometry import FloatArray, directions, lengths

__all__ = ["remove_specks", "remove_thin", "typical_thickness", "walls_of"]

Mask = npt.NDArray[np.bool_]
Cells = tuple[npt.NDArray[np.intp], ...]  # rows and columns, as np.nonzero gives them
_ORIENTATIONS = 24  # ours: round walls use many
_BINS = 360  # ours: half a degree each
_DONE_BINS = 5  # ours: orientations that near to one before are explained
_LEFT_SHARE = 0.01  # ours: the rest is noise
_FRESH_SHARE = 0.3  # ours: a bar that is mostly explained is not another wall
_THICK_CELLS = 3  # ours: thinner strokes do not survive turning, so they are enlarged
_MAX_CELLS = 16_000_000  # ours: of an enlarged picture; keeps memory under a gigabyte
_MAX_BARS = 10_000  # ours: more are noise or hatching
_FRUITLESS = 3  # ours: orientations without a bar before the rest is given up
_FINE_CELLS = 4  # ours: finer pictures only take longer
_STAIRS_CELLS, _STAIRS_LEVEL = 0.8, 0.25  # ours: keep a line of one cell about two cells wide
_BEND_CELLS = 1.5  # ours: middle lines waver by a cell
_PIECE_CELLS = 6  # ours: shorter pieces of a bent bar say nothing
_CROSSING = math.sin(math.radians(20.0))  # ours: flatter crossings are no corners


class _Turn(NamedTuple):
    """A turned picture: point (u, v) of it is low + (u, v), along and across an orientation."""

    angle_rad: float
    low: FloatArray
    shape: tuple[int, int]

    @classmethod
    def of(cls, shape: tuple[int, int], angle_rad: float) -> _Turn:
        rows, columns = shape
        corners = np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]]) @ _axes(angle_rad).T
        low = np.floor(corners.min(axis=0))
        u, v = np.ceil(corners.max(axis=0) - low).astype(int)
        return cls(angle_rad, low, (int(v), int(u)))

    def forth(self, mask: Mask) -> Mask:
        """Turn a mask of the picture."""
        back, offset = self._to_picture()
        grey = ndimage.affine_transform(
            mask.astype(np.float32), back, offset, self.shape, np.float32, order=1
        )
        return np.asarray(grey > 0.5)

    def forth_at(self, mask: Mask, cells: Cells) -> npt.NDArray[np.bool_]:
        """Values (N,) of the turned mask at some of its cells alone, which is much quicker."""
        at = _moved(cells, *self._to_picture())
        grey = ndimage.map_coordinates(mask.astype(np.float32), at, np.float32, order=1)
        return np.asarray(grey > 0.5)

    def back_at(self, mask: Mask, cells: Cells) -> npt.NDArray[np.bool_]:
        """Values (N,) of a turned mask at some cells of the picture."""
        forth = _axes(self.angle_rad)[::-1, ::-1]  # (row, column) to (v, u)
        offset = forth @ np.array([0.5, 0.5]) - self.low[::-1] - 0.5
        at = _moved(cells, forth, offset)
        return np.asarray(ndimage.map_coordinates(mask.astype(np.uint8), at, order=0) > 0)

    def _to_picture(self) -> tuple[FloatArray, FloatArray]:
        """Matrix and offset that take (v, u) to (row, column)."""
        back = _axes(self.angle_rad).T[::-1, ::-1]
        return back, back @ (self.low[::-1] + 0.5) - 0.5

    def point(self, uv: FloatArray) -> FloatArray:
        """Points (..., 2) of the picture."""
        return np.asarray((uv + self.low) @ _axes(self.angle_rad))


def _axes(angle_rad: float) -> FloatArray:
    """Rows: the direction along, and the one across."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, s], [-s, c]])


def _moved(cells: Cells, matrix: FloatArray, offset: FloatArray) -> FloatArray:
    """Coordinates (2, N) of cells, summed in the order of ``ndimage.affine_transform``."""
    rows, columns = cells
    return np.stack([offset[i] + rows * matrix[i, 0] + columns * matrix[i, 1] for i in (0, 1)])


def typical_thickness(dark: Mask) -> float:
    """Thickness in cells of the strokes that most dark cells belong to, to half a cell.

    Examples
    --------
    >>> dark = np.zeros((40, 40), bool)
    >>> dark[10:16] = True
    >>> typical_thickness(dark)
    5.5
    """
    if not dark.any():
        return 0.0
    depth = ndimage.distance_transform_edt(np.pad(dark, 1))
    depth = np.sort(depth[(depth > 0) & (depth == ndimage.maximum_filter(depth, 3))])
    middle = int(np.searchsorted(np.cumsum(depth), depth.sum() / 2))
    return float(2 * depth[min(middle, len(depth) - 1)] - 0.5)


def remove_thin(dark: Mask, thickness_cells: float) -> Mask:
    """Return what is at least so thick: opening by a square.

    Examples
    --------
    >>> dark = np.zeros((20, 20), bool)
    >>> dark[3], dark[10:14] = True, True
    >>> remove_thin(dark, 3)[:, 10].nonzero()[0].tolist()
    [10, 11, 12, 13]
    """
    size = round(thickness_cells)
    if size <= 1:
        return dark
    padded = np.pad(dark, size, mode="edge")  # walls go on at the border
    return np.asarray(ndimage.binary_opening(padded, np.ones((size, size)))[size:-size, size:-size])


def remove_specks(dark: Mask, size_cells: float) -> Mask:
    """Return the mask without patches that fit into a square of some cells.

    Letters, furniture and noise are such patches; walls hang together.

    Examples
    --------
    >>> dark = np.zeros((20, 40), bool)
    >>> dark[2:5, 2:5], dark[10] = True, True
    >>> int(remove_specks(dark, 5).sum())
    40
    """
    labels, count = ndimage.label(dark, np.ones((3, 3)))
    if not count:
        return dark
    boxes = ndimage.find_objects(labels)
    sides = np.array([max(s.stop - s.start for s in box) for box in boxes])
    return np.asarray(np.concatenate([[False], sides > size_cells])[labels])


def walls_of(dark: Mask, min_length_cells: float) -> FloatArray:
    """Return walls (N, 2, 2), x and y in cells, of the dark bars of a mask.

    Parameters
    ----------
    dark : (R, C) bool
    min_length_cells : float
        Shorter bars are no walls.

    Examples
    --------
    >>> dark = np.zeros((40, 60), bool)
    >>> dark[10:14, 5:55] = True
    >>> walls_of(dark, 8).round(1).tolist()
    [[[5.0, 12.0], [55.0, 12.0]]]
    """
    thickness = typical_thickness(dark)
    if not thickness:
        return np.empty((0, 2, 2))
    dark, zoom = _rescaled(dark, thickness)
    run = max(min_length_cells * zoom, 1.5 * thickness * zoom, 3.0)
    walls, half = _all_bars(dark, run)
    return _joined(walls, half) / zoom


def _rescaled(dark: Mask, thickness: float) -> tuple[Mask, float]:
    """Return the mask with strokes of 3 to 8 cells, and by what it was enlarged."""
    if thickness >= 2 * _FINE_CELLS:
        k = int(thickness // _FINE_CELLS)
        rows, columns = (-(-n // k) for n in dark.shape)
        padded = np.zeros((rows * k, columns * k), np.float32)
        padded[: dark.shape[0], : dark.shape[1]] = dark
        return np.asarray(padded.reshape(rows, k, columns, k).mean(axis=(1, 3)) > 0.5), 1 / k
    if thickness >= _THICK_CELLS:
        return dark, 1.0
    room = math.isqrt(_MAX_CELLS // max(dark.size, 1))
    k = min(math.ceil(_THICK_CELLS / thickness), max(room, 1))
    grey = dark.repeat(k, axis=0).repeat(k, axis=1).astype(np.float32)
    smooth = ndimage.gaussian_filter(grey, _STAIRS_CELLS * k)  # thin slanting lines are stairs
    return np.asarray(smooth > _STAIRS_LEVEL), float(k)


def _all_bars(dark: Mask, run: float) -> tuple[FloatArray, FloatArray]:
    """Middle lines (N, 2, 2) and half thicknesses (N,) of the bars of all orientations."""
    left = dark.copy()
    seen = np.ones(_BINS)
    walls, half = [np.empty((0, 2, 2))], [np.empty(0)]
    for _ in range(_ORIENTATIONS):
        angle = _orientation(left, seen)
        if angle is None or left.sum() <= _LEFT_SHARE * dark.sum():
            break
        near = np.arange(-_DONE_BINS, _DONE_BINS + 1) + round(angle / math.pi * _BINS)
        seen[near % _BINS] = 0.0
        turn = _Turn.of((dark.shape[0], dark.shape[1]), angle)
        lines, halves, covered = _bars(dark, left, turn, run)
        walls.append(turn.point(lines))
        half.append(halves)
        fruitless = len(half) > _FRUITLESS and not any(map(len, half[-_FRUITLESS:]))
        if fruitless or sum(map(len, half)) > _MAX_BARS:
            break
        cells = np.nonzero(left)
        left[cells] = ~turn.back_at(covered, cells)
    return np.concatenate(walls), np.concatenate(half)


def _orientation(dark: Mask, seen: FloatArray) -> float | None:
    """Direction in [0, pi) that most metres of edge share, of those not yet seen."""
    smooth = ndimage.gaussian_filter(dark.astype(np.float32), 1.0)
    dy, dx = np.gradient(smooth)
    strength = np.hypot(dx, dy)
    edge = strength > 0.1
    angle = np.mod(np.arctan2(dy[edge], dx[edge]) + math.pi / 2, math.pi)
    bins = np.rint(angle / math.pi * _BINS).astype(int) % _BINS
    histogram = np.bincount(bins, strength[edge], _BINS)
    histogram = ndimage.gaussian_filter1d(histogram, 1.5, mode="wrap") * seen
    if histogram.max() <= 0:
        return None
    peak = float(np.argmax(histogram)) * math.pi / _BINS
    off = np.mod(angle - peak + math.pi / 2, math.pi) - math.pi / 2
    near = np.abs(off) < math.radians(2)
    turn = float(np.average(off[near], weights=strength[edge][near])) if near.any() else 0.0
    return (peak + turn) % math.pi


def _bars(dark: Mask, left: Mask, turn: _Turn, run: float) -> tuple[FloatArray, FloatArray, Mask]:
    """Bars along a turn's rows: middle lines (N, 2, 2), half thicknesses (N,), what they cover.

    None where there are too many to be walls.
    """
    long = _long_runs(turn.forth(dark), max(2, round(run)))
    labels, count = ndimage.label(long, np.ones((3, 3)))
    if count > _MAX_BARS:
        return np.empty((0, 2, 2)), np.empty(0), np.zeros_like(long)
    cells = np.nonzero(labels)
    fresh = np.bincount(labels[cells], turn.forth_at(left, cells), count + 1)
    covered = np.zeros(count + 1, np.bool_)
    lines, halves = [], []
    for k, box in enumerate(ndimage.find_objects(labels), start=1):
        patch = labels[box] == k
        if fresh[k] < _FRESH_SHARE * patch.sum():
            continue
        pieces, half = _middles(patch, run)
        lines += [piece + [box[1].start, box[0].start] for piece in pieces]
        halves += [half] * len(pieces)
        covered[k] = bool(pieces)
    return np.array(lines).reshape(-1, 2, 2), np.array(halves), _widened(covered[labels])


def _long_runs(mask: Mask, run: int) -> Mask:
    """Return the runs along rows that are at least so long: opening by a row of cells."""
    step = np.diff(mask.astype(np.int8), axis=1, prepend=0, append=0)
    rows, begins = np.nonzero(step > 0)
    ends = np.nonzero(step < 0)[1]
    short = ends - begins < run
    step[rows[short], begins[short]] = step[rows[short], ends[short]] = 0
    return np.cumsum(step[:, :-1], axis=1, dtype=np.int8) > 0


def _widened(mask: Mask) -> Mask:
    """Return the mask and the eight neighbours of each of its cells."""
    wide = mask.copy()
    wide[1:] |= mask[:-1]
    wide[:-1] |= mask[1:]
    wider = wide.copy()
    wider[:, 1:] |= wide[:, :-1]
    wider[:, :-1] |= wide[:, 1:]
    return wider


def _middles(patch: Mask, run: float) -> tuple[list[FloatArray], float]:
    """Middle lines (2, 2) of a patch, more than one where it bends, and half its thickness."""
    thickness = patch.sum(axis=0)
    typical = float(np.median(thickness[thickness > 0]))
    if len(thickness) < max(run, 1.5 * typical):
        return [], 0.0
    usual = np.flatnonzero(np.abs(thickness - typical) <= max(1.0, 0.25 * typical))
    rows = np.arange(patch.shape[0])[:, None] + 0.5
    x = np.asarray(usual + 0.5, dtype=np.float64)
    y = np.asarray((patch[:, usual] * rows).sum(axis=0) / thickness[usual], dtype=np.float64)
    bends = _bends(x, y, max(_BEND_CELLS, typical / 2))
    borders = [0.0, *(x[bends]), float(len(thickness))]
    pieces = []
    for low, high in itertools.pairwise(borders):
        mine = (x >= low) & (x <= high)
        if not mine.any():
            continue
        centre = x[mine].mean()
        slope, level = _fit(x[mine] - centre, y[mine])
        ends = np.array([low, high])
        pieces.append(np.column_stack([ends, level + slope * (ends - centre)]))
    return pieces, typical / 2


def _fit(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Slope and level of a line through points around x = 0."""
    spread = float(x @ x)
    return (float(x @ y) / spread if len(x) > 2 and spread else 0.0), float(y.mean())


def _bends(x: FloatArray, y: FloatArray, tolerance: float) -> list[int]:
    """Return where a line through points must bend to stay within a tolerance of them."""
    found, todo = [], [(0, len(x) - 1)]
    while todo:
        first, last = todo.pop()
        if last - first < _PIECE_CELLS:
            continue
        chord = np.interp(x[first : last + 1], x[[first, last]], y[[first, last]])
        off = np.abs(y[first : last + 1] - chord)
        at = first + int(off.argmax())
        if off.max() > tolerance and first < at < last:
            found.append(at)
            todo += [(first, at), (at, last)]
    return sorted(found)


def _joined(walls: FloatArray, half: FloatArray) -> FloatArray:
    """Move ends that lie in or near a crossing bar to where the middle lines meet."""
    if len(walls) < 2:
        return walls
    angle, length = directions(walls), np.maximum(lengths(walls), 1e-9)
    along = np.column_stack([np.cos(angle), np.sin(angle)])
    moved = walls.copy()
    for i, wall in enumerate(walls):
        sine = along[i, 0] * along[:, 1] - along[i, 1] * along[:, 0]
        crossing = np.abs(sine) > _CROSSING
        rel = walls[:, 0] - wall[0]
        safe = np.where(crossing, sine, 1.0)
        here = (rel[:, 0] * along[:, 1] - rel[:, 1] * along[:, 0]) / safe
        there = (rel[:, 0] * along[i, 1] - rel[:, 1] * along[i, 0]) / safe
        slack = 2.5 * np.maximum(half, half[i]) + 1.0
        crossing &= (there > -slack) & (there < length + slack)
        for end, at in ((0, 0.0), (1, length[i])):
            away = np.where(crossing & (np.abs(here - at) <= slack), np.abs(here - at), np.inf)
            j = int(away.argmin())
            if np.isfinite(away[j]):
                moved[i, end] = wall[0] + here[j] * along[i]
    return moved
