"""The figures of an experiment's report: curves, reliability, coverage, effects.

Methods keep colour, stroke and marker in all figures; each is told by the last two alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter, StrMethodFormatter

from palms.evaluation.bootstrap import Interval, aggregate
from palms.evaluation.chart_parts import (
    MethodStyle,
    add_legend,
    as_shares,
    error_bars,
    mark_vertical,
    name_rows,
    panels_for,
    style_of,
    tidy,
)
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
from palms.plot.style import ANSWER, INK, MUTED, TRUTH, new_figure, styled

__all__ = [
    "cdf_figure",
    "coverage_figure",
    "effects_figure",
    "reliability_figure",
    "shares_figure",
    "sweep_figure",
]

ByMethod = Mapping[str, Records]

_SMALLEST_M: Final = 0.05  # errors are drawn on a scale that begins here
_NAMED: Final = (0.5, 0.8, 0.95)  # thresholds with a word
_WORDS: Final = {
    "false_localized": "false_localized (less is better)",
    "useful": "useful (more is better)",
}


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
            mark_vertical(axes, limit, word)
        as_shares(axes)
    left.set_ylabel("share of metres walked")
    add_legend(figure, left)
    return figure


def _cdf_line(axes: Axes, cdf: ErrorCdf, order: int, method: str) -> None:
    """Draw one line: those drawn later are thinner, so that none hides another."""
    style, width = style_of(method), max(1.3, 3.4 - 0.6 * order)
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
    figure, panels = panels_for(len(records), 2.5)
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
        as_shares(axes)
    if panels:
        figure.supylabel("trials localized", fontsize=9)
        add_legend(figure, panels[0])
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
        style, sweep = style_of(method), threshold_sweep(chosen)
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
    tidy(axes)
    add_legend(figure, axes)
    return figure


def _own_rule(axes: Axes, chosen: Records, style: MethodStyle) -> None:
    """Mark what the method's own rule leads to, with the intervals of both."""
    names = ("false_localized", "right_after_m_full")
    figures = aggregate(chosen, units_of(chosen), names)
    x, y = (figures[name] for name in names)
    if math.isnan(x.value):
        return
    axes.errorbar(
        x.value, y.value, xerr=error_bars(x), yerr=error_bars(y), fmt=style.marker, markersize=9,
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
    figure, panels = panels_for(len(records), 2.9)
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
            _reliability_points(axes, found.stated, found.came_true, style_of(method))
        axes.set_xlim(0, 1)
        axes.set_aspect("equal")
        axes.xaxis.set_major_formatter(PercentFormatter(1.0))
        axes.set_xlabel("stated")
        as_shares(axes)
    if panels:
        figure.supylabel("came true", fontsize=9)
    return figure


def _reliability_points(
    axes: Axes, stated: Any, came_true: Sequence[Interval], style: MethodStyle  # noqa: ANN401
) -> None:  # fmt: skip
    for x, interval in zip(stated, came_true, strict=True):
        if interval.n:
            axes.errorbar(
                x, interval.value, yerr=error_bars(interval), fmt=style.marker, markersize=5,
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
            _dot(axes, found, row, style_of(method))
        axes.axvline(percent / 100, color=INK, linewidth=1.0, linestyle=(0, (4, 1.6)))
        axes.set_xlim(0, 1)
        axes.xaxis.set_major_formatter(PercentFormatter(1.0))
        axes.set_title(f"Within the disc that should hold {percent} %")
        name_rows(axes, list(records))
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
    >>> change = Interval(0.3, 0.2, 0.4, 8, 4)
    >>> effect = Effect("furniture", "paper", "useful", before, after, change)
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
            name_rows(axes, [effect.nuisance for effect in chosen])
    return figure


def _bar(axes: Axes, effect: Effect, row: int) -> None:
    before, change = effect.before, effect.change
    worse = (change.value > 0) == (effect.figure == "false_localized")
    axes.barh(
        row, change.value, 0.55, before.value, facecolor="#f6d5d2" if worse else TRUTH,
        edgecolor=ANSWER if worse else TRUTH, hatch="////" if worse else None, linewidth=0.8,
    )  # fmt: skip
    value, low, high = (before.value + v for v in (change.value, change.low, change.high))
    end = Interval(value, low, high, change.n, change.units)
    _dot(axes, end, row, MethodStyle(INK, "solid", "|"))
    axes.axvline(before.value, color=INK, linewidth=1.0)


def _dot(axes: Axes, interval: Interval, row: int, style: MethodStyle) -> None:
    if math.isnan(interval.value):
        return
    axes.errorbar(
        interval.value, row, xerr=error_bars(interval), fmt=style.marker, markersize=7,
        color=style.colour, markeredgecolor=INK, markeredgewidth=0.7, elinewidth=1.2, capsize=2.5,
        clip_on=False, zorder=5,
    )  # fmt: skip
