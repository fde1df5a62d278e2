"""Tables of an experiment: methods as rows, headline figures and the paper's four columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from palms.evaluation.bootstrap import Interval, aggregate

__all__ = [
    "HEADLINE",
    "LEGEND",
    "PAPER",
    "Column",
    "by_method",
    "experiment_markdown",
    "markdown_table",
    "table_rows",
    "units_of",
]

Rows = Sequence[Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class Column:
    """One figure of a table.

    Parameters
    ----------
    heading : str
    figure : str
        Name in what `aggregate` returns; with the suffix ``.n`` the number of trials for
        which it is defined.
    factor : float
        100 for percent.
    digits : int
    """

    heading: str
    figure: str
    factor: float = 1.0
    digits: int = 2

    def cell(self, figures: Mapping[str, Interval]) -> str:
        """Return the figure with its interval."""
        if self.figure.endswith(".n"):
            return str(figures[self.figure[:-2]].n)
        interval = figures[self.figure]
        value, low, high = (self.factor * v for v in (interval.value, interval.low, interval.high))
        scaled = Interval(value, low, high, interval.n, interval.units)
        return f"{scaled:.{self.digits}f}"


HEADLINE = (
    Column("false_localized", "false_localized"),
    Column("m to right declaration", "right_after_m_full", 1, 0),
    Column("declared %", "declared", 100, 0),
    Column("wrong % of all", "wrong", 100, 0),
    Column("wrong % of declared", "wrong_of_declared", 100, 0),
    Column("useful", "useful"),
    Column("right_place", "right_place"),
    Column("within_1m_after", "within_1m_after"),
    Column("median m to declaration", "declared_after_m_full_median", 1, 0),
)
PAPER = (
    Column("time s", "paper_time_s", 1, 1),
    Column("distance m", "paper_distance_m", 1, 1),
    Column("RMSE m", "paper_rmse_m"),
    Column("within 1 m %", "paper_within_1m", 100, 0),
    Column("trials", "paper_time_s.n"),
)
LEGEND = (
    "Brackets: 95 % intervals by bootstrap over {units}. Metres to a (right) declaration count "
    "a trial that never came to one at the walk's full length; false_localized is over the "
    "metres walked while localized, useful and right_place over all metres. The paper's columns "
    "are over the trials that declared, with their number."
)


def table_rows(trials: Rows, columns: Sequence[Column]) -> list[list[str]]:
    """Return a heading row and a row for each method, in the order they come.

    Parameters
    ----------
    trials : sequence of mapping
        Records with scene, walk, method and the metrics by name.
    columns : sequence of Column
    """
    rows = [["method", "walks", *(column.heading for column in columns)]]
    names = {column.figure.removesuffix(".n") for column in columns}
    for method, chosen in by_method(trials).items():
        figures = aggregate(chosen, units_of(chosen), names)
        walks = {(t["scene"], t["walk"]) for t in chosen}
        rows.append([method, str(len(walks)), *(column.cell(figures) for column in columns)])
    return rows


def by_method(trials: Rows) -> dict[str, list[Mapping[str, Any]]]:
    """Return the trials of each method, in the order they come.

    Examples
    --------
    >>> list(by_method([{"method": "paper"}, {"method": "uniform"}, {"method": "paper"}]))
    ['paper', 'uniform']
    """
    found: dict[str, list[Mapping[str, Any]]] = {}
    for trial in trials:
        found.setdefault(trial["method"], []).append(trial)
    return found


def units_of(trials: Rows) -> list[tuple[str, ...]]:
    """Return what is resampled: the building of each trial, or its walk when there is only one.

    Examples
    --------
    >>> units_of([{"scene": "E2", "walk": "w1"}, {"scene": "E2", "walk": "w2"}])
    [('E2', 'w1'), ('E2', 'w2')]
    """
    if len({t["scene"] for t in trials}) > 1:
        return [(t["scene"],) for t in trials]
    return [(t["scene"], t["walk"]) for t in trials]


def markdown_table(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as a Markdown table.

    Examples
    --------
    >>> print(markdown_table([["method", "useful"], ["paper", "0.45"]]))
    | method | useful |
    | --- | --- |
    | paper | 0.45 |
    """
    head, *body = rows
    lines = [head, ["---"] * len(head), *body]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def experiment_markdown(trials: Rows, heading: str) -> str:
    """Return the tables of an experiment: all scenes together, then each by itself."""
    scenes = list(dict.fromkeys(t["scene"] for t in trials))
    units = "buildings" if len(scenes) > 1 else "walks"
    parts = [f"# {heading}", LEGEND.format(units=units)]
    for scene in [None, *scenes] if len(scenes) > 1 else scenes:
        chosen = [t for t in trials if scene in (None, t["scene"])]
        parts += [
            f"## {scene or 'All buildings'}",
            markdown_table(table_rows(chosen, HEADLINE)),
            "The paper's columns:",
            markdown_table(table_rows(chosen, PAPER)),
        ]
    return "\n\n".join(parts) + "\n"
