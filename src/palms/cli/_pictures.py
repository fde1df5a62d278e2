"""From results to pictures in files."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palms.plot.output import write_figure
from palms.plot.plans import draw_plan as draw_segments
from palms.plot.plans import figure_size, plan_figure
from palms.plot.style import ANSWER, GROUPS, INK, MUTED, frame_map, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from palms.cli._inputs import Case
    from palms.floorplan import FloorPlan
    from palms.places import Place
    from palms.scan import Scan
    from palms.settings import Settings

__all__ = ["draw_places", "draw_plan", "draw_walk", "places_figure"]


def draw_plan(path: Path, plan: FloorPlan) -> None:
    """Write a picture of a floor plan."""
    write_figure(path, plan_figure(plan))


def draw_places(path: Path, plan: FloorPlan, scan: Scan, places: Sequence[Place]) -> None:
    """Write a picture of candidate places."""
    write_figure(path, places_figure(plan, scan, places))


@styled
def places_figure(plan: FloorPlan, scan: Scan, places: Sequence[Place]) -> Figure:
    """Draw candidate places over their plan, with the walls that the scan saw from each.

    Parameters
    ----------
    plan : FloorPlan
    scan : Scan
    places : sequence of Place
        In order; they are numbered from 1.
    """
    from matplotlib.collections import LineCollection

    from palms.geometry import rotate

    figure = new_figure(*figure_size(plan, 70.0, extra_in=0.6))
    axes = figure.add_subplot()
    frame_map(axes, *plan.bounds_m)
    draw_segments(axes, plan, colour=MUTED)
    for rank, place in reversed(list(enumerate(places, start=1))):
        colour = ANSWER if rank == 1 else GROUPS[1].colour
        walls = np.add(rotate(scan.relative_m, place.drift_rad), (place.x_m, place.y_m))
        axes.add_collection(LineCollection(list(walls), colors=colour, linewidths=2.4, zorder=5))
        axes.plot(
            [place.x_m], [place.y_m], "o", markersize=13, color="white",
            markeredgecolor=colour, markeredgewidth=1.6, zorder=6,
        )  # fmt: skip
        axes.text(
            place.x_m, place.y_m, str(rank), color=INK, fontsize=8, ha="center",
            va="center_baseline", zorder=7,
        )  # fmt: skip
    best = places[0]
    axes.set_title(
        f"Where the scan may have been taken on {plan.name}: the {len(places)} most probable "
        f"places,\nwith the walls seen from each. Place 1: {100 * best.p:.1f} %, "
        f"drift {math.degrees(best.drift_rad):.1f}°"
    )
    return figure


def draw_walk(folder: Path, case: Case, settings: Settings, seed: int) -> Path:
    """Write report, figures and animation of a tracked walk; return the report's path."""
    raise NotImplementedError
