"""A scan as a picture: its walls, and the space that is certainly empty."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon

from palms.geometry import FloatArray, lengths
from palms.plot.pipeline import draw_scan
from palms.plot.style import EMPTY, INK, MUTED, SCAN, frame_map, legend_line, new_figure, styled
from palms.scan import Scan
from palms.settings import TemplateSettings
from palms.template import empty_triangles

__all__ = ["coverage_outline", "scan_figure"]

_EMPTY_FILL = "#f6cf7e"
_MAX_POINTS = 60_000  # ours: more only make a picture larger


@styled
def scan_figure(scan: Scan, title: str | None = None, points_m: FloatArray | None = None) -> Figure:
    """Draw a scan with its empty space: of the coverage, else the triangles before the walls.

    Parameters
    ----------
    scan : Scan
    title : str, optional
        The number and length of the walls when left out.
    points_m : ndarray (P, 2), optional
        Points on the ground that the walls were found among, drawn below.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> scan_figure(Scan([[[2, -2], [2, 2]]])).axes[0].get_title(loc="left")
    '1 wall, 4.0 m'
    """
    figure = new_figure(8.0, 8.4)
    axes = figure.add_subplot()
    shown = np.concatenate([scan.walls_m.reshape(-1, 2), scan.position_m[None]])
    frame_map(axes, shown.min(axis=0) - 0.4, shown.max(axis=0) + 0.4)
    entries: list[Artist] = [_draw_empty(axes, scan)]
    if points_m is not None and len(points_m):
        some = points_m[:: len(points_m) // _MAX_POINTS + 1]
        axes.plot(*some.T, ",", color=MUTED, zorder=2, gid="points")
        entries.append(Line2D([], [], color=MUTED, marker=".", linestyle="none", label="points"))
    draw_scan(axes, scan.walls_m)
    axes.plot(*scan.position_m, marker="o", markersize=6, color=INK, zorder=6, gid="position")
    count = len(scan.walls_m)
    words = f"{count} wall{'s' if count > 1 else ''}, {lengths(scan.walls_m).sum():.1f} m"
    axes.set_title(title or words)
    entries = [
        legend_line(SCAN, 2.6, "wall seen"), *entries,
        Line2D([], [], color=INK, marker="o", linestyle="none", label="observation point"),
    ]  # fmt: skip
    figure.legend(handles=entries, loc="outside lower center", ncols=2)
    return figure


def _draw_empty(axes: Axes, scan: Scan) -> Patch:
    """Draw what is certainly empty; return its legend entry."""
    if scan.coverage_m is not None:
        shapes, words = coverage_outline(scan), "seen to be empty"
    else:
        triangles = empty_triangles(scan.relative_m, TemplateSettings().empty_shrink)
        shapes, words = list(triangles + scan.position_m), "certainly empty space"
    for shape in shapes:
        axes.add_patch(
            Polygon(
                shape, facecolor=_EMPTY_FILL, edgecolor=EMPTY, linewidth=0.6, zorder=1, gid="empty"
            )
        )
    return Patch(facecolor=_EMPTY_FILL, edgecolor=EMPTY, label=words)


def coverage_outline(scan: Scan) -> list[FloatArray]:
    """Return outlines (K, 2) of what a scan's coverage knows to be free, odom frame.

    Parameters
    ----------
    scan : Scan
        With a coverage.

    Examples
    --------
    >>> half = Scan([[[2, -2], [2, 2]]], coverage_m=[2.0, 2.0, float("nan"), float("nan")])
    >>> [outline.shape for outline in coverage_outline(half)]
    [(5, 2)]
    """
    free = np.asarray(scan.coverage_m)
    count, known = len(free), np.isfinite(free)
    if not known.any():
        return []
    first = 0 if known.all() else int(np.flatnonzero(~known)[0])
    order = np.roll(np.arange(count), -first)
    runs = np.split(order, np.flatnonzero(np.diff(known[order].astype(int))) + 1)
    outlines = []
    for run in runs:
        if not known[run[0]]:
            continue
        edges = np.stack([run, run + 1], axis=1).ravel() * 2 * np.pi / count
        rim = np.repeat(free[run], 2)[:, None] * np.stack([np.cos(edges), np.sin(edges)], axis=1)
        closed = rim if known.all() else np.concatenate([np.zeros((1, 2)), rim])
        outlines.append(closed + scan.position_m)
    return outlines
