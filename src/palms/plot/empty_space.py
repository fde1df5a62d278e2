"""The paper's Fig. 2: certainly empty space at a right place and at a wrong one."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon

from palms.floorplan import FloorPlan
from palms.geometry import FloatArray, rotate
from palms.heatmap import Heatmaps, correlate
from palms.plot.pipeline import draw_scan
from palms.plot.plans import draw_plan, plan_legend
from palms.plot.style import (
    EMPTY,
    INK,
    INTRUDER,
    SCAN,
    degrees,
    frame_map,
    new_figure,
    styled,
    truth_entry,
    truth_mark,
)
from palms.template import empty_triangles

__all__ = ["Match", "empty_space_figure", "length_m", "right_match", "walls_inside", "wrong_match"]

_INTRUDING_M: Final = 1.5  # a wrong place has at least so much wall in its empty space
_AWAY_M: Final = 5.0  # and is at least so far from the right one
_DRIFTS: Final = 8  # at most so many drifts are searched for a wrong place


class Match(NamedTuple):
    """A scan laid on a plan.

    Attributes
    ----------
    position_m : (2,)
        Where its observation point lies, map frame.
    drift_rad : float
        The drift that it is turned by.
    """

    position_m: FloatArray
    drift_rad: float


@styled
def empty_space_figure(heatmaps: Heatmaps, truth_m: npt.ArrayLike | None = None) -> Figure:
    """Draw the certainly empty space of a scan where it is empty and where it is not.

    Parameters
    ----------
    heatmaps : Heatmaps
    truth_m : array_like (2,), optional
        Where the scan was truly taken, map frame; else the best match stands for it.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> from palms import FloorPlan, Scan, rasterize
    >>> from palms.heatmap import match
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
    >>> heatmaps = match(Scan(room - (2.0, 1.0)), rasterize(FloorPlan(room)), [0.0])
    >>> figure = empty_space_figure(heatmaps, [2.0, 1.0])
    >>> figure.axes[1].get_title(loc="left")
    '2  The right place: 0.0 m of wall inside'
    """
    truth = None if truth_m is None else np.asarray(truth_m, dtype=np.float64)
    right = right_match(heatmaps, truth)
    wrong = wrong_match(heatmaps, right.position_m)
    plan, reach = heatmaps.raster.plan, _reach_m(heatmaps)
    figure = new_figure(13.0, 4.9)
    first, second, third = figure.subplots(1, 3)
    frame_map(first, (-reach, -reach), (reach, reach))
    _draw_match(first, heatmaps, Match(np.zeros(2), right.drift_rad), None)
    first.set_title(f"1  The scan, turned by {degrees(right.drift_rad)}")
    named = "The right place" if truth is not None else "The best match"
    for axes, found, word in ((second, right, f"2  {named}"), (third, wrong, "3  A wrong place")):
        if found is None:
            _say(axes, "No wrong place of this plan\nhas walls like these.")
            continue
        frame_map(axes, found.position_m - reach, found.position_m + reach)
        inside_m = _draw_match(axes, heatmaps, found, plan)
        axes.set_title(f"{word}: {inside_m:.1f} m of wall inside")
        if truth is not None:
            truth_mark(axes, *truth)
    entries = [*_entries(), *([truth_entry()] if truth is not None else []), *plan_legend(plan)]
    figure.legend(handles=entries, loc="outside lower center", ncols=len(entries))
    return figure


def right_match(heatmaps: Heatmaps, truth_m: FloatArray | None = None) -> Match:
    """Return the best match of all, or the best within half a metre of a true place.

    Parameters
    ----------
    heatmaps : Heatmaps
    truth_m : (2,), optional
        Map frame.
    """
    near = _distances_m(heatmaps, truth_m) <= 0.5 if truth_m is not None else None
    near = near if near is not None and near.any() else None
    best, found = -np.inf, Match(np.zeros(2), 0.0)
    for k, scores in enumerate(heatmaps):
        allowed = scores if near is None else np.where(near, scores, -np.inf)
        top = int(allowed.argmax())
        if allowed.flat[top] > best:
            best = float(allowed.flat[top])
            place = heatmaps.grid.position_of(np.unravel_index(top, scores.shape))
            found = Match(place, float(heatmaps.drifts_rad[k]))
    return found


def wrong_match(heatmaps: Heatmaps, right_m: FloatArray) -> Match | None:
    """Return where the walls fit best although walls stand in the certainly empty space.

    Parameters
    ----------
    heatmaps : Heatmaps
    right_m : (2,)
        The right place; the wrong one is at least 5 m away.

    Returns
    -------
    Match or None
        None when no place is wrong in this way.
    """
    plain = replace(heatmaps.settings, empty_weight=0.0, floor_at_zero=False)
    only_walls = replace(heatmaps, settings=plain)
    far = (_distances_m(heatmaps, right_m) >= _AWAY_M) & heatmaps.raster.inside
    best, found = -np.inf, None
    for k in range(0, len(heatmaps), -(-len(heatmaps) // _DRIFTS)):
        fits = only_walls.scores(k)
        score = np.where(far & (_intruding_m(heatmaps, k) >= _INTRUDING_M), fits, -np.inf)
        top = int(score.argmax())
        if score.flat[top] > best:
            best = float(score.flat[top])
            place = heatmaps.grid.position_of(np.unravel_index(top, score.shape))
            found = Match(place, float(heatmaps.drifts_rad[k]))
    return found


def _intruding_m(heatmaps: Heatmaps, k: int) -> npt.NDArray[np.float32]:
    """Metres of wall (R, C) inside the empty space of drift k, by its anchor's cell."""
    walls_only = replace(heatmaps.settings, empty_weight=0.0)
    with_empty = replace(heatmaps.settings, empty_weight=1.0)
    wanted = replace(heatmaps, settings=walls_only).template(k)
    both = replace(heatmaps, settings=with_empty).template(k)
    empty = replace(wanted, values=wanted.values - both.values)
    return correlate(heatmaps.raster, empty) * np.float32(heatmaps.grid.cell_size_m)


def _distances_m(heatmaps: Heatmaps, point_m: FloatArray) -> FloatArray:
    """Distance (R, C) of every cell from a point."""
    rows, columns = heatmaps.grid.shape
    x, y = heatmaps.grid.origin_m - point_m
    cell = heatmaps.grid.cell_size_m
    along = (np.arange(columns) + 0.5) * cell + x
    return np.asarray(np.hypot(along, ((np.arange(rows) + 0.5) * cell + y)[:, None]))


def _reach_m(heatmaps: Heatmaps) -> float:
    return 1.1 * float(np.linalg.norm(heatmaps.scan.relative_m, axis=-1).max()) + 0.5


def _draw_match(axes: Axes, heatmaps: Heatmaps, match: Match, plan: FloorPlan | None) -> float:
    """Draw a scan laid on a place; return the metres of plan wall in its empty space."""
    walls = rotate(heatmaps.scan.relative_m, match.drift_rad)
    triangles = empty_triangles(walls, heatmaps.settings.empty_shrink) + match.position_m
    for triangle in triangles:
        axes.add_patch(
            Polygon(triangle, facecolor="#f6cf7e", edgecolor=EMPTY, linewidth=0.8, zorder=1)
        )
    draw_scan(axes, walls + match.position_m)
    axes.plot(*match.position_m, marker="o", markersize=6, color=INK, zorder=7, linestyle="none")
    if plan is None:
        return 0.0
    draw_plan(axes, plan, 0.9)
    inside = walls_inside(heatmaps, match)
    axes.add_collection(
        LineCollection(
            inside, colors=INTRUDER, linewidths=5.0, capstyle="butt", zorder=6, gid="intruder"
        ),
        autolim=False,
    )
    return length_m(inside)


def walls_inside(heatmaps: Heatmaps, match: Match) -> list[FloatArray]:
    """Return the parts (n, 2) of the plan's walls that lie inside the certainly empty space.

    Parameters
    ----------
    heatmaps : Heatmaps
    match : Match
    """
    import shapely

    walls = rotate(heatmaps.scan.relative_m, match.drift_rad)
    triangles = empty_triangles(walls, heatmaps.settings.empty_shrink) + match.position_m
    space = shapely.union_all(shapely.make_valid([shapely.Polygon(each) for each in triangles]))
    lines = shapely.linestrings(heatmaps.raster.plan.blocking_m)
    parts = shapely.get_parts(shapely.intersection(lines, space))
    return [shapely.get_coordinates(part) for part in parts if part.length > 0]


def length_m(lines: list[FloatArray]) -> float:
    """Return the summed length of lines (n, 2) in metres.

    Examples
    --------
    >>> length_m([np.array([[0.0, 0.0], [3.0, 4.0]])])
    5.0
    """
    return float(sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in lines))


def _entries() -> list[Line2D | Patch]:
    return [
        Line2D([], [], color=INK, marker="o", linestyle="none", label="observation point"),
        Line2D([], [], color=SCAN, linewidth=2.6, label="seen by the scan"),
        Patch(facecolor="#f6cf7e", edgecolor=EMPTY, label="certainly empty space"),
        Line2D([], [], color=INTRUDER, linewidth=5.0, label="wall inside it"),
    ]


def _say(axes: Axes, words: str) -> None:
    axes.set_axis_off()
    axes.text(0.5, 0.5, words, transform=axes.transAxes, ha="center", va="center")
