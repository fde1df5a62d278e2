"""What scans, jumps, hints, levels and inertial odometry do: data sets, results and tables."""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.simulated.steps import bench_only, read
from benchmarks.simulated.studies import Happenings, Run
from benchmarks.simulated.tables import made_on
from palms.evaluation.bootstrap import bootstrap_difference, bootstrap_interval
from palms.evaluation.tables import HEADLINE, by_method, markdown_table, table_rows, units_of
from palms.io.files import read_text

BY_M = 25.0  # issue: a second scan after 20 m; declared rightly by 25 m
WITHIN_M = 30.0  # issue: found again within 30 m of walking
NEAR_M = 1.0  # issue: localized and within 1 m
MARKS = 3  # ours: in a row, two metres apart; the five steps are a little less
JUMP_M = 15.0  # ours: in the odometry's metres a jump of 20 m is the only move as long

Trial = Mapping[str, Any]
Figure = Callable[[Trial], float]
Trials = Mapping[str, Sequence[Trial]]


def run(plan: Happenings, work: Path, jobs: int) -> Iterator[str]:
    """Simulate and run what is missing; yield each name when it is done."""
    for name in plan.names:
        bench_only(plan.study(name), work, jobs)
        yield name


def table(plan: Happenings, work: Path) -> str:
    """Return the commands and the tables."""
    results = {name: read(plan.study(name), work) for name in plan.names}
    trials = {name: _with_series(plan.study(name).runs[0], work) for name in plan.names}
    parts = [
        _commands(plan), made_on(results["plain"]),
        "### Second scan, jump, hints", markdown_table(_lines(trials)),
        "### Three levels", markdown_table(table_rows(results["levels"]["trials"], HEADLINE)),
        "### Inertial odometry with unknown frame",
        markdown_table(table_rows(results["inertial"]["trials"], HEADLINE)),
    ]  # fmt: skip
    return "\n\n".join(parts)


def _commands(plan: Happenings) -> str:
    commands = dict.fromkeys(
        shlex.join(words) for name in plan.names for words in plan.study(name).commands()
    )
    return "\n".join(["```sh", *commands, "```"])


def read_series(folder: Path) -> list[Trial]:
    """Return the trials with what happened along them, which results.json leaves out."""
    return [json.loads(line) for line in read_text(folder / "trials.jsonl").splitlines()]


def _with_series(run: Run, work: Path) -> list[Trial]:
    """Return the trials of a run with their series, in the order of its methods."""
    rank = {method: k for k, method in enumerate(run.methods)}
    found = read_series(work / run.out)
    return sorted(found, key=lambda t: (rank[t["method"]], t["scene"], t["walk"]))


def right_by(metres: float) -> Figure:
    """Return whether a trial was declared rightly within so many metres."""

    def figure(trial: Trial) -> float:
        after = trial["right_after_m"]
        return float(after is not None and after <= metres)

    return figure


def right_after_m(trial: Trial) -> float:
    """Metres to a right declaration, the whole walk where there was none."""
    after = trial["right_after_m"]
    return float(trial["length_m"] if after is None else after)


def is_wrong(trial: Trial) -> float:
    """Whether the declaration was wrong."""
    return float(trial["wrong"])


def found_again(trial: Trial) -> float:
    """Whether it is localized and right again soon after the jump; NaN without a jump.

    Examples
    --------
    >>> walked = [58.0, 60.0, 80.5, 82.0, 84.0, 86.0, 88.0]
    >>> right = {"walked_m": walked, "error_m": [0.2, 0.2, 20.1, 0.3, 0.3, 0.2, 0.2]}
    >>> found_again({"series": {**right, "localized": [1, 1, 1, 1, 1, 1, 1]}})
    1.0
    >>> found_again({"series": {**right, "localized": [1, 1, 0, 0, 1, 0, 1]}})
    0.0
    """
    series = trial["series"]
    walked = np.array(series["walked_m"])
    jumps = np.flatnonzero(np.diff(walked) > JUMP_M)
    if not len(jumps):
        return math.nan
    first = int(jumps[0]) + 1
    error = [math.inf if each is None else each for each in series["error_m"][first:]]
    good = (np.array(error) <= NEAR_M) & (np.array(series["localized"][first:]) == 1)
    begins = np.flatnonzero(np.convolve(good, np.ones(MARKS), "valid") >= MARKS)
    within = walked[first:][begins] - walked[first] <= WITHIN_M
    return float(within.any())


def _lines(trials: Trials) -> list[list[str]]:
    methods = list(by_method(trials["plain"]))
    soon = right_by(BY_M)
    lines: list[tuple[str, str, Figure]] = [
        (f"declared rightly by {BY_M:.0f} m: one scan", "plain", soon),
        ("the same: a second scan after 20 m", "second-scan", soon),
        (f"a jump by 20 m: found again within {WITHIN_M:.0f} m", "jump", found_again),
        ("the same, with a new scan 5 m after it", "jump-and-scan", found_again),
        ("m to right declaration: no hint", "plain", right_after_m),
        ("the same: the right room", "right-room", right_after_m),
        ("the same: the right place within 5 m", "right-place", right_after_m),
        ("wrong: no hint", "plain", is_wrong),
        ("the same: a wrong room", "wrong-room", is_wrong),
        ("the same: a wrong place", "wrong-place", is_wrong),
    ]
    rows = [["", *methods, "change from the walks as they are, palms"]]
    for words, name, figure in lines:
        cells = [_cell(by_method(trials[name])[method], figure) for method in methods]
        rows.append([words, *cells, "" if name == "plain" else _change(trials, name, figure)])
    return rows


def _cell(trials: Sequence[Trial], figure: Figure) -> str:
    values = [figure(trial) for trial in trials]
    digits = 1 if figure is right_after_m else 3
    return f"{bootstrap_interval(values, units_of(trials)):.{digits}f}"


def _change(trials: Trials, name: str, figure: Figure) -> str:
    """Return what changes building by building; nothing where the plain walks have no figure."""
    first = next(iter(by_method(trials["plain"])))
    before, after = (by_method(trials[each])[first] for each in ("plain", name))
    values = [[figure(trial) for trial in each] for each in (before, after)]
    if np.isnan(values[0]).all():
        return ""
    digits = 1 if figure is right_after_m else 3
    change = bootstrap_difference(*values, units_of(before), units_of(after))
    return f"{change:+.{digits}f}"
