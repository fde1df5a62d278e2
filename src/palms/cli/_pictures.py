"""From results to pictures in files."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from palms.cli._words import at_the_end, outcome
from palms.io.files import make_folder
from palms.io.track_json import versions
from palms.localizer import locate, track
from palms.plot.album import make_album, write_album
from palms.plot.candidates import candidates_figure
from palms.plot.output import write_figure
from palms.plot.plans import plan_figure
from palms.plot.recorder import Recorder
from palms.plot.report import Details, write_report
from palms.plot.story import Story
from palms.raster import rasterize

if TYPE_CHECKING:
    from palms.cli._inputs import Case
    from palms.floorplan import FloorPlan
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
    told = [*outcome(story.track, case), *at_the_end(story.track, case)]
    return Details(
        title=f"{case.walk_name} on {case.plan.name}: where is the phone?",
        summary=tuple(sentence for sentence in told if sentence),
        command=shlex.join(["palms", *sys.argv[1:]]),
        versions=versions(),
        notes={"Scan, walk": f"{case.scan_name}, {case.walk_name} ({case.source})"},
    )


def tell_story(case: Case, settings: Settings, seed: int) -> Story:
    """Track a walk as `follow` does, the same to the bit, and keep what pictures need."""
    raster = rasterize(case.plan, settings.raster)
    recorder, by_scan = Recorder(), settings.start.by_scan
    answers = track(raster, case.scan, case.odometry, settings, seed, recorder)
    return Story(
        raster,
        case.odometry,
        answers,
        recorder,
        case.scan,
        locate(raster, case.scan, settings) if by_scan else None,
        case.walk.reference_m if case.walk.has_reference.any() else None,
        case.walk.start_m,
        settings,
    )
