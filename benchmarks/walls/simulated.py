"""Depth sequences in simulated buildings, whose truth is known."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import shapely

from benchmarks.walls.score import COVERED, Score, score
from palms.evaluation.bootstrap import bootstrap_interval
from palms.evaluation.simulation import (
    DepthCamera,
    WorldNoise,
    generate_building,
    make_world,
    sample_building,
    take_depth,
)
from palms.evaluation.simulation.world import World
from palms.extraction import scan_from_depth
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray, distance_to_segments, lengths

CAMERA = DepthCamera(columns=192, rows=144)
BUILDINGS = ("sample", "office", "campus")
CLEAR_M = 0.7  # around the user
LONG_M = 0.8
OFFSET_M, ANGLE_RAD = 0.02, np.deg2rad(0.5)  # what was asked for


def run(kind: str, place: int) -> tuple[Score, FloatArray, float]:
    """Score, lengths of the true walls and seconds, of one place in a building of its own."""
    rng = np.random.default_rng([BUILDINGS.index(kind), place])
    plan = sample_building() if kind == "sample" else generate_building(kind, place)
    world = make_world(plan, WorldNoise(), rng)
    taken = take_depth(world, choose_place(plan, world, rng), rng.uniform(-3, 3), CAMERA, rng)
    start = time.process_time()
    scan = scan_from_depth(taken.frames)
    seconds = time.process_time() - start
    truth = taken.seen_m[lengths(taken.seen_m) > LONG_M]
    return score(truth, taken.surfaces_m, scan.walls_m), lengths(truth), seconds


def choose_place(plan: FloorPlan, world: World, rng: np.random.Generator) -> FloatArray:
    """Draw a place in any room with room for a user's arms."""
    everything = np.concatenate([world.blocking_m, world.seen_m])
    while True:
        corners = plan.rooms[int(rng.integers(len(plan.rooms)))].polygon_m
        low, high = corners.min(axis=0), corners.max(axis=0)
        place = low + rng.random(2) * (high - low)
        inside = shapely.Polygon(corners).contains(shapely.Point(place))
        if inside and distance_to_segments(place, everything).min() > CLEAR_M:
            return place


def row(kind: str, results: list[tuple[Score, FloatArray, float]]) -> dict[str, Any]:
    """Figures of one kind of building."""
    unit = np.repeat(np.arange(len(results)), [len(s.covered) for s, _, _ in results])
    found = np.concatenate([s.covered >= COVERED for s, _, _ in results])
    offset = np.concatenate([s.offset_m for s, _, _ in results])[found]
    angle = np.concatenate([s.angle_rad for s, _, _ in results])[found]
    spurious = np.concatenate([s.spurious for s, _, _ in results])
    of = np.repeat(np.arange(len(results)), [len(s.spurious) for s, _, _ in results])
    return {
        "building": kind,
        "places": len(results),
        "walls": len(found),
        "found %": interval(100 * found, unit),
        "offset cm, median": f"{100 * np.median(offset):.1f}",
        "95 %": f"{100 * np.quantile(offset, 0.95):.1f}",
        "within 2 cm %": f"{100 * np.mean(offset <= OFFSET_M):.0f}",
        "angle °, median": f"{np.rad2deg(np.median(angle)):.2f}",
        "95 % ": f"{np.rad2deg(np.quantile(angle, 0.95)):.2f}",
        "within 0.5° %": f"{100 * np.mean(angle <= ANGLE_RAD):.0f}",
        "spurious %": interval(100 * spurious, of),
        "CPU s a place, median": f"{np.median([s for _, _, s in results]):.1f}",
    }


def interval(values: FloatArray, units: FloatArray) -> str:
    """Mean with its interval over places."""
    found = bootstrap_interval(values, list(units))
    return f"{found.value:.1f} [{found.low:.1f}, {found.high:.1f}]"
