"""The localizer: a scan, then move by move, from end to end."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import numpy as np

from palms.belief import Belief, Estimate, Stage, settle, summarize
from palms.building import Atlas, Building
from palms.declaration import doubted, evidence_of, judge
from palms.errors import InputError
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray
from palms.heatmap import Candidates, find_candidates, match, scan_drifts
from palms.hints import Hint, faded, heard
from palms.jumps import Pace, jumped
from palms.levels import climbed, on_levels
from palms.odometry import Move
from palms.orientation import candidate_drifts, principal_orientation, smallest_alignment
from palms.particles import (
    MoveInfo,
    Particles,
    advance,
    start_everywhere,
    start_from,
    with_scales,
)
from palms.population import adapted, start_posterior
from palms.posterior import Posterior, posterior
from palms.randomness import RandomKey, as_key
from palms.raster import PlanRaster, rasterize
from palms.recovery import Conditions, Sighting, carried, look_again, look_elsewhere, take_hint
from palms.restart import is_turned_anyhow, reframed, taken_up
from palms.scan import Scan
from palms.settings import Settings

__all__ = ["Localizer", "Watcher", "ground", "locate"]

CLEAR_M = 1.0  # ours: so far from stairs nobody stands on them

Watcher = Callable[[Estimate, Belief, MoveInfo], None]
_START = 0  # key of the start; step i has key i + 1
_SEARCH, _SCAN, _ADAPT, _HINT, _CLIMB, _FRAME, _JUMP = range(21, 28)  # purposes of random numbers


def locate(
    plan: FloorPlan | PlanRaster | Building, scan: Scan, settings: Settings | None = None
) -> Candidates | Posterior:
    """Return where one scan alone may have been taken (paper III-A to III-C, or ours).

    Parameters
    ----------
    plan : FloorPlan, PlanRaster or Building
        A raster is reused, with its cached transform. The places of a building of several
        levels are those of its atlas.
    scan : Scan
    settings : Settings, optional
    """
    settings = settings or Settings()
    raster = ground(plan, settings)
    if settings.start.source == "posterior":
        return posterior(scan, raster, settings.observation)
    drifts_rad = scan_drifts(scan, raster, settings)
    return find_candidates(match(scan, raster, drifts_rad, settings.template), settings.candidates)


class Localizer:
    """Finds a phone in a plan while it walks: `observe` a scan, then `move` by `move`.

    Parameters
    ----------
    plan : FloorPlan, PlanRaster or Building
    settings : Settings, optional
    rng : int, Generator or RandomKey
        Same seed and same inputs, same answers as `track`.
    own_frame : bool
        Whether the odometry's frame is not the scan's.
    watch : callable, optional
        Receives (estimate, belief, info) after each move.
    source : {"vio", "inertial"}
        What makes the odometry.

    Attributes
    ----------
    estimate : Estimate
        The latest answer.
    belief : Belief or None
        What it rests on; None before there is any. In a building of several levels its places
        are those of the building's atlas.
    atlas : Atlas or None
        None where there is one level.

    Examples
    --------
    >>> room = [[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]]
    >>> localizer = Localizer(FloorPlan(room), rng=1)
    >>> localizer.move(Move(0.5, 0.3, 0.0)).position_m is None  # no scan yet
    True
    >>> estimate = localizer.observe(Scan(np.array(room) - (2.0, 1.0)))
    >>> estimate.is_localized, estimate.position_m is None
    (False, False)
    """

    def __init__(
        self,
        plan: FloorPlan | PlanRaster | Building,
        settings: Settings | None = None,
        rng: int | np.random.Generator | RandomKey = 0,
        own_frame: bool = False,
        watch: Watcher | None = None,
        source: Literal["vio", "inertial"] = "vio",
    ) -> None:
        self.settings = (settings or Settings()).for_odometry(source)
        self.raster = ground(plan, self.settings)
        self.atlas = plan.atlas if isinstance(plan, Building) and len(plan.levels) > 1 else None
        self.estimate = Estimate(0.0)
        self.belief: Belief | None = None
        self._key = as_key(rng)
        self._watch = watch
        self._step = 0
        self._heading: float | None = None
        self._waiting: list[Move] = []
        self._conditions = Conditions(self.raster, self.settings, own_frame, self.atlas)
        self._sighting: Sighting | None = None
        self._hints: list[Hint] = []
        self._arrived = False  # on a level that was told, and not off its stairs since
        self._new_frame: float | None = None  # since it, no scan; its nats of doubt for places
        self._since_search_m = math.inf
        self._pace = Pace()
        self._begin_anywhere()

    def observe(self, scan: Scan, at_m: FloatArray | None = None) -> Estimate:
        """Take a scan: the first one starts the search; ours takes any number of them.

        Parameters
        ----------
        scan : Scan
        at_m : array_like (2,), optional
            Where the phone is now, in the odom frame; the scan's position when left out.
        """
        if not self.settings.start.by_scan:
            return self.estimate
        return self.start(locate(self.raster, scan, self.settings), scan, at_m)

    def start(
        self, found: Candidates | Posterior, scan: Scan, at_m: FloatArray | None = None
    ) -> Estimate:
        """Take a scan that `locate` was asked about before; see `observe`."""
        moved_m = np.zeros(2) if at_m is None else np.asarray(at_m, np.float64) - scan.position_m
        if isinstance(found, Candidates):
            key = self._key.child(_START)
            return self._begin(
                carried(start_from(found, self._n, key, self._conditions.own_frame), moved_m)
            )
        self._sighting = Sighting(found, moved_m)
        if self.belief is None:
            particles = start_posterior(
                found, self.raster, self.settings, self._key.child(_START),
                self._conditions.own_frame,
            )  # fmt: skip
            return self._begin(carried(particles, moved_m))
        self._step += 1
        key = self._key.child(self._step, _SCAN)
        self.belief = self._look(self.belief, self._sighting, key)
        self.estimate = self._summary(self.estimate.time_s)
        return self.estimate

    def _look(self, belief: Belief, sighting: Sighting, key: RandomKey) -> Belief:
        """Weigh the belief by a scan; the first one of a new frame finds the drift, too."""
        conditions, nats = self._conditions, self._new_frame
        self._new_frame = None
        turned = nats is not None and is_turned_anyhow(belief.particles, conditions)
        if not turned or nats is None or conditions.own_frame:
            return look_again(belief, sighting, conditions, key)
        doubt = doubted(belief.doubt, nats, self.settings.declaration)
        return taken_up(replace(belief, doubt=doubt), sighting, conditions, key)

    def hint(self, hint: Hint) -> Estimate:
        """Take what somebody says of where the phone is; only ours listens.

        Before there is a belief it waits for the first scan.

        Parameters
        ----------
        hint : Hint
            Such as the entrance that one came in by, or a room sign just read.
        """
        if not self.settings.is_ours:
            return self.estimate
        if self.belief is None:
            nowhere = np.zeros((1, 2))
            hint.ratio(nowhere, self.raster, self.atlas)  # one that cannot be used is said at once
            self._hints.append(hint)
            return self.estimate
        self._step += 1
        self._arrived = self._arrived or hint.level is not None
        key = self._key.child(self._step, _HINT)
        self.belief = take_hint(self.belief, hint, self._sighting, self._conditions, key)
        self.estimate = self._summary(self.estimate.time_s)
        return self.estimate

    def restart(self, away_s: float = 0.0) -> Estimate:
        """Go on in a new frame, as when the phone's session was lost and another one begun.

        Ours keeps where it was, spread by what may have been walked meanwhile; the drift is
        anything, until a scan or the walk tells. Other methods begin anew.

        Parameters
        ----------
        away_s : float
            How long nothing was known of the phone's moves.
        """
        if not away_s >= 0:
            raise InputError("time away", expected="0 s or more", got=f"{away_s:g} s")
        self._heading, self._sighting, self._new_frame = None, None, 0.0
        self._pace = Pace()
        self._step += 1
        if self.belief is None or not self.settings.is_ours:
            self.belief, self.estimate = None, Estimate(self.estimate.time_s)
            self._waiting.clear()
            self._begin_anywhere()
            return self.estimate
        key = self._key.child(self._step, _FRAME)
        self.belief, self._new_frame = reframed(self.belief, away_s, self._conditions, key)
        self.estimate = self._summary(self.estimate.time_s)
        return self.estimate

    def move(self, move: Move) -> Estimate:
        """Take one move of the odometry and return where that leads."""
        if move.time_s < self.estimate.time_s:
            raise InputError(
                "move", expected=f"a time from {self.estimate.time_s:g} s on",
                got=f"{move.time_s:g} s", fix="send the moves in order",
            )  # fmt: skip
        if self.settings.start.source == "uniform-ori" and self.belief is None:
            return self._wait(move)
        return self._take(move)

    @property
    def _n(self) -> int:
        return self.settings.start.n_particles

    def _begin_anywhere(self) -> None:
        if self.settings.start.source == "uniform":
            self._begin(start_everywhere(self.raster, self._n, self._key.child(_START)))

    def _begin(self, particles: Particles) -> Estimate:
        particles = with_scales(particles, self.settings.motion, self._key.child(_START))
        self.belief = Belief(particles)
        if self.settings.is_ours:
            for hint in self._hints:
                said = hint.says(particles.position_m, self.raster, self.atlas)
                particles, _ = heard(particles, said)
            self._hints.clear()
            declaration = self.settings.declaration
            unsure = replace(self.belief, doubt=declaration.doubt_at_start)
            self.belief = judge(unsure, particles, declaration)
        self.estimate = self._summary(self.estimate.time_s)
        return self.estimate

    def _summary(self, time_s: float) -> Estimate:
        assert self.belief is not None
        estimate = summarize(self.belief, time_s, self._heading, self.settings.answer)
        return estimate if self.atlas is None else on_levels(estimate, self.belief, self.atlas)

    def _take(self, move: Move) -> Estimate:
        self._step += 1
        if move.duration_s is None:
            move = move._replace(duration_s=move.time_s - self.estimate.time_s)
        before, self._pace = self._pace, self._pace.after(move, self.settings.jump)
        jumps = self.settings.is_ours and self._pace.jumps
        if not jumps and move.length_m > self.settings.answer.heading_move_m:
            self._heading = float(np.arctan2(move.dy_m, move.dx_m))
        if self.belief is None:
            self.estimate = Estimate(move.time_s)
            return self.estimate
        key = self._key.child(self._step)
        particles, info = advance(
            faded(self.belief.particles, move.length_m, self.settings.hint), move, self.raster,
            self.settings.motion, key, self.settings.resampling,
        )  # fmt: skip
        if jumps:
            self.belief = jumped(
                self.belief, (particles, info), move.duration_s or 0.0, before,
                self._conditions, key.child(_JUMP),
            )  # fmt: skip
        elif self.settings.is_ours:
            if self.atlas is not None:
                particles = self._climbed(particles, move, self.atlas, key.child(_CLIMB))
            self.belief = self._weigh(particles, move, info, key)
        else:
            self.belief = settle(self.belief, particles, move, self.settings.convergence, key)
        self.estimate = self._summary(move.time_s)
        if self._watch is not None:
            self._watch(self.estimate, self.belief, info)
        return self.estimate

    def _climbed(self, particles: Particles, move: Move, atlas: Atlas, key: RandomKey) -> Particles:
        """Let particles climb; not while somebody who was told the level leaves the stairs."""
        assert self.belief is not None
        levels = self.settings.levels
        if self._arrived:
            here = self.belief.answer_m[None]
            self._arrived = bool(atlas.on_stairs(here, levels.reach_m + CLEAR_M)[0])
            return particles
        return climbed(particles, atlas, move.duration_s, levels, key)

    def _weigh(self, particles: Particles, move: Move, info: MoveInfo, key: RandomKey) -> Belief:
        """Ours: draw anew where it helps, judge, and look elsewhere when lost."""
        assert self.belief is not None
        resampling, declaration = self.settings.resampling, self.settings.declaration
        due = self._step % resampling.check_moves == 0
        particles = adapted(particles, self.raster, resampling, self._n, key.child(_ADAPT), due)
        if self._sighting is not None:
            moved_m = self._sighting.moved_m + (move.dx_m, move.dy_m)
            self._sighting = self._sighting._replace(moved_m=moved_m)
        self._since_search_m += move.length_m
        nats = evidence_of(move.length_m, info, declaration)
        belief = judge(self.belief, particles, declaration, nats)
        if belief.stage is not Stage.LOST or self._since_search_m < declaration.search_every_m:
            return belief
        self._since_search_m = 0.0
        return look_elsewhere(belief, self._sighting, self._conditions, key.child(_SEARCH))

    def _wait(self, move: Move) -> Estimate:
        """Uniform + Ori: theta needs the first few moves (paper IV-B); then replay them."""
        self._waiting.append(move)
        self.estimate = Estimate(move.time_s)
        if len(self._waiting) < self.settings.start.orientation_moves:
            return self.estimate
        steps = np.array([[[0.0, 0.0], [m.dx_m, m.dy_m]] for m in self._waiting])
        theta = smallest_alignment(
            principal_orientation(steps), principal_orientation(self.raster.plan.segments_m)
        )
        self.estimate = replace(self.estimate, time_s=0.0)
        self._begin(
            start_everywhere(self.raster, self._n, self._key.child(_START), candidate_drifts(theta))
        )
        for waiting in self._waiting:
            self._take(waiting)
        self._waiting.clear()
        return self.estimate


def ground(plan: FloorPlan | PlanRaster | Building, settings: Settings) -> PlanRaster:
    """Return the cells that a method walks on; those of a building's atlas are made once."""
    if isinstance(plan, PlanRaster):
        return plan
    if isinstance(plan, FloorPlan):
        return rasterize(plan, settings.raster)
    return plan.atlas.raster(settings.raster)
