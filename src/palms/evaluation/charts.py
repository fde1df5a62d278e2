"""The figures of an experiment's report: curves, reliability, coverage, effects.

Methods keep colour, stroke and marker in all figures; each is told by the last two alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter, StrMethodFormatter

from palms.evaluation.bootstrap import Interval, aggregate
from palms.evaluation.curves import (
    THRESHOLDS,
    ErrorCdf,
    Records,
    error_cdf,
    localized_shares,
    pooled_errors,
    sampled_reliability,
    threshold_sweep,
)
from palms.evaluation.metrics import NEAR_M, WRONG_M
from palms.evaluation.sensitivity import FIGURES, Effect
from palms.evaluation.tables import units_of
from palms.plot.style import ANSWER, INK, MUTED, TRUTH, Dashes, new_figure, styled

__all__ = [
    "cdf_figure",
    "coverage_figure",
    "effects_figure",
    "reliability_figure",
    "shares_figure",
    "sweep_figure",
]

ByMethod = Mapping[str, Records]

_GRID: Final = "#e3e3e3"
_COLUMNS: Final = 3  # small pictures side by side
_SMALLEST_M: Final = 0.05  # errors are drawn on a scale that begins here
_NAMED: Final = (0.5, 0.8, 0.95)  # thresholds with a word
_WORDS: Final = {
    "false_localized": "false_localized (less is better)",
    "useful": "useful (more is better)",
}


class _Style(NamedTuple):
    colour: str
    dashes: Dashes
    marker: str


_STYLES: Final = {
    "palms": _Style(ANSWER, "solid", "o"),
    "paper": _Style("#4aa3df", (0, (6, 1.6)), "s"),
    "authors": _Style("#b0508c", (0, (7, 1.6, 1.4, 1.6)), "D"),
    "uniform": _Style("#a8a8a8", (0, (1, 1.4)), "^"),
    "uniform-ori": _Style("#8a5a00", (0, (2.6, 1.4)), "v"),
    "no-scan": _Style(TRUTH, (0, (7, 1.4, 1.4, 1.4, 1.4, 1.4)), "P"),
    "oracle": _Style(INK, (0, (4, 1, 1, 1)), "X"),
}
_OTHER: Final = _Style(MUTED, "solid", "h")


def _style(method: str) -> _Style:
    return _STYLES.get(method, _OTHER)


@styled
def cdf_figure(records: ByMethod) -> Figure:
    """Draw how large errors are: while localized, and over the whole walks.

    Parameters
    ----------
    records : mapping of str to sequence of mapping
        Records of each method.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> len(cdf_figure({}).axes)
    2
    """
    figure = new_figure(9.0, 3.9)
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, only, title in (
        (left, True, "While it says that it is localized"),
        (right, False, "Over the whole walk"),
    ):
        largest = 10.0
        for i, (method, chosen) in enumerate(records.items()):
            cdf = error_cdf(*pooled_errors(chosen, only))
            largest = max([largest, *cdf.error_m[-1:]])
            _cdf_line(axes, cdf, i, method)
        axes.set_xscale("log")
        axes.set_xlim(_SMALLEST_M, largest)
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.set_xlabel("error in m")
        axes.set_title(title)
        for limit, word in ((NEAR_M, "1 m"), (WRONG_M, "2 m")):
            _vertical(axes, limit, word)
        _shares_axis(axes)
    left.set_ylabel("share of metres walked")
    _legend(figure, left)
    return figure


def _cdf_line(axes: Axes, cdf: ErrorCdf, order: int, method: str) -> None:
    """Draw one line: those drawn later are thinner, so that none hides another."""
    style, width = _style(method), max(1.3, 3.4 - 0.6 * order)
    look: dict[str, Any] = {"color": style.colour, "markersize": 5, "markeredgecolor": "white"}
    axes.plot(
        [], [], linestyle=style.dashes, linewidth=width, marker=style.marker, label=method, **look
    )  # fmt: skip
    if not len(cdf.error_m):
        return
    axes.step(
        [_SMALLEST_M / 2, *cdf.error_m], [0.0, *cdf.share], where="post", color=style.colour,
        linestyle=style.dashes, linewidth=width,
    )  # fmt: skip
    at = (np.arange(5) + 0.4 + 0.1 * order) / 5 * cdf.share[-1]
    marks = np.minimum(np.searchsorted(cdf.share, at), len(cdf.share) - 1)
    axes.plot(
        cdf.error_m[marks], cdf.share[marks], linestyle="none", marker=style.marker, zorder=4,
        markeredgewidth=0.5, **look,
    )  # fmt: skip


@styled
def shares_figure(records: ByMethod) -> Figure:
    """Draw how many trials are localized, rightly or wrongly, after so many metres.

    Parameters
    ----------
    records : mapping of str to sequence of mapping

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> series = {"walked_m": [2.0, 4.0], "error_m": [9.0, 0.5], "localized": [0, 1],
    ...           "p2": [0.1, 0.9]}
    >>> shares_figure({"paper": [{"series": series}]}).axes[0].get_title(loc="left")
    'paper'
    """
    figure, panels = _panels(len(records), 2.5)
    for (method, chosen), axes in zip(records.items(), panels, strict=True):
        shares = localized_shares(chosen)
        axes.fill_between(
            shares.walked_m, 0.0, shares.right, color=TRUTH, linewidth=0, label="rightly",
        )  # fmt: skip
        axes.fill_between(
            shares.walked_m, shares.right, shares.localized, facecolor="#f6d5d2",
            edgecolor=ANSWER, hatch="////", linewidth=0.6, label="wrongly (more than 2 m off)",
        )  # fmt: skip
        axes.set_title(method)
        axes.set_xlim(0.0, max(float(shares.walked_m[-1]), 1.0))
        axes.set_xlabel("metres walked")
        _shares_axis(axes)
    if panels:
        figure.supylabel("trials localized", fontsize=9)
        _legend(figure, panels[0])
    return figure


@styled
def sweep_figure(records: ByMethod) -> Figure:
    """Draw the headline's pair as the threshold on `p_within_2m` moves.

    Parameters
    ----------
    records : mapping of str to sequence of mapping

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> sweep_figure({}).axes[0].get_xlabel()
    'false_localized'
    """
    figure = new_figure(7.6, 4.6)
    axes = figure.add_subplot()
    for i, (method, chosen) in enumerate(records.items()):
        style, sweep = _style(method), threshold_sweep(chosen)
        axes.plot(
            sweep.false_localized, sweep.right_after_m, color=style.colour,
            linestyle=style.dashes, linewidth=max(1.2, 3.0 - 0.6 * i), marker=style.marker,
            markersize=4, markevery=[THRESHOLDS.index(t) for t in _NAMED], label=method,
        )  # fmt: skip
        for threshold in _NAMED:
            at = THRESHOLDS.index(threshold)
            axes.annotate(
                f"{threshold:g}", (sweep.false_localized[at], sweep.right_after_m[at]),
                xytext=(4, 3), textcoords="offset points", fontsize=6.5, color=MUTED,
            )  # fmt: skip
        _own_rule(axes, chosen, style)
    axes.set_xlim(-0.02, 1.02)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("false_localized")
    axes.set_ylabel("metres to a right declaration")
    _tidy(axes)
    _legend(figure, axes)
    return figure


def _own_rule(axes: Axes, chosen: Records, style: _Style) -> None:
    """Mark what the method's own rule leads to, with the intervals of both."""
    names = ("false_localized", "right_after_m_full")
    figures = aggregate(chosen, units_of(chosen), names)
    x, y = (figures[name] for name in names)
    if math.isnan(x.value):
        return
    axes.errorbar(
        x.value, y.value, xerr=_ends(x), yerr=_ends(y), fmt=style.marker, markersize=9,
        color=style.colour, markeredgecolor=INK, markeredgewidth=1.0, elinewidth=0.8, zorder=5,
    )  # fmt: skip


@styled
def reliability_figure(records: ByMethod) -> Figure:
    """Draw whether stated probabilities come true as often as they say.

    Parameters
    ----------
    records : mapping of str to sequence of mapping
        With one random step each: see `curves.sampled_reliability`.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> record = {"scene": "E2", "walk": "w1", "sampled_p_within_1m": 0.95,
    ...           "sampled_within_1m": True}
    >>> reliability_figure({"paper": [record]}).axes[0].get_title(loc="left")
    'paper: Brier 0.003'
    """
    figure, panels = _panels(len(records), 2.9)
    for (method, chosen), axes in zip(records.items(), panels, strict=True):
        found = sampled_reliability(chosen)
        axes.plot([0, 1], [0, 1], color=MUTED, linewidth=0.9, linestyle=(0, (1, 1.6)))
        if found is not None:
            axes.set_title(f"{method}: Brier {found.brier.value:.3f}")
            n = np.array([interval.n for interval in found.came_true])
            bins = np.arange(len(n)) / len(n)
            axes.bar(
                bins, 0.3 * n / n.sum(), 1 / len(n), align="edge", color="#dcdcdc",
                edgecolor="white",
            )  # fmt: skip
            _reliability_points(axes, found.stated, found.came_true, _style(method))
        axes.set_xlim(0, 1)
        axes.set_aspect("equal")
        axes.xaxis.set_major_formatter(PercentFormatter(1.0))
        axes.set_xlabel("stated")
        _shares_axis(axes)
    if panels:
        figure.supylabel("came true", fontsize=9)
    return figure


def _reliability_points(
    axes: Axes, stated: Any, came_true: Sequence[Interval], style: _Style  # noqa: ANN401
) -> None:  # fmt: skip
    for x, interval in zip(stated, came_true, strict=True):
        if interval.n:
            axes.errorbar(
                x, interval.value, yerr=_ends(interval), fmt=style.marker, markersize=5,
                color=style.colour, markeredgecolor=INK, markeredgewidth=0.6, elinewidth=1.0,
                capsize=2.0, clip_on=False, zorder=5,
            )  # fmt: skip


@styled
def coverage_figure(records: ByMethod) -> Figure:
    """Draw how often the truth lies within the stated radii, while localized.

    Parameters
    ----------
    records : mapping of str to sequence of mapping

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> len(coverage_figure({}).axes)
    2
    """
    figure = new_figure(8.0, 1.2 + 0.34 * max(1, len(records)))
    panels = figure.subplots(1, 2, sharey=True)
    for axes, percent in zip(panels, (68, 95), strict=True):
        name = f"coverage_{percent}"
        for row, (method, chosen) in enumerate(records.items()):
            found = aggregate(chosen, units_of(chosen), (name,))[name]
            _dot(axes, found, row, _style(method))
        axes.axvline(percent / 100, color=INK, linewidth=1.0, linestyle=(0, (4, 1.6)))
        axes.set_xlim(0, 1)
        axes.xaxis.set_major_formatter(PercentFormatter(1.0))
        axes.set_title(f"Within the disc that should hold {percent} %")
        _rows(axes, list(records))
    return figure


@styled
def effects_figure(effects: Sequence[Effect]) -> Figure:
    """Draw what each nuisance does: a bar from the figure as it is to the figure with it.

    Parameters
    ----------
    effects : sequence of Effect
        Of one or more methods; each has a row of panels.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> before, after = Interval(0.1, 0.0, 0.2, 4, 4), Interval(0.4, 0.3, 0.5, 4, 4)
    >>> effect = Effect("furniture", "paper", "useful", before, after)
    >>> effects_figure([effect]).axes[1].get_title(loc="left")
    'paper: useful (more is better)'
    """
    methods = list(dict.fromkeys(effect.method for effect in effects))
    names = list(dict.fromkeys(effect.nuisance for effect in effects))
    height = 1.0 + 0.3 * max(1, len(names))
    figure = new_figure(9.0, height * max(1, len(methods)))
    grid = figure.subplots(max(1, len(methods)), len(FIGURES), squeeze=False)
    for method, panels in zip(methods, grid, strict=True):
        for axes, name in zip(panels, FIGURES, strict=True):
            chosen = [e for e in effects if e.method == method and e.figure == name]
            axes.set_title(f"{method}: {_WORDS[name]}")
            for row, effect in enumerate(chosen):
                _bar(axes, effect, row)
            _rows(axes, [effect.nuisance for effect in chosen])
    return figure


def _bar(axes: Axes, effect: Effect, row: int) -> None:
    before, after = effect.before, effect.after
    worse = (effect.change > 0) == (effect.figure == "false_localized")
    axes.barh(
        row, effect.change, 0.55, before.value, facecolor="#f6d5d2" if worse else TRUTH,
        edgecolor=ANSWER if worse else TRUTH, hatch="////" if worse else None, linewidth=0.8,
    )  # fmt: skip
    _dot(axes, after, row, _Style(INK, "solid", "|"))
    axes.axvline(before.value, color=INK, linewidth=1.0)


def _dot(axes: Axes, interval: Interval, row: int, style: _Style) -> None:
    if math.isnan(interval.value):
        return
    axes.errorbar(
        interval.value, row, xerr=_ends(interval), fmt=style.marker, markersize=7,
        color=style.colour, markeredgecolor=INK, markeredgewidth=0.7, elinewidth=1.2, capsize=2.5,
        clip_on=False, zorder=5,
    )  # fmt: skip


def _ends(interval: Interval) -> Any:  # noqa: ANN401 - as errorbar wants them
    if math.isnan(interval.low):
        return None
    return [
        [max(0.0, interval.value - interval.low)], [max(0.0, interval.high - interval.value)]
    ]  # fmt: skip


def _panels(n: int, height_in: float) -> tuple[Figure, list[Axes]]:
    """Return small pictures side by side, as many as there are methods."""
    columns = 2 if n == 4 else min(_COLUMNS, max(1, n))
    rows = max(1, math.ceil(n / columns))
    figure = new_figure(3.0 * columns + 0.6, height_in * rows + 0.4)
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    panels = list(grid.ravel())
    for empty in panels[n:]:
        empty.remove()
    return figure, panels[:n]


def _vertical(axes: Axes, at: float, word: str) -> None:
    axes.axvline(at, color=MUTED, linewidth=0.8, linestyle=(0, (4, 1.6)), zorder=1)
    axes.annotate(
        word, (at, 0.0), xycoords=("data", "axes fraction"), xytext=(2, 3),
        textcoords="offset points", fontsize=7.5, color=MUTED,
    )  # fmt: skip


def _shares_axis(axes: Axes) -> None:
    axes.set_ylim(0.0, 1.0)
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    _tidy(axes)


def _rows(axes: Axes, names: Sequence[str]) -> None:
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    _tidy(axes)
    axes.grid(visible=False, axis="y")
    axes.grid(axis="x", color=_GRID, linewidth=0.6)


def _tidy(axes: Axes) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", color=_GRID, linewidth=0.6)
    axes.set_axisbelow(True)


def _legend(figure: Figure, axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        figure.legend(handles, labels, loc="outside lower center", ncols=5, handlelength=3.2)
