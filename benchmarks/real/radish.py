"""Radish: laser logs with corrected poses, observations and walks in them."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palms import Odometry, Scan
from palms.evaluation.simulation.noise import vio_odometry
from palms.evaluation.simulation.settings import VioNoise
from palms.evaluation.simulation.walker import TrueWalk
from palms.geometry import FloatArray

BUILDINGS = ("csail", "freiburg-079", "intel", "seattle")
STARTS_FILE = Path(__file__).with_name("starts.json")

NO_RETURN_M = 50.0  # ranges from here on mean no return
APART_M = 10.0  # starts at least so far apart
WALK_M, SHORTEST_WALK_M = 100.0, 60.0  # of each walk
STEP_M, SPEED_M_S = 0.65, 1.2  # of a person
JUMP_M = 3.0  # ours: a gap between poses beyond this is a jump of the log; walks end there
ADDED_NOISE = VioNoise()  # to the walks; the oracle knows it


def data_folder() -> Path:
    """Return the data folder: ``$PALMS_DATA``, else ``../shared/data`` beside the repository."""
    given = os.environ.get("PALMS_DATA")
    return Path(given) if given else Path(__file__).resolve().parents[2] / ".." / "shared" / "data"


@dataclass(frozen=True)
class Observation:
    """Walls seen within 5 m of a pose, in the sensor's frame (x ahead, y left)."""

    row: int  # of the log
    walls_m: FloatArray  # (N, 2, 2)


@dataclass(frozen=True)
class Log:
    """A laser log: corrected poses and ranges over -90 to +90 degrees."""

    building: str
    pose: FloatArray  # (L, 3): x, y, theta in the map frame
    ranges_m: FloatArray  # (L, B)
    observations: tuple[Observation, ...]

    @property
    def path_m(self) -> FloatArray:
        """Path (L,) from the first pose."""
        steps = np.linalg.norm(np.diff(self.pose[:, :2], axis=0), axis=1)
        return np.concatenate([[0.0], np.cumsum(steps)])

    def hits(self, rows: FloatArray, range_m: float) -> tuple[FloatArray, FloatArray]:
        """Where beams of some scans ended (H, 2), map frame, and the row (H,) of each."""
        beams = self.ranges_m.shape[1]
        # 361 beams span -90 to +90 degrees; 180 and 360 end one short: maps are sharpest so
        bearing = np.pi * (np.arange(beams) / (beams - beams % 2) - 0.5)
        far = self.ranges_m[rows]
        scan, beam = np.nonzero((far < min(range_m, NO_RETURN_M)) & (far > 0.05))
        x, y, theta = self.pose[rows][scan].T
        angle, reach = theta + bearing[beam], far[scan, beam]
        ends = np.stack([x + reach * np.cos(angle), y + reach * np.sin(angle)], axis=1)
        return ends, np.asarray(rows)[scan]


def read_log(building: str, data: Path | None = None) -> Log:
    """Read the log of a building."""
    folder = (data or data_folder()) / "radish" / building
    table = np.loadtxt(folder / "scans.csv.gz", delimiter=",", comments="#")
    content = json.loads((folder / "pseudo360_5m.json").read_text())
    pose = table[:, :3]
    observations = tuple(
        Observation(
            int(np.abs(pose - seen["gt"]).sum(axis=1).argmin()),
            np.array(seen["segments"]).reshape(-1, 2, 2),
        )
        for seen in content["observations"]
    )
    return Log(building, pose, table[:, 3:], observations)


def reference_walk(log: Log, row: int) -> TrueWalk | None:
    """Return the next 100 m of the log from a row; None where less than 60 m are left."""
    at, path = log.pose[row:, :2], log.path_m[row:] - log.path_m[row]
    jumps = np.flatnonzero(np.diff(path) > JUMP_M)
    end = path[jumps[0]] if len(jumps) else path[-1]
    steps = int(min(end, WALK_M) / STEP_M + 1e-9)
    if end < SHORTEST_WALK_M:
        return None
    s = STEP_M * np.arange(steps + 1)
    position = np.stack([np.interp(s, path, at[:, 0]), np.interp(s, path, at[:, 1])], axis=1)
    move = np.diff(position, axis=0)
    heading = np.arctan2(move[:, 1], move[:, 0])
    return TrueWalk(s[1:] / SPEED_M_S, position[1:], heading, position[0])


def scan_of(observation: Observation) -> Scan:
    """Return the scan, in the odom frame: the observation point is its origin."""
    return Scan(observation.walls_m)


def odometry_of(walk: TrueWalk, drift_rad: float, seed: int) -> Odometry:
    """Return the walk with a VIO's drift added; each seed has its own."""
    return vio_odometry(walk, drift_rad, ADDED_NOISE, np.random.default_rng([seed, 7]))


def choose_starts(log: Log, apart: str) -> list[int]:
    """Return observations at least 10 m apart that leave 60 m of walk, in the order of the log.

    ``apart`` is "position" (the protocol) or "path" (more starts, which overlap more). Each
    is the first that is far enough from those before: picking the largest set instead would
    pick dead ends, which the log saw only once.
    """
    chosen: list[int] = []
    where: list[FloatArray] = []
    for i, seen in enumerate(log.observations):
        at = log.pose[seen.row, :2] if apart == "position" else log.path_m[seen.row, None]
        far = all(np.linalg.norm(at - other) >= APART_M for other in where)
        if far and reference_walk(log, seen.row) is not None:
            chosen.append(i)
            where.append(at)
    return chosen


def derive_starts() -> dict[str, dict[str, dict[str, list[int]]]]:
    """Return the fixed lists of `starts.json`: every other start, in the order of the log."""
    lists: dict[str, dict[str, dict[str, list[int]]]] = {}
    for apart in ("position", "path"):
        lists[apart] = {}
        for building in BUILDINGS:
            chosen = choose_starts(read_log(building), apart)
            lists[apart][building] = {"development": chosen[::2], "reporting": chosen[1::2]}
    return lists


def starts(building: str, purpose: str, apart: str = "position") -> list[int]:
    """Return the fixed starts (indices of observations) for development or reporting."""
    chosen: list[int] = json.loads(STARTS_FILE.read_text())[apart][building][purpose]
    return chosen
