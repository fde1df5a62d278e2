"""Where one scan alone may have been taken: the best places, numbered."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palms.floorplan import FloorPlan
from palms.geometry import rotate
from palms.places import Place
from palms.plot.pipeline import draw_scan
from palms.plot.plans import draw_plan, figure_size, plan_legend
from palms.plot.style import (
    ANSWER,
    GROUPS,
    SCAN,
    degrees,
    frame_map,
    legend_line,
    new_figure,
    styled,
    truth_entry,
    truth_mark,
)
from palms.scan import Scan

__all__ = ["candidates_figure"]

_LISTED = 5  # places whose numbers stand in the title's second line
_ARROW = 0.05  # length over the map's larger side
_BEHIND = 0.45  # of the arrow's length lies behind the place, with the number at its end


@styled
def candidates_figure(
    plan: FloorPlan,
    places: Sequence[Place],
    scan: Scan | None = None,
    truth_m: Sequence[float] | None = None,
) -> Figure:
    """Draw candidate places over their plan, each with an arrow for its drift.

    Parameters
    ----------
    plan : FloorPlan
    places : sequence of Place
        Best first; they are numbered from 1.
    scan : Scan, optional
        Its walls are drawn as they would lie at the first place.
    truth_m : array_like (2,), optional
        Where it was truly taken, map frame.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> plan = FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]])
    >>> figure = candidates_figure(plan, [Place(2.0, 2.0, 0.0, 0.6, 9.0)])
    >>> print(figure.axes[0].get_title(loc="left"))
    Where the scan may have been taken on plan
    1: 60 %, drift 0°
    """
    figure = new_figure(*figure_size(plan, 70.0, extra_in=0.8))
    axes = figure.add_subplot()
    frame_map(axes, *plan.bounds_m)
    draw_plan(axes, plan, 0.8)
    entries = plan_legend(plan)
    if scan is not None and places:
        best = places[0]
        walls = np.add(rotate(scan.relative_m, best.drift_rad), (best.x_m, best.y_m))
        draw_scan(axes, walls, width=3.4)
        entries.append(legend_line(SCAN, 3.4, "the scan, laid on place 1"))
    if truth_m is not None:
        truth_mark(axes, truth_m[0], truth_m[1])
        entries.append(truth_entry())
    for rank, place in reversed(list(enumerate(places, start=1))):
        _mark(axes, rank, place, _ARROW * float(max(plan.size_m)))
    entries.append(legend_line(ANSWER, 1.8, "dot: the place; arrow: its drift"))
    axes.set_title(_title(plan, places))
    figure.legend(handles=entries, loc="outside lower center", ncols=4)
    return figure


def _mark(axes: Axes, rank: int, place: Place, length_m: float) -> None:
    """Draw the arrow of a drift through its place, and a number behind it."""
    colour = ANSWER if rank == 1 else GROUPS[1].colour
    ahead = length_m * np.array([np.cos(place.drift_rad), np.sin(place.drift_rad)])
    here = np.array([place.x_m, place.y_m])
    x, y = here - _BEHIND * ahead
    axes.annotate(
        "", xy=tuple(here + ahead), xytext=(x, y), zorder=8,
        arrowprops={
            "arrowstyle": "-|>", "color": colour, "linewidth": 1.8, "shrinkA": 0, "shrinkB": 0,
            "path_effects": [patheffects.withStroke(linewidth=3.6, foreground="white")],
        },
    )  # fmt: skip
    axes.plot(
        [place.x_m], [place.y_m], marker="o", markersize=6, color=colour, linestyle="none",
        markeredgecolor="white", markeredgewidth=1.0, zorder=9, gid="place",
    )  # fmt: skip
    axes.plot(
        [x], [y], marker="o", markersize=14, color=colour, linestyle="none",
        markeredgecolor="white", markeredgewidth=1.2, zorder=9,
    )  # fmt: skip
    axes.text(
        x, y, str(rank), color="white", fontsize=8.5, fontweight="bold", ha="center",
        va="center_baseline", zorder=10,
    )  # fmt: skip


def _title(plan: FloorPlan, places: Sequence[Place]) -> str:
    first = f"Where the scan may have been taken on {plan.name}"
    if not places:
        return f"{first}: nowhere"
    listed = [
        f"{rank}: {_percent(place.p)}, drift {degrees(place.drift_rad)}"
        for rank, place in enumerate(places[:_LISTED], start=1)
    ]
    return f"{first}\n{'     '.join(listed)}"


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.1 else f"{100 * share:.1f} %"
