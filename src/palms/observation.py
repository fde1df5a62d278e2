"""What a scan says about a place: a likelihood, searched over the whole building.

The walls that were seen should lie on walls of the plan, and no wall of the plan should stand
where the scan proves empty space. Both are sums over points of the scan, looked up in fields
of the plan: per metre of wall and per square metre of empty space, so that neither cells nor
points decide how much a scan says (docs/explanation/likelihood.md).
"""

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
from palms.orientation import likely_drifts
from palms.raster import PlanRaster
from palms.scan import Scan
from palms.settings import ObservationSettings
from palms.sight import Field, Sight, see
from palms.template import Template

__all__ = [
    "Likelihoods",
    "ScanPoints",
    "likelihoods",
    "log_likelihood",
    "scan_points",
    "search",
]

BEARINGS = 360  # ours: empty space is known for every degree
ERODE = 2  # ours: bearings on either side that must be free as well


@dataclass(frozen=True, slots=True)
class ScanPoints:
    """A scan as points, seen from its observation point, axes of the odom frame.

    Parameters
    ----------
    wall_m : (W, 2)
        On the walls.
    wall_weight_m : (W,)
        Metres of wall that each stands for.
    empty_m : (E, 2)
        In space that is proven empty.
    empty_m2 : float
        Square metres that each of these stands for.
    """

    wall_m: FloatArray
    wall_weight_m: FloatArray
    empty_m: FloatArray
    empty_m2: float

    @property
    def reach_m(self) -> float:
        """Distance of the farthest point."""
        points = np.concatenate([self.wall_m, self.empty_m])
        return float(np.linalg.norm(points, axis=1).max())


def scan_points(scan: Scan, settings: ObservationSettings | None = None) -> ScanPoints:
    """Turn a scan into points on its walls and in its empty space.

    Parameters
    ----------
    scan : Scan
    settings : ObservationSettings, optional

    Examples
    --------
    >>> points = scan_points(Scan([[[2.0, -1.0], [2.0, 1.0]]]))
    >>> round(float(points.wall_weight_m.sum()), 6), bool((points.empty_m[:, 0] < 1.7).all())
    (2.0, True)
    """
    settings = settings or ObservationSettings()
    step, on_walls, weights = settings.spacing_m, [], []
    for start, end in scan.relative_m:
        length = float(np.linalg.norm(end - start))
        n = max(1, round(length / step))
        on_walls.append(start + ((np.arange(n) + 0.5) / n)[:, None] * (end - start))
        weights.append(np.full(n, length / n))
    free = np.minimum(_free_m(scan), settings.empty_range_m)
    free = np.nan_to_num(free - settings.empty_margin_m, nan=0.0)
    free = np.min([np.roll(free, k) for k in range(-ERODE, ERODE + 1)], axis=0)
    n = max(1, math.ceil(max(float(free.max()), 0.0) / step))
    x, y = (axis.ravel() * step for axis in np.meshgrid(*2 * [np.arange(-n, n + 1)]))
    bearing = np.floor(np.mod(np.arctan2(y, x), 2 * np.pi) / (2 * np.pi) * BEARINGS)
    empty = np.hypot(x, y) < free[bearing.astype(int) % BEARINGS]
    return ScanPoints(
        as_readonly(np.concatenate(on_walls)), as_readonly(np.concatenate(weights)),
        as_readonly(np.stack([x[empty], y[empty]], axis=1)), step**2,
    )  # fmt: skip


def _free_m(scan: Scan) -> FloatArray:
    """How far it is surely free by bearing: up to the nearest wall seen; NaN where none was.

    What the scan itself says of its coverage counts too, where it is nearer.
    """
    angle = (np.arange(BEARINGS) + 0.5) * 2 * np.pi / BEARINGS
    beam = np.stack([np.cos(angle), np.sin(angle)], axis=1)[:, None]
    start, along = scan.relative_m[:, 0], scan.relative_m[:, 1] - scan.relative_m[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        across = beam[..., 0] * along[:, 1] - beam[..., 1] * along[:, 0]
        range_m = (start[:, 0] * along[:, 1] - start[:, 1] * along[:, 0]) / across
        part = (start[:, 0] * beam[..., 1] - start[:, 1] * beam[..., 0]) / across
    met = (range_m > 0) & (part >= 0) & (part <= 1)
    free: FloatArray = np.where(met, range_m, np.inf).min(axis=1)
    free[np.isinf(free)] = np.nan
    if scan.coverage_m is not None:
        index = (angle / (2 * np.pi) * len(scan.coverage_m)).astype(int)
        free = np.fmin(free, scan.coverage_m[index])
    return free


def log_likelihood(
    points: ScanPoints,
    raster: PlanRaster,
    position_m: FloatArray,
    drift_rad: FloatArray,
    settings: ObservationSettings | None = None,
) -> FloatArray:
    """Return what a scan says about poses, in nats (N,); 0 where it says nothing.

    Against the same scan in a place without any wall of the plan; before `strength`.

    Parameters
    ----------
    points : ScanPoints
    raster : PlanRaster
    position_m : (N, 2)
        Where the scan may have been taken, map frame.
    drift_rad : (N,)
    settings : ObservationSettings, optional
    """
    settings = settings or ObservationSettings()
    sight = see(raster, settings)
    place = np.ascontiguousarray(position_m, dtype=np.float64)
    turn = np.ascontiguousarray(drift_rad, dtype=np.float64)
    walls, empty = np.empty(len(turn)), np.empty(len(turn))
    loops.lookup(
        place, turn, points.wall_m, points.wall_weight_m, sight.support, sight.frame, walls
    )  # fmt: skip
    area = np.full(len(points.empty_m), points.empty_m2)
    loops.lookup(place, turn, points.empty_m, area, sight.cost, sight.frame, empty)
    return np.asarray(walls - settings.empty_nats_per_m * empty)


@dataclass(frozen=True)
class Likelihoods:
    """`log_likelihood` over the whole building, one map for each drift; see `likelihoods`.

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
        return self._sight.grid

    def __len__(self) -> int:
        return len(self.drifts_rad)

    @cached_property
    def inside(self) -> npt.NDArray[np.bool_]:
        """Cells (R, C) that reach into the building."""
        return _any(self.raster.inside, self.grid.shape)

    def template(self, k: int) -> Template:
        """Return what speaks for a place with drift k (metres of wall) and against it."""
        walls, empty = self._splats(k)
        cost = self.settings.empty_nats_per_m * empty
        return Template(walls - cost, (self._half, self._half), float(self.drifts_rad[k]))

    def scores(self, k: int) -> Field:
        """Return the map (R, C) of drift k, in nats, by Fourier transform."""
        (rows, columns), shape = self.grid.shape, self._shape
        support, cost = self._spectra
        walls, empty = self._splats(k)
        product = np.conj(_turned(walls, shape)) * support
        product -= self.settings.empty_nats_per_m * np.conj(_turned(empty, shape)) * cost
        turned = scipy.fft.ifft(product, axis=0, overwrite_x=True)[:rows]
        return np.ascontiguousarray(scipy.fft.irfft(turned, n=shape[1], axis=1)[:, :columns])

    def __iter__(self) -> Iterator[Field]:
        return (self.scores(k) for k in range(len(self)))

    @cached_property
    def _points(self) -> ScanPoints:
        return scan_points(self.scan, self.settings)

    @cached_property
    def _sight(self) -> Sight:
        return see(self.raster, self.settings, _coarseness(self.raster.grid, self.settings))

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
        fields = (self._sight.support, self._sight.cost)
        support, cost = (_spectrum(field, self._half, self._shape) for field in fields)
        return support, cost

    def _splats(self, k: int) -> tuple[Field, Field]:
        """Metres of wall and square metres of empty space in each cell of a template."""
        points, side = self._points, 2 * self._half + 1
        walls, empty = (np.zeros((side, side), np.float32) for _ in range(2))
        drift, cell = float(self.drifts_rad[k]), self.grid.cell_size_m
        area = np.full(len(points.empty_m), points.empty_m2)
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
        Their shares are the posterior of an even prior over the inside and all drifts, at
        the settings' `strength`. `mass` is the share that the plan explains at all,
        ``1 - elsewhere``; `log_mean` the logarithm of the mean likelihood over the prior.

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
    reach, found = settings.keep_nats / settings.strength, []
    best = -np.inf
    for k, scores in enumerate(maps):
        best = max(best, float(scores.max(where=inside, initial=-np.inf)))
        here = np.argwhere(inside & (scores >= best - reach)).astype(np.int32)
        found.append((here, np.full(len(here), k, np.int32), scores[here[:, 0], here[:, 1]]))
    at, label, score = (np.concatenate(part) for part in zip(*found, strict=True))
    if len(score) > settings.max_candidates:
        best_left = float(select.nth_largest(score, settings.max_candidates))
        keep = np.flatnonzero(score >= max(best - reach, best_left))
    else:
        keep = np.flatnonzero(score >= best - reach)
    log_weight = settings.strength * score[keep].astype(np.float64)
    top = log_weight.max()
    total = float(np.exp(log_weight - top).sum())
    poses = inside.sum() * round(2 * math.pi / settings.drift_step_rad)
    return Candidates(
        maps.grid, maps.drifts_rad, at[keep], label[keep], score[keep],
        log_weight - top - math.log(total), 1 - settings.elsewhere, settings.drift_step_rad,
        top + math.log(total / poses),
    )  # fmt: skip


def _coarseness(grid: Grid, settings: ObservationSettings) -> int:
    """Cells of the raster along a side of a cell of the search."""
    k = max(1, round(settings.cell_size_m / grid.cell_size_m))
    while grid.size / k**2 > settings.max_cells:
        k += 1
    return k


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
