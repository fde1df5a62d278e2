"""Running: cases x methods x seeds in processes; the results do not depend on their number."""

from __future__ import annotations

import platform
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from typing import Any

from benchmarks.real.cases import Key, load_case, run_trial
from benchmarks.real.plans import GRADES, SUITES
from benchmarks.real.radish import ADDED_NOISE, BUILDINGS, starts
from palms import Settings
from palms.evaluation.experiment import finite
from palms.evaluation.oracle import ORACLE, oracle_settings
from palms.evaluation.provenance import machine, versions
from palms.settings import METHODS

KNOWN = (*METHODS, ORACLE)
ROWS = ("uniform", "uniform-ori", "paper", "authors", "no-scan", "palms", ORACLE)


@dataclass(frozen=True)
class Plan:
    """What to run."""

    methods: tuple[str, ...]
    buildings: tuple[str, ...] = BUILDINGS
    grades: tuple[str, ...] = tuple(GRADES)
    suites: tuple[str, ...] = SUITES
    purpose: str = "development"
    apart: str = "position"
    seeds: int = 10
    first_seed: int = 0

    def tasks(self) -> list[tuple[Key, str]]:
        """Return (case, method), in the order of the results."""
        cases = (
            Key(building, start, grade, suite)
            for suite, grade, building in product(self.suites, self.grades, self.buildings)
            for start in starts(building, self.purpose, self.apart)
        )
        return list(product(cases, self.methods))


def run(plan: Plan, cache: Path | None, jobs: int) -> Iterator[list[dict[str, Any]]]:
    """Yield the trials of each task, in order."""
    tasks = plan.tasks()
    seeds = range(plan.first_seed, plan.first_seed + plan.seeds)
    arguments = [(key, method, seeds, cache) for key, method in tasks]
    if jobs == 1:
        yield from map(_run_task, arguments)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(_run_task, arguments, chunksize=len(plan.methods))


def _run_task(task: tuple[Key, str, Sequence[int], Path | None]) -> list[dict[str, Any]]:
    key, method, seeds, cache = task
    settings = settings_of(method)
    case = load_case(key, cache, settings.raster)
    return [run_trial(case, method, settings, seed) for seed in seeds]


def settings_of(method: str) -> Settings:
    """Return the settings of a method; the oracle knows the noise that is added to walks."""
    return oracle_settings(ADDED_NOISE) if method == ORACLE else Settings.for_method(method)


def as_json(plan: Plan) -> dict[str, Any]:
    """Return the results in the schema palms-bench/1, without trials yet.

    Call it before the run: it holds a digest of the source, which may change meanwhile.
    """
    return {
        "schema": "palms-bench/1",
        "settings": {
            "benchmark": "radish",
            **asdict(plan),
            "methods": {name: finite(asdict(settings_of(name))) for name in plan.methods},
        },
        "versions": {"python": platform.python_version(), **versions()},
        "machine": machine(),
    }
