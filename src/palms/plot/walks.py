"""A recorded walk by itself: its path, where the phone looked, and the reference."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from palms.geometry import FloatArray, rotate
from palms.plot.style import INK, SCAN, TRUTH, frame_map, new_figure, styled

if TYPE_CHECKING:
    from palms.odometry import Odometry

__all__ = ["walk_figure"]

_LOOKS: Final = 40  # arrows that show where the phone looked
_SMALLEST_M: Final = 4.0  # maps are at least so wide


@styled
def walk_figure(
    odometry: Odometry, reference_m: FloatArray | None = None, title: str = ""
) -> Figure:
    """Draw a walk; with a reference turned and moved, never scaled, to fit it best.

    Parameters
    ----------
    odometry : Odometry
    reference_m : array_like (T, 2), optional
        One position for each sample, map frame; NaN where there is none.
    title : str
        What to call the walk.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> from palms import Odometry
    >>> figure = walk_figure(Odometry([1, 2], [[1, 0], [2, 0]]), title="walk-1")
    >>> figure.axes[0].get_title(loc="left")
    'walk-1: 2 samples, 2.0 m in 2 s'
    """
    path = np.concatenate([odometry.start_m[None], odometry.position_m])
    turn = 0.0
    if reference_m is None:
        reference_m = np.full((len(odometry), 2), np.nan)
    known = np.asarray(np.isfinite(reference_m).all(axis=1))
    reference = reference_m[known]
    if len(reference) >= 2:
        turn, shift = _fit(odometry.position_m[known], reference)
        path = rotate(path, turn) + shift
    shown = np.concatenate([path, reference])
    figure = new_figure(*_size(shown))
    axes = figure.add_subplot()
    frame_map(axes, *_frame(shown))
    entries = _draw_path(axes, path, fitted=len(reference) >= 2)
    if len(reference):
        entries += _draw_reference(axes, reference)
    if odometry.facing_rad is not None:
        entries += _draw_looks(axes, path[1:], odometry.facing_rad + turn)
    words = f"{len(odometry)} samples, {odometry.walked_m[-1]:.1f} m in {odometry.time_s[-1]:.0f} s"
    axes.set_title(f"{title}: {words}" if title else words)
    figure.legend(handles=entries, loc="outside lower center", ncols=4)
    return figure


def _fit(found: FloatArray, true: FloatArray) -> tuple[float, FloatArray]:
    """Angle and shift that bring points closest to others, by least squares."""
    a, b = found - found.mean(axis=0), true - true.mean(axis=0)
    cross = float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())
    angle = math.atan2(cross, float((a * b).sum()))
    return angle, true.mean(axis=0) - rotate(found.mean(axis=0), angle)


def _frame(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    low, high = points.min(axis=0), points.max(axis=0)
    more = np.maximum(_SMALLEST_M - (high - low), 0.0) / 2 + 0.03 * float((high - low).max())
    return low - more, high + more


def _size(points: FloatArray) -> tuple[float, float]:
    """Width and height in inches, of the path's shape."""
    low, high = _frame(points)
    width, height = (float(v) for v in high - low)
    aspect = min(max(width / height, 0.5), 2.5)
    return round(6.5 * math.sqrt(aspect), 2), round(6.5 / math.sqrt(aspect) + 0.8, 2)


def _draw_path(axes: Axes, path: FloatArray, fitted: bool) -> list[Line2D]:
    label = "walk, turned and moved to fit" if fitted else "walk"
    (line,) = axes.plot(*path.T, color=SCAN, linewidth=1.6, zorder=5, label=label, gid="walk")
    (start,) = axes.plot(
        *path[:1].T, marker="o", markersize=8, color="white", markeredgecolor=INK,
        markeredgewidth=1.6, linestyle="none", zorder=7, label="start", gid="start",
    )  # fmt: skip
    (end,) = axes.plot(
        *path[-1:].T, marker="s", markersize=6.5, color=INK, linestyle="none", zorder=7,
        label="end", gid="end",
    )  # fmt: skip
    return [line, start, end]


def _draw_reference(axes: Axes, reference_m: FloatArray) -> list[Line2D]:
    (line,) = axes.plot(
        *reference_m.T, color=TRUTH, linewidth=3.0, alpha=0.75, marker="D", zorder=4,
        markersize=5 if len(reference_m) < 60 else 0, label="reference", gid="reference",
    )  # fmt: skip
    return [line]


def _draw_looks(axes: Axes, path: FloatArray, facing_rad: FloatArray) -> list[Line2D]:
    """Draw arrows from some samples to where the phone looked."""
    at = np.unique(np.linspace(0, len(path) - 1, min(_LOOKS, len(path))).astype(int))
    length = 0.02 * float(np.ptp(path, axis=0).max()) + 0.2
    x, y = path[at].T
    axes.quiver(
        x, y, length * np.cos(facing_rad[at]), length * np.sin(facing_rad[at]), color=INK,
        angles="xy", scale_units="xy", scale=1.0, width=0.0022, headwidth=6.0, headlength=7.0,
        headaxislength=6.0, zorder=6, gid="looks",
    )  # fmt: skip
    return [
        Line2D(
            [], [], color=INK, marker=">", markersize=5, linewidth=0.9,
            label="where the phone looked",
        )
    ]  # fmt: skip
