"""The tables: walks that cross no wall, the rest beside them; for each frame of the walk."""

from __future__ import annotations

import numpy as np

from palms.evaluation.bootstrap import Interval, bootstrap_interval
from palms.evaluation.metrics import WRONG_M
from palms.evaluation.tables import (
    HEADLINE,
    LEGEND,
    PAPER,
    Rows,
    by_method,
    markdown_table,
    table_rows,
    units_of,
)

AT_WAYPOINTS = ("localized % at waypoints", "within 2 m %", "median m off")
CROSSING = {False: "Walks that cross no wall", True: "Walks that cross walls"}
FRAME = {"scan": "in the scan's frame", "own": "in a frame of their own"}


def markdown(trials: Rows, heading: str) -> str:
    """Return the whole table: the digest, then each floor by itself."""
    parts = [f"# {heading}", LEGEND.format(units="walks"), digest(trials)]
    for floor in dict.fromkeys(t["floor"] for t in trials):
        chosen = [t for t in trials if t["floor"] == floor]
        parts += [f"## {floor}", digest(chosen)]
    return "\n\n".join(parts) + "\n"


def digest(trials: Rows) -> str:
    """Return what the results page shows: all floors together."""
    parts = []
    for crosses, words in CROSSING.items():
        for frame, where in FRAME.items():
            chosen = [t for t in trials if (t["crosses"], t["frame"]) == (crosses, frame)]
            if chosen:
                parts += [f"### {words}, {where}", *_tables(chosen)]
    return "\n\n".join(parts)


def _tables(trials: Rows) -> list[str]:
    return [
        markdown_table(table_rows(trials, HEADLINE)),
        "At the waypoints alone, and the paper's columns:",
        markdown_table(_with_waypoints(trials)),
    ]


def _with_waypoints(trials: Rows) -> list[list[str]]:
    head, *body = table_rows(trials, PAPER)
    rows = [[*head[:2], *AT_WAYPOINTS, *head[2:]]]
    for line, chosen in zip(body, by_method(trials).values(), strict=True):
        shares = [f"{_percent(interval):.0f}" for interval in waypoint_shares(chosen)]
        rows.append([*line[:2], *shares, f"{waypoint_median(chosen):.1f}", *line[2:]])
    return rows


def waypoint_shares(trials: Rows) -> tuple[Interval, Interval]:
    """Share of all waypoints at which it was localized, and of these within 2 m.

    Waypoints of all trials together, with intervals over walks.
    """
    error, units = _pooled(trials)
    known = ~np.isnan(error)
    near = np.where(known, error <= WRONG_M, np.nan)
    return bootstrap_interval(known, units), bootstrap_interval(near, units)


def waypoint_median(trials: Rows) -> Interval:
    """Median error over the waypoints at which it was localized, with intervals over walks."""
    return bootstrap_interval(*_pooled(trials), "median")


def _pooled(trials: Rows) -> tuple[np.ndarray, list[tuple[str, ...]]]:
    """Errors at the waypoints of all trials, NaN where not localized, and the walk of each."""
    walks = units_of(trials)
    errors = [np.array(t["waypoint_error_m"], dtype=np.float64) for t in trials]
    units = [walk for walk, error in zip(walks, errors, strict=True) for _ in error]
    return np.concatenate(errors), units


def _percent(interval: Interval) -> Interval:
    value, low, high = (100 * v for v in (interval.value, interval.low, interval.high))
    return Interval(value, low, high, interval.n, interval.units)
