"""Heatmaps: where a scan may have been taken, one map for each drift (paper III-B, III-C)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt
import scipy.fft

from palms._compiled import select
from palms.geometry import FloatArray, as_readonly
from palms.grid import Grid
from palms.orientation import candidate_drifts, principal_orientation, smallest_alignment
from palms.raster import PlanRaster
from palms.scan import Scan
from palms.settings import CandidateSettings, Settings, TemplateSettings
from palms.template import Template, build_template, template_reach_m

__all__ = [
    "Candidates",
    "Heatmaps",
    "ScoreMaps",
    "correlate",
    "find_candidates",
    "match",
    "scan_drifts",
]

OFFSET_CELLS = 16  # ours: paddings are rounded up to this, so that scans share transforms

Scores = npt.NDArray[np.float32]


class ScoreMaps(Protocol):
    """Scores of every cell for every drift, by whatever method; what pictures need."""

    @property
    def raster(self) -> PlanRaster:
        """The plan."""

    @property
    def scan(self) -> Scan:
        """The scan."""

    @property
    def drifts_rad(self) -> FloatArray:
        """The drifts (K,)."""

    @property
    def grid(self) -> Grid:
        """The cells of every map."""

    def __len__(self) -> int: ...

    def template(self, k: int) -> Template:
        """Return what was looked for with drift k."""

    def scores(self, k: int) -> Scores:
        """Return the map (R, C) of drift k."""


@dataclass(frozen=True)
class Heatmaps:
    """Scores of every cell for every drift, made when asked for, one drift at a time.

    Parameters
    ----------
    raster : PlanRaster
    scan : Scan
    drifts_rad : array_like (K,)
        The drifts to try.
    settings : TemplateSettings

    Examples
    --------
    >>> from palms import FloorPlan
    >>> from palms.raster import rasterize
    >>> room = [[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]]
    >>> scan = Scan(np.array(room) - (2.05, 1.05))
    >>> heatmaps = match(scan, rasterize(FloorPlan(room)), np.array([0.0]))
    >>> heatmaps.grid.position_of(heatmaps.best_cell(0)).round(2).tolist()
    [2.05, 1.05]
    """

    raster: PlanRaster
    scan: Scan
    drifts_rad: FloatArray
    settings: TemplateSettings

    @property
    def grid(self) -> Grid:
        """The cells of every map."""
        return self.raster.grid

    def __len__(self) -> int:
        return len(self.drifts_rad)

    def template(self, k: int) -> Template:
        """Return the template of drift k."""
        drift = float(self.drifts_rad[k])
        return build_template(self.scan, drift, self.grid.cell_size_m, self.settings)

    def scores(self, k: int) -> Scores:
        """Return the map (R, C) of drift k: H_k of paper III-B."""
        reach = template_reach_m(self.scan, self.settings) / self.grid.cell_size_m
        scores = correlate(self.raster, self.template(k), int(np.ceil(reach)) + 1)
        if self.settings.floor_at_zero:
            np.maximum(scores, 0, out=scores)
        return scores

    def __iter__(self) -> Iterator[Scores]:
        return (self.scores(k) for k in range(len(self)))

    def best_cell(self, k: int) -> tuple[int, int]:
        """(row, column) of the highest score of drift k."""
        scores = self.scores(k)
        row, column = np.unravel_index(int(scores.argmax()), scores.shape)
        return int(row), int(column)


@dataclass(frozen=True, slots=True)
class Candidates:
    """The cells worth keeping: small enough to hold on to for recovery.

    Parameters
    ----------
    grid : Grid
    drifts_rad : (K,)
        The drifts that were tried.
    cells : (C, 2) int32
        (row, column).
    label : (C,) int32
        Index of each cell's drift.
    score : (C,) float32
        As in the heatmap.
    log_weight : (C,)
        Natural logarithm of each cell's share; the shares sum to 1.
    mass : float
        Share of the whole belief that the kept cells stand for.
    drift_step_rad : float
        The true drift may lie half of this to either side.
    n_poses : int
        How many there are, all cells inside times all drifts around; 0 where nobody asks.
    """

    grid: Grid
    drifts_rad: FloatArray
    cells: npt.NDArray[np.int32]
    label: npt.NDArray[np.int32]
    score: npt.NDArray[np.float32]
    log_weight: FloatArray
    mass: float = 1.0
    drift_step_rad: float = 0.0
    n_poses: int = 0

    def __len__(self) -> int:
        return len(self.cells)

    @property
    def position_m(self) -> FloatArray:
        """Centres (C, 2) in the map frame."""
        return self.grid.position_of(self.cells)

    @property
    def drift_rad(self) -> FloatArray:
        """Drift (C,) of each cell."""
        return self.drifts_rad[self.label]


def scan_drifts(scan: Scan, raster: PlanRaster, settings: Settings | None = None) -> FloatArray:
    """Return the four candidate drifts theta + k * 90 degrees of a scan (paper III-A)."""
    settings = settings or Settings()
    target = 0.0
    if settings.start.orientation_from == "plan":
        target = principal_orientation(raster.plan.segments_m)
    return candidate_drifts(smallest_alignment(principal_orientation(scan.walls_m), target))


def match(
    scan: Scan,
    raster: PlanRaster,
    drifts_rad: npt.ArrayLike,
    settings: TemplateSettings | None = None,
) -> Heatmaps:
    """Return the heatmaps of a scan for some drifts; nothing is computed yet."""
    return Heatmaps(raster, scan, as_readonly(drifts_rad), settings or TemplateSettings())


def correlate(raster: PlanRaster, template: Template, reach: int = 0) -> Scores:
    """Correlate the plan with a template: score (R, C) of its anchor lying on each cell.

    Beyond the plan's border there are no walls. Linear, by Fourier transform in float32; the
    plan's own transform is cached.

    Parameters
    ----------
    raster : PlanRaster
    template : Template
    reach : int, optional
        Largest distance in cells, in rows or columns, from the anchor to a border of any
        template that will be tried; the same reach shares the plan's transform.
    """
    h, w = template.values.shape
    (row, column), (rows, columns) = template.anchor, raster.grid.shape
    reach = max(reach, row, column, h - 1 - row, w - 1 - column)
    offset = -(-reach // OFFSET_CELLS) * OFFSET_CELLS
    shape = (
        scipy.fft.next_fast_len(rows + offset),
        scipy.fft.next_fast_len(columns + offset, real=True),
    )
    plan = raster.spectrum(shape, offset)
    turned = scipy.fft.rfft(template.values, n=shape[1], axis=1)  # only rows that are not zero
    turned = scipy.fft.fft(turned, n=shape[0], axis=0, overwrite_x=True)
    np.conjugate(turned, out=turned)
    turned *= plan
    spectrum = scipy.fft.ifft(turned, axis=0, overwrite_x=True)[offset - row : offset - row + rows]
    scores: Scores = scipy.fft.irfft(spectrum, n=shape[1], axis=1)
    return np.ascontiguousarray(scores[:, offset - column : offset - column + columns])


def find_candidates(heatmaps: Heatmaps, settings: CandidateSettings | None = None) -> Candidates:
    """Binarise the heatmaps and keep the cells that are 1 (paper III-C).

    One threshold, the quantile of all values of all maps; each map is made once and only the
    cells that may still pass are kept, so memory does not grow with the number of drifts.
    """
    settings = settings or CandidateSettings()
    cells_total = heatmaps.grid.size * (1 if settings.per_map else len(heatmaps))
    wanted = cells_total - int(np.ceil(settings.quantile * (cells_total - 1)))
    kept = [_top(scores, wanted, k) for k, scores in enumerate(heatmaps)]
    if settings.per_map:
        index, score, label = _joined(kept)
        weight = 1.0 / (len(heatmaps) * np.bincount(label, minlength=len(heatmaps))[label])
    else:
        index, score, label = kept[0]
        for part in kept[1:]:
            index, score, label = _merge((index, score, label), part, wanted)
        weight = np.full(len(index), 1.0 / len(index))
    cells = np.stack(np.unravel_index(index, heatmaps.grid.shape), axis=1)
    return Candidates(
        heatmaps.grid, heatmaps.drifts_rad, as_readonly(cells, np.int32),
        as_readonly(label, np.int32), as_readonly(score, np.float32),
        as_readonly(np.log(weight)),
    )  # fmt: skip


_Kept = tuple[npt.NDArray[np.int64], Scores, npt.NDArray[np.int32]]


def _top(scores: Scores, wanted: int, k: int) -> _Kept:
    """Cells of one map at or above its `wanted`-th largest score, ties included."""
    flat = scores.ravel()
    threshold = select.nth_largest(flat, wanted) if wanted < flat.size else flat.min()
    index = select.at_least(scores, threshold)
    return index, flat[index], np.full(len(index), k, np.int32)


def _joined(parts: list[_Kept]) -> _Kept:
    return (
        np.concatenate([index for index, _, _ in parts]),
        np.concatenate([score for _, score, _ in parts]),
        np.concatenate([label for _, _, label in parts]),
    )


def _merge(a: _Kept, b: _Kept, wanted: int) -> _Kept:
    index, score, label = _joined([a, b])
    if len(score) > wanted:
        keep = score >= select.nth_largest(score, wanted)
        index, score, label = index[keep], score[keep], label[keep]
    return index, score, label
