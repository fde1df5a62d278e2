"""The table: for each suite and grade all buildings together, then each by itself."""

from __future__ import annotations

from palms.evaluation.tables import HEADLINE, LEGEND, PAPER, Rows, markdown_table, table_rows


def markdown(trials: Rows, heading: str) -> str:
    """Return the whole table."""
    legend = LEGEND.format(units="starts, in the tables of all buildings over buildings")
    parts = [f"# {heading}", legend]
    for suite in _names(trials, "suite"):
        for grade in _names(trials, "grade"):
            chosen = [t for t in trials if t["suite"] == suite and t["grade"] == grade]
            if chosen:
                parts += [f"## {suite}, plan {grade}", *_sections(chosen)]
    return "\n\n".join(parts) + "\n"


def digest(trials: Rows) -> str:
    """Return what the results page shows: all buildings for each grade, and each building once."""
    parts = []
    for suite in _names(trials, "suite"):
        for grade in _names(trials, "grade"):
            chosen = [t for t in trials if t["suite"] == suite and t["grade"] == grade]
            parts += [f"### All buildings, {suite}, plan {grade}", *_pair(chosen)]
    first = [t for t in trials if t["suite"] == trials[0]["suite"]]
    first = [t for t in first if t["grade"] == first[0]["grade"]]
    for building in _names(trials, "scene"):
        chosen = [t for t in first if t["scene"] == building]
        heading = f"### {building}, {first[0]['suite']}, plan {first[0]['grade']}"
        parts += [heading, markdown_table(table_rows(chosen, HEADLINE))]
    return "\n\n".join(parts)


def _pair(trials: Rows) -> list[str]:
    return [
        markdown_table(table_rows(trials, HEADLINE)),
        "The paper's columns:",
        markdown_table(table_rows(trials, PAPER)),
    ]


def _sections(trials: Rows) -> list[str]:
    buildings = _names(trials, "scene")
    parts = []
    for building in [None, *buildings] if len(buildings) > 1 else buildings:
        chosen = [t for t in trials if building in (None, t["scene"])]
        parts += [f"### {building or 'all buildings'}", *_pair(chosen)]
    return parts


def _names(trials: Rows, key: str) -> list[str]:
    return list(dict.fromkeys(t[key] for t in trials))
