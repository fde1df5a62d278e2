"""Times functions against a baseline in alternating runs; prints and writes the table."""

from __future__ import annotations

import json
import platform
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ROUNDS = 7
BUDGET_S = 1.5  # per case


@dataclass(frozen=True)
class Case:
    """One line of the table.

    `baseline` is another way to do the same work, run in turns with ours; `goal_ms` is what
    we want on the reference machine (a core of about 3 GHz), None where there is no goal.
    """

    name: str
    ours: Callable[[], object]
    goal_ms: float | None = None
    baseline: Callable[[], object] | None = None
    baseline_name: str = ""


@dataclass(frozen=True)
class Result:
    name: str
    min_ms: float
    median_ms: float
    goal_ms: float | None
    baseline_name: str
    baseline_min_ms: float | None

    @property
    def verdict(self) -> str:
        if self.goal_ms is None:
            return ""
        return "yes" if self.min_ms <= self.goal_ms else "no"


def measure(case: Case) -> Result:
    """Run ours and the baseline in turns; the first run of each is not counted."""
    functions = [case.ours] + ([case.baseline] if case.baseline else [])
    times: list[list[float]] = [[] for _ in functions]
    for function in functions:
        function()
    end = time.perf_counter() + BUDGET_S
    while len(times[0]) < ROUNDS or time.perf_counter() < end:
        for k, function in enumerate(functions):
            start = time.perf_counter()
            function()
            times[k].append(1e3 * (time.perf_counter() - start))
        if len(times[0]) >= 400 or (len(times[0]) >= ROUNDS and time.perf_counter() > end):
            break
    other = min(times[1]) if case.baseline else None
    return Result(
        case.name,
        min(times[0]),
        statistics.median(times[0]),
        case.goal_ms,
        case.baseline_name,
        other,
    )


def table(results: list[Result]) -> str:
    """The results as Markdown."""
    lines = [
        "| work | min ms | median ms | goal ms | met | baseline | its min ms | ratio |",
        "|---|---:|---:|---:|---|---|---:|---:|",
    ]
    for r in results:
        other = "" if r.baseline_min_ms is None else f"{r.baseline_min_ms:.3g}"
        ratio = "" if r.baseline_min_ms is None else f"{r.baseline_min_ms / r.min_ms:.1f}"
        goal = "" if r.goal_ms is None else f"{r.goal_ms:g}"
        lines.append(
            f"| {r.name} | {r.min_ms:.3g} | {r.median_ms:.3g} | {goal} | {r.verdict} "
            f"| {r.baseline_name} | {other} | {ratio} |"
        )
    return "\n".join(lines)


def machine() -> dict[str, str]:
    """What the figures depend on."""
    from importlib.metadata import version

    cpu = platform.processor() or "unknown"
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line for line in info.read_text().splitlines() if "model name" in line]
        cpu = names[0].split(":")[1].strip() if names else cpu
    packages = {name: version(name) for name in ("numpy", "scipy", "numba")}
    return {"cpu": cpu, "python": platform.python_version(), **packages}


def machine_words() -> str:
    """The same in a line."""
    return ", ".join(f"{name} {value}" for name, value in machine().items())


def write(results: list[Result], path: Path) -> None:
    """Write the results as JSON."""
    rows = [r.__dict__ | {"met": r.verdict} for r in results]
    path.write_text(json.dumps({"machine": machine(), "results": rows}, indent=1) + "\n")
