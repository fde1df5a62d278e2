"""Cases: a walk, the plan of its floor, and a scan simulated at its true start; trials on them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np

from benchmarks.mall.walks import FLOORS, Walk, read_plan, read_walks
from palms import Odometry, PlanRaster, Scan, Settings, Track, rasterize
from palms.errors import InputError
from palms.evaluation.metrics import Answers, sample_step, trial_metrics
from palms.evaluation.simulation import ScannerNoise, World, WorldNoise, make_world, take_scan
from palms.localizer import track_trials
from palms.settings import RasterSettings

Frame = Literal["scan", "own"]
FRAMES: tuple[Frame, ...] = ("scan", "own")

# walls are thick and up to 10 cm off; no furniture: it would stand where people really walked
WORLD = WorldNoise(furniture_per_m=0.0, missing_walls=0)


@dataclass(frozen=True)
class Case:
    """One walk with what a method gets.

    Parameters
    ----------
    walk : Walk
    frame : {"scan", "own"}
        Whether the scan shares the frame of the walk's heading.
    raster : PlanRaster
    scan : Scan or None
        None where no wall is near enough to be seen.
    odometry : Odometry
    """

    walk: Walk
    frame: Frame
    raster: PlanRaster
    scan: Scan | None
    odometry: Odometry

    @property
    def crosses(self) -> bool:
        """Whether a straight leg between two waypoints crosses a wall of the plan."""
        legs = self.walk.legs_m
        return bool(self.raster.blocked(legs[:, 0], legs[:, 1]).any())


@lru_cache(maxsize=3)
def _world(floor: str) -> World:
    return make_world(read_plan(floor), WORLD, np.random.default_rng([FLOORS.index(floor), 3]))


@lru_cache(maxsize=3)
def _raster(floor: str, settings: RasterSettings | None) -> PlanRaster:
    return rasterize(read_plan(floor), settings)


def load_case(
    floor: str, index: int, frame: Frame = "scan", raster: RasterSettings | None = None
) -> Case:
    """Put the case of a walk together: its index on its floor, in the order of names."""
    walk = read_walks()[floor][index]
    odometry = Odometry(
        walk.step_s, np.cumsum(walk.step_m, axis=0), frame=frame, source="inertial"
    )  # fmt: skip
    return Case(walk, frame, _raster(floor, raster), _scan(walk, frame), odometry)


def _scan(walk: Walk, frame: Frame) -> Scan | None:
    """Scan at the walk's true start, in the frame of its heading or in one of its own."""
    rng = np.random.default_rng([int(walk.name, 16), 5])
    own_rad = float(rng.uniform(-np.pi, np.pi))
    drift_rad = walk.drift_rad if frame == "scan" else own_rad
    start_m = walk.waypoint_m[0]
    try:
        return take_scan(_world(walk.floor), start_m, drift_rad, ScannerNoise(), rng).scan
    except InputError:
        return None


def run_trials(case: Case, method: str, seeds: Sequence[int]) -> Iterator[dict[str, Any]]:
    """Follow the walk once for each seed: rows of results.json."""
    settings = Settings.for_method(method)
    tracks = track_trials(case.raster, case.scan, case.odometry, settings, seeds)
    about = {
        "scene": "mall",
        "walk": f"{case.walk.floor}-{case.walk.name}",
        "method": method,
        "floor": case.walk.floor,
        "frame": case.frame,
        "crosses": case.crosses,
        "scan_walls": 0 if case.scan is None else len(case.scan.walls_m),
    }
    for seed, track in zip(seeds, tracks, strict=True):
        yield {**about, "seed": seed, **_figures(case, track, seed)}


def _figures(case: Case, track: Track, seed: int) -> dict[str, Any]:
    answers, reference = Answers.of(track), case.walk.reference_m
    metrics = trial_metrics(answers, reference, case.odometry.displacements_m, case.raster)
    sampled = sample_step(answers, reference, np.random.default_rng([seed, 11]))
    return {
        **metrics.to_json(),
        "sampled_p_within_1m": sampled[0] if sampled else None,
        "sampled_within_1m": sampled[1] if sampled else None,
        "waypoint_error_m": waypoint_errors(answers, case.walk),
    }


def waypoint_errors(answers: Answers, walk: Walk) -> list[float | None]:
    """Error at each waypoint but the first, of the answer nearest in time.

    None where it was not localized then.
    """
    gap = np.abs(walk.waypoint_s[1:, None] - answers.t_s[None])
    at = gap.argmin(axis=1)
    error = np.linalg.norm(answers.position_m[at] - walk.waypoint_m[1:], axis=1)
    return [float(e) if yes else None for e, yes in zip(error, answers.localized[at], strict=True)]
