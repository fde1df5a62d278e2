"""The answers along a recorded walk."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from palms.belief import Estimate, Stage
from palms.building import Building
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray
from palms.heatmap import Candidates
from palms.hints import Hint
from palms.localizer.live import Localizer, Watcher, ground, locate
from palms.odometry import Odometry
from palms.posterior import Posterior
from palms.processes import in_order, in_processes
from palms.randomness import RandomKey
from palms.raster import PlanRaster
from palms.scan import Scan
from palms.settings import Settings

__all__ = ["Happening", "Track", "track", "track_trials"]

SAME_S = 1e-6  # ours: times this near are the same
SHARE = 30_000_000  # ours: moves of particles, about 2 s; for fewer no process is worth its start
MOVE = 2000  # ours: what a move costs besides its particles, in particles


class Happening(NamedTuple):
    """What happens during a walk, beside its moves.

    Attributes
    ----------
    time_s : float
        On the walk's clock; it counts after the move that ends then, and before the first
        move when it is earlier than that.
    what : Scan or Hint
        A scan taken then, in the odom frame, or what somebody says.
    found : Candidates, Posterior or None
        What `locate` makes of the scan, where it was asked before.
    """

    time_s: float
    what: Scan | Hint
    found: Candidates | Posterior | None = None


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


def track(
    plan: FloorPlan | PlanRaster | Building,
    scan: Scan | Sequence[Happening] | None,
    odometry: Odometry,
    settings: Settings | None = None,
    rng: int | np.random.Generator | RandomKey = 0,
    watch: Watcher | None = None,
) -> Track:
    """Follow a recorded walk through a plan (paper III).

    Parameters
    ----------
    plan : FloorPlan, PlanRaster or Building
    scan : Scan, sequence of Happening, or None
        Taken where the walk begins; or all scans and hints with their times, of which only
        our method takes those on the way. None for the methods that start everywhere.
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
    where = plan if isinstance(plan, Building) else ground(plan, settings)
    localizer = _localizer(where, odometry, settings, rng, watch)
    estimates = _followed(localizer, odometry, _located(where, scan, odometry, settings))
    return Track(int(rng) if isinstance(rng, (int, np.integer)) else None, estimates)


def track_trials(
    plan: FloorPlan | PlanRaster | Building,
    scan: Scan | Sequence[Happening] | None,
    odometry: Odometry,
    settings: Settings,
    seeds: Sequence[int],
    jobs: int = 1,
) -> Generator[Track, None, None]:
    """Yield one track for each seed, in order; each scan is searched for once.

    Parameters
    ----------
    plan, scan, odometry, settings
        As for `track`.
    seeds : sequence of int
    jobs : int
        Processes at most; the tracks do not depend on it. Little work is done in this one.

    Raises
    ------
    PalmsError
        When a process died.
    """
    where = plan if isinstance(plan, Building) else ground(plan, settings)
    told = _located(where, scan, odometry, settings)
    work = len(seeds) * len(odometry) * (settings.start.n_particles + MOVE)
    jobs = min(jobs, work // SHARE)
    if jobs < 2:
        yield from (_follow(where, odometry, settings, told, seed) for seed in seeds)
        return
    yield _follow(where, odometry, settings, told, seeds[0])  # compiles loops once, for all
    run = partial(_numbered, where, odometry, settings, told)
    with closing(in_processes(run, enumerate(seeds[1:]), jobs, "run it again")) as arriving:
        yield from in_order(arriving)


def _numbered(
    where: PlanRaster | Building, odometry: Odometry, settings: Settings, told: Sequence[_Told],
    number: int, seed: int,
) -> tuple[int, Track]:  # fmt: skip
    return number, _follow(where, odometry, settings, told, seed)


def _follow(
    where: PlanRaster | Building, odometry: Odometry, settings: Settings, told: Sequence[_Told],
    seed: int,
) -> Track:  # fmt: skip
    localizer = _localizer(where, odometry, settings, seed)
    return Track(seed, _followed(localizer, odometry, told))


class _Told(NamedTuple):
    """A happening, with where its scan may have been taken."""

    time_s: float
    what: Scan | Hint
    found: Candidates | Posterior | None


def _localizer(
    where: PlanRaster | Building, odometry: Odometry, settings: Settings,
    rng: int | np.random.Generator | RandomKey, watch: Watcher | None = None,
) -> Localizer:  # fmt: skip
    own = odometry.frame == "own"
    return Localizer(where, settings, rng, own, watch, odometry.source)


def _located(
    where: PlanRaster | Building,
    scan: Scan | Sequence[Happening] | None,
    odometry: Odometry,
    settings: Settings,
) -> tuple[_Told, ...]:
    """Return what a method listens to, in order of time, each scan searched for."""
    start_s = float(odometry.time_s[0]) - SAME_S
    if scan is None or isinstance(scan, Scan):
        scan = [] if scan is None else [Happening(-np.inf, scan)]
    told: list[_Told] = []
    for time_s, what, found in sorted(scan, key=lambda each: each.time_s):
        if isinstance(what, Scan) and settings.start.by_scan and (settings.is_ours or not told):
            told.append(_Told(time_s, what, found or locate(where, what, settings)))
        elif isinstance(what, Hint) and settings.is_ours:
            told.append(_Told(time_s, what, None))
    return tuple(each for each in told if settings.is_ours or each.time_s < start_s)


def _followed(
    localizer: Localizer, odometry: Odometry, told: Sequence[_Told]
) -> tuple[Estimate, ...]:
    """Move by move, and what happens before the first and after each."""
    waiting, estimates = list(told), []

    def listen(until_s: float, at_m: FloatArray) -> None:
        while waiting and waiting[0].time_s <= until_s:
            _, what, found = waiting.pop(0)
            if isinstance(what, Hint):
                localizer.hint(what)
            else:
                assert found is not None
                localizer.start(found, what, at_m)

    listen(float(odometry.time_s[0]) - SAME_S, odometry.start_m)
    for move, at_m in zip(odometry.moves(), odometry.position_m, strict=True):
        localizer.move(move)
        listen(move.time_s + SAME_S, at_m)
        estimates.append(localizer.estimate)
    return tuple(estimates)
