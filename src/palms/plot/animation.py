"""The particles of a walk, moving: a GIF."""

from __future__ import annotations

import io
import os
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from PIL import Image

from palms.belief import Stage
from palms.errors import InputError
from palms.io.files import write_bytes
from palms.plot.plans import draw_plan, figure_size
from palms.plot.recorder import Snapshot
from palms.plot.stages import moment_words
from palms.plot.story import Story, broken
from palms.plot.style import (
    EMPTY,
    TRUTH,
    answer_entry,
    answer_mark,
    draw_particles,
    frame_map,
    group_entries,
    legend_line,
    new_figure,
    styled,
    truth_entry,
    truth_mark,
)

__all__ = ["animation_bytes", "write_animation"]

_DPI: Final = 80
_WIDTH_IN: Final = 8.0  # 640 pixels
_COLOURS: Final = 48
_DURATION_S: Final = 12.0  # of the whole animation
_LAST_S: Final = 2.0  # the last picture stands so long
_NO_GROUP: Final = np.zeros(0, np.int8)

_WORDS: Final = {
    Stage.SEARCHING: "searching",
    Stage.ORIENTED: "oriented, not localized yet",
    Stage.LOCALIZED: "localized",
    Stage.LOST: "lost",
}


def write_animation(
    path: str | os.PathLike[str], story: Story, n_frames: int = 100, max_bytes: int = 3_000_000
) -> None:
    """Write a GIF of the particles while the user walks.

    Parameters
    ----------
    path : path
        The file; replaced when it exists. Its folder must exist.
    story : Story
        Its recorder's frames are shown.
    n_frames : int
        Most pictures, evenly spaced, the last one included.
    max_bytes : int
        When it grows larger, every second picture is left out until it does not.

    Raises
    ------
    InputError
        When nothing was recorded.
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> from palms.plot import write_animation
    >>> write_animation("walk.gif", story)  # doctest: +SKIP
    """
    write_bytes(path, animation_bytes(story, n_frames, max_bytes))


def animation_bytes(story: Story, n_frames: int = 100, max_bytes: int = 3_000_000) -> bytes:
    """Return what `write_animation` writes.

    Examples
    --------
    >>> from palms import FloorPlan, Odometry, Scan, rasterize, track
    >>> from palms.plot import Recorder
    >>> room = np.array([[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]])
    >>> raster, scan = rasterize(FloorPlan(room)), Scan(room - (2.0, 1.0))
    >>> walk, recorder = Odometry([1, 2], [[0.5, 0], [1, 0]]), Recorder()
    >>> story = Story(raster, walk, track(raster, scan, walk, watch=recorder), recorder, scan)
    >>> Image.open(io.BytesIO(animation_bytes(story))).n_frames
    2
    """
    shown = _shown(story.recorder.frames, story.recorder.moment("end"), n_frames)
    if not shown:
        raise InputError(
            "animation",
            expected="a recorder that watched a walk",
            got="one that saw nothing",
            fix="pass it to track() as watch",
        )
    pictures = _paletted(_render(story, shown))
    content = _gif(pictures)
    while len(content) > max_bytes and len(pictures) > 2:
        pictures = [*pictures[:-1:2], pictures[-1]]
        content = _gif(pictures)
    return content


def _shown(frames: list[Snapshot], last: Snapshot | None, n: int) -> list[Snapshot]:
    """Evenly spaced frames, the last moment included."""
    if last is None:
        return []
    frames = frames if frames[-1].time_s == last.time_s else [*frames, last]
    at = np.unique(np.linspace(0, len(frames) - 1, max(1, min(n, len(frames)))).round())
    return [frames[int(i)] for i in at[:-1]] + [last]


@dataclass(frozen=True)
class _Stagehands:
    """What moves in front of the plan."""

    particles: list[Line2D]
    path: Line2D
    truth: Line2D
    answer: Line2D
    disc: Circle
    words: Any

    def show(self, story: Story, snapshot: Snapshot) -> None:
        """Move everything to where it is at one moment."""
        for k, line in enumerate(self.particles):
            mine = snapshot.position_m[snapshot.group == k]
            line.set_data(mine[:, 0], mine[:, 1])
        if story.truth_m is not None:
            so_far = story.truth_m[: story.step_at(snapshot.time_s) + 1]
            self.path.set_data(*broken(so_far).T)
            self.truth.set_data(so_far[-1:, 0], so_far[-1:, 1])
        estimate = snapshot.estimate
        place = np.full(2, np.nan) if estimate.position_m is None else estimate.position_m
        self.answer.set_data(place[:1], place[1:])
        is_shown = estimate.is_localized and estimate.radius_68_m is not None
        self.disc.set_visible(is_shown)
        self.disc.set_center((float(place[0]), float(place[1])))
        self.disc.set_radius(estimate.radius_68_m or 0.0)
        self.words.set_text(f"{moment_words(story, snapshot)}: {_WORDS[estimate.stage]}")

    def draw(self, axes: Axes) -> None:
        """Draw everything, in order of depth."""
        movers = (*self.particles, self.path, self.disc, self.truth, self.answer, self.words)
        for artist in sorted(movers, key=lambda artist: artist.get_zorder()):
            axes.draw_artist(artist)


@styled
def _render(story: Story, shown: list[Snapshot]) -> list[Image.Image]:
    """Pictures: the plan is drawn once, the rest over a copy of it."""
    figure, axes, stagehands = _scene(story, shown)
    canvas = figure.canvas
    assert isinstance(canvas, FigureCanvasAgg)
    canvas.draw()  # type: ignore[no-untyped-call]
    background = canvas.copy_from_bbox(figure.bbox)  # type: ignore[no-untyped-call]
    pictures = []
    for snapshot in shown:
        canvas.restore_region(background)  # type: ignore[no-untyped-call]
        stagehands.show(story, snapshot)
        stagehands.draw(axes)
        pixels = canvas.buffer_rgba()  # type: ignore[no-untyped-call]
        size = pixels.shape[1], pixels.shape[0]
        pictures.append(Image.frombuffer("RGBA", size, pixels, "raw", "RGBA", 0, 1).convert("RGB"))
    return pictures


def _scene(story: Story, shown: list[Snapshot]) -> tuple[Figure, Axes, _Stagehands]:
    width, height = figure_size(story.plan, 40.0)
    figure = new_figure(_WIDTH_IN, round(_WIDTH_IN * height / width + 0.7, 1))
    figure.set_dpi(_DPI)
    axes = figure.add_subplot()
    frame_map(axes, *story.plan.bounds_m)
    draw_plan(axes, story.plan, 0.7, colour="#8a8a8a")
    axes.set_title(" ", fontsize=15)
    groups = sorted({int(k) for snapshot in shown for k in np.unique(snapshot.group)})
    entries = [*group_entries(groups), answer_entry(), legend_line(EMPTY, 1.8, "holds 68 %")]
    if story.truth_m is not None:
        entries += [truth_entry(), legend_line(TRUTH, 1.6, "true path")]
    figure.legend(handles=entries, loc="outside lower center", ncols=4)
    particles = draw_particles(axes, np.zeros((0, 2)), _NO_GROUP, 3.0)
    (path,) = axes.plot([], [], color=TRUTH, linewidth=1.6, zorder=5)
    truth_mark(axes, np.nan, np.nan)
    answer_mark(axes, np.nan, np.nan)
    truth, answer = axes.lines[-2], axes.lines[-1]
    disc = Circle((0, 0), 1, facecolor="none", edgecolor=EMPTY, linewidth=1.8, zorder=6)
    axes.add_patch(disc)
    words = axes.text(0.0, 1.012, "", transform=axes.transAxes, fontsize=11, va="bottom")
    moving = _Stagehands(particles, path, truth, answer, disc, words)
    for artist in (*particles, path, truth, answer, disc, words):
        artist.set_animated(True)
    return figure, axes, moving


def _paletted(pictures: list[Image.Image]) -> list[Image.Image]:
    """Give all pictures one palette, chosen for some of them together."""
    some = sorted({0, len(pictures) // 3, 2 * len(pictures) // 3, len(pictures) - 1})
    together = Image.fromarray(np.concatenate([np.asarray(pictures[i]) for i in some]))
    palette = together.quantize(_COLOURS, method=Image.Quantize.MAXCOVERAGE)
    return [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]


def _gif(pictures: list[Image.Image]) -> bytes:
    duration_ms = min(500, max(50, 10 * round(100 * _DURATION_S / len(pictures))))
    durations = [duration_ms] * (len(pictures) - 1) + [round(1000 * _LAST_S)]
    buffer = io.BytesIO()
    pictures[0].save(
        buffer, "GIF", save_all=True, append_images=pictures[1:], duration=durations, loop=0,
        optimize=False, disposal=1,
    )  # fmt: skip
    return buffer.getvalue()
