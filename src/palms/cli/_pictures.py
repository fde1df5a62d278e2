"""From results to pictures in files."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palms.cli._words import at_the_end, outcome
from palms.io.files import make_folder
from palms.io.track_json import versions
from palms.levels import on_atlas
from palms.localizer import locate, track
from palms.localizer.live import ground
from palms.plot.album import make_album, write_album
from palms.plot.candidates import candidates_figure
from palms.plot.output import write_figure
from palms.plot.plans import plan_figure
from palms.plot.recorder import Recorder
from palms.plot.report import Details, write_report
from palms.plot.story import Story

if TYPE_CHECKING:
    from palms.belief import Belief, Estimate
    from palms.building import Atlas
    from palms.cli._inputs import Case
    from palms.floorplan import FloorPlan
    from palms.geometry import FloatArray
    from palms.localizer import Track
    from palms.particles import MoveInfo
    from palms.places import Place
    from palms.scan import Scan
    from palms.settings import Settings

__all__ = ["draw_places", "draw_plan", "draw_walk", "tell_story"]


def draw_plan(path: Path, plan: FloorPlan) -> None:
    """Write a picture of a floor plan."""
    write_figure(path, plan_figure(plan))


def draw_places(path: Path, plan: FloorPlan, scan: Scan, places: Sequence[Place]) -> None:
    """Write a picture of candidate places."""
    write_figure(path, candidates_figure(plan, places, scan))


def draw_walk(folder: Path, story: Story, case: Case) -> list[Path]:
    """Write report, pictures and animation of a walk into a folder, made when it is not there.

    Returns
    -------
    list of Path
        What was written, the most worth looking at first.
    """
    album = make_album(story)
    make_folder(folder)
    written = write_album(folder, album)
    report = folder / "report.html"
    write_report(report, story, _details(story, case), album)
    return [report, *written]


def _details(story: Story, case: Case) -> Details:
    """Return what a report says about a walk besides its numbers."""
    answers = story.track if story.atlas is None else _folded(story.track, story.atlas)
    told = [*outcome(answers, case), *at_the_end(answers, case)]
    return Details(
        title=f"{case.walk_name} on {case.plan.name}: where is the phone?",
        summary=tuple(sentence for sentence in told if sentence),
        command=shlex.join(["palms", *sys.argv[1:]]),
        versions=versions(),
        notes={"Scan, walk": f"{case.scan_name}, {case.walk_name} ({case.source})"},
    )


def tell_story(case: Case, settings: Settings, seed: int) -> Story:
    """Track a walk as `follow` does, the same to the bit, and keep what pictures need.

    In a building of several levels everything is laid out on its atlas.
    """
    where, atlas = case.ground, None if case.building is None else case.building.atlas
    raster = ground(where, settings)
    recorder, by_scan = Recorder(), settings.start.by_scan

    def watch(estimate: Estimate, belief: Belief, info: MoveInfo) -> None:
        recorder(estimate if atlas is None else on_atlas(estimate, atlas), belief, info)

    there = raster if atlas is None else where
    answers = track(there, case.told, case.odometry, settings, seed, watch)
    return Story(
        raster,
        case.odometry,
        answers if atlas is None else _laid_out(answers, atlas),
        recorder,
        case.scan,
        locate(raster, case.scan, settings) if by_scan else None,
        _truth(case, atlas),
        _start(case, atlas),
        settings,
        atlas,
    )


def _laid_out(track: Track, atlas: Atlas) -> Track:
    return replace(track, estimates=tuple(on_atlas(each, atlas) for each in track))


def _folded(track: Track, atlas: Atlas) -> Track:
    """Return the answers in the map again, which is what words are about."""
    known = [
        each if each.position_m is None
        else replace(each, position_m=atlas.folded(each.position_m[None])[0])
        for each in track
    ]  # fmt: skip
    return replace(track, estimates=tuple(known))


def _truth(case: Case, atlas: Atlas | None) -> FloatArray | None:
    """Return the reference; on an atlas only where its levels are known."""
    walk = case.walk
    if not walk.has_reference.any():
        return None
    if atlas is None:
        return walk.reference_m
    if walk.truth is None or not set(walk.truth.level) <= set(atlas.names):
        return None
    shift = atlas.shift_m[[atlas.names.index(name) for name in walk.truth.level]]
    return np.asarray(walk.reference_m + shift)


def _start(case: Case, atlas: Atlas | None) -> FloatArray | None:
    """Return where the walk started; on an atlas on the level of its first sample."""
    start, truth = case.walk.start_m, case.walk.truth
    if atlas is None or start is None:
        return start
    if truth is None or truth.level[0] not in atlas.names:
        return None
    return np.asarray(start + atlas.shift_m[atlas.names.index(truth.level[0])])
