"""Simulating: what a phone would send on a walk that somebody drew on the map."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

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
from palms.odometry import Move
from palms.raster import PlanRaster
from palms.server import messages
from palms.server.scans import scan_message

__all__ = ["simulated"]

STEP_M = 0.65  # ours: a human step
STEP_S = 0.5
LONGEST_M = 2000.0  # ours: of a drawn walk
DEFAULT_M = 80.0  # ours: of a chosen walk; most are localized long before
_CHOICE = 1  # purpose of random numbers


def simulated(
    raster: PlanRaster,
    path_m: tuple[tuple[float, float], ...] | None,
    seed: int,
    length_m: float = DEFAULT_M,
) -> messages.Simulation:
    """Return a scan at the beginning of a path, and the odometry along it.

    The path ends before the first wall that it would cross.

    Parameters
    ----------
    raster : PlanRaster
    path_m : sequence of (float, float) or None
        Corners of the path, map frame; one of them alone gives the scan alone. None: a walk is
        chosen as people walk, from where there is much to see, along corridors.
    seed : int
        Of the world, the phone's noise, the angle of its frame, and the choice.
    length_m : float
        Of a walk that is chosen.

    Raises
    ------
    InputError
        When it begins outside of the building, or is too long; when there is none to choose.

    Examples
    --------
    >>> from palms import FloorPlan, rasterize
    >>> square = [[[0, 0], [9, 0]], [[9, 0], [9, 9]], [[9, 9], [0, 9]], [[0, 9], [0, 0]]]
    >>> found = simulated(rasterize(FloorPlan(square)), ((1.0, 1.0), (5.0, 1.0), (5.0, 20.0)), 3)
    >>> found.is_cut, len(found.samples) > 10, found.truth_m[-1][1] < 9
    (True, True, True)
    """
    if path_m is None:
        path = _chosen(raster.plan, length_m, np.random.default_rng((seed, _CHOICE)))
    else:
        path = np.array(path_m, dtype=np.float64)
    _check(path, raster)
    truth_m = _stepped(path)
    stopped = raster.blocked(truth_m[:-1], truth_m[1:])
    is_cut = bool(stopped.any())
    if is_cut:
        truth_m = truth_m[: int(stopped.argmax()) + 1]
    rng = np.random.default_rng(seed)
    drift = float(rng.uniform(-math.pi, math.pi))
    world = make_world(raster.plan, WorldNoise(), rng)
    seen = take_scan(world, truth_m[0], drift, ScannerNoise(), rng).scan
    return messages.Simulation(
        scan=scan_message(seen),
        samples=_samples(truth_m, drift, rng),
        truth_m=tuple((float(x), float(y)) for x, y in truth_m), is_cut=is_cut,
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
