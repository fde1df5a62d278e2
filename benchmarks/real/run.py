"""Running: cases x methods x seeds in processes; the results do not depend on their number."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from importlib.metadata import version
from itertools import product
from pathlib import Path
from typing import Any

import palms
from benchmarks.real.cases import Key, load_case, run_trial
from benchmarks.real.plans import GRADES, SUITES
from benchmarks.real.radish import BUILDINGS, starts
from palms import Settings


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
    settings = Settings.for_method(method)
    case = load_case(key, cache, settings.raster)
    return [run_trial(case, method, settings, seed) for seed in seeds]


def as_json(plan: Plan, trials: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the results in the schema palms-bench/1."""
    packages = ("palms-localization", "numpy", "scipy", "numba")
    return {
        "schema": "palms-bench/1",
        "trials": trials,
        "settings": {
            "benchmark": "radish",
            **asdict(plan),
            "methods": {name: _finite(asdict(Settings.for_method(name))) for name in plan.methods},
        },
        "versions": {
            "python": platform.python_version(),
            **{package: version(package) for package in packages},
            "source": _source(),
        },
    }


def _source() -> str:
    """Digest of the method's source: results of different ones are not to be mixed."""
    root = Path(palms.__file__).parent
    files = sorted([*root.glob("*.py"), *root.glob("_compiled/*.py")])
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:16]


def _finite(value: Any) -> Any:
    """Infinity is no number of JSON: it becomes a word."""
    if isinstance(value, dict):
        return {name: _finite(item) for name, item in value.items()}
    return (
        str(value) if isinstance(value, float) and value in (float("inf"), -float("inf")) else value
    )
