"""What a scan says about all places of a building at once, roughly: where to look closer."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import scipy.fft

from palms._compiled import observation as loops
from palms._compiled import select
from palms.geometry import FloatArray, as_readonly
from palms.grid import Grid
from palms.heatmap import Candidates
from palms.observation.points import ScanPoints, scan_points
from palms.observation.sight import Blurred, Field, blurred, coarseness
from palms.orientation import likely_drifts
from palms.raster import PlanRaster
from palms.scan import Scan
from palms.settings import ObservationSettings
from palms.template import Template

__all__ = ["Likelihoods", "likelihoods", "search"]


@dataclass(frozen=True)
class Likelihoods:
    """A rough likelihood over the whole building, one map for each drift; see `likelihoods`.

    As `log_likelihood`, but every metre of a wall errs by itself, which makes it two sums.

    Parameters
    ----------
    raster : PlanRaster
    scan : Scan
    drifts_rad : (K,)
    settings : ObservationSettings
    """

    raster: PlanRaster
    scan: Scan
    drifts_rad: FloatArray
    settings: ObservationSettings

    @property
    def grid(self) -> Grid:
        """The cells of every map."""
        return self._fields.grid

    def __len__(self) -> int:
        return len(self.drifts_rad)

    @cached_property
    def inside(self) -> npt.NDArray[np.bool_]:
        """Cells (R, C) that reach into the building."""
        return _any(self.raster.inside, self.grid.shape)

    def template(self, k: int) -> Template:
        """Return what speaks for a place with drift k (metres of wall) and against it."""
        walls, empty = self._splats(k)
        cost = self.settings.search_empty_nats_per_m * empty
        return Template(walls - cost, (self._half, self._half), float(self.drifts_rad[k]))

    def scores(self, k: int) -> Field:
        """Return the map (R, C) of drift k, in nats, by Fourier transform."""
        (rows, columns), shape = self.grid.shape, self._shape
        support, metres = self._spectra
        walls, empty = self._splats(k)
        product, against = _turned(walls, shape), _turned(empty, shape)
        for each in (product, against):  # in place throughout: plans may be large
            np.conjugate(each, out=each)
        product *= support
        np.multiply(self.settings.search_empty_nats_per_m, against, out=against)
        against *= metres
        product -= against
        turned = scipy.fft.ifft(product, axis=0, overwrite_x=True)[:rows]
        return np.ascontiguousarray(scipy.fft.irfft(turned, n=shape[1], axis=1)[:, :columns])

    def __iter__(self) -> Iterator[Field]:
        return (self.scores(k) for k in range(len(self)))

    @cached_property
    def _points(self) -> ScanPoints:
        return scan_points(self.scan, self.settings)

    @cached_property
    def _fields(self) -> Blurred:
        return blurred(self.raster, self.settings, coarseness(self.raster.grid, self.settings))

    @property
    def _half(self) -> int:
        """Cells from the middle of a template to its border."""
        return math.ceil(self._points.reach_m / self.grid.cell_size_m) + 2

    @property
    def _shape(self) -> tuple[int, int]:
        rows, columns = (n + 2 * self._half for n in self.grid.shape)
        return scipy.fft.next_fast_len(rows), scipy.fft.next_fast_len(columns, real=True)

    @cached_property
    def _spectra(self) -> tuple[npt.NDArray[np.complex64], npt.NDArray[np.complex64]]:
        fields = (self._fields.support, self._fields.metres)
        support, metres = (_spectrum(field, self._half, self._shape) for field in fields)
        return support, metres

    def _splats(self, k: int) -> tuple[Field, Field]:
        """Metres of wall and square metres of empty space in each cell of a template."""
        points, side = self._points, 2 * self._half + 1
        walls, empty = (np.zeros((side, side), np.float32) for _ in range(2))
        drift, cell = float(self.drifts_rad[k]), self.grid.cell_size_m
        area = as_readonly(np.full(len(points.empty_m), points.empty_m2))  # as the metres
        loops.splat(points.wall_m, points.wall_weight_m, drift, cell, walls)
        loops.splat(points.empty_m, area, drift, cell, empty)
        return walls, empty


def likelihoods(
    scan: Scan, raster: PlanRaster, settings: ObservationSettings | None = None
) -> Likelihoods:
    """Return the maps of a scan for all drifts that its walls allow; made when asked for."""
    settings = settings or ObservationSettings()
    drifts_rad = likely_drifts(
        scan.walls_m, raster.plan.segments_m, settings.drift_step_rad, settings.drift_share
    )
    return Likelihoods(raster, scan, drifts_rad, settings)


def search(
    scan: Scan, raster: PlanRaster, settings: ObservationSettings | None = None
) -> Candidates:
    """Return where in the building a scan may have been taken, and how its frame lies.

    Parameters
    ----------
    scan : Scan
    raster : PlanRaster
    settings : ObservationSettings, optional

    Returns
    -------
    Candidates
        Their shares are what poses are to be proposed by, so that few are missed: the rough
        likelihood, made flat.

    Examples
    --------
    >>> from palms.floorplan import FloorPlan
    >>> from palms.raster import rasterize
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[4, 4], [4, 2]]])
    >>> found = search(Scan(room - (2.1, 1.1)), rasterize(FloorPlan(room)))
    >>> found.position_m[found.score.argmax()].round(1).tolist()
    [2.1, 1.1]
    """
    settings = settings or ObservationSettings()
    maps = likelihoods(scan, raster, settings)
    inside = maps.inside
    best, least = -np.inf, -np.inf
    at, label, score = np.empty(0, np.int64), np.empty(0, np.int32), np.empty(0, np.float32)
    for k, scores in enumerate(maps):
        best = max(best, float(select.peak(scores, inside)))
        least = max(least, best - settings.search_nats)
        here = select.at_least_inside(scores, inside, np.float32(least))
        at, score = np.concatenate([at, here]), np.concatenate([score, scores.ravel()[here]])
        label = np.concatenate([label, np.full(len(here), k, np.int32)])
        last = k == len(maps) - 1
        if len(score) > (1 if last else 2) * settings.max_candidates:
            least = max(least, float(select.nth_largest(score, settings.max_candidates)))
            enough = score >= least
            at, label, score = at[enough], label[enough], score[enough]
    keep = np.flatnonzero(score >= best - settings.search_nats)
    cells = np.stack(np.unravel_index(at[keep], inside.shape), axis=1).astype(np.int32)
    log_weight = settings.search_power * (score[keep].astype(np.float64) - best)
    n_drifts = round(2 * math.pi / settings.drift_step_rad)
    return Candidates(
        maps.grid, maps.drifts_rad, cells, label[keep], score[keep],
        log_weight - math.log(np.exp(log_weight).sum()),
        drift_step_rad=settings.drift_step_rad, n_poses=int(inside.sum()) * n_drifts,
    )  # fmt: skip


def _any(mask: npt.NDArray[np.bool_], shape: tuple[int, int]) -> npt.NDArray[np.bool_]:
    """Whether any cell of each block is set."""
    k = -(-mask.shape[0] // shape[0])
    padded = np.pad(mask, [(0, n * k - m) for n, m in zip(shape, mask.shape, strict=True)])
    return np.asarray(padded.reshape(shape[0], k, shape[1], k).any(axis=(1, 3)))


def _spectrum(field: Field, offset: int, shape: tuple[int, int]) -> npt.NDArray[np.complex64]:
    """Transform of a field that is set off by some zeros."""
    padded = np.zeros(shape, np.float32)
    rows, columns = field.shape
    padded[offset : offset + rows, offset : offset + columns] = field
    spectrum: npt.NDArray[np.complex64] = scipy.fft.rfft2(padded)
    return spectrum


def _turned(template: Field, shape: tuple[int, int]) -> npt.NDArray[np.complex64]:
    """Transform of a template; its rows alone are not zero."""
    rows = scipy.fft.rfft(template, n=shape[1], axis=1)
    full: npt.NDArray[np.complex64] = scipy.fft.fft(rows, n=shape[0], axis=0)
    return full
