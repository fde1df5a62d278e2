"""One trial once more: how to rerun it, and a picture of it."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from itertools import pairwise
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from palms.belief import Stage
from palms.evaluation.experiment import Experiment, Subject
from palms.evaluation.oracle import ORACLE
from palms.floorplan import FloorPlan
from palms.geometry import FloatArray
from palms.io import Case
from palms.localizer import Track
from palms.plot.plans import draw_plan, figure_size
from palms.plot.story import broken
from palms.plot.style import (
    ANSWER,
    INK,
    STAGE_LINES,
    TRUTH,
    frame_map,
    legend_line,
    new_figure,
    styled,
)
from palms.settings import Settings

__all__ = ["case_figure", "rerun", "rerun_command"]

_JUMP_M: Final = 3.0  # an answer that moves farther in one step was not walked
_WIDTHS: Final = {Stage.SEARCHING: 1.1, Stage.ORIENTED: 1.2, Stage.LOCALIZED: 2.0, Stage.LOST: 1.3}


def rerun_command(experiment: Experiment, case: Case, record: Mapping[str, Any]) -> str:
    """Return the command line that runs one trial once more.

    The oracle is told the noise of a case, which `palms track` does not read, and our methods
    what happens on the way: their walks are run by `palms bench`, up to this trial.

    Examples
    --------
    >>> from pathlib import Path
    >>> case = Case("E2", Path("d/maps/E2.csv"), "w1", Path("d/w1/w1.json"), (Path("d/w1/S_7"),))
    >>> record = {"method": "paper", "seed": 42, "trial": 0}
    >>> rerun_command(Experiment(Path("d"), ("paper",)), case, record)
    'palms track d/maps/E2.csv d/w1/S_7 d/w1 --method paper --seed 42'
    >>> rerun_command(Experiment(Path("d"), ("oracle",)), case, record | {"method": "oracle"})
    'palms bench d --methods oracle --only E2/w1 --trials 1 --seed 0 --out rerun'
    """
    method = record["method"]
    more = _tells_more(case) and Settings.for_method(method).is_ours if method != ORACLE else True
    if more:
        words = ["palms", "bench", str(experiment.dataset), "--methods", method, "--only"]
        words += [case.title, "--trials", str(record["trial"] + 1), "--seed", str(experiment.seed)]
    else:
        words = ["palms", "track", str(case.plan_path), *map(str, case.scan_paths[:1])]
        words += [str(case.folder), "--method", method, "--seed", str(record["seed"])]
    if experiment.particles is not None:
        words += ["--particles", str(experiment.particles)]
    if experiment.walk_source != "arkit":
        words += ["--walk-source", experiment.walk_source]
    return shlex.join(words + (["--out", "rerun"] if more else []))


def _tells_more(case: Case) -> bool:
    """Whether our methods are told what `palms track` does not read: further scans, events."""
    return bool(len(case.scan_paths) > 1 or case.above_paths or case.events_path.is_file())


def rerun(experiment: Experiment, subject: Subject, record: Mapping[str, Any]) -> Track:
    """Run the trial of a record once more; its answers are what they were.

    Examples
    --------
    >>> from palms.sample import sample_folder
    >>> experiment = Experiment(sample_folder(), ("uniform",), particles=50)
    >>> (case,) = experiment.cases()
    >>> len(rerun(experiment, Subject.of(case), {"method": "uniform", "seed": 3}))
    227
    """
    settings = experiment.settings(record["method"], subject.noise)
    return next(subject.tracks(settings, [record["seed"]]))


@styled
def case_figure(plan: FloorPlan, track: Track, truth_m: FloatArray) -> Figure:
    """Draw plan, true path and the answers of one trial.

    Parameters
    ----------
    plan : FloorPlan
    track : Track
    truth_m : (T, 2)
        NaN where unknown.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> from palms import Estimate
    >>> steps = tuple(Estimate(t, Stage.LOCALIZED, np.array([t, 1.0])) for t in (1.0, 2.0))
    >>> plan = FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]])
    >>> len(case_figure(plan, Track(0, steps), np.ones((2, 2))).axes)
    1
    """
    figure = new_figure(*figure_size(plan, 34.0, extra_in=0.5))
    axes = figure.add_subplot()
    frame_map(axes, *plan.bounds_m)
    draw_plan(axes, plan, 0.5, colour="#9a9a9a")
    axes.plot(*broken(truth_m).T, color=TRUTH, linewidth=3.6, alpha=0.75, zorder=3)
    entries = [legend_line(TRUTH, 3.6, "true path")]
    stages = _draw_answers(axes, track)
    entries += [legend_line(ANSWER, _WIDTHS[s], f"answer, {s}", STAGE_LINES[s]) for s in stages]
    entries += _mark_ends(axes, track, truth_m)
    figure.legend(handles=entries, loc="outside lower center", ncols=4, fontsize=8)
    return figure


def _draw_answers(axes: Axes, track: Track) -> list[Stage]:
    """Draw the path in stretches of one stage, broken where it jumps; return the stages."""
    position = track.position_m
    stretch: list[int] = []
    drawn = set()

    def draw() -> None:
        if stretch:
            stage = track.estimates[stretch[-1]].stage
            path = position[stretch]
            axes.plot(
                path[:, 0], path[:, 1], color=ANSWER, linewidth=_WIDTHS[stage],
                linestyle=STAGE_LINES[stage], alpha=1.0 if stage is Stage.LOCALIZED else 0.85,
                zorder=4 + (stage is Stage.LOCALIZED),
            )  # fmt: skip
            drawn.add(stage)

    for before, now in pairwise(range(-1, len(track))):
        jumped = before >= 0 and not np.linalg.norm(position[now] - position[before]) <= _JUMP_M
        if jumped or np.isnan(position[now]).any():
            draw()
            stretch = []
        elif stretch and track.estimates[now].stage != track.estimates[before].stage:
            draw()
            stretch = [before]
        if not np.isnan(position[now]).any():
            stretch.append(now)
    draw()
    return [stage for stage in Stage if stage in drawn]


def _mark_ends(axes: Axes, track: Track, truth_m: FloatArray) -> list[Line2D]:
    """Mark start and end of the truth, and the last answer."""
    known = truth_m[~np.isnan(truth_m).any(axis=1)]
    answered = track.position_m[~np.isnan(track.position_m).any(axis=1)]
    marks: list[Line2D] = []
    for points, at, marker, colour, word in (
        (known, 0, "o", TRUTH, "true start"), (known, -1, "s", TRUTH, "true end"),
        (answered, -1, "D", ANSWER, "last answer"),
    ):  # fmt: skip
        if len(points):
            marks += axes.plot(
                points[at, 0], points[at, 1], linestyle="none", marker=marker, markersize=7,
                color=colour, markeredgecolor=INK, markeredgewidth=0.9, zorder=7, label=word,
            )  # fmt: skip
    return marks
