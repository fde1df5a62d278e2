"""Times functions against a baseline in alternating runs; prints and writes the table."""

from __future__ import annotations

import platform
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from palms.io import write_json
from palms.io.files import make_folder

ROUNDS, FEWEST, MOST = 7, 3, 400
BUDGET_S = 1.2  # per case
TOO_LONG_S = 6.0  # a case of a few long rounds


@dataclass(frozen=True)
class Case:
    """One line of the table.

    `ours` is timed by the processor's clock, which counts only its own work, or by the wall's
    where processes are started; with a `unit` it returns the figure instead. `baseline` is
    another way to do the same work, run in turns with ours; `goal` is what we want on the
    reference machine (a core of about 3 GHz), None where there is none.
    """

    name: str
    ours: Callable[[], object]
    goal: float | None = None
    baseline: Callable[[], object] | None = None
    baseline_name: str = ""
    unit: str = "ms"
    clock: Callable[[], float] = time.process_time


@dataclass(frozen=True)
class Result:
    """What a case came to; `ratio` is how many times faster than the baseline."""

    name: str
    unit: str
    minimum: float
    median: float
    goal: float | None
    baseline: str = ""
    baseline_minimum: float | None = None

    @property
    def ratio(self) -> float | None:
        return None if self.baseline_minimum is None else self.baseline_minimum / self.minimum

    @property
    def met(self) -> str:
        if self.goal is None:
            return ""
        return "yes" if self.minimum <= self.goal else f"no, {self.minimum / self.goal:.2g} times"


def measure(case: Case) -> Result:
    """Run ours and the baseline in turns; the first run of each is not counted."""
    if case.unit != "ms":
        figure = float(case.ours())  # type: ignore[arg-type]
        return Result(case.name, case.unit, figure, figure, case.goal)
    functions = [case.ours] + ([case.baseline] if case.baseline else [])
    for function in functions:
        function()
    times: list[list[float]] = [[] for _ in functions]
    start = time.perf_counter()
    while not _enough(len(times[0]), time.perf_counter() - start):
        for k, function in enumerate(functions):
            times[k].append(timed_ms(function, case.clock))
    baseline = (case.baseline_name, min(times[1])) if case.baseline else ("", None)
    return Result(
        case.name, case.unit, min(times[0]), statistics.median(times[0]), case.goal, *baseline
    )


def _enough(rounds: int, spent_s: float) -> bool:
    if rounds < FEWEST:
        return False
    return rounds >= MOST or spent_s > (BUDGET_S if rounds >= ROUNDS else TOO_LONG_S)


def timed_ms(
    function: Callable[[], object], clock: Callable[[], float] = time.process_time
) -> float:
    """Time of one call."""
    start = clock()
    function()
    return 1e3 * (clock() - start)


def quickest_ms(function: Callable[[], object], budget_s: float = 0.4) -> float:
    """Minimum of a few calls after one that is not counted."""
    function()
    times, end = [timed_ms(function)], time.perf_counter() + budget_s
    while len(times) < FEWEST or (time.perf_counter() < end and len(times) < MOST):
        times.append(timed_ms(function))
    return min(times)


def table(results: Sequence[Result]) -> str:
    """The results as Markdown."""
    lines = [
        "| work | min | median | unit | goal | met | baseline | its min | ratio |",
        "|---|---:|---:|---|---:|---|---|---:|---:|",
    ]
    for r in results:
        goal = "" if r.goal is None else f"{r.goal:g}"
        other = "" if r.baseline_minimum is None else f"{r.baseline_minimum:.3g}"
        ratio = "" if r.ratio is None else f"{r.ratio:.2g}"
        lines.append(
            f"| {r.name} | {r.minimum:.3g} | {r.median:.3g} | {r.unit} | {goal} | {r.met} "
            f"| {r.baseline} | {other} | {ratio} |"
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


def write(results: Sequence[Result], curves: Sequence[object], path: Path) -> None:
    """Write results and curves as JSON."""
    rows = [r.__dict__ | {"ratio": r.ratio, "met": r.met} for r in results]
    make_folder(path.parent)
    write_json(path, {"machine": machine(), "results": rows, "curves": list(curves)})
