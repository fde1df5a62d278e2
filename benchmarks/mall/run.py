"""Running: walks x frames x methods in processes; the results do not depend on their number."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

from benchmarks.mall.cases import FRAMES, Frame, load_case, run_trials
from benchmarks.mall.walks import FLOORS, read_walks
from benchmarks.real.run import as_json as real_as_json
from palms import Settings

Task = tuple[str, int, Frame, str, int]  # floor, walk, frame, method, seeds


@dataclass(frozen=True)
class Plan:
    """What to run; walks is how many of each floor, None for all."""

    methods: tuple[str, ...]
    floors: tuple[str, ...] = FLOORS
    frames: tuple[Frame, ...] = FRAMES
    seeds: int = 10
    walks: int | None = None

    def tasks(self) -> list[Task]:
        """Return what is to be done, in the order of the results.

        Methods that start everywhere read no scan: in a frame of its own nothing changes for
        them, so they run only once.
        """
        recorded = read_walks()
        return [
            (floor, index, frame, method, self.seeds)
            for floor in self.floors
            for index in range(len(recorded[floor][: self.walks]))
            for frame in self.frames
            for method in self.methods
            if frame == "scan" or Settings.for_method(method).start.by_scan
        ]


def run(plan: Plan, jobs: int) -> Iterator[list[dict[str, Any]]]:
    """Yield the trials of each task, in order."""
    if jobs == 1:
        yield from map(_run_task, plan.tasks())
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(_run_task, plan.tasks(), chunksize=len(plan.methods))


def _run_task(task: Task) -> list[dict[str, Any]]:
    floor, index, frame, method, seeds = task
    case = load_case(floor, index, frame, Settings.for_method(method).raster)
    return list(run_trials(case, method, range(seeds)))


def as_json(plan: Plan) -> dict[str, Any]:
    """Return the results in the schema palms-bench/1, without trials yet.

    Call it before the run: it holds a digest of the source, which may change meanwhile.
    """
    content = real_as_json(plan)
    content["settings"]["benchmark"] = "mall"
    return content
