"""Simulating: what a phone would send on a walk that somebody drew on the map."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from palms.building import Stairs
from palms.errors import InputError
from palms.evaluation.simulation import (
    Place,
    RouteSettings,
    ScannerNoise,
    StartSettings,
    TrueWalk,
    VioNoise,
    WorldNoise,
    choose_start,
    free_space,
    make_world,
    plan_route,
    take_scan,
    vio_odometry,
)
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray
from palms.io.happenings import LEVEL_PROBABILITY
from palms.odometry import Move
from palms.raster import PlanRaster
from palms.server import messages
from palms.server.scans import scan_message

__all__ = ["Drawn", "simulated"]

STEP_M = 0.65  # ours: a human step
STEP_S = 0.5
LONGEST_M = 2000.0  # ours: of a drawn walk
DEFAULT_M = 80.0  # ours: of a chosen walk; most are localized long before
_CHOICE = 1  # purpose of random numbers
CLIMB_S = 12.0  # ours: for each level
REACH_M = 0.5  # ours: corners of a path are drawn so exactly


class Drawn(NamedTuple):
    """A walk as somebody drew it.

    Attributes
    ----------
    path_m : sequence of (float, float) or None
        Corners of the path, map frame; one of them alone gives the scan alone. None: a walk is
        chosen as people walk, from where there is much to see, along corridors.
    levels : sequence of str
        The level of each corner; the one level of a walk that is chosen.
    names : sequence of str
        All levels of the building, from the lowest up.
    """

    path_m: Sequence[tuple[float, float]] | None
    levels: Sequence[str]
    names: Sequence[str]


class _Way(NamedTuple):
    """Places along a drawn walk, a step or half a second apart."""

    place_m: FloatArray
    level: list[str]
    is_cut: bool


def simulated(
    rasters: Mapping[str, PlanRaster],
    stairs: Sequence[Stairs],
    drawn: Drawn,
    seed: int,
    length_m: float = DEFAULT_M,
) -> messages.Simulation:
    """Return a scan at the beginning of a path, and the odometry along it.

    The path ends before the first wall that it would cross. Where two corners lie on different
    levels, both lie on the same stairs; there it takes its time to climb, and then the phone
    notices the change by its barometer.

    Parameters
    ----------
    rasters : mapping
        Of the levels that are walked on, by name.
    stairs : sequence of Stairs
    drawn : Drawn
    seed : int
        Of the world, the phone's noise, the angle of its frame, and the choice.
    length_m : float
        Of a walk that is chosen.

    Raises
    ------
    InputError
        When it begins outside of the building, is too long, or climbs where no stairs are; when
        there is none to choose.

    Examples
    --------
    >>> from palms import FloorPlan, rasterize
    >>> square = [[[0, 0], [9, 0]], [[9, 0], [9, 9]], [[9, 9], [0, 9]], [[0, 9], [0, 0]]]
    >>> drawn = Drawn(((1.0, 1.0), (5.0, 1.0), (5.0, 20.0)), ["1"] * 3, ["1"])
    >>> found = simulated({"1": rasterize(FloorPlan(square))}, (), drawn, 3)
    >>> found.is_cut, len(found.samples) > 10, found.truth_m[-1][1] < 9
    (True, True, True)
    """
    first = rasters[drawn.levels[0]]
    if drawn.path_m is None:
        path = _chosen(first.plan, length_m, np.random.default_rng((seed, _CHOICE)))
        corners = [(float(x), float(y)) for x, y in path]
        drawn = drawn._replace(path_m=corners, levels=[drawn.levels[0]] * len(corners))
    _check(np.array(drawn.path_m, dtype=np.float64), first)
    way = _way(rasters, stairs, drawn)
    rng = np.random.default_rng(seed)
    drift = float(rng.uniform(-math.pi, math.pi))
    world = make_world(first.plan, WorldNoise(), rng)
    seen = take_scan(world, way.place_m[0], drift, ScannerNoise(), rng).scan
    return messages.Simulation(
        scan=scan_message(seen),
        samples=_samples(way.place_m, drift, rng),
        truth_m=tuple((float(x), float(y)) for x, y in way.place_m),
        truth_level=tuple(way.level), changes=tuple(_changes(way, drawn.names)),
        is_cut=way.is_cut,
    )  # fmt: skip


def _chosen(plan: FloorPlan, length_m: float, rng: np.random.Generator) -> FloatArray:
    """Return a way through a building as people take it."""
    world = make_world(plan, WorldNoise.none(), rng)
    free = free_space(world, RouteSettings())
    none = np.empty((0, 2))
    taken = choose_start(Place(world, free), none, ScannerNoise(), StartSettings(), rng)
    route_m = plan_route(free, taken.position_m, length_m, RouteSettings(), rng)
    return route_m[: 1 + int(np.searchsorted(_along(route_m), length_m))]


def _along(path: FloatArray) -> FloatArray:
    """Length of a path (N, 2) up to each of its points."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])


def _check(path: FloatArray, raster: PlanRaster) -> None:
    length = float(_along(path)[-1])
    if length > LONGEST_M:
        raise InputError("path", expected=f"at most {LONGEST_M:g} m", got=f"{length:.0f} m")
    row, column = (int(v) for v in raster.grid.cell_of(path[0]))
    rows, columns = raster.grid.shape
    if not (0 <= row < rows and 0 <= column < columns and raster.inside[row, column]):
        raise InputError(
            "path", expected="a start inside of the building", got=str(path[0].tolist())
        )


def _way(rasters: Mapping[str, PlanRaster], stairs: Sequence[Stairs], drawn: Drawn) -> _Way:
    """Walk each stretch of corners on one level, and climb between them, until a wall."""
    places: list[FloatArray] = []
    levels: list[str] = []
    corners = list(zip(drawn.path_m or (), drawn.levels, strict=True))
    at = 0
    for level, stretch in itertools.groupby(corners, key=lambda each: each[1]):
        path = np.array([place for place, _ in stretch], dtype=np.float64)
        if at:
            n = _climb_samples(corners[at - 1], (path[0], level), stairs, drawn.names)
            places.append(np.repeat(path[:1], n, axis=0))
            levels += [levels[-1]] * (n - 1) + [level]
        along, is_cut = _walked(path, rasters[level])
        places.append(along)
        levels += [level] * len(along)
        if is_cut:
            return _Way(np.concatenate(places), levels, True)
        at += len(path)
    return _Way(np.concatenate(places), levels, False)


def _walked(path: FloatArray, raster: PlanRaster) -> tuple[FloatArray, bool]:
    """Places along a path up to the first wall that it would cross, and whether there is one."""
    places = _stepped(path)
    stopped = raster.blocked(places[:-1], places[1:])
    if not stopped.any():
        return places, False
    return places[: int(stopped.argmax()) + 1], True


def _climb_samples(
    here: tuple[tuple[float, float], str], there: tuple[FloatArray, str],
    stairs: Sequence[Stairs], names: Sequence[str],
) -> int:  # fmt: skip
    """Return how many samples a climb takes; the phone stays on the stairs meanwhile."""
    import shapely

    ends = shapely.MultiPoint([here[0], there[0].tolist()])
    areas = [shapely.make_valid(shapely.Polygon(each.polygon_m)) for each in stairs]
    if not any(area.buffer(REACH_M).covers(ends) for area in areas):
        raise InputError(
            "levels", expected="a change between two corners on the same stairs",
            got=f"one from {here[1]} to {there[1]} elsewhere", fix="lead the path on to stairs",
        )  # fmt: skip
    return int(CLIMB_S / STEP_S) * abs(names.index(there[1]) - names.index(here[1]))


def _changes(way: _Way, names: Sequence[str]) -> Iterator[messages.LevelChange]:
    number = [names.index(level) for level in way.level]
    for k in range(1, len(number)):
        if number[k] != number[k - 1]:
            yield messages.LevelChange(
                seq=1,
                t_s=STEP_S * k,
                change=number[k] - number[k - 1],
                probability=LEVEL_PROBABILITY,
            )


def _stepped(path: FloatArray) -> FloatArray:
    """Places (N, 2) along a path, a step apart."""
    along = _along(path)
    n = int(along[-1] / STEP_M)
    at = STEP_M * np.arange(n + 1)
    return np.column_stack([np.interp(at, along, path[:, axis]) for axis in (0, 1)])


def _samples(
    truth_m: FloatArray, drift: float, rng: np.random.Generator
) -> tuple[messages.Sample, ...]:
    if len(truth_m) < 3:
        return ()
    moves = np.diff(truth_m, axis=0)
    heading = np.arctan2(moves[:, 1], moves[:, 0])
    time_s = STEP_S * np.arange(1.0, len(truth_m))
    truth = TrueWalk(time_s, truth_m[1:], heading, truth_m[0], heading)
    moved = vio_odometry(truth, drift, VioNoise(), rng).moves()
    return tuple(
        messages.Sample(t_s=t_s, position_m=(x, y), facing_rad=facing)
        for t_s, x, y, facing in _places(moved)
    )


def _places(moves: Iterator[Move]) -> Iterator[tuple[float, float, float, float | None]]:
    """Time, place and facing after each move from the origin."""
    x = y = 0.0
    for move in moves:
        x, y = x + move.dx_m, y + move.dy_m
        yield move.time_s, x, y, move.facing_rad
