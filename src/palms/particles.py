"""Particles: start, move, meet walls, resample (paper III-C)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms._compiled import filter as loops
from palms.errors import InputError
from palms.geometry import FloatArray, as_readonly, wrap_angle
from palms.heatmap import Candidates
from palms.motion import move_noise
from palms.odometry import Move
from palms.randomness import RandomKey
from palms.raster import PlanRaster
from palms.settings import MotionSettings

__all__ = [
    "MoveInfo",
    "Particles",
    "advance",
    "effective_sample_size",
    "resample_systematic",
    "start_everywhere",
    "start_from",
    "thin",
    "with_scales",
]

_PLACE, _DRIFT, _MOVE, _COPY, _RESAMPLE, _THIN, _SCALE = (
    0,
    1,
    2,
    3,
    4,
    5,
    7,
)  # purposes of random numbers


@dataclass(frozen=True, slots=True)
class Particles:
    """What the phone's pose may be: many guesses, each with a weight.

    Parameters
    ----------
    position_m : (N, 2)
        In the map frame.
    drift_rad : (N,)
        Angle from odom vectors to map vectors; not wrapped, so that it stays continuous.
    scale : (N,)
        Metres walked per metre of odometry.
    label : (N,) int32
        The candidate drift a particle came from.
    weight : (N,)
        Sum 1.

    Examples
    --------
    >>> two = Particles([[0, 0], [1, 0]], [0, 0], [1, 1], [0, 1], [0.5, 0.5])
    >>> two.mean_m().tolist()
    [0.5, 0.0]
    """

    position_m: FloatArray
    drift_rad: FloatArray
    scale: FloatArray
    label: npt.NDArray[np.int32]
    weight: FloatArray

    def __post_init__(self) -> None:
        for name, dtype in (
            ("position_m", np.float64), ("drift_rad", np.float64), ("scale", np.float64),
            ("label", np.int32), ("weight", np.float64),
        ):  # fmt: skip
            array = np.ascontiguousarray(getattr(self, name), dtype=dtype)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        n = len(self.weight)
        if n == 0 or self.position_m.shape != (n, 2) or len(self.drift_rad) != n:
            raise InputError("particles", expected="as many of each, at least 1", got=str(n))

    def __len__(self) -> int:
        return len(self.weight)

    def mean_m(self, members: npt.NDArray[np.bool_] | None = None) -> FloatArray:
        """Weighted mean position (2,) of all particles or of some of them."""
        if members is None:
            mean: FloatArray = self.weight @ self.position_m / self.weight.sum()
        else:
            weight = self.weight[members]
            mean = weight @ self.position_m[members] / weight.sum()
        return mean

    def dispersion_m(self) -> float:
        """Root of the summed variances of the positions."""
        offset = self.position_m - self.mean_m()
        return float(np.sqrt(self.weight @ (offset**2).sum(axis=1)))

    def label_shares(self) -> FloatArray:
        """Share of the weight that each label holds."""
        return np.asarray(np.bincount(self.label, self.weight), dtype=np.float64)


class MoveInfo(NamedTuple):
    """What happened in a move, for those who watch.

    Attributes
    ----------
    n_hit : int
        Particles that hit a wall or left the plan.
    n_survived : int
        The others. When it is 0 the move contradicts the plan for every particle; then all
        of them make the move all the same, since the odometry is sure and the plan is not.
    effective_sample_size : float
        Of the weights after the move.
    """

    n_hit: int
    n_survived: int
    effective_sample_size: float


def start_from(candidates: Candidates, n: int, key: RandomKey, own_frame: bool) -> Particles:
    """Sample particles from the candidate cells, uniformly within each cell (paper III-C).

    Parameters
    ----------
    candidates : Candidates
    n : int
        Number of particles, spread evenly over the cells' weights.
    key : RandomKey
    own_frame : bool
        Whether the walk's frame is not the scan's: the drift is then anything.
    """
    index = resample_systematic(np.exp(candidates.log_weight), n, key.child(_PLACE))
    position, drift = np.empty((n, 2)), np.empty(n)
    loops.place(
        candidates.cells, candidates.drift_rad, index, candidates.grid.cell_size_m,
        candidates.grid.origin_m, key.child(_PLACE, 1).word, position, drift,
    )  # fmt: skip
    if own_frame:
        drift = _any_drift(n, key)
    return Particles(position, drift, np.ones(n), candidates.label[index], np.full(n, 1 / n))


def start_everywhere(
    raster: PlanRaster, n: int, key: RandomKey, drifts_rad: FloatArray | None = None
) -> Particles:
    """Sample particles uniformly over the inside of the building (paper IV-B).

    Parameters
    ----------
    raster : PlanRaster
    n : int
    key : RandomKey
    drifts_rad : array_like (K,), optional
        Equal groups with these drifts (Uniform + Ori). Left out: any drift (Uniform).
    """
    cells = np.argwhere(raster.inside).astype(np.int32)
    index = resample_systematic(np.full(len(cells), 1 / len(cells)), n, key.child(_PLACE))
    position, drift = np.empty((n, 2)), np.empty(n)
    loops.place(
        cells, np.zeros(len(cells)), index, raster.grid.cell_size_m, raster.grid.origin_m,
        key.child(_PLACE, 1).word, position, drift,
    )  # fmt: skip
    label = np.zeros(n, np.int32)
    if drifts_rad is None:
        drift = _any_drift(n, key)
    else:
        label = _dealt(n, len(drifts_rad), key)
        drift = drifts_rad[label]
    return Particles(position, drift, np.ones(n), label, np.full(n, 1 / n))


def advance(
    particles: Particles, move: Move, raster: PlanRaster, settings: MotionSettings, key: RandomKey
) -> tuple[Particles, MoveInfo]:
    """Move all particles by one move of the odometry and let the walls judge (paper III-C).

    Parameters
    ----------
    particles : Particles
    move : Move
    raster : PlanRaster
    settings : MotionSettings
    key : RandomKey
        Of this step.

    Returns
    -------
    particles : Particles
    info : MoveInfo
    """
    n = len(particles)
    position, drift, hit = np.empty((n, 2)), np.empty(n), np.empty(n, np.bool_)
    noise = move_noise(move.length_m, settings, move.duration_s or 0.0)
    n_hit = loops.move(
        particles.position_m, particles.drift_rad, particles.scale, (move.dx_m, move.dy_m),
        tuple(noise), key.child(_MOVE).word, raster.walls, position, drift, hit,
    )  # fmt: skip
    scale, label, weight = particles.scale, particles.label, particles.weight
    if settings.hit_weight > 0:
        weight = np.where(hit, settings.hit_weight * weight, weight)
        moved = Particles(position, drift, scale, label, weight / weight.sum())
        moved = _resample_all(moved, settings, key)
    else:
        if 0 < n_hit < n:
            scale, label = scale.copy(), label.copy()
            spread = np.array([settings.jitter_m, noise.drift_rad])
            loops.replace_hits(
                position, drift, scale, label, hit, spread, key.child(_COPY).word, raster.walls
            )
        moved = Particles(position, drift, scale, label, weight)
    return moved, MoveInfo(n_hit, n - n_hit, effective_sample_size(moved.weight))


def _resample_all(particles: Particles, settings: MotionSettings, key: RandomKey) -> Particles:
    """Resample at every step and keep the weights as they are (authors' code)."""
    n = len(particles)
    index = resample_systematic(particles.weight, n, key.child(_RESAMPLE))
    offset = np.empty((n, 2))
    loops.normals(key.child(_COPY).word, 2, offset)
    weight = particles.weight[index]
    return Particles(
        particles.position_m[index] + settings.jitter_m * offset, particles.drift_rad[index],
        particles.scale[index], particles.label[index], weight / weight.sum(),
    )  # fmt: skip


def thin(particles: Particles, n: int, key: RandomKey) -> Particles:
    """Keep n particles, drawn by weight."""
    index = resample_systematic(particles.weight, n, key.child(_THIN))
    return Particles(
        particles.position_m[index], particles.drift_rad[index], particles.scale[index],
        particles.label[index], np.full(n, 1 / n),
    )  # fmt: skip


def resample_systematic(weights: FloatArray, n: int, key: RandomKey) -> npt.NDArray[np.int64]:
    """Return n indices drawn in proportion to the weights, by systematic resampling.

    One random offset for all (Kitagawa 1996): each index comes out as often as its share of
    n says, rounded up or down.

    Examples
    --------
    >>> from palms.randomness import as_key
    >>> resample_systematic(np.array([0.5, 0.0, 0.5]), 4, as_key(0)).tolist()
    [0, 0, 2, 2]
    """
    out = np.empty(n, np.int64)
    loops.systematic(np.ascontiguousarray(weights), n, key.uniform(), out)
    return out


def with_scales(particles: Particles, scale_sd: float, key: RandomKey) -> Particles:
    """Give each particle a scale of its own around 1; the same particles for a spread of 0."""
    if scale_sd == 0:
        return particles
    z = np.empty((len(particles), 1))
    loops.normals(key.child(_SCALE).word, 1, z)
    return replace(particles, scale=1 + scale_sd * z[:, 0])


def effective_sample_size(weight: FloatArray) -> float:
    """Return 1 / sum of squared weights, the number of particles that count (Kong 1994).

    Examples
    --------
    >>> effective_sample_size(np.array([0.5, 0.5, 0.0]))
    2.0
    """
    return float(weight.sum() ** 2 / (weight @ weight))


def _dealt(n: int, n_groups: int, key: RandomKey) -> npt.NDArray[np.int32]:
    """Labels of equal groups in random order, so that no order of places falls in step."""
    ticket = np.empty((n, 1))
    loops.uniforms(key.child(_DRIFT).word, 1, ticket)
    label = np.empty(n, np.int32)
    label[np.argsort(ticket[:, 0], kind="stable")] = np.arange(n) % n_groups
    return label


def _any_drift(n: int, key: RandomKey) -> FloatArray:
    turn = np.empty((n, 1))
    loops.uniforms(key.child(_DRIFT).word, 1, turn)
    drift: FloatArray = as_readonly(wrap_angle(2 * np.pi * turn[:, 0]))
    return drift
