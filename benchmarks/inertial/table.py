"""The table: methods by the floor that was tuned on, the others, and all together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from benchmarks.inertial.measure import METHODS, TUNED_ON
from palms.evaluation.bootstrap import bootstrap_interval
from palms.evaluation.tables import markdown_table

Rows = Sequence[dict[str, Any]]
GROUPS: dict[str, Callable[[dict[str, Any]], bool]] = {
    f"{TUNED_ON} (tuned on)": lambda row: row["floor"] == TUNED_ON,
    "the others": lambda row: row["floor"] != TUNED_ON,
    "all": lambda _: True,
}


def markdown(rows: Rows) -> str:
    """Return the tables of errors and of steps."""
    return "\n\n".join([markdown_table(_errors(rows)), _steps(rows)])


def _errors(rows: Rows) -> list[list[str]]:
    heads = [f"end error %, {name}" for name in GROUPS]
    table = [["length, heading", "walks", *heads, "RMSE m", "metres found per metre"]]
    for method in dict.fromkeys(row["method"] for row in rows):
        chosen = [row for row in rows if row["method"] == method]
        ends = [_median([r for r in chosen if belongs(r)], "end_error", 100) for belongs in
                GROUPS.values()]  # fmt: skip
        others = [_median(chosen, "rmse_m", 1), _spread(chosen)]
        table.append([method, str(len(chosen)), *ends, *others])
    return table


def _median(rows: Rows, name: str, factor: float) -> str:
    if not rows:
        return "-"
    values = np.array([factor * row[name] for row in rows])
    return f"{bootstrap_interval(values, [row['walk'] for row in rows], 'median'):.1f}"


def _spread(rows: Rows) -> str:
    ratio = np.array([row["length_ratio"] for row in rows])
    return f"{ratio.mean():.2f} ± {ratio.std():.2f}"


def _steps(rows: Rows) -> str:
    """Say how the steps that were found compare with those that come with the data."""
    chosen = [row for row in rows if row["method"] == next(iter(METHODS))]
    known, both, new = (
        sum(row[name] for row in chosen) for name in ("steps_known", "steps_both", "steps_new")
    )
    return (
        f"Steps: of {known} in `steps.csv.gz` {both} are found, {100 * both / known:.1f} %, "
        f"and {new} besides."
    )
