"""Several levels: particles take the stairs, and answers say their level."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from palms._compiled import filter as loops
from palms.belief import Belief, Estimate
from palms.building import Atlas
from palms.geometry import FloatArray
from palms.particles import Particles
from palms.randomness import RandomKey
from palms.settings import LevelSettings

__all__ = ["climbed", "level_shares", "on_atlas", "on_levels"]


def climbed(
    particles: Particles,
    atlas: Atlas,
    duration_s: float | None,
    settings: LevelSettings,
    key: RandomKey,
) -> Particles:
    """Let some of the particles on stairs go up or down a level.

    Up and down are equally likely; on the lowest and the highest level there is one way.

    Parameters
    ----------
    particles : Particles
    atlas : Atlas
    duration_s : float or None
        Of the move; nobody climbs in no time.
    settings : LevelSettings
    key : RandomKey
    """
    if not duration_s:
        return particles
    there = np.flatnonzero(atlas.on_stairs(particles.position_m, settings.reach_m))
    if not len(there):
        return particles
    chance = np.empty((len(there), 2))
    loops.uniforms(key.word, 2, chance)
    goes = chance[:, 0] < 1 - np.exp(-settings.climb_per_s * duration_s)
    there = there[goes]
    level = atlas.level_of(particles.position_m[there])
    way = np.where(chance[goes, 1] < 0.5, -1, 1)
    top = len(atlas.names) - 1
    way = np.where(level == 0, 1, np.where(level == top, -1, way))
    position = particles.position_m.copy()
    position[there] = atlas.on_level(particles.position_m[there], level + way)
    return replace(particles, position_m=position)


def level_shares(particles: Particles, atlas: Atlas) -> FloatArray:
    """Share of the weight on each level (L,)."""
    level = atlas.level_of(particles.position_m)
    return np.asarray(np.bincount(level, particles.weight, len(atlas.names)))


def on_levels(estimate: Estimate, belief: Belief, atlas: Atlas) -> Estimate:
    """Return an answer given on an atlas as one in the map, with its level.

    Parameters
    ----------
    estimate : Estimate
        With places of the atlas.
    belief : Belief
        Behind it.
    atlas : Atlas
    """
    if estimate.position_m is None:
        return estimate
    here = estimate.position_m[None]
    level = int(atlas.level_of(here)[0])
    share = (1 - belief.doubt) * float(level_shares(belief.particles, atlas)[level])
    places = np.array([[h.x_m, h.y_m] for h in estimate.hypotheses]).reshape(-1, 2)
    names = [atlas.names[k] for k in atlas.level_of(places)]
    hypotheses = tuple(
        h._replace(x_m=float(x), y_m=float(y), level=name)
        for h, (x, y), name in zip(estimate.hypotheses, atlas.folded(places), names, strict=True)
    )
    return replace(
        estimate, position_m=atlas.folded(here)[0], level=atlas.names[level],
        p_level=min(share, 1.0), hypotheses=hypotheses,
    )  # fmt: skip


def on_atlas(estimate: Estimate, atlas: Atlas) -> Estimate:
    """Return an answer given in the map as one on an atlas: the other way than `on_levels`.

    An answer that names no level is on the lowest.

    Parameters
    ----------
    estimate : Estimate
    atlas : Atlas
    """
    if estimate.position_m is None:
        return estimate

    def shift_m(level: str | None) -> FloatArray:
        shift: FloatArray = atlas.shift_m[0 if level is None else atlas.names.index(level)]
        return shift

    hypotheses = []
    for each in estimate.hypotheses:
        x, y = shift_m(each.level) + (each.x_m, each.y_m)
        hypotheses.append(each._replace(x_m=float(x), y_m=float(y)))
    place = estimate.position_m + shift_m(estimate.level)
    return replace(estimate, position_m=place, hypotheses=tuple(hypotheses))
