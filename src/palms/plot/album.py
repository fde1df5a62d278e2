"""Album: all pictures of one walk, each with words for those who do not see it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from palms.geometry import FloatArray
from palms.heatmap import Heatmaps
from palms.io.files import write_bytes
from palms.places import Place, find_places, place_on_level
from palms.plot.animation import animation_bytes
from palms.plot.candidates import candidates_figure
from palms.plot.empty_space import (
    empty_space_figure,
    length_m,
    right_match,
    walls_inside,
    wrong_match,
)
from palms.plot.output import image_bytes
from palms.plot.pipeline import named_guesses, pipeline_figure
from palms.plot.plans import plan_figure
from palms.plot.stages import moment_words, moments_of, stages_figure
from palms.plot.story import Story
from palms.plot.style import degrees
from palms.plot.tracks import track_figure

__all__ = ["Picture", "make_album", "write_album"]

_PLACES = 9  # candidate places that are drawn
_DPI = 110.0


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture as bytes, and in words.

    Parameters
    ----------
    name : str
        Of its file: ``track.png``.
    title : str
    content : bytes
        PNG or GIF.
    words : str
        What it shows, for those who do not see it.

    Examples
    --------
    >>> Picture("walk.gif", "The walk", b"", "Particles gather.").mime
    'image/gif'
    """

    name: str
    title: str
    content: bytes
    words: str

    @property
    def mime(self) -> str:
        """Its media type."""
        return f"image/{Path(self.name).suffix[1:]}"


def make_album(story: Story) -> tuple[Picture, ...]:
    """Draw all pictures of a walk that there is data for, the most telling first.

    Parameters
    ----------
    story : Story

    Returns
    -------
    tuple of Picture
        ``track.png``, ``walk.gif``, ``stages.png``, with a scan also ``pipeline.png``,
        ``empty-space.png`` and ``candidates.png``, and ``plan.png``.

    Examples
    --------
    >>> from palms import FloorPlan, Odometry, rasterize, track
    >>> from palms.plot import Recorder
    >>> from palms.settings import Settings
    >>> room = [[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]]
    >>> raster, walk = rasterize(FloorPlan(room)), Odometry([1, 2], [[0.5, 0], [1, 0]])
    >>> recorder = Recorder()
    >>> answers = track(raster, None, walk, Settings.uniform(), watch=recorder)
    >>> [picture.name for picture in make_album(Story(raster, walk, answers, recorder))]
    ['track.png', 'walk.gif', 'stages.png', 'plan.png']
    """
    return tuple(_pictures(story))


def write_album(folder: str | os.PathLike[str], album: tuple[Picture, ...]) -> list[Path]:
    """Write all pictures into a folder, which must exist.

    Parameters
    ----------
    folder : path
    album : tuple of Picture

    Returns
    -------
    list of Path
        In the album's order.

    Raises
    ------
    OutputError
        When one cannot be written.
    """
    paths = [Path(folder) / picture.name for picture in album]
    for path, picture in zip(paths, album, strict=True):
        write_bytes(path, picture.content)
    return paths


def _pictures(story: Story) -> Iterator[Picture]:
    plan = story.plan
    if len(story.track):
        figure = track_figure(plan, story.track, story.truth_m)
        yield Picture("track.png", "The answers", image_bytes(figure, dpi=_DPI), _of_track(story))
    if len(story.recorder):
        yield Picture("walk.gif", "The walk", animation_bytes(story), _of_animation(story))
        figure = stages_figure({story.settings.method: story})
        yield Picture(
            "stages.png", "Start, t1, t2 and end", image_bytes(figure, dpi=_DPI), _of_stages(story)
        )
    if story.heatmaps is not None:
        yield from _pictures_of_scan(story)
    yield Picture("plan.png", "The floor plan", image_bytes(plan_figure(plan), dpi=_DPI),
                  _of_plan(story))  # fmt: skip


def _pictures_of_scan(story: Story) -> Iterator[Picture]:
    heatmaps, candidates, here = story.heatmaps, story.candidates, story.scan_place_m
    maps = story.maps
    assert heatmaps is not None
    assert maps is not None
    assert candidates is not None
    figure = pipeline_figure(maps, candidates, truth_m=here)
    yield Picture("pipeline.png", "From the scan to particles", image_bytes(figure, dpi=_DPI),
                  _of_pipeline(story))  # fmt: skip
    figure = empty_space_figure(heatmaps, here)
    yield Picture("empty-space.png", "Certainly empty space", image_bytes(figure, dpi=_DPI),
                  _of_empty_space(heatmaps, here))  # fmt: skip
    places = find_places(candidates)[:_PLACES]
    spot = None if here is None else here.tolist()
    figure = candidates_figure(story.plan, places, story.scan, spot)
    if story.atlas is not None:
        places = tuple(place_on_level(place, story.atlas) for place in places)
    yield Picture("candidates.png", "Where the scan alone may have been taken",
                  image_bytes(figure, dpi=_DPI), _of_candidates(places))  # fmt: skip


def _of_track(story: Story) -> str:
    track = story.track
    at, last = track.localized_at_s, track.estimates[-1]
    words = ["Map of the floor plan with the path of the answers, dotted while searching"]
    words.append(
        ". The walk was never localized" if at is None else f" and solid from {at:.1f} s, localized"
    )
    if story.error_m is not None and np.isfinite(story.error_m).any():
        known = story.error_m[np.isfinite(story.error_m)]
        words.append(
            f". Against the true path the answers are off by {np.median(known):.1f} m in the "
            f"median and {known[-1]:.1f} m at the end"
        )
    words.append(f". Beneath it, over time: {'' if story.error_m is None else 'the error, '}")
    words.append("the radius that holds 95 % of the belief, and the probability within 2 m, ")
    words.append(f"which ends at {100 * last.p_within_2m:.0f} %.")
    return "".join(words)


def _of_animation(story: Story) -> str:
    n, first = len(story.recorder), story.recorder.frames[0]
    return (
        f"Animation over {n} steps: {len(first.position_m):,} particles move over the plan as the "
        "user walks, coloured and shaped by their drift; a red dot is the answer"
        + ("." if story.truth_m is None else ", a green cross the true place.")
    )


def _of_stages(story: Story) -> str:
    told = []
    shown = moments_of({"": story})
    for moment in shown:
        snapshot = story.snapshot(moment)
        words = "never came" if snapshot is None else moment_words(story, snapshot)
        name = {"half": "half way there", "t2": "t2" if "t1" in shown else "t1 and t2"}
        told.append(f"{name.get(moment, moment)}: {words}")
    return "Particles on the plan at four moments. " + "; ".join(told) + "."


def _of_pipeline(story: Story) -> str:
    assert story.candidates is not None
    assert story.scan is not None
    drifts = story.candidates.drifts_rad
    listed = ", ".join(degrees(float(drift)) for drift in drifts[:4])
    tried = f"drifts of {listed}" if len(drifts) <= 4 else f"the best of {len(drifts)} drifts"
    return (
        f"Five steps from left to right: the {len(story.scan.walls_m)} walls of the scan; the "
        "floor plan; the template of wanted walls and certainly empty space; heatmaps of where "
        f"it fits, for {tried}; and {len(story.candidates):,} "
        f"{named_guesses(story.candidates)} on the "
        "plan, coloured and shaped by drift."
    )


def _of_empty_space(heatmaps: Heatmaps, here: FloatArray | None) -> str:
    right = right_match(heatmaps, here)
    wrong = wrong_match(heatmaps, right.position_m)
    inside_m = length_m(walls_inside(heatmaps, right))
    words = (
        "Orange triangles between the observation point and each wall that was seen: nothing can "
        "stand there. Left the scan alone; in the middle it lies on the "
        f"{'best match' if here is None else 'right place'}, with {inside_m:.1f} m of the plan's "
        "walls inside the triangles, drawn thick and red"
    )
    if wrong is None:
        return f"{words}; a wrong place with walls like these was not found."
    inside_m = length_m(walls_inside(heatmaps, wrong))
    return f"{words}; right on a wrong place, with {inside_m:.1f} m."


def _of_candidates(places: tuple[Place, ...]) -> str:
    told = [
        f"{rank}: {_level(place)}x {place.x_m:.1f} m, y {place.y_m:.1f} m, "
        f"drift {degrees(place.drift_rad)}, {100 * place.p:.1f} %"
        for rank, place in enumerate(places, start=1)
    ]
    return "Most probable places of the scan, numbered on the plan. " + "; ".join(told) + "."


def _level(place: Place) -> str:
    return "" if place.level is None else f"level {place.level}, "


def _of_plan(story: Story) -> str:
    plan = story.plan
    width, height = plan.size_m
    rooms = f" and {len(plan.rooms)} named rooms" if plan.rooms else ""
    if story.atlas is not None:
        return f"Floor plans of {plan.name}, levels {', '.join(story.atlas.names)}{rooms}."
    return (
        f"Floor plan {plan.name}, {width:.0f} by {height:.0f} m, with {len(plan.segments_m)} "
        f"segments{rooms}."
    )
