"""The paper's Fig. 3: methods by moments of a walk."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from palms.errors import InputError
from palms.plot.plans import draw_plan
from palms.plot.recorder import MOMENTS, Snapshot
from palms.plot.story import Story, broken
from palms.plot.style import (
    MUTED,
    TRUTH,
    answer_entry,
    answer_mark,
    draw_particles,
    frame_map,
    group_entries,
    new_figure,
    styled,
    truth_entry,
    truth_mark,
)

__all__ = ["draw_moment", "moment_words", "moments_of", "stages_figure"]

_TITLES: Final = {
    "start": "start",
    "half": "half way",
    "t1": "$t_1$: oriented",
    "t2": "$t_2$: localized",
    "end": "end",
}
_NEVER: Final = {
    "start": "no particles",
    "half": "no particles",
    "t1": "never oriented",
    "t2": "never localized",
    "end": "no particles",
}


@styled
def stages_figure(stories: Mapping[str, Story], moments: Sequence[str] | None = None) -> Figure:
    """Draw the particles of several methods at the start, at t1, at t2 and at the end.

    Parameters
    ----------
    stories : mapping of str to Story
        One row each, under its name.
    moments : sequence of str, optional
        Columns, some of start, half, t1, t2 and end. When left out start, t1, t2 and end,
        with half of the way there in place of t1 where t1 and t2 coincide for all.

    Returns
    -------
    matplotlib Figure

    Raises
    ------
    InputError
        When there is no story.

    Examples
    --------
    >>> from palms import FloorPlan, Odometry, Scan, rasterize, track
    >>> from palms.plot import Recorder
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
    >>> raster, scan = rasterize(FloorPlan(room)), Scan(room - (2.0, 1.0))
    >>> walk, recorder = Odometry([1, 2], [[0.5, 0], [1, 0]]), Recorder()
    >>> story = Story(raster, walk, track(raster, scan, walk, watch=recorder), recorder, scan)
    >>> [axes.get_title(loc="left") for axes in stages_figure({"palms": story}).axes][0]
    'start'
    """
    if not stories:
        raise InputError("stages figure", expected="at least one method", got="none")
    width, height = next(iter(stories.values())).plan.size_m
    together = _together(stories)
    moments = moments_of(stories) if moments is None else moments
    across = 12.4 / len(moments)
    panel = across / float(np.clip(width / max(height, 1e-6), 0.6, 2.5)) + 0.75
    figure = new_figure(13.0, len(stories) * panel + 0.6)
    table = figure.subplots(len(stories), len(moments), squeeze=False)
    for row, (name, story) in zip(table, stories.items(), strict=True):
        for axes, moment in zip(row, moments, strict=True):
            _cell(axes, story, moment)
        row[0].text(
            -0.02, 0.5, name, transform=row[0].transAxes, rotation=90, ha="right", va="center",
            fontsize=11,
        )  # fmt: skip
    for axes, moment in zip(table[0], moments, strict=True):
        both = together and moment == "t2" and "t1" not in moments
        axes.set_title("$t_1 = t_2$: localized" if both else _TITLES[moment])
    entries = _entries(stories)
    figure.legend(handles=entries, loc="outside lower center", ncols=len(entries))
    return figure


def moments_of(stories: Mapping[str, Story]) -> tuple[str, ...]:
    """Return the columns of the figure: one less where t1 and t2 coincide, and half way there."""
    return ("start", "half", "t2", "end") if _together(stories) else MOMENTS


def _together(stories: Mapping[str, Story]) -> bool:
    """Whether t1 and t2 coincide for all that were localized, and some were."""
    each = stories.values()
    some = any(story.track.localized_at_s is not None for story in each)
    return some and all(story.t1_is_t2 for story in each)


def draw_moment(axes: Axes, story: Story, snapshot: Snapshot) -> None:
    """Draw particles, answer and the true path so far over the plan.

    Parameters
    ----------
    axes : Axes
    story : Story
    snapshot : Snapshot
        Of the story's recorder.
    """
    frame_map(axes, *story.plan.bounds_m)
    draw_plan(axes, story.plan, 0.4, colour="#9a9a9a")
    draw_particles(axes, snapshot.position_m, snapshot.group, 2.4)
    if story.truth_m is not None:
        so_far = story.truth_m[: story.step_at(snapshot.time_s) + 1]
        axes.plot(*broken(so_far).T, color=TRUTH, linewidth=1.6, zorder=7, gid="path")
        truth_mark(axes, *so_far[-1])
    if snapshot.estimate.position_m is not None:
        answer_mark(axes, *snapshot.estimate.position_m)


def moment_words(story: Story, snapshot: Snapshot) -> str:
    """Return what stands under a picture: the time, and how far off the answer is.

    Parameters
    ----------
    story : Story
    snapshot : Snapshot
    """
    words = f"t = {snapshot.time_s:.1f} s"
    position = snapshot.estimate.position_m
    if story.truth_m is None or position is None:
        return words
    truth = story.truth_m[story.step_at(snapshot.time_s)]
    error = float(np.hypot(*(position - truth)))
    if not np.isfinite(error):
        return words
    if story.atlas is not None:
        answered, true = story.atlas.level_of(np.stack([position, truth]))
        if answered != true:
            return f"{words}, on another level"
    return f"{words}, {error:.1f} m off"


def _cell(axes: Axes, story: Story, moment: str) -> None:
    snapshot = story.snapshot(moment)
    if snapshot is None:
        frame_map(axes, *story.plan.bounds_m)
        draw_plan(axes, story.plan, 0.4, colour="#dcdcdc")
        axes.text(
            0.5, 0.55, _NEVER[moment], transform=axes.transAxes, ha="center", va="center",
            fontsize=11, zorder=9, bbox={"facecolor": "white", "edgecolor": "none", "pad": 3.0},
        )  # fmt: skip
        axes.set_xlabel("—", color=MUTED)
        return
    draw_moment(axes, story, snapshot)
    axes.set_xlabel(moment_words(story, snapshot) + _coincidence(story, moment))


def _coincidence(story: Story, moment: str) -> str:
    coincide = story.t1_is_t2 and story.track.localized_at_s is not None
    return ", with $t_1$" if moment == "t2" and coincide else ""


def _entries(stories: Mapping[str, Story]) -> list[Line2D]:
    groups: set[int] = set()
    for story in stories.values():
        for moment in MOMENTS:
            snapshot = story.recorder.moment(moment)
            groups |= set() if snapshot is None else set(np.unique(snapshot.group).tolist())
    entries = [*group_entries(sorted(groups)), answer_entry()]
    if any(story.truth_m is not None for story in stories.values()):
        entries += [truth_entry(), Line2D([], [], color=TRUTH, linewidth=1.6, label="true path")]
    return entries
