"""Draw the documentation's figures from our own runs: ``python tools/make_figures.py``.

They go into ``docs/figures``; ``--out FOLDER`` writes elsewhere. The same bytes every time.
"""

from __future__ import annotations

import argparse
import io
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon
from PIL import Image

import palms
from palms.geometry import FloatArray, rotate
from palms.grid import Grid
from palms.heatmap import Heatmaps, correlate, find_candidates, match, scan_drifts
from palms.io import Label, RecordedWalk, open_dataset
from palms.particles import start_from
from palms.plot.output import image_bytes, write_bytes
from palms.plot.pipeline import draw_scan, pipeline_figure
from palms.plot.plans import draw_plan
from palms.plot.recorder import Recorder, Snapshot
from palms.plot.style import (
    ANSWER,
    EMPTY,
    GROUPS,
    INK,
    MUTED,
    SCAN,
    TRUTH,
    answer_mark,
    degrees,
    draw_particles,
    frame_map,
    new_figure,
    styled,
    truth_mark,
)
from palms.randomness import as_key
from palms.sample import sample_folder
from palms.template import certainly_empty, empty_triangles

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "figures"
SEED = 0
METHODS = {
    "uniform": "uniform: everywhere, any drift",
    "uniform-ori": "uniform-ori: everywhere, four drifts",
    "paper": "paper: where the scan fits",
}
INTRUDER = "#d7191c"  # plan walls that stand where none can be
WINDOW_M = 5.8  # half of what a map around a match shows
FAR_M = 10.0  # a wrong place is at least so far from the truth
COLOURS = 256  # of a picture without shades: a palette keeps it small


@dataclass(frozen=True)
class Sample:
    """The sample data set, read and matched."""

    raster: palms.PlanRaster
    scan: palms.Scan
    label: Label
    walk: RecordedWalk
    heatmaps: Heatmaps

    @property
    def true_k(self) -> int:
        """Index of the right drift."""
        off = self.heatmaps.drifts_rad - self.label.drift_rad
        return int(np.abs(np.angle(np.exp(1j * off))).argmin())


def read_sample() -> Sample:
    """Read the sample data set."""
    case = open_dataset(sample_folder()).cases[0]
    raster, scan, label = palms.rasterize(case.plan()), case.scan(), case.label()
    if label is None:
        raise SystemExit("the sample has no label")
    heatmaps = match(scan, raster, scan_drifts(scan, raster))
    return Sample(raster, scan, label, case.walk(), heatmaps)


def pipeline(sample: Sample) -> Figure:
    """Draw the paper's Fig. 1."""
    candidates = find_candidates(sample.heatmaps)
    particles = start_from(candidates, 2000, as_key(SEED).child(0), own_frame=False)
    return pipeline_figure(sample.heatmaps, candidates, particles, sample.label.position_m)


@styled
def empty_space(sample: Sample) -> Figure:
    """Draw the paper's Fig. 2: a match that respects empty space, and one that does not."""
    figure = new_figure(13.0, 4.9)
    left, middle, right = figure.subplots(1, 3)
    drift = float(sample.heatmaps.drifts_rad[sample.true_k])
    walls = rotate(sample.scan.relative_m, drift)
    frame_map(left, (-WINDOW_M, -WINDOW_M), (WINDOW_M, WINDOW_M))
    _draw_match(left, sample, walls, np.zeros(2), with_plan=False)
    left.set_title(f"1  The scan, turned by {degrees(drift)}, and its certainly empty space")
    for axes, place, word in (
        (middle, _best_place(sample), "2  A match"),
        (right, _contradicted_place(sample), "3  No match"),
    ):
        low, high = place - WINDOW_M, place + WINDOW_M
        frame_map(axes, low, high)
        inside_m = _draw_match(axes, sample, walls, place, with_plan=True)
        axes.set_title(f"{word}: {inside_m:.1f} m of wall in the empty space")
    figure.legend(
        handles=[
            Line2D([], [], color="#333333", linewidth=1.5, label="wall of the plan"),
            Line2D([], [], color=SCAN, linewidth=2.6, label="wall that the scan saw"),
            Patch(facecolor=EMPTY, alpha=0.45, label="certainly empty space"),
            Line2D([], [], color=INTRUDER, linewidth=4.0, label="plan wall inside it"),
            Line2D([], [], color=INK, marker="o", linestyle="none", label="observation point"),
        ],
        loc="outside lower center", ncols=5,
    )  # fmt: skip
    return figure


def _draw_match(
    axes: Axes, sample: Sample, walls: FloatArray, place: FloatArray, with_plan: bool
) -> float:
    """Draw a scan laid on a place; return the metres of plan wall in its empty space."""
    triangles = empty_triangles(walls, sample.heatmaps.settings.empty_shrink) + place
    space = shapely.union_all([shapely.Polygon(each) for each in triangles])
    for part in shapely.get_parts(space):
        axes.add_patch(
            Polygon(np.asarray(part.exterior.coords), facecolor=EMPTY, alpha=0.45, linewidth=0)
        )
    inside_m = 0.0
    if with_plan:
        plan = sample.raster.plan
        draw_plan(axes, plan, 0.9)
        cut = shapely.intersection(shapely.linestrings(plan.blocking_m), space)
        inside_m = float(shapely.length(cut).sum())
        lines = [np.asarray(each.coords) for each in shapely.get_parts(cut) if each.length > 0]
        axes.add_collection(LineCollection(lines, colors=INTRUDER, linewidths=4.5, zorder=7))
    draw_scan(axes, walls + place)
    axes.plot(*place, marker="o", markersize=6, color=INK, zorder=8)
    return inside_m


def _best_place(sample: Sample) -> FloatArray:
    """Return the best cell of the right drift."""
    return sample.heatmaps.grid.position_of(sample.heatmaps.best_cell(sample.true_k))


def _contradicted_place(sample: Sample) -> FloatArray:
    """Far from the truth, where the walls fit best although walls stand in the empty space."""
    heatmaps, k = sample.heatmaps, sample.true_k
    settings = replace(heatmaps.settings, empty_weight=0.0)
    fits = match(sample.scan, sample.raster, heatmaps.drifts_rad, settings)
    template = fits.template(k)
    cell = heatmaps.grid.cell_size_m
    corner = -(np.array(template.anchor[::-1]) + 0.5) * cell
    around = Grid(corner, cell, template.values.shape)
    walls = rotate(sample.scan.relative_m, template.drift_rad)
    empty = replace(template, values=certainly_empty(walls, around, settings))
    intruding = correlate(sample.raster, empty) > 1.5 / cell  # metres of wall
    rows, columns = np.indices(heatmaps.grid.shape)
    centres = heatmaps.grid.position_of(np.stack([rows, columns], axis=-1))
    far = np.linalg.norm(centres - sample.label.position_m, axis=-1) > FAR_M
    score = np.where(intruding & far, fits.scores(k), -np.inf)
    return heatmaps.grid.position_of(np.unravel_index(int(score.argmax()), score.shape))


@dataclass(frozen=True)
class Moment:
    """A moment of a walk: what it is called, and the index of its step."""

    word: str
    step: int


@dataclass(frozen=True)
class Run:
    """A tracked walk with all its snapshots, and whether its particles have labels."""

    track: palms.Track
    frames: list[Snapshot]
    has_labels: bool

    @property
    def moments(self) -> Iterator[Moment]:
        """Start, half of the way to t1, t2 (with t1 when they coincide), end."""
        stages = [estimate.stage for estimate in self.track]
        t1 = next((i for i, s in enumerate(stages) if s != palms.Stage.SEARCHING), None)
        t2 = next((i for i, s in enumerate(stages) if s == palms.Stage.LOCALIZED), None)
        yield Moment("start", 0)
        if t1 is not None:
            yield Moment("on the way", t1 // 2)
        if t2 is not None:
            yield Moment("t1 = t2" if t1 == t2 else "t2", t2)
        yield Moment("end", len(stages) - 1)


def follow(sample: Sample, method: str) -> Run:
    """Track the sample's walk by a method."""
    recorder = Recorder(every=1)
    settings = palms.Settings.for_method(method)
    track = palms.track(
        sample.raster, sample.scan, sample.walk.odometry(), settings, SEED, watch=recorder
    )
    waited = len(track) - len(recorder.frames)  # moves before there was a belief
    has_labels = settings.convergence.step1 == "label"
    return Run(track, [recorder.frames[0]] * waited + recorder.frames, has_labels)


@styled
def stages(sample: Sample) -> Figure:
    """Draw the paper's Fig. 3: methods by moments."""
    figure = new_figure(13.0, 9.6)
    table = figure.subplots(len(METHODS), 4)
    for row, (method, title) in zip(table, METHODS.items(), strict=True):
        run = follow(sample, method)
        for axes, moment in zip(row, run.moments, strict=False):
            _draw_moment(axes, sample, run, moment)
        row[0].text(-0.03, 0.5, title, rotation=90, transform=row[0].transAxes, va="center",
                    ha="right", fontsize=9.5)  # fmt: skip
    figure.legend(handles=_moment_legend(also_any=True), loc="outside lower center", ncols=8)
    return figure


@styled
def readme(sample: Sample) -> Figure:
    """Draw three moments of the paper's method."""
    figure = new_figure(13.0, 4.1)
    run = follow(sample, "paper")
    moments = [moment for moment in run.moments if moment.word != "on the way"]
    for axes, moment in zip(figure.subplots(1, 3), moments, strict=True):
        _draw_moment(axes, sample, run, moment)
    figure.legend(handles=_moment_legend(), loc="outside lower center", ncols=8)
    return figure


def _draw_moment(axes: Axes, sample: Sample, run: Run, moment: Moment) -> None:
    plan, step = sample.raster.plan, moment.step
    frame, truth = run.frames[step], sample.walk.reference_m
    estimate = run.track.estimates[step]
    frame_map(axes, *plan.bounds_m)
    draw_plan(axes, plan, 0.35, colour="#9a9a9a")
    if run.has_labels:
        draw_particles(axes, frame.position_m.astype(float), frame.group, 1.8)
    else:
        axes.plot(*frame.position_m.T, "o", markersize=1.8, markeredgewidth=0, color=MUTED)
    path = np.vstack([sample.label.position_m, truth[: step + 1]])
    axes.plot(*path.T, color=TRUTH, linewidth=1.6, zorder=6)
    truth_mark(axes, *truth[step])
    told = f"{moment.word}, {estimate.time_s:.0f} s: {estimate.stage}"
    if estimate.position_m is not None:
        answer_mark(axes, *estimate.position_m)
        told += f", {np.hypot(*(estimate.position_m - truth[step])):.1f} m off"
    axes.set_title(told, fontsize=9)


def _moment_legend(also_any: bool = False) -> list[Line2D]:
    any_drift = Line2D([], [], linestyle="none", marker="o", color=MUTED, markersize=5,
                       label="any drift")  # fmt: skip
    drifts = [any_drift] * also_any + [
        Line2D([], [], linestyle="none", marker=s.marker, color=s.colour, markersize=5,
               label=f"drift {s.word}")
        for s in GROUPS
    ]  # fmt: skip
    return [
        *drifts,
        Line2D([], [], linestyle="none", marker="o", color=ANSWER, markersize=7, label="answer"),
        Line2D([], [], linestyle="none", marker="x", color=TRUTH, markersize=8,
               markeredgewidth=2.4, label="true place"),
        Line2D([], [], color=TRUTH, linewidth=1.6, label="true path"),
    ]  # fmt: skip


def write_small(path: Path, figure: Figure, dpi: float, has_shades: bool) -> None:
    """Write a figure as a small PNG."""
    picture = Image.open(io.BytesIO(image_bytes(figure, "png", dpi))).convert("RGB")
    if not has_shades:
        picture = picture.quantize(COLOURS, dither=Image.Dither.NONE)
    buffer = io.BytesIO()
    picture.save(buffer, "PNG", optimize=True)
    write_bytes(path, buffer.getvalue())


FIGURES = {  # how to draw it, pixels per inch, whether it has shades of colour
    "pipeline": (pipeline, 90.0, True),
    "empty-space": (empty_space, 100.0, False),
    "stages": (stages, 110.0, False),
    "readme": (readme, 100.0, False),
}


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("only", nargs="*", help=f"some of {', '.join(FIGURES)}")
    parser.add_argument("--out", type=Path, default=FOLDER, help="where to (default: docs/figures)")
    arguments = parser.parse_args()
    sample = read_sample()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name, (draw, dpi, has_shades) in FIGURES.items():
        if not arguments.only or name in arguments.only:
            path = arguments.out / f"{name}.png"
            write_small(path, draw(sample), dpi, has_shades)
            print(f"{path.stat().st_size:8d}  {path.name}")


if __name__ == "__main__":
    main()
