"""A tracked walk: the path of the answers, and how sure they were over time."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Final

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from palms.belief import Stage
from palms.errors import InputError
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray
from palms.localizer import Track
from palms.plot.plans import draw_plan, figure_size
from palms.plot.story import broken, check_truth, errors_m
from palms.plot.style import (
    ANSWER,
    EMPTY,
    INK,
    MUTED,
    SCAN,
    STAGE_LINES,
    TRUTH,
    frame_map,
    legend_line,
    new_figure,
    styled,
)

__all__ = ["track_figure"]

_DISCS: Final = 6  # moments at which discs are drawn
_LARGEST: Final = 0.15  # discs wider than this share of the plan say nothing on a map
_JUMP_M: Final = 3.0  # an answer that moves farther in one step was not walked
_SMALLEST_M: Final = 0.05  # errors are drawn on a scale that begins here


@styled
def track_figure(plan: FloorPlan, track: Track, truth_m: npt.ArrayLike | None = None) -> Figure:
    """Draw a track over its plan, and beneath it how far off and how sure it was.

    Parameters
    ----------
    plan : FloorPlan
    track : Track
    truth_m : array_like (T, 2), optional
        True positions, one for each answer, map frame; NaN where unknown.

    Returns
    -------
    matplotlib Figure

    Raises
    ------
    InputError
        When the truth is not as long as the track, or the track is empty.

    Examples
    --------
    >>> from palms import Estimate
    >>> steps = [(1.0, Stage.SEARCHING), (2.0, Stage.LOCALIZED), (3.0, Stage.LOCALIZED)]
    >>> answers = tuple(
    ...     Estimate(t, stage, np.array([t, 1.0]), 0.0, 0.0, 0.9, 1.0, 0.3, 0.8)
    ...     for t, stage in steps
    ... )
    >>> figure = track_figure(FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]]), Track(0, answers))
    >>> figure.axes[0].get_title(loc="left")
    'Localized after 2.0 s'
    """
    if not len(track):
        raise InputError("track", expected="at least one answer", got="none")
    truth = check_truth(truth_m, len(track))
    width, height = figure_size(plan, 60.0)
    figure = new_figure(max(width, 7.0), height + 4.0)
    grid = figure.add_gridspec(3, 1, height_ratios=(height, 1.7, 1.1))
    _map_panel(figure.add_subplot(grid[0]), plan, track, truth)
    metres = figure.add_subplot(grid[1])
    share = figure.add_subplot(grid[2], sharex=metres)
    _metres_panel(metres, track, None if truth is None else errors_m(track, truth))
    _share_panel(share, track)
    for axes in (metres, share):
        _mark_stages(axes, track)
    return figure


def _map_panel(axes: Axes, plan: FloorPlan, track: Track, truth: FloatArray | None) -> None:
    frame_map(axes, *plan.bounds_m)
    draw_plan(axes, plan, 0.6, colour="#9a9a9a")
    entries = []
    if truth is not None:
        axes.plot(*broken(truth).T, color=TRUTH, linewidth=3.4, zorder=4, gid="truth")
        entries.append(legend_line(TRUTH, 3.4, "true path"))
    drawn = set()
    for stage, path in _runs(track):
        thin = stage in (Stage.SEARCHING, Stage.ORIENTED)
        width = 1.1 if thin else 1.7
        axes.plot(
            *broken(path).T, color=ANSWER, linewidth=width, linestyle=STAGE_LINES[stage],
            zorder=5, alpha=0.75 if thin else 1.0, gid=f"path-{stage}",
        )  # fmt: skip
        drawn.add(stage)
    for stage in (stage for stage in Stage if stage in drawn):
        entries.append(legend_line(ANSWER, 1.5, f"answer, {stage}", STAGE_LINES[stage]))
    if _draw_discs(axes, plan, track):
        entries.append(legend_line(EMPTY, 1.4, "disc that holds 68 %, 95 %"))
    entries += _mark_declaration(axes, track)
    at = track.localized_at_s
    axes.set_title("Never localized" if at is None else f"Localized after {at:.1f} s")
    axes.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0.02), ncols=4)


def _runs(track: Track) -> Iterator[tuple[Stage, FloatArray]]:
    """Yield each stretch of one stage with its path (n, 2), joined to the one before if near."""
    stages = np.array([estimate.stage.value for estimate in track])
    position = track.position_m
    borders = [0, *(np.flatnonzero(stages[1:] != stages[:-1]) + 1).tolist(), len(stages)]
    for begin, end in pairwise(borders):
        near = begin > 0 and np.hypot(*(position[begin] - position[begin - 1])) <= _JUMP_M
        yield Stage(str(stages[begin])), position[begin - int(near) : end]


def _draw_discs(axes: Axes, plan: FloorPlan, track: Track) -> bool:
    """Draw the discs that hold 68 % and 95 % of the belief at some localized moments."""
    largest = _LARGEST * float(max(plan.size_m))
    sure = [e for e in track if e.is_localized and (e.radius_95_m or np.inf) <= largest]
    at = np.unique(np.linspace(0, len(sure) - 1, min(_DISCS, len(sure))).astype(int))
    for estimate in (sure[i] for i in at):
        assert estimate.position_m is not None
        x, y = (float(v) for v in estimate.position_m)
        radii = (estimate.radius_68_m or 0.0, "solid"), (estimate.radius_95_m or 0.0, (0, (3, 2)))
        for radius, dashes in radii:
            axes.add_patch(
                Circle((x, y), radius, fill=False, edgecolor=EMPTY, linewidth=1.4,
                       linestyle=dashes, zorder=6, gid="disc")
            )  # fmt: skip
    return bool(sure)


def _mark_declaration(axes: Axes, track: Track) -> list[Line2D]:
    """Put a star where the track first was localized."""
    first = next((e for e in track if e.is_localized), None)
    if first is None or first.position_m is None:
        return []
    star = axes.plot(
        [first.position_m[0]], [first.position_m[1]], marker="*", markersize=15, color=ANSWER,
        markeredgecolor="white", linestyle="none", zorder=9, label="localized here",
        gid="localized",
    )  # fmt: skip
    return [*star]


def _times(track: Track) -> FloatArray:
    return np.array([estimate.time_s for estimate in track])


def _metres_panel(axes: Axes, track: Track, error_m: FloatArray | None) -> None:
    time = _times(track)
    radius = np.array([np.nan if e.radius_95_m is None else e.radius_95_m for e in track])
    axes.plot(
        time, np.maximum(radius, _SMALLEST_M), color=SCAN, linewidth=1.4, linestyle=(0, (4, 1.6)),
        label="radius that holds 95 %",
    )  # fmt: skip
    shown = [radius]
    if error_m is not None:
        axes.plot(time, np.maximum(error_m, _SMALLEST_M), color=INK, linewidth=1.4, label="error")
        shown.append(error_m)
    finite = np.concatenate(shown)
    finite = finite[np.isfinite(finite)]
    axes.set_yscale("log")
    axes.set_ylim(_SMALLEST_M, max(20.0, 2.0 * float(finite.max(initial=1.0))))
    axes.set_yticks([0.1, 1.0, 10.0], ["0.1", "1", "10"])
    axes.minorticks_off()
    axes.set_ylabel("metres")
    axes.tick_params(labelbottom=False)
    axes.legend(loc="upper right", ncols=2, framealpha=0.8, frameon=True, edgecolor="none")
    _tidy(axes, time)


def _share_panel(axes: Axes, track: Track) -> None:
    time = _times(track)
    share = np.array([estimate.p_within_2m for estimate in track])
    axes.fill_between(time, share, step=None, color="#c9dff0", linewidth=0)
    axes.plot(time, share, color=SCAN, linewidth=1.2, label="within 2 m")
    axes.set_ylim(0.0, 1.04)
    axes.set_yticks([0.0, 0.5, 1.0], ["0", "50 %", "100 %"])
    axes.set_ylabel("probability\nwithin 2 m")
    axes.set_xlabel("time in s")
    _tidy(axes, time)


def _tidy(axes: Axes, time: FloatArray) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", color="#e3e3e3", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlim(float(time[0]), max(float(time[-1]), float(time[0]) + 1e-3))


def _mark_stages(axes: Axes, track: Track) -> None:
    """Mark t1 and t2 by vertical lines; words only where they do not coincide."""
    first, second = track.oriented_at_s, track.localized_at_s
    marks = [(first, "oriented, $t_1$", STAGE_LINES[Stage.ORIENTED])] if first != second else []
    word = "localized, $t_2$" if marks else "localized, $t_1 = t_2$"
    marks.append((second, word, STAGE_LINES[Stage.LOCALIZED]))
    for line, (at, word, dashes) in enumerate(reversed(marks)):
        if at is None:
            continue
        axes.axvline(
            at, color=MUTED, linewidth=1.0, linestyle=dashes, gid=f"at-{word.split(',')[0]}"
        )
        if axes.get_yscale() == "log":
            axes.annotate(
                word, (at, 0.0), xycoords=("data", "axes fraction"), xytext=(3, 4 + 11 * line),
                textcoords="offset points", fontsize=8, color=MUTED,
            )  # fmt: skip
