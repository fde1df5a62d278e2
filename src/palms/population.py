"""Our population of particles: drawn from the posterior, as many as the belief needs.

A particle's chance to be drawn is the root of its weight, and its new weight is what the root
leaves over: a place that is unlikely keeps particles to come back with, and several places
live side by side until the walk decides (docs/explanation/filter.md).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from palms._compiled import filter as loops
from palms._compiled import observation as counts
from palms._compiled import weights as by_weight
from palms.geometry import FloatArray, rotate_each
from palms.particles import (
    Particles,
    any_drift,
    effective_sample_size,
    resample_systematic,
    start_everywhere,
)
from palms.posterior import Posterior
from palms.randomness import RandomKey
from palms.raster import PlanRaster
from palms.settings import ResamplingSettings, Settings

__all__ = ["adapted", "anywhere", "drawn", "mixed", "pushed", "shifted_m", "start_posterior"]

_JUDGE, _SPARE, _ADAPT, _JITTER = 11, 12, 13, 14  # purposes of random numbers
DUST = 1e-3  # ours: a particle of less than this of its fair weight occupies no bin
SHRINK = 0.7  # ours: fewer particles pay only when they are fewer than this share


def start_posterior(
    found: Posterior,
    raster: PlanRaster,
    settings: Settings,
    key: RandomKey,
    own_frame: bool = False,
) -> Particles:
    """Draw particles from the posterior of a scan, some of them from anywhere.

    Parameters
    ----------
    found : Posterior
    raster : PlanRaster
    settings : Settings
    key : RandomKey
    own_frame : bool
        Whether the walk's frame is not the scan's: the drift is then anything.
    """
    n = settings.start.n_particles
    elsewhere = 1 - found.mass
    n_spare = round(n * settings.start.spare_share) if elsewhere > 0 else 0
    start = drawn(found, n - n_spare, key.child(_JUDGE))
    if own_frame:
        start = replace(start, drift_rad=any_drift(len(start), key))
    if not n_spare:
        return start
    drifts = None if own_frame else found.drifts_rad
    spare = anywhere(raster, n_spare, drifts, found.drift_step_rad, key.child(_SPARE))
    return mixed(start, spare, elsewhere)


def drawn(found: Posterior, n: int, key: RandomKey) -> Particles:
    """Draw n poses of a posterior by the root of their weight."""
    weight = np.exp(found.log_weight)
    index, weight = _by_root(weight, n, key)
    return Particles(
        found.position_m[index], found.drift_rad[index], np.ones(n), found.label[index], weight
    )


def anywhere(
    raster: PlanRaster, n: int, drifts_rad: FloatArray | None, step_rad: float, key: RandomKey
) -> Particles:
    """Sample particles over the inside of the building, with any of some drifts.

    Parameters
    ----------
    raster : PlanRaster
    n : int
    drifts_rad : (K,), optional
        Any drift when left out.
    step_rad : float
        The drift may lie half of this to either side.
    key : RandomKey
    """
    spread = start_everywhere(raster, n, key, drifts_rad)
    turn = np.empty((n, 1))
    loops.uniforms(key.child(_JITTER).word, 1, turn)
    return replace(spread, drift_rad=spread.drift_rad + (turn[:, 0] - 0.5) * step_rad)


def mixed(belief: Particles, others: Particles, share: float) -> Particles:
    """Return one population of two, of which the second holds a share of the weight.

    Examples
    --------
    >>> here, there = (Particles([[x, 0]], [0], [1], [0], [1]) for x in (0.0, 9.0))
    >>> mixed(here, there, 0.25).weight.tolist()
    [0.75, 0.25]
    """
    return Particles(
        np.concatenate([belief.position_m, others.position_m]),
        np.concatenate([belief.drift_rad, others.drift_rad]),
        np.concatenate([belief.scale, others.scale]),
        np.concatenate([belief.label, others.label]),
        np.concatenate([(1 - share) * belief.weight, share * others.weight]),
        _joined(*((each.drift_rate_rad_per_s, len(each)) for each in (belief, others))),
        _joined(*((each.leg_scale, len(each)) for each in (belief, others))),
        _joined(*((each.hint_nats, len(each)) for each in (belief, others))),
    )


def _joined(*parts: tuple[FloatArray | None, int]) -> FloatArray | None:
    """Join what populations of some sizes have; 0 for one that has none."""
    if all(have is None for have, _ in parts):
        return None
    return np.concatenate([np.zeros(n) if have is None else have for have, n in parts])


def pushed(found: Posterior, n: int, moved_m: FloatArray, key: RandomKey) -> Particles:
    """Draw from the posterior of a scan, carried along by what was walked since.

    Parameters
    ----------
    found : Posterior
    n : int
    moved_m : (2,)
        From the scan's observation point to the phone, odom frame.
    key : RandomKey
    """
    particles = drawn(found, n, key)
    offset = rotate_each(moved_m, particles.drift_rad)
    return replace(particles, position_m=particles.position_m + offset)


def adapted(
    particles: Particles,
    raster: PlanRaster,
    settings: ResamplingSettings,
    most: int,
    key: RandomKey,
    count: bool = True,
) -> Particles:
    """Draw the particles anew when few of them count, or when fewer would do.

    Parameters
    ----------
    particles : Particles
    raster : PlanRaster
    settings : ResamplingSettings
    most : int
        Never more than this.
    key : RandomKey
        Of this step.
    count : bool
        Whether to look if fewer would do, even if the effective sample size is fine.
    """
    n = len(particles)
    starved = effective_sample_size(particles.weight) < settings.ess_share * n
    if not starved and not count:
        return particles
    bins = counts.occupied(
        particles.position_m, particles.drift_rad, particles.weight, DUST / n, settings.bin_m,
        settings.bin_rad,
    )  # fmt: skip
    wanted = int(min(max(settings.per_bin * bins, settings.min_particles), most))
    if not starved and wanted > SHRINK * n:
        return particles
    index, weight = _by_root(particles.weight, wanted, key.child(_ADAPT))
    return _jittered(particles.take(index, weight), raster, settings, key)


def _by_root(
    weight: FloatArray, n: int, key: RandomKey
) -> tuple[npt.NDArray[np.int64], FloatArray]:
    """Draw n indices by the root of the weights; return them with their new weights."""
    root = np.sqrt(weight)
    index = resample_systematic(root, n, key)
    left = root[index]
    return index, left / by_weight.moments(left)[0]


def shifted_m(particles: Particles, by_m: FloatArray, raster: PlanRaster) -> FloatArray:
    """Return positions (N, 2) shifted by (N, 2); those stay that would go through a wall."""
    there: FloatArray = particles.position_m + by_m
    blocked = raster.blocked(particles.position_m, there)
    there[blocked] = particles.position_m[blocked]
    return there


def _jittered(
    particles: Particles, raster: PlanRaster, settings: ResamplingSettings, key: RandomKey
) -> Particles:
    """Spread copies a little: the fewer there are, the more; none through a wall."""
    n = len(particles)
    z = np.empty((n, 4))
    loops.normals(key.child(_JITTER).word, 4, z)
    spread_m = settings.jitter_m * min(1.0, math.sqrt(settings.min_particles / n))
    return replace(
        particles, position_m=shifted_m(particles, spread_m * z[:, :2], raster),
        drift_rad=particles.drift_rad + settings.jitter_rad * z[:, 2],
        scale=particles.scale + settings.jitter_scale * z[:, 3],
    )  # fmt: skip
