"""Cases: a plan, a scan and a reference walk; trials on them; one of them as a data set."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.real.plans import plan_for
from benchmarks.real.radish import Log, odometry_of, read_log, reference_walk, scan_of
from palms import PlanRaster, Scan, SegmentClass, Settings, rasterize, track
from palms.evaluation.metrics import Answers, sample_step, trial_metrics
from palms.evaluation.simulation.walker import TrueWalk
from palms.geometry import distance_to_segments, lengths, rotate
from palms.io import Label, RecordedWalk, write_case, write_plan
from palms.settings import RasterSettings

IN_PLAN_M = 0.3  # ours: a wall of the scan is in the plan when it has one so near


@dataclass(frozen=True)
class Key:
    """What names a case."""

    building: str
    start: int
    grade: str = "as-is"
    suite: str = "clean"

    @property
    def walk(self) -> str:
        """Name of the walk."""
        return f"start-{self.start}"


@dataclass(frozen=True)
class Case:
    """One start of a log, with the plan that belongs to it."""

    key: Key
    raster: PlanRaster
    scan: Scan
    walk: TrueWalk
    drift_rad: float

    @cached_property
    def scan_in_plan(self) -> float:
        """Share of the scan's metres of wall that lie near a wall of the plan.

        It tells starts whose surroundings only the left-out scans saw: nothing matches there.
        """
        ends = rotate(self.scan.relative_m, self.drift_rad) + self.walk.start_m
        plan = self.raster.plan.of_class(SegmentClass.WALL, SegmentClass.DOOR)
        points = ends[:, :1] + np.linspace(0, 1, 21)[:, None] * (ends[:, 1:] - ends[:, :1])
        near = [[distance_to_segments(p, plan).min() < IN_PLAN_M for p in wall] for wall in points]
        return float(np.average(np.mean(near, axis=1), weights=lengths(ends)))


@lru_cache(maxsize=4)
def _log(building: str) -> Log:
    return read_log(building)


@lru_cache(maxsize=4)
def load_case(key: Key, cache: Path | None, raster: RasterSettings | None = None) -> Case:
    """Read the log, fit the plan (or take it from the cache) and put the case together."""
    log = _log(key.building)
    seen = log.observations[key.start]
    walk = reference_walk(log, seen.row)
    if walk is None:
        raise ValueError(f"{key.building} {key.start}: less than 60 m of walk are left")
    plan = plan_for(log, key.start, walk, key.grade, key.suite, cache)
    return Case(key, rasterize(plan, raster), scan_of(seen), walk, float(log.pose[seen.row, 2]))


def run_trial(case: Case, method: str, settings: Settings, seed: int) -> dict[str, Any]:
    """Follow one walk once: a row of results.json."""
    odometry = odometry_of(case.walk, case.drift_rad, seed)
    answers = Answers.of(track(case.raster, case.scan, odometry, settings, seed))
    reference = case.walk.position_m
    metrics = trial_metrics(answers, reference, odometry.displacements_m, case.raster)
    sampled = sample_step(answers, reference, np.random.default_rng([seed, 11]))
    key = case.key
    return {
        "scene": key.building,
        "walk": key.walk,
        "method": method,
        "seed": seed,
        "grade": key.grade,
        "suite": key.suite,
        "scan_in_plan": case.scan_in_plan,
        **metrics.to_json(),
        "sampled_p_within_1m": sampled[0] if sampled else None,
        "sampled_within_1m": sampled[1] if sampled else None,
    }


def write_as_dataset(case: Case, folder: Path, seed: int = 0) -> Path:
    """Write one case in the data set's layout, so that `palms track` runs on it."""
    key = case.key
    session = f"{key.building}-{key.start}"
    odometry = replace(odometry_of(case.walk, case.drift_rad, seed), session=(session,))
    walk = case.walk
    recorded = RecordedWalk(
        arkit=odometry,
        reference_m=walk.position_m,
        start_m=walk.start_m,
        session=(session,),
        building_id=key.building,
    )
    write_plan(folder, case.raster.plan)
    scan = replace(case.scan, session=session)
    label = Label(walk.start_m, case.drift_rad)
    return write_case(folder, key.building, key.walk, recorded, [scan], [label])
