"""One log against its waypoints: how far off at the end, how many steps were found."""

from __future__ import annotations

import csv
import gzip
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.mall.walks import FLOORS, Walk, read_walks
from benchmarks.real.radish import data_folder
from palms.geometry import FloatArray, lengths, rotate
from palms.io.android import read_readings
from palms.io.reckoned import ReckoningOptions, reckon

TUNED_ON = "F2"  # lengths of legs on this floor gave the constants of step length
SAME_STEP_S = 0.25  # ours: half a step; peaks nearer in time are one step
METHODS = {
    "pendulum, gyro": {"length": "pendulum", "heading": "gyro"},
    "weinberg, gyro": {"length": "weinberg", "heading": "gyro"},
    "constant, gyro": {"length": "constant", "heading": "gyro"},
    "pendulum, attitude": {"length": "pendulum", "heading": "attitude"},
    "constant, attitude": {"length": "constant", "heading": "attitude"},
}
DETECTED = ("steps.csv, gyro", "steps.csv, attitude")


@dataclass(frozen=True)
class Log:
    """A raw log and what is known of it; its clock begins at the first waypoint.

    Parameters
    ----------
    path : Path
    walk : Walk
        Its waypoints and the detected steps.
    headings_rad : (T, 2)
        Of those steps: by gyroscope, by rotation vector.
    """

    path: Path
    walk: Walk
    headings_rad: FloatArray


def read_logs(data: Path | None = None) -> list[Log]:
    """Return the raw logs of all floors, by name."""
    folder = (data or data_folder()) / "mall"
    headings: dict[str, list[list[float]]] = {}
    with gzip.open(folder / "steps.csv.gz", "rt", newline="") as lines:
        for row in csv.DictReader(lines):
            angles = [float(row[name]) for name in ("yaw_gyro_rad", "yaw_rotvec_rad")]
            headings.setdefault(row["walk"], []).append(angles)
    return [
        Log(path, walk, np.array(headings[walk.name]))
        for floor in FLOORS
        for path in sorted((folder / floor / "walks").glob("*.txt.gz"))
        for walk in read_walks(data)[floor]
        if walk.name == path.name.partition(".")[0]
    ]


def measure(log: Log) -> Iterator[dict[str, Any]]:
    """Yield a row of results for each method, and for the steps that come with the data."""
    about = {"floor": log.walk.floor, "walk": log.walk.name}
    sensors = read_readings(log.path).sensors
    for name, options in METHODS.items():
        found = reckon(sensors, ReckoningOptions(**options), log.path)
        figures = against_waypoints(found.time_s, found.position_m, log.walk)
        steps = step_figures(found.time_s, log.walk)
        yield {**about, "method": name, **figures, **steps}
    step_m = lengths(np.stack([np.zeros_like(log.walk.step_m), log.walk.step_m], axis=1))
    for name, heading in zip(DETECTED, log.headings_rad.T, strict=True):
        moves = step_m[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
        yield {
            **about, "method": name,
            **against_waypoints(log.walk.step_s, np.cumsum(moves, axis=0), log.walk),
        }  # fmt: skip


def against_waypoints(time_s: FloatArray, position_m: FloatArray, walk: Walk) -> dict[str, float]:
    """Compare a walk with its waypoints: moved to the first, turned to fit all, never scaled."""
    time = np.concatenate([[min(0.0, time_s[0] - 1e-3)], time_s])
    path = np.concatenate([[[0.0, 0.0]], position_m])
    at = np.column_stack([np.interp(walk.waypoint_s, time, path[:, k]) for k in (0, 1)])
    found, true = at - at[0], walk.waypoint_m - walk.waypoint_m[0]
    cross = (found[:, 0] * true[:, 1] - found[:, 1] * true[:, 0]).sum()
    off = rotate(found, float(np.arctan2(cross, (found * true).sum()))) - true
    distance = float(lengths(walk.legs_m).sum())
    inside = time_s <= walk.waypoint_s[-1]
    moves = np.diff(np.concatenate([[[0.0, 0.0]], position_m[inside]]), axis=0)
    return {
        "end_error": float(np.linalg.norm(off[-1])) / distance,
        "rmse_m": float(np.sqrt((off**2).sum(axis=1).mean())),
        "length_ratio": float(np.linalg.norm(moves, axis=1).sum()) / distance,
        "distance_m": distance,
    }


def step_figures(time_s: FloatArray, walk: Walk) -> dict[str, int]:
    """Count the steps until the last waypoint: found, known, and those that are both."""
    found = time_s[time_s <= walk.waypoint_s[-1]]
    gap = np.abs(found[:, None] - walk.step_s[None])
    return {
        "steps_found": len(found),
        "steps_known": len(walk.step_s),
        "steps_both": int((gap.min(axis=0) <= SAME_STEP_S).sum()),
        "steps_new": int((gap.min(axis=1) > SAME_STEP_S).sum()),
    }
