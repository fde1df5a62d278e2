"""Advice: how much one scan tells, before anybody walks in vain."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms.geometry import FloatArray, wrap_angle
from palms.heatmap import Candidates
from palms.places import find_places
from palms.posterior import Posterior
from palms.scan import Scan

__all__ = ["Advice", "Gap", "View", "advise", "view_of"]

BEARINGS = 72  # ours: five degrees each
LEAST_GAP_RAD = math.radians(30.0)  # ours: smaller ones are missed between two planes
LEAST_WALL_M = 0.5  # ours: shorter ones are door frames and furniture
SQUARE_RAD = math.radians(20.0)  # ours: walls that differ less than this run one way
HELD = 0.9  # ours: the share of the belief that the places are counted for
PLACE_M = 2.0  # ours: what is nearer is one place, as in p_within_2m


@dataclass(frozen=True, slots=True)
class Gap:
    """Bearings that a scan says nothing about.

    Parameters
    ----------
    middle_rad : float
        Bearing of its middle, odom frame, in (-pi, pi].
    width_rad : float
    """

    middle_rad: float
    width_rad: float


@dataclass(frozen=True, slots=True)
class View:
    """What a scan has seen of its surroundings.

    Parameters
    ----------
    n_walls : int
        Walls of at least half a metre.
    one_way : bool
        Whether they all run one way, so that nothing tells the place along them.
    gaps : tuple of Gap
        Where it did not look, or nothing was near enough, the widest first.
    """

    n_walls: int
    one_way: bool
    gaps: tuple[Gap, ...]

    @property
    def unseen(self) -> float:
        """Share of all bearings that lie in gaps."""
        return sum(gap.width_rad for gap in self.gaps) / (2 * math.pi)


@dataclass(frozen=True, slots=True)
class Advice:
    """How much one scan tells.

    Parameters
    ----------
    view : View
    n_places : int
        The fewest places that hold 90 % of what the scan says.
    mass : float
        Share of the belief that all places hold; the rest is anywhere.
    """

    view: View
    n_places: int
    mass: float


def view_of(scan: Scan) -> View:
    """Return what a scan has seen.

    Examples
    --------
    >>> ahead = Scan([[[2.0, -2.0], [2.0, 2.0]]])
    >>> view_of(ahead).n_walls, round(math.degrees(view_of(ahead).gaps[0].width_rad))
    (1, 270)
    """
    ends = scan.relative_m
    along = ends[:, 1] - ends[:, 0]
    large = np.hypot(*along.T) >= LEAST_WALL_M
    return View(int(large.sum()), _one_way(ends[large]), _gaps(_seen(scan)))


def _one_way(walls_m: FloatArray) -> bool:
    """Whether walls (N, 2, 2) run within `SQUARE_RAD` of one line."""
    if not len(walls_m):
        return True
    along = walls_m[:, 1] - walls_m[:, 0]
    twice = 2 * np.arctan2(along[:, 1], along[:, 0])
    off = np.abs(wrap_angle(twice - twice[np.hypot(*along.T).argmax()])) / 2
    return bool((off < SQUARE_RAD).all())


def _seen(scan: Scan) -> npt.NDArray[np.bool_]:
    """Whether anything is known of each bearing: a wall in it, or that it is free."""
    start, stop = scan.relative_m[:, 0], scan.relative_m[:, 1]
    first = np.arctan2(start[:, 1], start[:, 0])
    turn = wrap_angle(np.arctan2(stop[:, 1], stop[:, 0]) - first)
    bearing = (np.arange(BEARINGS) + 0.5) * 2 * np.pi / BEARINGS
    away = wrap_angle(bearing[:, None] - (first + turn / 2))
    seen = (np.abs(away) <= np.abs(turn) / 2).any(axis=1)
    if scan.coverage_m is not None and len(scan.coverage_m):
        index = (bearing / (2 * np.pi) * len(scan.coverage_m)).astype(int)
        seen |= ~np.isnan(scan.coverage_m[index])
    return np.asarray(seen)


def _gaps(seen: npt.NDArray[np.bool_]) -> tuple[Gap, ...]:
    width = 2 * math.pi / len(seen)
    if not seen.any():
        return (Gap(math.pi, 2 * math.pi),)
    first = int(seen.argmax())
    turned = np.concatenate([[True], np.roll(seen, -first), [True]])
    starts = np.flatnonzero(turned[:-1] & ~turned[1:])
    stops = np.flatnonzero(~turned[:-1] & turned[1:])
    gaps = [
        Gap(float(wrap_angle((first + (start + stop) / 2) * width)), float(stop - start) * width)
        for start, stop in zip(starts.tolist(), stops.tolist(), strict=True)
    ]
    wide = [gap for gap in gaps if gap.width_rad >= LEAST_GAP_RAD]
    return tuple(sorted(wide, key=lambda gap: -gap.width_rad))


def advise(scan: Scan, found: Candidates | Posterior) -> Advice:
    """Return how much a scan tells: how many places are left, and what it has not seen.

    Parameters
    ----------
    scan : Scan
    found : Candidates or Posterior
        What `palms.locate` makes of it.

    Examples
    --------
    >>> from palms import FloorPlan, locate
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
    >>> scan = Scan(room - (2.0, 1.0))
    >>> advice = advise(scan, locate(FloorPlan(room), scan))
    >>> advice.n_places, advice.view.gaps  # the other is this room turned by half a turn
    (2, ())
    """
    p = np.array([place.p for place in find_places(found, PLACE_M)])
    total = float(p.sum())
    enough = np.cumsum(p) >= HELD * total
    return Advice(view_of(scan), int(enough.argmax()) + 1 if total else 0, min(total, 1.0))
