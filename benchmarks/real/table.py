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


def _sections(trials: Rows) -> list[str]:
    buildings = _names(trials, "scene")
    parts = []
    for building in [None, *buildings] if len(buildings) > 1 else buildings:
        chosen = [t for t in trials if building in (None, t["scene"])]
        parts += [
            f"### {building or 'all buildings'}",
            markdown_table(table_rows(chosen, HEADLINE)),
            "The paper's columns:",
            markdown_table(table_rows(chosen, PAPER)),
        ]
    return parts


def _names(trials: Rows, key: str) -> list[str]:
    return list(dict.fromkeys(t[key] for t in trials))
