"""From results to pictures in files."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palms.io.files import make_folder
from palms.localizer import locate, track
from palms.plot.output import write_figure
from palms.plot.pipeline import pipeline_figure
from palms.plot.plans import draw_plan as draw_segments
from palms.plot.plans import figure_size, plan_figure
from palms.plot.recorder import Recorder
from palms.plot.story import Story
from palms.plot.style import ANSWER, GROUPS, INK, MUTED, frame_map, new_figure, styled
from palms.raster import rasterize

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from palms.cli._inputs import Case
    from palms.floorplan import FloorPlan
    from palms.places import Place
    from palms.scan import Scan
    from palms.settings import Settings

__all__ = ["draw_places", "draw_plan", "draw_walk", "places_figure", "tell_story"]


def draw_plan(path: Path, plan: FloorPlan) -> None:
    """Write a picture of a floor plan."""
    write_figure(path, plan_figure(plan))


def draw_places(path: Path, plan: FloorPlan, scan: Scan, places: Sequence[Place]) -> None:
    """Write a picture of candidate places."""
    write_figure(path, places_figure(plan, scan, places))


@styled
def places_figure(plan: FloorPlan, scan: Scan, places: Sequence[Place]) -> Figure:
    """Draw candidate places over their plan, with the walls that the scan saw from each.

    Parameters
    ----------
    plan : FloorPlan
    scan : Scan
    places : sequence of Place
        In order; they are numbered from 1.
    """
    from matplotlib.collections import LineCollection

    from palms.geometry import rotate

    figure = new_figure(*figure_size(plan, 70.0, extra_in=0.6))
    axes = figure.add_subplot()
    frame_map(axes, *plan.bounds_m)
    draw_segments(axes, plan, colour=MUTED)
    for rank, place in reversed(list(enumerate(places, start=1))):
        colour = ANSWER if rank == 1 else GROUPS[1].colour
        walls = np.add(rotate(scan.relative_m, place.drift_rad), (place.x_m, place.y_m))
        axes.add_collection(LineCollection(list(walls), colors=colour, linewidths=2.4, zorder=5))
        axes.plot(
            [place.x_m], [place.y_m], "o", markersize=13, color="white",
            markeredgecolor=colour, markeredgewidth=1.6, zorder=6,
        )  # fmt: skip
        axes.text(
            place.x_m, place.y_m, str(rank), color=INK, fontsize=8, ha="center",
            va="center_baseline", zorder=7,
        )  # fmt: skip
    best = places[0]
    axes.set_title(
        f"Where the scan may have been taken on {plan.name}: the {len(places)} most probable "
        f"places,\nwith the walls seen from each. Place 1: {100 * best.p:.1f} %, "
        f"drift {math.degrees(best.drift_rad):.1f}°"
    )
    return figure


def draw_walk(folder: Path, case: Case, settings: Settings, seed: int) -> list[Path]:
    """Write the pictures of a tracked walk into a folder, made when it is not there.

    Returns
    -------
    list of Path
        What was written, the most worth looking at first.
    """
    story = tell_story(case, settings, seed)
    make_folder(folder)
    written = []
    if story.heatmaps is not None and story.candidates is not None:
        place = story.scan_place_m
        figure = pipeline_figure(story.heatmaps, story.candidates, truth_m=place)
        written.append(folder / "pipeline.png")
        write_figure(written[-1], figure)
    written.append(folder / "plan.png")
    write_figure(written[-1], plan_figure(case.plan))
    return written


def tell_story(case: Case, settings: Settings, seed: int) -> Story:
    """Track a walk again, the same to the bit, and keep what pictures need."""
    raster = rasterize(case.plan, settings.raster)
    recorder, by_scan = Recorder(), settings.start.source == "scan"
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
