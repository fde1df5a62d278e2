"""Places that one scan alone allows, over their plan."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from palms.floorplan import FloorPlan
from palms.geometry import rotate
from palms.places import Place
from palms.plot.plans import draw_plan, figure_size
from palms.plot.style import ANSWER, GROUPS, INK, MUTED, degrees, frame_map, new_figure, styled
from palms.scan import Scan

__all__ = ["places_figure"]


@styled
def places_figure(plan: FloorPlan, scan: Scan, places: Sequence[Place]) -> Figure:
    """Draw candidate places over their plan, with the walls that the scan saw from each.

    Parameters
    ----------
    plan : FloorPlan
    scan : Scan
    places : sequence of Place
        In order; they are numbered from 1.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> plan, scan = FloorPlan([[[0, 0], [8, 0]]]), Scan([[[-1, -2], [3, -2]]])
    >>> figure = places_figure(plan, scan, [Place(2.0, 2.0, 0.0, 0.25, 3.0)])
    >>> figure.axes[0].get_title(loc="left").splitlines()[-1]
    'Place 1: 25 %, drift 0°'
    """
    figure = new_figure(*figure_size(plan, 70.0, extra_in=0.6))
    axes = figure.add_subplot()
    frame_map(axes, *plan.bounds_m)
    draw_plan(axes, plan, colour=MUTED)
    for rank, place in reversed(list(enumerate(places, start=1))):
        colour = ANSWER if rank == 1 else GROUPS[1].colour
        walls = np.add(rotate(scan.relative_m, place.drift_rad), (place.x_m, place.y_m))
        axes.add_collection(
            LineCollection(list(walls), colors=colour, linewidths=2.4, zorder=5), autolim=False
        )
        axes.plot(
            [place.x_m], [place.y_m], "o", markersize=13, color="white",
            markeredgecolor=colour, markeredgewidth=1.6, zorder=6 - rank / 1000,
        )  # fmt: skip
        axes.text(
            place.x_m, place.y_m, str(rank), color=INK, fontsize=8, ha="center",
            va="center_baseline", zorder=7,
        )  # fmt: skip
    axes.set_title(_title(plan, places))
    return figure


def _title(plan: FloorPlan, places: Sequence[Place]) -> str:
    if not places:
        return f"The scan fits nowhere on {plan.name}"
    how_many = "the most probable place" if len(places) == 1 else f"{len(places)} places"
    share = f"{100 * places[0].p:.2g} %" if places[0].p >= 0.001 else "< 0.1 %"
    return (
        f"Where the scan may have been taken on {plan.name}: {how_many},\n"
        f"with the walls that it saw from there\n"
        f"Place 1: {share}, drift {degrees(places[0].drift_rad)}"
    )
