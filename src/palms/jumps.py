"""Jumps of the odometry: a move that nobody makes is none of the phone's.

Tracking that loses its features and finds them again puts the phone elsewhere in one move, and
perhaps turns its frame a little. The phone has not gone there (docs/explanation/restart.md).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from palms._compiled import filter as loops
from palms.belief import Belief
from palms.declaration import judge
from palms.geometry import rotate_each
from palms.odometry import Move, Odometry
from palms.particles import MoveInfo, Particles, resample_systematic
from palms.population import mixed, shifted_m
from palms.randomness import RandomKey
from palms.recovery import Conditions
from palms.restart import spread_m
from palms.settings import JumpSettings

__all__ = ["Pace", "jumped", "jumps_of"]

_DRAW, _WALK, _TURN = range(3)  # purposes of random numbers


class Pace(NamedTuple):
    """How far the odometry is ahead of anybody who moves as fast as people can.

    Attributes
    ----------
    ahead_m : float
        Minus infinity before the first move: nobody knows when that one began.
    jumps : bool
        Whether the latest move was too fast.
    velocity_m_s : (float, float)
        Of the latest move that people make, odom frame.

    Examples
    --------
    >>> settings, pace = JumpSettings(speed_m_s=4.0, slack_m=1.0), Pace()
    >>> [(pace := pace.after(Move(t, dx, 0.0, None, 0.5), settings)).jumps
    ...  for t, dx in ((0.5, 0.7), (1.0, 20.0), (1.5, 0.7))]
    [False, True, False]

    A jump in slices is one, too.

    >>> pace = Pace(0.0)
    >>> sum((pace := pace.after(Move(k / 60, 0.3, 0.0, None, 1 / 60), settings)).jumps
    ...     for k in range(60))
    56
    """

    ahead_m: float = -math.inf
    jumps: bool = False
    velocity_m_s: tuple[float, float] = (0.0, 0.0)

    def after(self, move: Move, settings: JumpSettings) -> Pace:
        """Return the pace after a move, whose duration is known."""
        seconds = move.duration_s or 0.0
        beyond_m = move.length_m - settings.speed_m_s * seconds
        ahead_m = max(self.ahead_m + beyond_m, 0.0)
        velocity = self.velocity_m_s
        if seconds > 0 and beyond_m <= 0:
            velocity = (move.dx_m / seconds, move.dy_m / seconds)
        return Pace(min(ahead_m, settings.slack_m), ahead_m > settings.slack_m, velocity)


def jumps_of(odometry: Odometry, settings: JumpSettings) -> list[Move]:
    """Return the moves of a walk that are none of the phone's.

    Examples
    --------
    >>> walk = Odometry([0.5, 1.0, 1.5], [[0.6, 0.0], [20.6, 0.0], [21.2, 0.0]])
    >>> [move.time_s for move in jumps_of(walk, JumpSettings())]
    [1.0]
    """
    found, pace, time_s = [], Pace(), 0.0
    for move in odometry.moves():
        pace = pace.after(move._replace(duration_s=move.time_s - time_s), settings)
        time_s = move.time_s
        if pace.jumps:
            found.append(move)
    return found


def jumped(
    belief: Belief,
    gone: tuple[Particles, MoveInfo],
    duration_s: float,
    pace: Pace,
    conditions: Conditions,
    key: RandomKey,
) -> Belief:
    """Return a belief after a jump: most of it walks on as before, whatever the odometry says.

    Parameters
    ----------
    belief : Belief
        Before the jump.
    gone : Particles, MoveInfo
        Those that moved as the odometry says, and what the walls say about that.
    duration_s : float
        Of the jump.
    pace : Pace
        Before the jump; when that was one already, this is a slice of it.
    conditions : Conditions
    key : RandomKey
    """
    settings, (moved, info) = conditions.settings, gone
    n = settings.start.n_particles
    index = resample_systematic(belief.particles.weight, n, key.child(_DRAW))
    kept = belief.particles.take(index, np.full(n, 1 / n))
    kept = _walked_on(kept, duration_s, pace.velocity_m_s, conditions, key)
    if not pace.jumps:  # once, not in each slice
        kept = _turned(kept, settings.jump, key)
        real = settings.jump.real_share * math.exp(min(info.evidence, 0.0))
        kept = mixed(kept, moved, real / (1 - settings.jump.real_share + real))
    doubt = max(belief.doubt, settings.declaration.doubt_at_start)
    return judge(replace(belief, doubt=doubt), kept, settings.declaration)


def _walked_on(
    particles: Particles,
    duration_s: float,
    velocity_m_s: tuple[float, float],
    conditions: Conditions,
    key: RandomKey,
) -> Particles:
    """Let particles walk on, at first straight on, none through a wall.

    Given where somebody walks now, the place after a while is as likely as any walker's
    (`spread_m`) to whom so much of the way is known.
    """
    walk = conditions.settings.restart
    known = math.exp(-duration_s / walk.leg_s)
    z = np.empty((len(particles), 2))
    loops.normals(key.child(_WALK).word, 2, z)
    ahead = known * duration_s * rotate_each(np.array(velocity_m_s), particles.drift_rad)
    spread = spread_m(duration_s, walk) * math.sqrt(1 - known * known)
    there = shifted_m(particles, ahead + spread * z, conditions.raster)
    return replace(particles, position_m=there)


def _turned(particles: Particles, settings: JumpSettings, key: RandomKey) -> Particles:
    """Turn the frame of some of the particles."""
    n = len(particles)
    z, u = np.empty((n, 1)), np.empty((n, 1))
    loops.normals(key.child(_TURN, 0).word, 1, z)
    loops.uniforms(key.child(_TURN, 1).word, 1, u)
    turns = np.where(u < settings.turned_share, settings.turn_rad * z, 0.0)
    return replace(particles, drift_rad=particles.drift_rad + turns[:, 0])
