"""The table: one for each suite and grade, methods as rows, buildings one below the other."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from palms.evaluation.bootstrap import Interval, aggregate

ALL = "all"

# heading, figure, factor, digits
COLUMNS = (
    ("declared %", "declared", 100, 0),
    ("wrong % of all", "wrong", 100, 0),
    ("wrong % of declared", "wrong_of_declared", 100, 0),
    ("false_localized", "false_localized", 1, 2),
    ("useful", "useful", 1, 2),
    ("right_place", "right_place", 1, 2),
    ("within_1m_after", "within_1m_after", 1, 2),
    ("median m to declaration", "declared_after_m_full_median", 1, 0),
    ("m to right declaration", "right_after_m_full", 1, 0),
    ("paper: time s", "paper_time_s", 1, 1),
    ("distance m", "paper_distance_m", 1, 1),
    ("RMSE m", "paper_rmse_m", 1, 2),
    ("within 1 m", "paper_within_1m", 1, 2),
    ("of trials", None, 1, 0),
)

Rows = Sequence[Mapping[str, Any]]


def markdown(trials: Rows, heading: str) -> str:
    """Return the whole table."""
    parts = [f"# {heading}", _LEGEND]
    for suite in _names(trials, "suite"):
        for grade in _names(trials, "grade"):
            chosen = [t for t in trials if t["suite"] == suite and t["grade"] == grade]
            if chosen:
                parts += [f"## {suite}, plan {grade}", _section(chosen)]
    return "\n\n".join(parts) + "\n"


_LEGEND = """Brackets: 95 % intervals by bootstrap over starts; in the rows of all buildings over
buildings. Declaration metres count a trial that never declared (rightly) at the walk's full
length. The last columns are the paper's, over the trials that declared, with their number."""


def _section(trials: Rows) -> str:
    head = ["building", "method", "starts", *(heading for heading, *_ in COLUMNS)]
    lines = [head, ["---"] * len(head)]
    buildings = _names(trials, "scene")
    for building in [ALL, *buildings] if len(buildings) > 1 else buildings:
        for method in _names(trials, "method"):
            chosen = [t for t in trials if t["method"] == method]
            if building != ALL:
                chosen = [t for t in chosen if t["scene"] == building]
            if chosen:
                lines.append([building, method, *_cells(chosen, building == ALL)])
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _cells(trials: Rows, over_buildings: bool) -> list[str]:
    starts = [(t["scene"], t["walk"]) for t in trials]
    figures = aggregate(trials, [t["scene"] for t in trials] if over_buildings else starts)
    cells = [str(len(set(starts)))]
    for _, name, factor, digits in COLUMNS:
        if name is None:
            cells.append(str(figures["paper_time_s"].n))
        else:
            cells.append(f"{_scaled(figures[name], factor):.{digits}f}")
    return cells


def _scaled(interval: Interval, factor: float) -> Interval:
    value, low, high = (factor * v for v in (interval.value, interval.low, interval.high))
    return Interval(value, low, high, interval.n, interval.units)


def _names(trials: Rows, key: str) -> Iterable[str]:
    return list(dict.fromkeys(t[key] for t in trials))
