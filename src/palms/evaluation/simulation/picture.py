"""A picture of a simulated case: drawing, world, scan and walk."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from palms.evaluation.simulation.cases import SimulatedCase
from palms.evaluation.simulation.sites import Site
from palms.geometry import FloatArray, rotate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["DPI", "case_figure"]

DPI = 100
_AREA_IN2 = 30.0  # ours
_WORLD, _SCANNED, _WALK = "#b3160b", "#0072b2", "#12a06f"


def case_figure(site: Site, case: SimulatedCase) -> Figure:
    """Draw a case: the drawing in grey, what is really there in red, the scans in blue.

    Parameters
    ----------
    site : Site
    case : SimulatedCase

    Returns
    -------
    matplotlib Figure
        Small; a panel for each level.
    """
    from palms.plot.plans import draw_plan, figure_size
    from palms.plot.style import frame_map, new_figure

    count = len(site.drawings)
    width, height = figure_size(site.drawings[0], _AREA_IN2)
    figure = new_figure(width * count, height + 0.4, layout=None)
    panels = figure.subplots(1, count, squeeze=False)[0]
    figure.subplots_adjust(0.01, 0.01, 0.99, 1 - 0.3 / (height + 0.4), wspace=0.02)
    for k, axes in enumerate(panels):
        drawing = site.drawings[k]
        frame_map(axes, *drawing.bounds_m)
        draw_plan(axes, drawing, width=1.0, colour="#c4c4c4")
        _lines(axes, site.stretch.apply(site.places[k].world.seen_m), _WORLD, 0.35)
        _walk(axes, case, drawing.level or "")
    for scan, label in zip(case.scans, case.labels, strict=True):
        seen = rotate(scan.relative_m, label.drift_rad) + label.position_m
        _lines(panels[_panel(site, case, scan.time_s)], seen, _SCANNED, 1.8)
    panels[0].set_title(_title(site, case), fontsize=8)
    return figure


def _lines(axes: Axes, segments: FloatArray, colour: str, width: float) -> None:
    from matplotlib.collections import LineCollection

    lines = LineCollection(list(segments), colors=colour, linewidths=width, zorder=3)
    axes.add_collection(lines, autolim=False)


def _walk(axes: Axes, case: SimulatedCase, level: str) -> None:
    truth, start = case.recorded.truth, case.recorded.start_m
    if truth is None or start is None:
        return
    here = np.array([name == level for name in truth.level])
    axes.plot(*truth.position_m[here].T, color=_WALK, linewidth=1.2, zorder=4)
    if here[:1].all():
        axes.plot(*start, "o", color=_WALK, markersize=6, zorder=5)
    for event in case.events:
        at = min(int(np.searchsorted(truth.time_s, event.time_s)), len(here) - 1)
        if here[at]:
            axes.annotate(event.kind, truth.position_m[at], fontsize=7, zorder=6)


def _panel(site: Site, case: SimulatedCase, time_s: float) -> int:
    truth = case.recorded.truth
    if truth is None or len(site.drawings) == 1:
        return 0
    at = min(int(np.searchsorted(truth.time_s, time_s)), len(truth.level) - 1)
    return site.tower.names.index(truth.level[at])


def _title(site: Site, case: SimulatedCase) -> str:
    walls, recorded = len(case.scans[0].walls_m), case.recorded
    length = recorded.odometry(recorded.usual_source).walked_m[-1]
    return f"{site.name}, {case.name}: {walls} walls seen, walk of {length:.0f} m"
