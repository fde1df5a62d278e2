"""Cases: a scan, a walk from there, what the phone made of it, and what happened on the way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from palms.errors import SettingsError
from palms.evaluation.simulation.happenings import give_hint, make_jump, scan_again
from palms.evaluation.simulation.levels import walk_levels
from palms.evaluation.simulation.noise import inertial_odometry, vio_odometry
from palms.evaluation.simulation.nuisances import NuisanceRanges, Nuisances, draw_nuisances
from palms.evaluation.simulation.pace import resampled, with_facing, with_pause, with_stops
from palms.evaluation.simulation.scanner import SimulatedScan
from palms.evaluation.simulation.settings import StartSettings
from palms.evaluation.simulation.sites import Site, random_for
from palms.evaluation.simulation.starts import choose_start
from palms.evaluation.simulation.walker import TrueWalk, plan_route, walk
from palms.geometry import FloatArray
from palms.io import Label, RecordedWalk, Truth
from palms.io.events import Event
from palms.odometry import Odometry
from palms.scan import Scan

__all__ = ["CaseSettings", "SimulatedCase", "Start", "simulate_start", "simulate_walk"]

_SCAN_S = (9.0, 16.0)  # simulation: how long users turn round
_ROOM_VISIT_SHARE = 0.5  # simulation: of the goals, when rooms are visited
_TRIES = 4  # ours: starts from which nobody gets anywhere are given up
_FIRST_SESSION = 1001
_AHEAD = 3  # ours: the sample that tells the first direction, as the data set has it


@dataclass(frozen=True, slots=True)
class CaseSettings:
    """What is asked of simulated cases.

    Parameters
    ----------
    length_m : float
        Of the walks (the mean of the paper's: 147 m).
    rate_hz : float, optional
        Samples a second; one for each step when left out.
    odometry : {"both", "vio", "inertial"}
        What is recorded.
    scan_turn_rad : float
        How far the user turns for a scan.
    second_scan_m, jump_m : float, optional
        After how many metres there is a second scan; a jump of the odometry.
    jump_size_m : float, optional
        How far it jumps, then without a turn; drawn from the nuisances when left out.
    hint : {"room", "place"}, optional
        What somebody says after `hint_m` metres.
    hint_is_right : bool
        Whether it is true.
    hint_m : float
    stops : bool
        Whether walkers stop now and then.
    rooms : bool
        Whether they go into rooms.

    Raises
    ------
    SettingsError
        When a number is out of its range, or a second scan is asked for without VIO.

    Examples
    --------
    >>> CaseSettings(rate_hz=2.0).length_m
    147.0
    """

    length_m: float = 147.0
    rate_hz: float | None = None
    odometry: Literal["both", "vio", "inertial"] = "both"
    scan_turn_rad: float = 2 * math.pi
    second_scan_m: float | None = None
    jump_m: float | None = None
    jump_size_m: float | None = None
    hint: Literal["room", "place"] | None = None
    hint_is_right: bool = True
    hint_m: float = 30.0
    stops: bool = False
    rooms: bool = False

    def __post_init__(self) -> None:
        for name, low, high in (
            ("length_m", 5.0, 10_000.0), ("rate_hz", 0.2, 200.0), ("scan_turn_rad", 0.1, 20.0),
            ("second_scan_m", 1.0, self.length_m), ("jump_m", 1.0, self.length_m),
            ("jump_size_m", 0.0, 1000.0), ("hint_m", 0.0, 10_000.0),
        ):  # fmt: skip
            value = getattr(self, name)
            if value is not None and not low <= value <= high:
                raise SettingsError(
                    f"CaseSettings.{name}", expected=f"{low:g} to {high:g}", got=f"{value:g}"
                )
        if self.second_scan_m is not None and self.odometry == "inertial":
            raise SettingsError(
                "CaseSettings.second_scan_m", expected="vio: it knows where the second scan was",
                got="inertial odometry alone",
            )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Start:
    """Where walks begin: a scan, and the scanner's noise.

    Parameters
    ----------
    index : int
    taken : SimulatedScan
        In the building's own metres.
    nuisances : Nuisances
        Its own, with those of the site.
    """

    index: int
    taken: SimulatedScan
    nuisances: Nuisances


@dataclass(frozen=True, slots=True)
class SimulatedCase:
    """One walk as a phone recorded it, and what really happened.

    Parameters
    ----------
    name : str
    recorded : RecordedWalk
        With its truth, in the map frame.
    scans : tuple of Scan
    labels : tuple of Label
    events : tuple of Event
    nuisances : Nuisances
    facing_rad : (T,)
        Where the phone truly looked, map frame.
    """

    name: str
    recorded: RecordedWalk
    scans: tuple[Scan, ...]
    labels: tuple[Label, ...]
    events: tuple[Event, ...]
    nuisances: Nuisances
    facing_rad: FloatArray


def simulate_start(
    site: Site,
    index: int,
    others: Sequence[Start],
    settings: CaseSettings,
    ranges: NuisanceRanges | None = None,
) -> Start:
    """Choose a start on the first level and scan there.

    Parameters
    ----------
    site : Site
    index : int
        Which start of this site.
    others : sequence of Start
        Those before it; it keeps away from them.
    settings : CaseSettings
    ranges : NuisanceRanges, optional

    Examples
    --------
    >>> from palms.evaluation.simulation import generate_levels, make_site
    >>> site = make_site(generate_levels("office", 7, 1), seed=7)
    >>> start = simulate_start(site, 0, [], CaseSettings())
    >>> len(start.taken.scan.walls_m) >= 4
    True
    """
    drawn = draw_nuisances(random_for("nuisances", site.seed, 1, index), ranges)
    noise = replace(drawn.scanner, turn_rad=settings.scan_turn_rad)
    before = np.array([start.taken.position_m for start in others]).reshape(-1, 2)
    place, rng = site.places[0], random_for("start", site.seed, index)
    taken = choose_start(place, before, noise, StartSettings(), rng)
    return Start(index, taken, _combined(site.nuisances, drawn, "scanner"))


_OF_SCANNER = (
    "normal_sd_m", "angle_sd_rad", "end_sd_m", "merge_gap_m", "missed_share",
    "grazing_missed_share", "spurious_count", "glass_seen_share",
)  # fmt: skip
_OF_WALK = ("vio_", "inertial_", "jump_", "step_m", "speed_m_s")


def _combined(base: Nuisances, drawn: Nuisances, part: str) -> Nuisances:
    """Nuisances of which those of the scanner or of the walk were drawn anew."""
    begins = _OF_SCANNER if part == "scanner" else _OF_WALK
    fresh = {name: v for name, v in drawn.to_json().items() if name.startswith(begins)}
    return replace(base, **fresh)


def simulate_walk(
    site: Site,
    start: Start,
    index: int,
    settings: CaseSettings,
    ranges: NuisanceRanges | None = None,
) -> SimulatedCase:
    """Walk from a start, and record it.

    Parameters
    ----------
    site : Site
    start : Start
    index : int
        Which walk of this start.
    settings : CaseSettings
    ranges : NuisanceRanges, optional

    Returns
    -------
    SimulatedCase
        In the map frame: that of the drawing.

    Examples
    --------
    >>> from palms.evaluation.simulation import generate_levels, make_site
    >>> site = make_site(generate_levels("office", 7, 1), seed=7)
    >>> start = simulate_start(site, 0, [], CaseSettings())
    >>> case = simulate_walk(site, start, 0, CaseSettings(length_m=40.0))
    >>> case.name, round(float(case.recorded.arkit.walked_m[-1]), -1)
    ('start-1-walk-1', 40.0)
    """
    key = (site.seed, start.index, index)
    drawn = draw_nuisances(random_for("nuisances", site.seed, 2, start.index, index), ranges)
    nuisances = _combined(start.nuisances, drawn, "walk")
    rng = random_for("walk", *key)
    truth, begin = _walked(site, start, settings, nuisances, rng)
    truth, again = _with_second_scan(truth, settings, rng)
    if settings.rate_hz is not None:
        truth = resampled(truth, settings.rate_hz, begin)
    truth = _rounded(truth)
    vio, inertial, events = _odometry(
        truth, start, settings, nuisances, random_for("odometry", *key)
    )
    rng = random_for("events", *key)
    session = str(_FIRST_SESSION + start.index)
    scans = [replace(_tidy(start.taken.scan), session=session)]
    labels = [Label(site.stretch.apply(start.taken.position_m), start.taken.drift_rad)]
    if again is not None:
        noise = replace(nuisances.scanner, turn_rad=settings.scan_turn_rad)
        more = scan_again(site, truth, vio, (again, session), noise, rng)
        if more is not None:
            scans.append(_tidy(more.scan))
            labels.append(more.label)
            events.append(more.event)
    events += _level_events(truth)
    if settings.hint is not None:
        events.append(give_hint(site, truth, settings, rng))
    recorded = _recorded(site, truth, start, (vio, inertial), settings)
    return SimulatedCase(
        f"start-{start.index + 1}-walk-{index + 1}", recorded, tuple(scans), tuple(labels),
        tuple(sorted(events, key=lambda event: event.time_s)), nuisances,
        _in_map(truth.facing_rad if truth.facing_rad is not None else truth.heading_rad, site),
    )  # fmt: skip


def _in_map(direction_rad: FloatArray, site: Site) -> FloatArray:
    """Return directions (T,) of the building's metres in the map frame."""
    x, y = site.stretch.matrix @ np.stack([np.cos(direction_rad), np.sin(direction_rad)])
    return np.asarray(np.arctan2(y, x).round(4))


def _walked(
    site: Site,
    start: Start,
    settings: CaseSettings,
    nuisances: Nuisances,
    rng: np.random.Generator,
) -> tuple[TrueWalk, float]:
    """Walk in the building's metres; also when the first step began."""
    route = nuisances.route
    if settings.rooms:
        route = replace(route, room_visit_share=_ROOM_VISIT_SHARE)
    begin, here = round(float(rng.uniform(*_SCAN_S)), 3), start.taken.position_m
    if len(site.places) > 1:
        truth = walk_levels(site.tower, here, settings.length_m, route, rng, begin)
    else:
        path = plan_route(site.places[0].free, here, settings.length_m, route, rng)
        truth = walk(path, settings.length_m, route, rng, begin)
    truth = with_facing(truth, rng)
    return (with_stops(truth, rng) if settings.stops else truth), begin


def _with_second_scan(
    truth: TrueWalk, settings: CaseSettings, rng: np.random.Generator
) -> tuple[TrueWalk, float | None]:
    """Stand still for a second scan; also when it is done."""
    if settings.second_scan_m is None:
        return truth, None
    after = min(int(np.searchsorted(truth.walked_m, settings.second_scan_m)), len(truth.time_s) - 1)
    duration = float(rng.uniform(*_SCAN_S))
    return with_pause(truth, after, duration), float(truth.time_s[after]) + duration


def _odometry(
    truth: TrueWalk,
    start: Start,
    settings: CaseSettings,
    nuisances: Nuisances,
    rng: np.random.Generator,
) -> tuple[Odometry, Odometry, list[Event]]:
    """Both odometries, in whole millimetres, and their jump."""
    vio = vio_odometry(truth, start.taken.drift_rad, nuisances.vio, rng)
    inertial = inertial_odometry(truth, nuisances.inertial, rng)
    events: list[Event] = []
    if settings.jump_m is not None:
        at = int(np.searchsorted(truth.walked_m, settings.jump_m))
        if settings.jump_size_m is not None:
            nuisances = replace(nuisances, jump_m=settings.jump_size_m, jump_turn_rad=0.0)
        vio, jump = make_jump(vio, min(at, len(vio) - 2), nuisances, rng)
        inertial, _ = make_jump(inertial, min(at, len(vio) - 2), nuisances, rng)
        events.append(jump)
    facing = None if vio.facing_rad is None else vio.facing_rad.round(4)
    vio = replace(vio, position_m=vio.position_m.round(3), facing_rad=facing)
    return vio, replace(inertial, position_m=inertial.position_m.round(3)), events


def _level_events(truth: TrueWalk) -> list[Event]:
    changes = [k for k in range(1, len(truth.level)) if truth.level[k] != truth.level[k - 1]]
    return [Event(float(truth.time_s[k]), "level", level=truth.level[k]) for k in changes]


def _rounded(truth: TrueWalk) -> TrueWalk:
    """Whole milliseconds, so that a file says what was simulated."""
    return replace(truth, time_s=truth.time_s.round(3))


def _tidy(scan: Scan) -> Scan:
    """Whole millimetres, and centimetres of coverage."""
    coverage = None if scan.coverage_m is None else scan.coverage_m.round(2)
    return replace(
        scan,
        walls_m=scan.walls_m.round(3),
        position_m=scan.position_m.round(3),
        coverage_m=coverage,
        time_s=round(scan.time_s, 3),
    )


def _recorded(
    site: Site,
    truth: TrueWalk,
    start: Start,
    odometries: tuple[Odometry, Odometry],
    settings: CaseSettings,
) -> RecordedWalk:
    """Return the walk as a data set has it, its truth in the map frame."""
    vio, inertial = odometries
    position: FloatArray = site.stretch.apply(truth.position_m).round(3)
    begin = site.stretch.apply(truth.start_m).round(3)
    heading = _in_map(truth.heading_rad, site)
    level = truth.level or (site.drawings[0].level or "",) * len(truth.time_s)
    known: dict[str, Any] = {"arkit": vio, "ronin": inertial}
    dropped = {"both": (), "vio": ("ronin",), "inertial": ("arkit",)}[settings.odometry]
    return RecordedWalk(
        **{name: None if name in dropped else each for name, each in known.items()},
        reference_m=position,
        start_m=begin,
        ahead_m=position[min(_AHEAD, len(position) - 1)],
        session=(str(_FIRST_SESSION + start.index),),
        building_id=site.name,
        truth=Truth(truth.time_s, position, heading, level),
    )
