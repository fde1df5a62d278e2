"""Localizer for a live stream, track() for a recording: the method from end to end."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from palms.belief import Belief, Estimate, Stage, settle, summarize
from palms.declaration import evidence_of, judge
from palms.errors import InputError
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray
from palms.heatmap import Candidates, find_candidates, match, scan_drifts
from palms.hints import Hint
from palms.observation import scan_points, search
from palms.odometry import Move, Odometry
from palms.orientation import candidate_drifts, principal_orientation, smallest_alignment
from palms.particles import (
    MoveInfo,
    Particles,
    advance,
    reweight,
    start_everywhere,
    start_from,
    with_scales,
)
from palms.population import adapted, start_posterior
from palms.randomness import RandomKey, as_key
from palms.raster import PlanRaster, rasterize
from palms.recovery import Conditions, Sighting, carried, look_again, look_elsewhere, take_hint
from palms.scan import Scan
from palms.settings import Settings

__all__ = ["Localizer", "Track", "Watcher", "locate", "track", "track_trials"]

Watcher = Callable[[Estimate, Belief, MoveInfo], None]
_START = 0  # key of the start; step i has key i + 1
_SEARCH, _SCAN, _ADAPT, _HINT = 21, 22, 23, 24  # purposes of random numbers


@dataclass(frozen=True)
class Track:
    """The answers along a recorded walk.

    Parameters
    ----------
    seed : int or None
        The seed, where a seed was given.
    estimates : tuple of Estimate
        One for each sample of the odometry.

    Examples
    --------
    >>> Track(0, (Estimate(0.5), Estimate(1.0))).localized_at_s is None
    True
    """

    seed: int | None
    estimates: tuple[Estimate, ...]

    def __len__(self) -> int:
        return len(self.estimates)

    def __iter__(self) -> Iterator[Estimate]:
        return iter(self.estimates)

    @property
    def oriented_at_s(self) -> float | None:
        """t1: when it was first oriented, or localized; None when never."""
        return self._first(Stage.ORIENTED, Stage.LOCALIZED)

    @property
    def localized_at_s(self) -> float | None:
        """t2: when it was first localized; None when never."""
        return self._first(Stage.LOCALIZED)

    @property
    def position_m(self) -> FloatArray:
        """Answers (T, 2); NaN where there was none."""
        none = np.full(2, np.nan)
        return np.array([none if e.position_m is None else e.position_m for e in self.estimates])

    def _first(self, *stages: Stage) -> float | None:
        return next((e.time_s for e in self.estimates if e.stage in stages), None)


def locate(
    plan: FloorPlan | PlanRaster, scan: Scan, settings: Settings | None = None
) -> Candidates:
    """Return where one scan alone may have been taken (paper III-A to III-C, or ours).

    Parameters
    ----------
    plan : FloorPlan or PlanRaster
        A raster is reused, with its cached transform.
    scan : Scan
    settings : Settings, optional
    """
    settings = settings or Settings()
    raster = _raster(plan, settings)
    if settings.start.source == "posterior":
        return search(scan, raster, settings.observation)
    drifts_rad = scan_drifts(scan, raster, settings)
    return find_candidates(match(scan, raster, drifts_rad, settings.template), settings.candidates)


def track(
    plan: FloorPlan | PlanRaster,
    scan: Scan | None,
    odometry: Odometry,
    settings: Settings | None = None,
    rng: int | np.random.Generator | RandomKey = 0,
    watch: Watcher | None = None,
) -> Track:
    """Follow a recorded walk through a plan (paper III).

    Parameters
    ----------
    plan : FloorPlan or PlanRaster
    scan : Scan or None
        Taken where the walk begins. None for the methods that start everywhere.
    odometry : Odometry
    settings : Settings, optional
        `Settings()` when left out.
    rng : int, Generator or RandomKey
        Same seed, same answer.
    watch : callable, optional
        Receives (estimate, belief, info) after each move.

    Returns
    -------
    Track
        One estimate for each sample of the odometry.
    """
    settings = settings or Settings()
    raster = _raster(plan, settings)
    localizer = Localizer(raster, settings, rng, odometry.frame == "own", watch, odometry.source)
    if scan is not None and settings.start.by_scan:
        localizer.observe(scan, odometry.start_m)
    estimates = tuple(localizer.move(move) for move in odometry.moves())
    return Track(int(rng) if isinstance(rng, (int, np.integer)) else None, estimates)


def track_trials(
    plan: FloorPlan | PlanRaster,
    scan: Scan | None,
    odometry: Odometry,
    settings: Settings,
    seeds: Sequence[int],
    jobs: int = 1,
) -> Iterator[Track]:
    """Yield one track for each seed, in order; heatmaps are made once.

    Parameters
    ----------
    plan, scan, odometry, settings
        As for `track`.
    seeds : sequence of int
    jobs : int
        Threads; the tracks do not depend on it.
    """
    raster = _raster(plan, settings)
    needs_scan = scan is not None and settings.start.by_scan
    candidates = locate(raster, scan, settings) if scan is not None and needs_scan else None

    def follow(seed: int) -> Track:
        own = odometry.frame == "own"
        localizer = Localizer(raster, settings, seed, own, source=odometry.source)
        if candidates is not None and scan is not None:
            localizer.start(candidates, scan, odometry.start_m)
        return Track(seed, tuple(localizer.move(move) for move in odometry.moves()))

    if jobs == 1:
        yield from map(follow, seeds)
        return
    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(follow, seeds)


class Localizer:
    """Finds a phone in a plan while it walks: `observe` a scan, then `move` by `move`.

    Parameters
    ----------
    plan : FloorPlan or PlanRaster
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
        What it rests on; None before there is any.

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
        plan: FloorPlan | PlanRaster,
        settings: Settings | None = None,
        rng: int | np.random.Generator | RandomKey = 0,
        own_frame: bool = False,
        watch: Watcher | None = None,
        source: Literal["vio", "inertial"] = "vio",
    ) -> None:
        self.settings = settings or Settings()
        self.raster = _raster(plan, self.settings)
        self.estimate = Estimate(0.0)
        self.belief: Belief | None = None
        self._key = as_key(rng)
        self._watch = watch
        self._step = 0
        self._heading: float | None = None
        self._waiting: list[Move] = []
        motion = self.settings.motion_for(source)
        self._conditions = Conditions(self.raster, self.settings, motion, own_frame)
        self._sighting: Sighting | None = None
        self._hints: list[Hint] = []
        self._since_search_m = math.inf
        if self.settings.start.source == "uniform":
            self._begin(start_everywhere(self.raster, self._n, self._key.child(_START)))

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

    def start(self, candidates: Candidates, scan: Scan, at_m: FloatArray | None = None) -> Estimate:
        """Take a scan whose candidates were found before; see `observe`."""
        moved_m = np.zeros(2) if at_m is None else np.asarray(at_m, np.float64) - scan.position_m
        if not self._ours:
            key = self._key.child(_START)
            return self._begin(
                carried(start_from(candidates, self._n, key, self._conditions.own_frame), moved_m)
            )
        self._sighting = Sighting(candidates, moved_m)
        points = scan_points(scan, self.settings.observation)
        if self.belief is None:
            particles = start_posterior(
                candidates, points, self.raster, self.settings, self._key.child(_START),
                self._conditions.own_frame,
            )  # fmt: skip
            return self._begin(carried(particles, moved_m))
        self._step += 1
        key = self._key.child(self._step, _SCAN)
        self.belief = look_again(self.belief, self._sighting, points, self._conditions, key)
        self.estimate = self._summary(self.estimate.time_s)
        return self.estimate

    def hint(self, hint: Hint) -> Estimate:
        """Take what somebody says of where the phone is; only ours listens.

        Before there is a belief it waits for the first scan.

        Parameters
        ----------
        hint : Hint
            Such as the entrance that one came in by, or a room sign just read.
        """
        if not self._ours:
            return self.estimate
        if self.belief is None:
            hint.ratio(np.zeros((1, 2)), self.raster)  # one that cannot be used is said at once
            self._hints.append(hint)
            return self.estimate
        self._step += 1
        key = self._key.child(self._step, _HINT)
        self.belief = take_hint(self.belief, hint, self._sighting, self._conditions, key)
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

    @property
    def _ours(self) -> bool:
        return self.settings.declaration.rule == "probability"

    def _begin(self, particles: Particles) -> Estimate:
        particles = with_scales(particles, self._conditions.motion, self._key.child(_START))
        self.belief = Belief(particles)
        if self._ours:
            for hint in self._hints:
                particles, _ = reweight(particles, hint.ratio(particles.position_m, self.raster))
            self._hints.clear()
            declaration = self.settings.declaration
            unsure = replace(self.belief, doubt=declaration.doubt_at_start)
            self.belief = judge(unsure, particles, declaration)
        self.estimate = self._summary(self.estimate.time_s)
        return self.estimate

    def _summary(self, time_s: float) -> Estimate:
        assert self.belief is not None
        return summarize(self.belief, time_s, self._heading, self.settings.answer)

    def _take(self, move: Move) -> Estimate:
        self._step += 1
        if move.duration_s is None:
            move = move._replace(duration_s=move.time_s - self.estimate.time_s)
        if move.length_m > self.settings.answer.heading_move_m:
            self._heading = float(np.arctan2(move.dy_m, move.dx_m))
        if self.belief is None:
            self.estimate = Estimate(move.time_s)
            return self.estimate
        key = self._key.child(self._step)
        particles, info = advance(
            self.belief.particles, move, self.raster, self._conditions.motion, key,
            self.settings.resampling,
        )  # fmt: skip
        if self._ours:
            self.belief = self._weigh(particles, move, info, key)
        else:
            self.belief = settle(self.belief, particles, move, self.settings.convergence, key)
        self.estimate = self._summary(move.time_s)
        if self._watch is not None:
            self._watch(self.estimate, self.belief, info)
        return self.estimate

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


def _raster(plan: FloorPlan | PlanRaster, settings: Settings) -> PlanRaster:
    return plan if isinstance(plan, PlanRaster) else rasterize(plan, settings.raster)
