"""Particles: start, move, meet walls, resample (paper III-C)."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms._compiled import clusters
from palms._compiled import filter as loops
from palms._compiled import weights as by_weight
from palms.errors import InputError
from palms.geometry import FloatArray, as_readonly, wrap_angle
from palms.heatmap import Candidates
from palms.motion import MoveNoise, move_noise
from palms.odometry import Move
from palms.randomness import RandomKey
from palms.raster import PlanRaster
from palms.settings import MotionSettings, ResamplingSettings

__all__ = [
    "MoveInfo",
    "Particles",
    "advance",
    "any_drift",
    "effective_sample_size",
    "resample_systematic",
    "reweight",
    "start_everywhere",
    "start_from",
    "thin",
    "with_scales",
]

_PLACE, _DRIFT, _MOVE, _COPY, _RESAMPLE, _THIN, _SCALE = 0, 1, 2, 3, 4, 5, 7  # of random numbers
_FIELDS = (
    ("position_m", np.float64), ("drift_rad", np.float64), ("scale", np.float64),
    ("label", np.int32), ("weight", np.float64), ("drift_rate_rad_per_s", np.float64),
    ("leg_scale", np.float64), ("hint_nats", np.float64),
)  # fmt: skip


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
    drift_rate_rad_per_s : (N,), optional
        Steady turn of the walk's frame; None where it does not turn.
    leg_scale : (N,), optional
        By so much is the scale of the leg that is walked now larger than the walk's; None
        where all legs have one scale.
    hint_nats : (N,), optional
        What hints say for each of them and has not faded yet; None where nobody said anything.

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
    drift_rate_rad_per_s: FloatArray | None = None
    leg_scale: FloatArray | None = None
    hint_nats: FloatArray | None = None

    def __post_init__(self) -> None:
        for name, dtype in _FIELDS:
            given = getattr(self, name)
            if given is None:
                continue
            array = np.ascontiguousarray(given, dtype)
            array.setflags(write=False)
            if array is not given:
                object.__setattr__(self, name, array)
        n = len(self.weight)
        if n == 0 or self.position_m.shape != (n, 2) or len(self.drift_rad) != n:
            raise InputError("particles", expected="as many of each, at least 1", got=str(n))

    def __len__(self) -> int:
        return len(self.weight)

    def mean_m(self, members: npt.NDArray[np.bool_] | None = None) -> FloatArray:
        """Weighted mean position (2,) of all particles or of some of them."""
        return self.mean_pose(members)[0]

    def mean_pose(self, members: npt.NDArray[np.bool_] | None = None) -> tuple[FloatArray, float]:
        """Weighted mean position (2,), and drift in (-pi, pi], of all or of some of them."""
        if members is None:
            return self.mean_poses(np.zeros(len(self), np.int8), 1)[0]
        return self.mean_poses(members.astype(np.int8) - 1, 1)[0]

    def mean_poses(self, place: npt.NDArray[np.int8], n: int) -> list[tuple[FloatArray, float]]:
        """Mean pose of the particles of each of n places; NaN where there are none.

        Parameters
        ----------
        place : (N,) int8
            The place that each particle belongs to, or -1.
        n : int
        """
        sums = self._sums(place, n)
        with np.errstate(invalid="ignore"):
            mean = sums[:, 1:3] / sums[:, :1]
        drift = np.arctan2(sums[:, 4], sums[:, 3]).tolist()
        return [(mean[k], wrap_angle(drift[k])) for k in range(n)]

    def drift_agreement(self) -> float:
        """Length of the mean of all drifts as unit vectors: 1 where they agree, 0 all around."""
        ((weight, _, _, east, north),) = self._sums(np.zeros(len(self), np.int8), 1)
        return math.hypot(east, north) / float(weight)

    def _sums(self, place: npt.NDArray[np.int8], n: int) -> FloatArray:
        """Return sums (n, 5) for n places: weight; x, y, the drift's cosine and sine by weight."""
        sums = np.empty((n, 5))
        loops.gathered(self.position_m, self.drift_rad, self.weight, place, sums)
        return sums

    def dispersion_m(self, mean_m: FloatArray | None = None) -> float:
        """Root of the summed variances of the positions; quicker where their mean is known."""
        x, y = self.mean_m() if mean_m is None else mean_m
        return math.sqrt(clusters.variance(self.position_m, self.weight, x, y))

    def take(self, index: npt.NDArray[np.int64], weight: FloatArray) -> Particles:
        """Return some of them, by index (M,), with new weights (M,)."""
        may_be = (self.drift_rate_rad_per_s, self.leg_scale, self.hint_nats)
        return Particles(
            self.position_m[index], self.drift_rad[index], self.scale[index], self.label[index],
            weight, *(None if each is None else each[index] for each in may_be),
        )  # fmt: skip

    def turned_rad(self, duration_s: float) -> FloatArray:
        """Drifts (N,) after some time, by the steady turn alone."""
        if self.drift_rate_rad_per_s is None:
            return self.drift_rad
        turned: FloatArray = self.drift_rad + duration_s * self.drift_rate_rad_per_s
        turned.setflags(write=False)  # one kind of array for the loop that takes it
        return turned

    @property
    def scale_now(self) -> FloatArray:
        """Metres walked per metre of odometry (N,), on the leg that is walked now."""
        if self.leg_scale is None:
            return self.scale
        scale: FloatArray = self.scale + self.leg_scale
        scale.setflags(write=False)  # as in `turned_rad`
        return scale

    def label_shares(self) -> FloatArray:
        """Share of the weight that each label holds."""
        shares: FloatArray = by_weight.by_label(self.label, self.weight)
        return shares


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
    evidence : float
        Logarithm of the share of its weight that the belief kept; 0 where hits are replaced.
    """

    n_hit: int
    n_survived: int
    effective_sample_size: float
    evidence: float = 0.0


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
        drift = any_drift(n, key)
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
    inside = np.flatnonzero(raster.inside)
    index = resample_systematic(np.full(len(inside), 1 / len(inside)), n, key.child(_PLACE))
    cells = np.stack(np.unravel_index(inside[index], raster.inside.shape), axis=1)
    position, drift = np.empty((n, 2)), np.empty(n)
    loops.place(
        cells.astype(np.int32), np.zeros(n), np.arange(n), raster.grid.cell_size_m,
        raster.grid.origin_m, key.child(_PLACE, 1).word, position, drift,
    )  # fmt: skip
    label = np.zeros(n, np.int32)
    if drifts_rad is None:
        drift = any_drift(n, key)
    else:
        label = _dealt(n, len(drifts_rad), key)
        drift = drifts_rad[label]
    return Particles(position, drift, np.ones(n), label, np.full(n, 1 / n))


def advance(
    particles: Particles,
    move: Move,
    raster: PlanRaster,
    settings: MotionSettings,
    key: RandomKey,
    resampling: ResamplingSettings | None = None,
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
    resampling : ResamplingSettings, optional
        The paper's when left out.

    Returns
    -------
    particles : Particles
    info : MoveInfo
    """
    scheme = "survivors" if resampling is None else resampling.scheme
    if settings.leg_scale_sd > 0:
        particles = _on_its_leg(particles, move.length_m, settings, key)
    noise = move_noise(move.length_m, settings, move.duration_s or 0.0)
    position, drift, hit, n_hit = _moved(particles, move, raster, noise, key)
    n, scale, label = len(hit), particles.scale, particles.label
    if scheme == "survivors" and 0 < n_hit < n:
        scale, label = scale.copy(), label.copy()
        spread = np.array([settings.jitter_m, noise.drift_rad])
        copying = key.child(_COPY).word
        loops.replace_hits(position, drift, scale, label, hit, spread, copying, raster.walls)
    moved = Particles(
        position, drift, scale, label, particles.weight, particles.drift_rate_rad_per_s,
        particles.leg_scale, particles.hint_nats,
    )  # fmt: skip
    if scheme == "survivors":
        return moved, MoveInfo(n_hit, n - n_hit, effective_sample_size(moved.weight))
    moved, kept = reweight(moved, np.where(hit, settings.hit_weight, 1.0))
    if scheme == "every-step":
        moved = _resample_all(moved, settings, key)
    return moved, MoveInfo(n_hit, n - n_hit, effective_sample_size(moved.weight), kept)


def _moved(
    particles: Particles, move: Move, raster: PlanRaster, noise: MoveNoise, key: RandomKey
) -> tuple[FloatArray, FloatArray, npt.NDArray[np.bool_], int]:
    """Return positions and drifts after a move, which hit a wall or left the plan, how many."""
    n = len(particles)
    position, drift, hit = np.empty((n, 2)), np.empty(n), np.empty(n, np.bool_)
    n_hit = loops.move(
        particles.position_m, particles.turned_rad(move.duration_s or 0.0), particles.scale_now,
        (move.dx_m, move.dy_m), tuple(noise), key.child(_MOVE).word, raster.walls,
        position, drift, hit,
    )  # fmt: skip
    return position, drift, hit, n_hit


def _on_its_leg(
    particles: Particles, length_m: float, settings: MotionSettings, key: RandomKey
) -> Particles:
    """Let the scale of the leg wander: back to the walk's, and anew (Uhlenbeck, Ornstein 1930)."""
    kept = math.exp(-length_m / settings.leg_m)
    anew = settings.leg_scale_sd * math.sqrt(1 - kept * kept)
    z = _normals(len(particles), key.child(_SCALE))
    before = 0.0 if particles.leg_scale is None else kept * particles.leg_scale
    return replace(particles, leg_scale=before + anew * z)


def reweight(particles: Particles, factor: npt.ArrayLike) -> tuple[Particles, float]:
    """Multiply the weights by factors (N,); return the logarithm of what they kept, too.

    When nothing would be left the weights stay, and the logarithm is that of the smallest
    number: the evidence contradicts every particle.

    Examples
    --------
    >>> two = Particles([[0, 0], [1, 0]], [0, 0], [1, 1], [0, 1], [0.5, 0.5])
    >>> more, kept = reweight(two, [1.0, 0.5])
    >>> more.weight.round(3).tolist(), round(kept, 3)
    ([0.667, 0.333], -0.288)
    """
    weight = np.empty(len(particles))
    total = by_weight.weighed(
        particles.weight, np.ascontiguousarray(factor, dtype=np.float64), weight
    )
    if total <= sys.float_info.min:
        return particles, math.log(sys.float_info.min)
    return replace(particles, weight=weight / total), math.log(total)


def _resample_all(particles: Particles, settings: MotionSettings, key: RandomKey) -> Particles:
    """Resample at every step and keep the weights as they are (authors' code)."""
    n = len(particles)
    index = resample_systematic(particles.weight, n, key.child(_RESAMPLE))
    offset = np.empty((n, 2))
    loops.normals(key.child(_COPY).word, 2, offset)
    weight = particles.weight[index]
    return Particles(
        particles.position_m[index] + settings.jitter_m * offset, particles.drift_rad[index],
        particles.scale[index], particles.label[index], weight / by_weight.moments(weight)[0],
    )  # fmt: skip


def thin(particles: Particles, n: int, key: RandomKey) -> Particles:
    """Keep n particles, drawn by weight."""
    index = resample_systematic(particles.weight, n, key.child(_THIN))
    return particles.take(index, np.full(n, 1 / n))


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
    by_weight.systematic(np.ascontiguousarray(weights), n, key.uniform(), out)
    return out


def with_scales(particles: Particles, settings: MotionSettings, key: RandomKey) -> Particles:
    """Give each particle a scale and a steady turn of its own, as the odometry may have."""
    n = len(particles)
    if settings.scale_sd > 0:
        scale = 1 + settings.scale_sd * _normals(n, key.child(_SCALE))
        particles = replace(particles, scale=scale)
    if settings.drift_rate_rad_per_s > 0:
        rate = settings.drift_rate_rad_per_s * _normals(n, key.child(_SCALE, 1))
        particles = replace(particles, drift_rate_rad_per_s=rate)
    if settings.leg_scale_sd > 0:
        leg = settings.leg_scale_sd * _normals(n, key.child(_SCALE, 2))
        particles = replace(particles, leg_scale=leg)
    return particles


def _normals(n: int, key: RandomKey) -> FloatArray:
    z = np.empty((n, 1))
    loops.normals(key.word, 1, z)
    return z[:, 0]


def effective_sample_size(weight: FloatArray) -> float:
    """Return 1 / sum of squared weights, the number of particles that count (Kong 1994).

    Examples
    --------
    >>> effective_sample_size(np.array([0.5, 0.5, 0.0]))
    2.0
    """
    total, squares = by_weight.moments(np.ascontiguousarray(weight))
    return float(total**2 / squares)


def _dealt(n: int, n_groups: int, key: RandomKey) -> npt.NDArray[np.int32]:
    """Labels of equal groups in random order, so that no order of places falls in step."""
    ticket = np.empty((n, 1))
    loops.uniforms(key.child(_DRIFT).word, 1, ticket)
    label = np.empty(n, np.int32)
    label[np.argsort(ticket[:, 0], kind="stable")] = np.arange(n) % n_groups
    return label


def any_drift(n: int, key: RandomKey) -> FloatArray:
    """Draw n drifts evenly all around, in (-pi, pi]."""
    turn = np.empty((n, 1))
    loops.uniforms(key.child(_DRIFT).word, 1, turn)
    drift: FloatArray = as_readonly(wrap_angle(2 * np.pi * turn[:, 0]))
    return drift
