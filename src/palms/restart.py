"""Taken up again: the odometry's frame is new, and the place is kept.

A phone's session ends when its camera is covered or another app takes over; the next one has
a frame of its own. Then the drift may be anything, but the phone is not far from where it was:
as far as its bearer may have walked meanwhile (docs/explanation/restart.md).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from palms._compiled import filter as loops
from palms.belief import Belief
from palms.declaration import doubted, judge, share_oriented
from palms.geometry import FloatArray, rotate_each
from palms.grid import Grid
from palms.levels import climbed
from palms.particles import Particles, any_drift, resample_systematic, with_scales
from palms.population import adapted, anywhere, drawn, mixed
from palms.randomness import RandomKey
from palms.raster import PlanRaster
from palms.recovery import Conditions, Sighting, carried
from palms.settings import ResamplingSettings, RestartSettings

__all__ = ["is_turned_anyhow", "reframed", "spread_m", "taken_up"]

_DRAW, _WALK, _CLIMB, _ELSEWHERE, _SCALE, _ADAPT = range(6)  # purposes of random numbers
STAYING = 4  # ours: every fourth particle is of those who stay
TRIES = 8  # ours: a place outside of the building is drawn again so often
DOUBTFUL = 0.3  # ours: few particles alone are no reason to be lost
ALIKE = 0.3  # ours: of the particles in a bin of half a metre and ten degrees
DENSITY_M = 0.5  # ours: cells in which the belief's places are counted


def spread_m(away_s: float, settings: RestartSettings) -> float:
    """Return how far somebody may have walked in some time, a standard deviation in x and y.

    Somebody who walks at one speed and turns at random, after `leg_s` in the mean: straight
    on at first, later as a random walk (Fürth 1920).

    Parameters
    ----------
    away_s : float
    settings : RestartSettings

    Examples
    --------
    >>> settings = RestartSettings(speed_m_s=1.2, leg_s=10.0)
    >>> [round(spread_m(away_s, settings), 1) for away_s in (0.0, 1.0, 60.0, 240.0)]
    [0.0, 0.8, 26.8, 57.5]
    """
    legs = away_s / settings.leg_s
    return settings.speed_m_s * settings.leg_s * math.sqrt(max(legs - 1 + math.exp(-legs), 0.0))


def reframed(
    belief: Belief, away_s: float, conditions: Conditions, key: RandomKey
) -> tuple[Belief, float]:
    """Return a belief that keeps its places, spread by the time away, with any drift.

    Parameters
    ----------
    belief : Belief
    away_s : float
        Without odometry.
    conditions : Conditions
    key : RandomKey

    Returns
    -------
    belief : Belief
    nats : float
        By which its doubt grew, because its particles are few for so many places and drifts.
    """
    raster, settings, _, atlas = conditions
    n = settings.start.n_particles
    index = resample_systematic(belief.particles.weight, n, key.child(_DRAW))
    kept = _walked_on(belief.particles.take(index, np.full(n, 1 / n)), away_s, conditions, key)
    kept = replace(kept, drift_rad=any_drift(n, key))
    if atlas is not None:
        kept = climbed(kept, atlas, away_s, settings.levels, key.child(_CLIMB))
    gone = -math.expm1(-away_s / settings.restart.keep_s)
    if gone > 0:
        others = anywhere(raster, max(1, n // 4), None, 0.0, key.child(_ELSEWHERE))
        kept = mixed(kept, others, gone)
    kept = with_scales(kept, settings.motion, key.child(_SCALE))
    declaration = settings.declaration
    doubt = max(belief.doubt, declaration.doubt_at_start)
    lost = _lost_share(kept, settings.resampling)
    doubtful = max(doubt, min(doubt + (1 - doubt) * lost, DOUBTFUL))
    nats = math.log(doubtful / (1 - doubtful)) - math.log(doubt / (1 - doubt))
    return judge(replace(belief, doubt=doubtful), kept, declaration), nats


def _lost_share(particles: Particles, settings: ResamplingSettings) -> float:
    """Probability that no particle holds a truth that is one of them itself.

    One of the others has to lie so near that the walls treat both alike: `ALIKE` of those in
    the same bin do.
    """
    turn = np.mod(particles.drift_rad, 2 * math.pi) / settings.bin_rad
    bins = np.column_stack([particles.position_m / settings.bin_m, turn])
    _, own, count = np.unique(
        np.floor(bins).astype(np.int64), axis=0, return_inverse=True, return_counts=True
    )
    return float((particles.weight * np.exp(-ALIKE * (count[own.reshape(-1)] - 1))).sum())


def _walked_on(
    particles: Particles, away_s: float, conditions: Conditions, key: RandomKey
) -> Particles:
    """Let most of the particles walk on, to places in the building; others stay, and weigh more.

    Those who walk need more particles than their weight, since they get around.
    """
    raster, settings, n = conditions.raster, conditions.settings.restart, len(particles)
    sd_m, goes = spread_m(away_s, settings), settings.walk_share
    if sd_m == 0 or goes == 0:
        return particles
    left = np.arange(n) if goes == 1 else np.flatnonzero(np.arange(n) % STAYING)
    weight = np.full(n, (1 - goes) / max(n - len(left), 1))
    weight[left] = goes / len(left)
    found = particles.position_m.copy()
    for turn in range(TRIES):
        z = np.empty((len(left), 2))
        loops.normals(key.child(_WALK, turn).word, 2, z)
        there = particles.position_m[left] + sd_m * z
        inside = _inside(there, raster)
        found[left[inside]] = there[inside]
        left = left[~inside]
    return replace(particles, position_m=found, weight=weight / weight.sum())


def _inside(position_m: FloatArray, raster: PlanRaster) -> npt.NDArray[np.bool_]:
    inside = raster.grid.contains(position_m)
    inside[inside] = raster.inside[tuple(raster.grid.cell_of(position_m[inside]).T)]
    return inside


def is_turned_anyhow(particles: Particles, conditions: Conditions) -> bool:
    """Whether the drift is still open after the frame was new."""
    declaration = conditions.settings.declaration
    return share_oriented(particles, declaration.oriented_rad) < declaration.oriented_share


def taken_up(belief: Belief, sighting: Sighting, conditions: Conditions, key: RandomKey) -> Belief:
    """Find the drift by a scan, once the frame is new: its poses, weighed by the places kept.

    Particles with any drift are too few for a scan to judge each; but where each is says how
    probable a pose of the scan was beforehand. With the share of the doubt a pose may lie
    anywhere, and with the probability `elsewhere` the scan says nothing.

    Parameters
    ----------
    belief : Belief
        With any drift; its doubt is that of its places.
    sighting : Sighting
        What the scan says, and the way from its observation point to the phone.
    conditions : Conditions
    key : RandomKey
    """
    raster, settings, _, _ = conditions
    found, said = sighting.found, 1 - settings.observation.elsewhere
    weight = np.exp(found.log_weight)
    before = _times_even(belief.particles, _phone_m(sighting), raster)
    held = float((weight * before).sum())
    doubt = doubted(
        belief.doubt, math.log(max(said * held + 1 - said, 1e-300)), settings.declaration
    )
    mean = belief.doubt + (1 - belief.doubt) * held
    weighed = weight * (belief.doubt + (1 - belief.doubt) * before)
    judged = replace(found, log_weight=np.log(np.maximum(weighed / mean, 1e-300)))
    seen = carried(drawn(judged, settings.start.n_particles, key.child(_DRAW)), sighting.moved_m)
    seen = with_scales(seen, settings.motion, key.child(_SCALE))
    silent = (1 - said) / (1 - said + said * mean)
    wider = adapted(
        mixed(seen, belief.particles, silent), raster, settings.resampling,
        settings.start.n_particles, key.child(_ADAPT),
    )  # fmt: skip
    left = max(doubt * settings.observation.elsewhere, settings.declaration.doubt_floor)
    return judge(replace(belief, doubt=left), wider, settings.declaration)


def _phone_m(sighting: Sighting) -> FloatArray:
    """Where the phone is now by each pose of a scan (P, 2)."""
    found = sighting.found
    return found.position_m + rotate_each(sighting.moved_m, found.drift_rad)


def _times_even(particles: Particles, position_m: FloatArray, raster: PlanRaster) -> FloatArray:
    """How much denser a belief lies at places (P, 2) than if it were even in the building."""
    from scipy import ndimage

    left, right, bottom, top = raster.grid.extent_m()
    grid = Grid.covering((left, bottom), (right, top), DENSITY_M)
    share = np.zeros(grid.shape)
    on = grid.contains(particles.position_m)
    np.add.at(share, tuple(grid.cell_of(particles.position_m[on]).T), particles.weight[on])
    share = ndimage.gaussian_filter(share, 1.0, mode="constant", truncate=3.0)
    cells = (raster.grid.cell_size_m / DENSITY_M) ** 2 * float(raster.inside.sum())
    times = np.zeros(len(position_m))
    on = grid.contains(position_m)
    times[on] = share[tuple(grid.cell_of(position_m[on]).T)] * cells
    return times
