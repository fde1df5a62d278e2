"""The mall's floors: their plans, and the walks with steps and tagged waypoints."""

from __future__ import annotations

import csv
import gzip
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from benchmarks.real.radish import data_folder
from palms import FloorPlan
from palms.geometry import FloatArray, lengths
from palms.io import read_plan_csv

FLOORS = ("F2", "F3", "F4")
FIRST_LEGS_M = 15.0  # ours: the legs that the rotation of a case's frame is taken from


@dataclass(frozen=True)
class Walk:
    """One recorded walk; times count from its first waypoint, where it begins.

    Parameters
    ----------
    floor, name : str
    step_s : (T,)
        When each step ended.
    step_m : (T, 2)
        Displacement of each, in the frame of the phone's gyro heading.
    waypoint_s : (W,)
        When each waypoint was tagged; the first at 0.
    waypoint_m : (W, 2)
        Map frame.
    """

    floor: str
    name: str
    step_s: FloatArray
    step_m: FloatArray
    waypoint_s: FloatArray
    waypoint_m: FloatArray

    @property
    def legs_m(self) -> FloatArray:
        """Straight lines (W - 1, 2, 2) between consecutive waypoints."""
        return np.stack([self.waypoint_m[:-1], self.waypoint_m[1:]], axis=1)

    @property
    def reference_m(self) -> FloatArray:
        """Where the walker was (T, 2): waypoints joined in time; NaN after the last one."""
        x, y = (
            np.interp(self.step_s, self.waypoint_s, self.waypoint_m[:, k], right=np.nan)
            for k in (0, 1)
        )
        return np.stack([x, y], axis=1)

    @property
    def drift_rad(self) -> float:
        """The rotation that turns the steps of the first legs, at least 15 m, into the map.

        Least squares over those legs. It makes the case: the simulated scan is put into the
        frame that the walk's heading had at the start. No filter gets it.
        """
        path = np.cumsum(lengths(self.legs_m))
        last = min(int(np.searchsorted(path, FIRST_LEGS_M)), len(path) - 1) + 1
        at = np.concatenate([[[0.0, 0.0]], np.cumsum(self.step_m, axis=0)])
        time = np.concatenate([[0.0], self.step_s])
        walked = np.diff([np.interp(self.waypoint_s, time, at[:, k]) for k in (0, 1)]).T[:last]
        true = np.diff(self.waypoint_m, axis=0)[:last]
        cross = walked[:, 0] * true[:, 1] - walked[:, 1] * true[:, 0]
        return float(np.arctan2(cross.sum(), (walked * true).sum()))


def read_plan(floor: str, data: Path | None = None) -> FloorPlan:
    """Read the plan of a floor."""
    return read_plan_csv((data or data_folder()) / "mall" / floor / "walls.csv")


@lru_cache(maxsize=2)
def read_walks(data: Path | None = None) -> dict[str, tuple[Walk, ...]]:
    """Read the long walks of each floor, by name."""
    folder = (data or data_folder()) / "mall"
    steps: dict[tuple[str, str], list[list[float]]] = {}
    for row in _rows(folder / "steps.csv.gz"):
        key = (row["floor"].rpartition("/")[2], row["walk"])
        values = [float(row[name]) for name in ("t_s", "dx_gyro", "dy_gyro")]
        steps.setdefault(key, []).append(values)
    walks = {}
    for floor in FLOORS:
        tagged: dict[str, list[list[float]]] = {}
        for row in _rows(folder / floor / "waypoints.csv.gz"):
            values = [float(row[name]) for name in ("t_ms", "x", "y")]
            tagged.setdefault(row["walk"], []).append(values)
        names = sorted(name for at, name in steps if at == floor)
        walks[floor] = tuple(_walk(floor, n, steps[floor, n], tagged[n]) for n in names)
    return walks


def _walk(floor: str, name: str, steps: list[list[float]], tagged: list[list[float]]) -> Walk:
    step, waypoint = np.array(steps), np.array(tagged)
    seconds = (waypoint[:, 0] - waypoint[0, 0]) / 1000
    return Walk(floor, name, step[:, 0], step[:, 1:], seconds, waypoint[:, 1:])


def _rows(path: Path) -> Iterator[dict[str, str]]:
    with gzip.open(path, "rt", newline="") as lines:
        yield from csv.DictReader(lines)
