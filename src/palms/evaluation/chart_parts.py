"""What the charts of an experiment share: a style for each method, panels and axes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from palms.evaluation.bootstrap import Interval
from palms.plot.style import ANSWER, INK, MUTED, TRUTH, Dashes, new_figure

_GRID: Final = "#e3e3e3"
_COLUMNS: Final = 3  # small pictures side by side


class MethodStyle(NamedTuple):
    """How a method is drawn in every chart."""

    colour: str
    dashes: Dashes
    marker: str


STYLES: Final = {
    "palms": MethodStyle(ANSWER, "solid", "o"),
    "paper": MethodStyle("#4aa3df", (0, (6, 1.6)), "s"),
    "authors": MethodStyle("#b0508c", (0, (7, 1.6, 1.4, 1.6)), "D"),
    "uniform": MethodStyle("#a8a8a8", (0, (1, 1.4)), "^"),
    "uniform-ori": MethodStyle("#8a5a00", (0, (2.6, 1.4)), "v"),
    "no-scan": MethodStyle(TRUTH, (0, (7, 1.4, 1.4, 1.4, 1.4, 1.4)), "P"),
    "oracle": MethodStyle(INK, (0, (4, 1, 1, 1)), "X"),
}
_OTHER: Final = MethodStyle(MUTED, "solid", "h")


def style_of(method: str) -> MethodStyle:
    """Return the style of a method."""
    return STYLES.get(method, _OTHER)


def error_bars(interval: Interval) -> Any:  # noqa: ANN401 - as errorbar wants them
    """Return an interval's arms as errorbar wants them; None without any."""
    if math.isnan(interval.low):
        return None
    return [
        [max(0.0, interval.value - interval.low)], [max(0.0, interval.high - interval.value)]
    ]  # fmt: skip


def panels_for(n: int, height_in: float) -> tuple[Figure, list[Axes]]:
    """Return small pictures side by side, as many as there are methods."""
    columns = 2 if n == 4 else min(_COLUMNS, max(1, n))
    rows = max(1, math.ceil(n / columns))
    figure = new_figure(3.0 * columns + 0.6, height_in * rows + 0.4)
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    panels = list(grid.ravel())
    for empty in panels[n:]:
        empty.remove()
    return figure, panels[:n]


def mark_vertical(axes: Axes, at: float, word: str) -> None:
    """Mark a place on the x axis with a word."""
    axes.axvline(at, color=MUTED, linewidth=0.8, linestyle=(0, (4, 1.6)), zorder=1)
    axes.annotate(
        word, (at, 0.0), xycoords=("data", "axes fraction"), xytext=(2, 3),
        textcoords="offset points", fontsize=7.5, color=MUTED,
    )  # fmt: skip


def as_shares(axes: Axes) -> None:
    """Let the y axis run from 0 to 100 %."""
    axes.set_ylim(0.0, 1.0)
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    tidy(axes)


def name_rows(axes: Axes, names: Sequence[str]) -> None:
    """Name the rows of a chart of bars or dots."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    tidy(axes)
    axes.grid(visible=False, axis="y")
    axes.grid(axis="x", color=_GRID, linewidth=0.6)


def tidy(axes: Axes) -> None:
    """Take away what is no data."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", color=_GRID, linewidth=0.6)
    axes.set_axisbelow(True)


def add_legend(figure: Figure, axes: Axes) -> None:
    """Put the legend beneath the figure."""
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside lower center", ncols=5, handlelength=3.2)
