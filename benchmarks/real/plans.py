"""Plans: walls of the scans that the start did not see, made worse by grades."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from benchmarks.real import walls as fitter
from benchmarks.real.radish import BUILDINGS, Log
from palms import FloorPlan, SegmentClass
from palms.evaluation.simulation.walker import TrueWalk
from palms.geometry import FloatArray, lengths

LEFT_OUT_M = 12.0  # scans within this much path of the start
SPACING_M = 0.25  # ours: path between scans that are used; one log stands still a lot
RANGE_M = 12.0  # ours: farther returns smear, the poses' angles are not that good
DOOR_M = 1.0  # walls that the reference crosses become doors this wide
STUB_M = 0.1  # ours: shorter remains of a cut wall go with the door


@dataclass(frozen=True)
class Grade:
    """How far a plan is from the walls."""

    offset_m: float
    missing: float
    scale: float


GRADES = {
    "as-is": Grade(0.0, 0.0, 0.0),
    "10cm": Grade(0.10, 0.10, 0.0),
    "20cm": Grade(0.20, 0.15, 0.01),
}
SUITES = ("clean", "dirty")


def cache_folder() -> Path:
    """Return where fitted walls are kept: the user's cache."""
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "palms" / "radish"


def fitted_walls(log: Log, row: int, cache: Path | None) -> FloatArray:
    """Return walls (W, 2, 2) fitted to all scans but those near the row, cached."""
    if cache is None:
        return _fit(log, row)
    file = cache / f"{log.building}-{row}-{_version(log.building, log.pose.tobytes())}.npy"
    if file.is_file():
        walls: FloatArray = np.load(file)
        return walls
    walls = _fit(log, row)
    cache.mkdir(parents=True, exist_ok=True)
    part = file.with_suffix(f".{os.getpid()}.part")
    with part.open("wb") as stream:
        np.save(stream, walls)
    part.replace(file)
    return walls


@lru_cache
def _version(building: str, content: bytes) -> str:
    """Name what the walls depend on: the log and the source of the fitter."""
    sources = [Path(__file__).read_bytes(), Path(fitter.__file__).read_bytes()]
    return hashlib.sha256(b"".join([building.encode(), content, *sources])).hexdigest()[:16]


def _fit(log: Log, row: int) -> FloatArray:
    path = log.path_m
    bins = np.unique(np.floor(path / SPACING_M), return_index=True)[1]
    rows = bins[np.abs(path[bins] - path[row]) > LEFT_OUT_M]
    return fitter.fit_walls(*log.hits(rows, RANGE_M))


def degraded(walls: FloatArray, grade: Grade, rng: np.random.Generator) -> FloatArray:
    """Shift walls along their normals, drop some, and stretch the plan in one direction."""
    d = walls[:, 1] - walls[:, 0]
    normal = np.stack([-d[:, 1], d[:, 0]], axis=1) / lengths(walls)[:, None]
    shifted = walls + (rng.normal(0.0, grade.offset_m, len(walls))[:, None] * normal)[:, None]
    kept = shifted[rng.permutation(len(walls)) >= round(grade.missing * len(walls))]
    stretch = np.ones(2)
    stretch[rng.integers(2)] += grade.scale * rng.choice([-1, 1])
    centre = walls.reshape(-1, 2).mean(axis=0)
    return centre + (kept - centre) * stretch


def plan_for(
    log: Log, observation: int, walk: TrueWalk, grade: str, suite: str, cache: Path | None = None
) -> FloorPlan:
    """Return the plan of a case."""
    walls = fitted_walls(log, log.observations[observation].row, cache)
    seed = [BUILDINGS.index(log.building), observation, list(GRADES).index(grade)]
    walls = degraded(walls, GRADES[grade], np.random.default_rng(seed))
    classes = np.zeros(len(walls), np.uint8)
    path = np.concatenate([walk.start_m[None], walk.position_m])
    if suite == "clean":
        walls, classes = with_doors(walls, path)
    walls, classes = _on_sheet(walls, classes, path)
    return FloorPlan(walls, classes, name=log.building)


def _on_sheet(
    walls: FloatArray, classes: FloatArray, path_m: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Make sure that the drawing holds the path: the filters take its edge for a wall.

    Where left out or missing walls leave the path outside, an opening of a centimetre, which
    neither blocks nor matches, marks the corner of the sheet.
    """
    ends = walls.reshape(-1, 2)
    corners = np.stack([path_m.min(axis=0), path_m.max(axis=0)])
    needed = [(corners[0] < ends.min(axis=0)).any(), (corners[1] > ends.max(axis=0)).any()]
    marks = np.stack([corners, corners + 0.01], axis=1)[needed]
    openings = np.full(len(marks), SegmentClass.OPENING, np.uint8)
    return np.concatenate([walls, marks]), np.concatenate([classes, openings])


def with_doors(walls: FloatArray, path_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Cut a door of a metre into every wall where a path (P, 2) crosses it."""
    segments, classes = [], []
    for wall, at in zip(walls, _crossings(walls, path_m), strict=True):
        for piece, is_door in _cut(wall, at):
            segments.append(piece)
            classes.append(SegmentClass.DOOR if is_door else SegmentClass.WALL)
    return np.array(segments), np.array(classes, np.uint8)


def _crossings(walls: FloatArray, path_m: FloatArray) -> list[FloatArray]:
    """Metres along each wall at which the path crosses it."""
    a, d = walls[:, None, 0], walls[:, None, 1] - walls[:, None, 0]
    p, e = path_m[None, :-1], np.diff(path_m, axis=0)[None]
    cross = d[..., 0] * e[..., 1] - d[..., 1] * e[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        rel = p - a
        t = (rel[..., 0] * e[..., 1] - rel[..., 1] * e[..., 0]) / cross
        u = (rel[..., 0] * d[..., 1] - rel[..., 1] * d[..., 0]) / cross
    slack = 1e-6
    met = (t >= -slack) & (t <= 1 + slack) & (u >= -slack) & (u <= 1 + slack)
    return [t_w[met_w] * length for t_w, met_w, length in zip(t, met, lengths(walls), strict=True)]


def _cut(wall: FloatArray, at_m: FloatArray) -> list[tuple[FloatArray, bool]]:
    """Split a wall into pieces, each with whether it is a door."""
    length = float(np.linalg.norm(wall[1] - wall[0]))
    doors: list[list[float]] = []
    for s in np.sort(at_m):
        low, high = max(0.0, s - DOOR_M / 2), min(length, s + DOOR_M / 2)
        low, high = 0.0 if low < STUB_M else low, length if length - high < STUB_M else high
        if doors and low - doors[-1][1] < STUB_M:
            doors[-1][1] = high
        else:
            doors.append([low, high])
    edges = [0.0, *(edge for door in doors for edge in door), length]
    ends = [wall[0] + edge / length * (wall[1] - wall[0]) for edge in edges]
    pieces = [(np.stack(ends[i : i + 2]), i % 2 == 1) for i in range(len(ends) - 1)]
    return [(piece, door) for piece, door in pieces if np.linalg.norm(piece[1] - piece[0]) > 1e-9]
