"""Write the sample data set that the package ships; the same bytes every time.

Run it after a change of the simulator: ``python tools/make_sample.py``. It rewrites
``src/palms/sample/data``; ``--out FOLDER`` writes elsewhere.
"""

from __future__ import annotations

import argparse
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from make_phone_files import write_phone_files
from palms import io
from palms.evaluation.simulation import (
    InertialNoise,
    RouteSettings,
    ScannerNoise,
    SimulatedScan,
    TrueWalk,
    VioNoise,
    WorldNoise,
    free_space,
    inertial_odometry,
    make_world,
    plan_route,
    sample_building,
    take_scan,
    vio_odometry,
    walk,
)
from palms.floorplan import FloorPlan
from palms.odometry import Odometry

SEED = 4  # ours: a scan of 8 walls; a walk through all five corridors
START_M = (55.9, 36.2)  # ours: at the niche of the Cross corridor; map frame
DRIFT_RAD = 2.13  # ours: no multiple of anything
SCAN_S = 12.0  # ours: how long the user stood and turned
LENGTH_M = 147.0  # the mean of the walks in the paper
RONIN_SCALE = 1.1  # measured on the data set of the paper
SESSION, WALK = "1001", "walk-1"
DATA = Path(__file__).resolve().parents[1] / "src" / "palms" / "sample" / "data"


def simulate(plan: FloorPlan) -> tuple[SimulatedScan, TrueWalk, Odometry, Odometry]:
    """Draw the scan, the walk and both odometries."""
    rng = np.random.default_rng(SEED)
    world = make_world(plan, WorldNoise(), rng)
    scan = take_scan(world, START_M, DRIFT_RAD, ScannerNoise(), rng)
    route = plan_route(free_space(world, RouteSettings()), START_M, LENGTH_M, RouteSettings(), rng)
    truth = walk(route, LENGTH_M, RouteSettings(), rng, start_s=SCAN_S)
    truth = replace(
        truth,
        time_s=truth.time_s.round(3),
        position_m=truth.position_m.round(3),
        heading_rad=truth.heading_rad.round(4),
    )
    ronin = inertial_odometry(truth, InertialNoise(scale=RONIN_SCALE), rng)
    return scan, truth, vio_odometry(truth, DRIFT_RAD, VioNoise(), rng), ronin


def recorded(truth: TrueWalk, arkit: Odometry, ronin: Odometry, level: str) -> io.RecordedWalk:
    """Return the walk as a data set has it, in whole millimetres."""
    return io.RecordedWalk(
        arkit=replace(arkit, position_m=arkit.position_m.round(3)),
        ronin=replace(ronin, position_m=ronin.position_m.round(3)),
        reference_m=truth.position_m,
        start_m=truth.start_m,
        ahead_m=truth.position_m[3],
        session=(SESSION,),
        building_id="sample",
        truth=io.Truth(
            truth.time_s, truth.position_m, truth.heading_rad, (level,) * len(truth.time_s)
        ),
    )


def rounded(value: Any) -> Any:  # noqa: ANN401
    """Return a JSON value with its numbers rounded, so that no machine's last digit shows."""
    if isinstance(value, dict):
        return {key: rounded(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [rounded(entry) for entry in value]
    return round(value, 6) + 0.0 if isinstance(value, float) else value


def make_sample(folder: Path) -> None:
    """Write the data set into a folder; `maps`, `trajectories`, `phone` in it are replaced."""
    for name in ("maps", "trajectories", "phone"):
        shutil.rmtree(folder / name, ignore_errors=True)
    plan = sample_building()
    taken, truth, arkit, ronin = simulate(plan)
    coverage = taken.scan.coverage_m
    scan = replace(
        taken.scan,
        walls_m=taken.scan.walls_m.round(3),
        coverage_m=None if coverage is None else coverage.round(2),
        session=SESSION,
    )
    io.write_plan(folder, plan)
    io.write_case(
        folder,
        plan.name,
        WALK,
        recorded(truth, arkit, ronin, plan.level or ""),
        [scan],
        [io.Label(taken.position_m, taken.drift_rad)],
    )
    for file in sorted(folder.rglob("*json")):
        io.write_json(file, rounded(io.read_json(file)))
    write_phone_files(folder)


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=DATA, help="where to (default: the package)")
    folder = parser.parse_args().out
    make_sample(folder)
    files = [file for file in sorted(folder.rglob("*")) if file.is_file()]
    for file in files:
        print(f"{file.stat().st_size:8d}  {file.relative_to(folder)}")
    print(f"{sum(file.stat().st_size for file in files):8d}  in all")


if __name__ == "__main__":
    main()
