"""What happens during a walk: a second scan, a jump of the odometry, a hint."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from palms.evaluation.simulation.noise import drift_of, with_jump
from palms.evaluation.simulation.settings import ScannerNoise
from palms.evaluation.simulation.sites import Site
from palms.evaluation.simulation.starts import take_any_scan, wide_free
from palms.evaluation.simulation.walker import TrueWalk
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray, rotate
from palms.io import Label
from palms.io.events import Event
from palms.odometry import Odometry
from palms.scan import Scan

if TYPE_CHECKING:
    from palms.evaluation.simulation.cases import CaseSettings
    from palms.evaluation.simulation.nuisances import Nuisances

__all__ = ["SecondScan", "give_hint", "make_jump", "scan_again"]

_HINT_RADIUS_M = 5.0  # simulation: "near the lift"
_WRONG_M = 15.0  # ours: a wrong hint is at least so far off


class SecondScan(NamedTuple):
    """A scan taken during a walk.

    Attributes
    ----------
    scan : Scan
        In the odom frame, as the phone then had it.
    label : Label
        Where it was really taken, map frame, with the drift of that moment.
    event : Event
    """

    scan: Scan
    label: Label
    event: Event


def make_jump(
    odometry: Odometry, at: int, nuisances: Nuisances, rng: np.random.Generator
) -> tuple[Odometry, Event]:
    """Let an odometry jump during one move, in any direction.

    Examples
    --------
    >>> from palms.evaluation.simulation import draw_nuisances
    >>> rng = np.random.default_rng(0)
    >>> straight = Odometry([1, 2, 3], [[1, 0], [2, 0], [3, 0]])
    >>> jumped, event = make_jump(straight, 1, draw_nuisances(rng), rng)
    >>> event.kind, event.time_s
    ('jump', 2.0)
    """
    way = rng.uniform(-np.pi, np.pi)
    x, y = (nuisances.jump_m * np.array([np.cos(way), np.sin(way)])).round(3).tolist()
    turn = round(float(nuisances.jump_turn_rad * rng.choice([-1.0, 1.0])), 4)
    jumped = with_jump(odometry, at, (x, y), turn)
    return jumped, Event(float(odometry.time_s[at]), "jump", shift_m=(x, y), turn_rad=turn)


def scan_again(
    site: Site,
    truth: TrueWalk,
    odometry: Odometry,
    when: tuple[float, str],
    noise: ScannerNoise,
    rng: np.random.Generator,
) -> SecondScan | None:
    """Scan where the walker stands; None when no wall is in sight.

    Parameters
    ----------
    site : Site
    truth : TrueWalk
        In the building's metres.
    odometry : Odometry
        With facing, so that the drift of that moment is known.
    when : tuple of float and str
        The time, and the session.
    noise : ScannerNoise
    rng : numpy.random.Generator
    """
    time_s, session = when
    at = int(np.searchsorted(truth.time_s, time_s + 1e-3)) - 1
    level = site.tower.names.index(truth.level[at]) if truth.level else 0
    drift = float(drift_of(odometry, truth)[at])
    here = truth.position_m[at]
    taken = take_any_scan(site.places[level].world, here, drift, noise, rng)
    if taken is None:
        return None
    time, place = float(odometry.time_s[at]), odometry.position_m[at]
    scan = Scan(
        taken.scan.walls_m + place, place, taken.scan.coverage_m, time_s=time, session=session
    )
    event = Event(time, "scan", session=f"Session_{session}_scan2")
    return SecondScan(scan, Label(site.stretch.apply(here), drift), event)


def give_hint(
    site: Site, truth: TrueWalk, settings: CaseSettings, rng: np.random.Generator
) -> Event:
    """Let somebody say where the walker is, rightly or wrongly.

    Parameters
    ----------
    site : Site
    truth : TrueWalk
        In the building's metres.
    settings : CaseSettings
        What is said, when, and whether it is true.
    rng : numpy.random.Generator
    """
    at = min(int(np.searchsorted(truth.walked_m, settings.hint_m)), len(truth.time_s) - 1)
    level = site.tower.names.index(truth.level[at]) if truth.level else 0
    drawing = site.drawings[level]
    here = site.stretch.apply(truth.position_m[at])
    meant = here if settings.hint_is_right else _elsewhere(site, level, here, rng)
    time, right = float(truth.time_s[at]), settings.hint_is_right
    room = _room_for(drawing, meant, here, right) if settings.hint == "room" else None
    if room is not None:
        return Event(time, "hint", room=room, level=drawing.level, is_right=right)
    off = rotate([_HINT_RADIUS_M * np.sqrt(rng.random()), 0.0], rng.uniform(-np.pi, np.pi))
    x, y = (meant + (0.9 * off if right else 0.0)).round(2).tolist()
    return Event(
        time, "hint", position_m=(x, y), radius_m=_HINT_RADIUS_M, level=drawing.level,
        is_right=right,
    )  # fmt: skip


def _elsewhere(site: Site, level: int, here: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return a place of the level that is far from here, in the map frame."""
    free = site.places[level].free
    where = site.stretch.apply(free.grid.position_of(np.argwhere(wide_free(free))))
    away = np.linalg.norm(where - here, axis=1)
    far = where[away >= min(_WRONG_M, away.max())]
    return np.asarray(far[rng.integers(len(far))])


def _room_for(drawing: FloorPlan, meant: FloatArray, here: FloatArray, right: bool) -> str | None:
    """Name of the room at a place; a wrong one is not the true one, too."""
    room = drawing.room_at(meant)
    return None if room is None or (not right and room == drawing.room_at(here)) else room
