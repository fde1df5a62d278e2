"""The floor, scan and walk that the speed benchmarks share: 110 x 60 m, 377 walls."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from palms.floorplan import FloorPlan
from palms.odometry import Odometry
from palms.raster import PlanRaster, rasterize
from palms.scan import Scan
from palms.settings import RasterSettings

WIDTH_M, HEIGHT_M, DOOR_M = 110.0, 60.0, 0.9
ROWS = ((0.0, 12.0), (14.5, 29.0), (31.0, 45.5), (48.0, 60.0))  # rooms; corridors between
START = np.array([31.0, 13.2])


@cache
def plan() -> FloorPlan:
    """Rows of offices along corridors, doors as gaps."""
    rng = np.random.default_rng(0)
    walls = [[[0, 0], [WIDTH_M, 0]], [[0, HEIGHT_M], [WIDTH_M, HEIGHT_M]]]
    walls += [[[x, 0], [x, HEIGHT_M]] for x in (0.0, WIDTH_M)]
    for bottom, top in ROWS:
        edges = np.concatenate([[2.0], 2.0 + np.cumsum(rng.uniform(3.2, 5.4, 40))])
        edges = np.append(edges[edges < WIDTH_M - 4], WIDTH_M - 2.0)
        walls += [[[x, bottom], [x, top]] for x in edges]
        for y in (bottom, top):
            if y in (0.0, HEIGHT_M):
                continue
            for left, right in pairwise(edges):
                door = rng.uniform(left + 0.5, right - 0.5 - DOOR_M)
                walls += [[[left, y], [door, y]], [[door + DOOR_M, y], [right, y]]]
    return FloorPlan(np.array(walls)[:377], name="benchmark floor")


@cache
def raster() -> PlanRaster:
    """The same, rasterised."""
    return rasterize(plan())


@cache
def campus(side_m: float, settings: RasterSettings | None = None) -> PlanRaster:
    """The same floor again and again on a square of some size, cut off at its border."""
    wide, high = (int(np.ceil(side_m / (n + 4.0))) for n in (WIDTH_M, HEIGHT_M))
    one = plan().segments_m
    shifts = [(i * (WIDTH_M + 4.0), k * (HEIGHT_M + 4.0)) for i in range(wide) for k in range(high)]
    walls = np.concatenate([one + shift for shift in shifts])
    walls = walls[(walls <= side_m).all(axis=(1, 2))]
    border = np.array([[0, 0], [side_m, 0], [side_m, side_m], [0, side_m]], np.float64)
    edges = np.stack([border, np.roll(border, -1, axis=0)], axis=1)
    return rasterize(FloorPlan(np.concatenate([edges, walls]), name="campus"), settings)


@cache
def crowded(n: int) -> PlanRaster:
    """A floor of 110 x 60 m with so many walls; the more there are, the shorter they are."""
    rng = np.random.default_rng(n)
    start = rng.uniform((0, 0), (WIDTH_M, HEIGHT_M), (n, 2))
    along = np.where(rng.random((n, 1)) < 0.5, (1.0, 0.0), (0.0, 1.0))
    end = start + along * min(4.0, 1500.0 / n)
    border = np.array([[[0, 0], [WIDTH_M, 0]], [[0, HEIGHT_M], [WIDTH_M, HEIGHT_M]]])
    return rasterize(FloorPlan(np.concatenate([border, np.stack([start, end], axis=1)])))


@cache
def scan() -> Scan:
    """Ten walls seen from a corridor."""
    segments = plan().segments_m
    middle = np.linalg.norm(segments.mean(axis=1) - START, axis=1)
    chosen = segments[np.argsort(middle)[:10]] - START
    reach = np.clip(chosen, -5.0, 5.0)
    return Scan(reach)


@cache
def walk(steps: int = 252, length_m: float = 149.0) -> Odometry:
    """Along the corridor and back."""
    step = length_m / steps
    there = np.where(np.arange(steps) % 100 < 50, 1.0, -1.0)
    moves = np.stack([step * there, np.zeros(steps)], axis=1)
    return Odometry(0.54 * np.arange(1, steps + 1), np.cumsum(moves, axis=0))
