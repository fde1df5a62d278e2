"""Found again: other places taken into a belief, by what a scan says or because it is lost."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from palms.belief import Belief, Stage
from palms.building import Atlas
from palms.declaration import doubted, judge
from palms.geometry import FloatArray, rotate_each
from palms.grid import Grid
from palms.hints import Hint, heard
from palms.observation import log_likelihood
from palms.particles import Particles, reweight, with_scales
from palms.population import adapted, anywhere, mixed, pushed, start_posterior
from palms.posterior import Posterior
from palms.randomness import RandomKey
from palms.raster import PlanRaster
from palms.settings import Settings

__all__ = ["Conditions", "Sighting", "look_again", "look_elsewhere", "take_hint"]

LARGEST_NATS = 300.0  # ours: a scan says no more than this; larger numbers overflow
PLACE_M = 0.4  # ours: places whose drift is unknown are told apart so finely
N_TURNS = 64  # ours: so many of the belief's drifts stand for all
TURN_RAD = 0.1  # ours: spread around each


class Conditions(NamedTuple):
    """What does not change while a phone is followed.

    Attributes
    ----------
    raster : PlanRaster
    settings : Settings
        For the phone's kind of odometry.
    own_frame : bool
        Whether the odometry's frame is not the scan's.
    atlas : Atlas or None
        Of a building of several levels.
    """

    raster: PlanRaster
    settings: Settings
    own_frame: bool
    atlas: Atlas | None = None


class Sighting(NamedTuple):
    """What the latest scan said, and how far the phone has moved since.

    Attributes
    ----------
    found : Posterior
    moved_m : (2,)
        From the scan's observation point, odom frame.
    """

    found: Posterior
    moved_m: FloatArray


def look_elsewhere(
    belief: Belief, sighting: Sighting | None, conditions: Conditions, key: RandomKey
) -> Belief:
    """Take other places into a belief that is lost.

    Half of them are the latest scan's poses, carried along by the odometry since; the
    others lie anywhere, with the drifts of the belief.

    Parameters
    ----------
    belief : Belief
    sighting : Sighting or None
        None when there was no scan.
    conditions : Conditions
    key : RandomKey
    """
    declaration, particles = conditions.settings.declaration, belief.particles
    wider = mixed(
        particles, _others(particles, sighting, conditions, key), declaration.search_share
    )
    unsure = replace(belief, doubt=declaration.doubt_after_search)
    return replace(judge(unsure, wider, declaration), stage=Stage.LOST)


def _others(
    particles: Particles, sighting: Sighting | None, conditions: Conditions, key: RandomKey
) -> Particles:
    """Other places: anywhere with the drifts that are known, and what the latest scan said."""
    raster, settings, own_frame, _ = conditions
    n = max(1, settings.start.n_particles // 2)
    turns = particles.drift_rad[:: max(1, len(particles) // N_TURNS)]
    others = anywhere(raster, n, turns, TURN_RAD, key.child(0))
    if sighting is not None and not own_frame:
        seen = pushed(sighting.found, n, sighting.moved_m, key.child(1))
        others = mixed(others, seen, 0.5)
    return with_scales(others, settings.motion, key.child(2))


def take_hint(
    belief: Belief, hint: Hint, sighting: Sighting | None, conditions: Conditions, key: RandomKey
) -> Belief:
    """Weigh a belief by a hint; what the hint speaks against it goes to places that it allows.

    Parameters
    ----------
    belief : Belief
    hint : Hint
    sighting : Sighting or None
    conditions : Conditions
    key : RandomKey
    """
    raster, settings, n = conditions.raster, conditions.settings, len(belief.particles)
    others = _others(belief.particles, sighting, conditions, key)
    if hint.level is not None and conditions.atlas is not None:
        others = mixed(others, _moved(belief.particles, hint.level, conditions.atlas), 0.5)
    places = np.concatenate([belief.particles.position_m, others.position_m])
    of_belief, of_others = hint.says(places, raster, conditions.atlas).split(n)
    particles, kept = heard(belief.particles, of_belief)
    others, _ = heard(others, of_others)
    doubt = doubted(belief.doubt, kept, settings.declaration)
    left = max(doubt * (1 - hint.probability), settings.declaration.doubt_floor)
    wider = adapted(
        mixed(particles, others, doubt), raster, settings.resampling,
        settings.start.n_particles, key,
    )  # fmt: skip
    return judge(replace(belief, doubt=left), wider, settings.declaration)


def _moved(particles: Particles, level: str, atlas: Atlas) -> Particles:
    """Move particles to a level; no stairs are asked for, since no plan shows all of them."""
    index = atlas.building.index(level)
    return replace(particles, position_m=atlas.on_level(particles.position_m, index))


def look_again(
    belief: Belief, sighting: Sighting, conditions: Conditions, key: RandomKey
) -> Belief:
    """Weigh a belief by one more scan, and take in the places that the scan knows of.

    The scan speaks for a particle by its likelihood there against that anywhere; with the
    probability `elsewhere` it says nothing. What it speaks against the belief as a whole is
    doubt, and gives that share of the belief to the scan's own places.

    Parameters
    ----------
    belief : Belief
    sighting : Sighting
        What the scan says, and the way from its observation point to the phone.
    conditions : Conditions
    key : RandomKey
    """
    raster, settings, own_frame, _ = conditions
    observation, declaration = settings.observation, settings.declaration
    particles, kept = reweight(belief.particles, _ratio(belief.particles, sighting, conditions))
    doubt = doubted(belief.doubt, kept, declaration)
    others = start_posterior(sighting.found, raster, settings, key, own_frame)
    others = with_scales(carried(others, sighting.moved_m), settings.motion, key)
    wider = adapted(
        mixed(particles, others, doubt), raster, settings.resampling,
        settings.start.n_particles, key,
    )  # fmt: skip
    left = max(doubt * observation.elsewhere, declaration.doubt_floor)
    return judge(replace(belief, doubt=left), wider, declaration)


def carried(particles: Particles, by_odom_m: FloatArray) -> Particles:
    """Carry particles along by a displacement (2,) in the odom frame.

    Examples
    --------
    >>> one = Particles([[0, 0]], [np.pi / 2], [1], [0], [1])
    >>> carried(one, np.array([2.0, 0.0])).position_m.round(6).tolist()
    [[0.0, 2.0]]
    """
    if not by_odom_m.any():
        return particles
    offset = rotate_each(by_odom_m, particles.drift_rad)
    return replace(particles, position_m=particles.position_m + offset)


def _ratio(particles: Particles, sighting: Sighting, conditions: Conditions) -> FloatArray:
    """Likelihood of a scan at each particle against that anywhere (N,)."""
    observation, found = conditions.settings.observation, sighting.found
    at_scan = particles.position_m - rotate_each(sighting.moved_m, particles.drift_rad)
    if conditions.own_frame:
        nats = _log_ratio_of_places(at_scan, found, conditions.raster)
    else:
        nats = log_likelihood(
            found.points, conditions.raster, at_scan, particles.drift_rad, observation
        )  # fmt: skip
        nats = observation.strength * nats - found.log_mean
    ratio: FloatArray = np.exp(np.minimum(nats, LARGEST_NATS))
    return (1 - observation.elsewhere) * ratio + observation.elsewhere


def _log_ratio_of_places(
    position_m: FloatArray, found: Posterior, raster: PlanRaster
) -> FloatArray:
    """Log ratio of a scan's share of each place, whatever its drift, to an even share."""
    left, right, bottom, top = raster.grid.extent_m()
    grid = Grid.covering((left, bottom), (right, top), PLACE_M)
    share = np.zeros(grid.shape)
    on = grid.contains(found.position_m)
    np.add.at(share, tuple(grid.cell_of(found.position_m[on]).T), np.exp(found.log_weight[on]))
    even = (raster.grid.cell_size_m / grid.cell_size_m) ** 2 * raster.inside.sum()
    on = grid.contains(position_m)
    ratio = np.full(len(position_m), np.exp(-LARGEST_NATS))
    cell = grid.cell_of(position_m[on])
    ratio[on] = np.maximum(share[tuple(cell.T)] * even, ratio[on])
    return np.asarray(np.log(ratio))
