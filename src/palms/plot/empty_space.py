"""The paper's Fig. 2: certainly empty space, where no wall of the plan can stand."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from palms.errors import InputError
from palms.geometry import FloatArray, rotate
from palms.grid import Grid
from palms.heatmap import Heatmaps, correlate, match
from palms.plot.pipeline import draw_scan
from palms.plot.plans import draw_plan
from palms.plot.story import Story
from palms.plot.style import EMPTY, INK, SCAN, WALL, degrees, frame_map, new_figure, say, styled
from palms.template import certainly_empty, empty_triangles

__all__ = ["empty_space_figure"]

INTRUDER: Final = "#d7191c"  # plan walls that stand where none can be
_FAR_M = 10.0  # the place that does not match is so far from the one that does
_INTRUDING_M = 1.5  # and has so many metres of wall in the empty space


@styled
def empty_space_figure(story: Story) -> Figure:
    """Draw the scan's certainly empty space, a place that respects it, and one that does not.

    Parameters
    ----------
    story : Story
        With scan and candidates.

    Returns
    -------
    matplotlib Figure

    Raises
    ------
    InputError
        When the story has no scan or no candidates.

    Examples
    --------
    >>> from palms import FloorPlan, Odometry, Scan, locate, rasterize, track
    >>> from palms.plot.recorder import Recorder
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
    >>> raster, scan = rasterize(FloorPlan(room)), Scan(room - (2.0, 1.0))
    >>> walk, recorder = Odometry([1, 2], [[0.5, 0], [1, 0]]), Recorder()
    >>> answers = track(raster, scan, walk, watch=recorder)
    >>> story = Story(raster, walk, answers, recorder, scan, locate(raster, scan))
    >>> figure = empty_space_figure(story)
    >>> figure.axes[1].get_title(loc="left")
    '2  Best match: no wall of the plan in the empty space'
    """
    heatmaps = story.heatmaps
    if heatmaps is None:
        raise InputError("story", expected="a scan and its candidates", got="none")
    k = max(range(len(heatmaps)), key=lambda i: float(heatmaps.scores(i).max()))
    drift = float(heatmaps.drifts_rad[k])
    walls = rotate(heatmaps.scan.relative_m, drift)
    window = max(2.5, 1.1 * float(np.abs(walls).max()))
    figure = new_figure(13.0, 5.0)
    left, middle, right = figure.subplots(1, 3)
    best = heatmaps.grid.position_of(heatmaps.best_cell(k))
    worst = _contradicted_place(heatmaps, k, best)
    for axes, place in ((left, np.zeros(2)), (middle, best), (right, worst)):
        if place is not None:
            frame_map(axes, place - window, place + window)
    _draw_match(left, heatmaps, walls, np.zeros(2), with_plan=False)
    left.set_title(f"1  Scan turned by {degrees(drift)}, and its empty space")
    inside_m = _draw_match(middle, heatmaps, walls, best)
    middle.set_title(f"2  Best match: {_metres(inside_m)} in the empty space")
    if worst is None:
        say(right, "No other place\nfits the walls and\nbreaks the empty space.")
        right.set_title("3  No match")
    else:
        inside_m = _draw_match(right, heatmaps, walls, worst)
        right.set_title(f"3  No match: {_metres(inside_m)} in it")
    figure.legend(handles=_legend(), loc="outside lower center", ncols=5)
    return figure


def _metres(inside_m: float) -> str:
    return f"{inside_m:.1f} m of wall" if inside_m >= 0.05 else "no wall of the plan"


def _legend() -> list[Line2D | Patch]:
    return [
        Line2D([], [], color=WALL, linewidth=1.5, label="wall of the plan"),
        Line2D([], [], color=SCAN, linewidth=2.6, label="wall that the scan saw"),
        Patch(facecolor=EMPTY, alpha=0.45, label="certainly empty space"),
        Line2D([], [], color=INTRUDER, linewidth=4.5, label="plan wall inside it"),
        Line2D([], [], color=INK, marker="o", linestyle="none", label="observation point"),
    ]


def _draw_match(
    axes: Axes, heatmaps: Heatmaps, walls: FloatArray, place: FloatArray, with_plan: bool = True
) -> float:
    """Draw a scan laid on a place; return the metres of plan wall in its empty space."""
    triangles = empty_triangles(walls, heatmaps.settings.empty_shrink) + place
    space = shapely.union_all([shapely.Polygon(each) for each in triangles])
    rings = [np.asarray(part.exterior.coords) for part in shapely.get_parts(space)]
    axes.add_collection(
        PolyCollection(rings, facecolors=EMPTY, alpha=0.45, linewidths=0, gid="empty-space"),
        autolim=False,
    )
    inside_m = 0.0
    if with_plan:
        plan = heatmaps.raster.plan
        draw_plan(axes, plan, 0.9)
        cut = shapely.intersection(shapely.linestrings(plan.blocking_m), space)
        inside_m = float(shapely.length(cut).sum())
        lines = [np.asarray(each.coords) for each in shapely.get_parts(cut) if each.length > 0]
        axes.add_collection(
            LineCollection(lines, colors=INTRUDER, linewidths=4.5, zorder=7, gid="intruders"),
            autolim=False,
        )
    draw_scan(axes, walls + place)
    axes.plot(*place, marker="o", markersize=6, color=INK, zorder=8)
    return inside_m


def _contradicted_place(heatmaps: Heatmaps, k: int, best_m: FloatArray) -> FloatArray | None:
    """Far from the best place, where the walls fit best although walls stand in the empty space."""
    settings = replace(heatmaps.settings, empty_weight=0.0)
    fits = match(heatmaps.scan, heatmaps.raster, heatmaps.drifts_rad[k : k + 1], settings)
    template = fits.template(0)
    cell = heatmaps.grid.cell_size_m
    corner = -(np.array(template.anchor[::-1]) + 0.5) * cell
    walls = rotate(heatmaps.scan.relative_m, template.drift_rad)
    empty = certainly_empty(walls, Grid(corner, cell, template.values.shape), settings)
    intruding_m = cell * correlate(heatmaps.raster, replace(template, values=empty))
    rows, columns = np.ogrid[: heatmaps.grid.shape[0], : heatmaps.grid.shape[1]]
    row, column = heatmaps.grid.cell_of(best_m)
    far = np.hypot(rows - row, columns - column) * cell > _FAR_M
    allowed = (intruding_m > _INTRUDING_M) & far
    if not allowed.any():
        return None
    score = np.where(allowed, fits.scores(0), -np.inf)
    return heatmaps.grid.position_of(np.unravel_index(int(score.argmax()), score.shape))
