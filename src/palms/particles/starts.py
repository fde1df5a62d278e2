"""Where particles start, and how their odometry may err (paper III-C, IV-B)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from palms._compiled import filter as loops
from palms.geometry import FloatArray, as_readonly, wrap_angle
from palms.heatmap import Candidates
from palms.particles.draws import resample_systematic
from palms.particles.particles import Particles
from palms.randomness import RandomKey
from palms.raster import PlanRaster
from palms.settings import MotionSettings

__all__ = ["any_drift", "normals", "start_everywhere", "start_from", "with_scales"]

_PLACE, _DRIFT, _SCALE = 0, 1, 7  # purposes of random numbers


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


def with_scales(particles: Particles, settings: MotionSettings, key: RandomKey) -> Particles:
    """Give each particle a scale and a steady turn of its own, as the odometry may have."""
    n = len(particles)
    if settings.scale_sd > 0:
        scale = 1 + settings.scale_sd * normals(n, key.child(_SCALE))
        particles = replace(particles, scale=scale)
    if settings.drift_rate_rad_per_s > 0:
        rate = settings.drift_rate_rad_per_s * normals(n, key.child(_SCALE, 1))
        particles = replace(particles, drift_rate_rad_per_s=rate)
    if settings.leg_scale_sd > 0:
        leg = settings.leg_scale_sd * normals(n, key.child(_SCALE, 2))
        particles = replace(particles, leg_scale=leg)
    return particles


def any_drift(n: int, key: RandomKey) -> FloatArray:
    """Draw n drifts evenly all around, in (-pi, pi]."""
    turn = np.empty((n, 1))
    loops.uniforms(key.child(_DRIFT).word, 1, turn)
    drift: FloatArray = as_readonly(wrap_angle(2 * np.pi * turn[:, 0]))
    return drift


def normals(n: int, key: RandomKey) -> FloatArray:
    """Draw n standard normal numbers."""
    z = np.empty((n, 1))
    loops.normals(key.word, 1, z)
    return z[:, 0]


def _dealt(n: int, n_groups: int, key: RandomKey) -> npt.NDArray[np.int32]:
    """Labels of equal groups in random order, so that no order of places falls in step."""
    ticket = np.empty((n, 1))
    loops.uniforms(key.child(_DRIFT).word, 1, ticket)
    label = np.empty(n, np.int32)
    label[np.argsort(ticket[:, 0], kind="stable")] = np.arange(n) % n_groups
    return label
