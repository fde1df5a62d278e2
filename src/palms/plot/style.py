"""One hand for all pictures: colours, markers, strokes, map axes and the scale bar.

Colours follow Okabe and Ito (Color Universal Design, 2008), moved in lightness so that they
stay apart in grey; whatever a colour says is also said by a marker, a stroke or a word.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final, Literal, NamedTuple, ParamSpec, TypeVar

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from palms.belief import Stage
from palms.geometry import wrap_angle

__all__ = [
    "ANSWER",
    "ANY_DRIFT",
    "EMPTY",
    "GROUPS",
    "INK",
    "INTRUDER",
    "MUTED",
    "SCAN",
    "STAGE_LINES",
    "TRUTH",
    "WALL",
    "GroupStyle",
    "add_scale_bar",
    "answer_entry",
    "answer_mark",
    "degrees",
    "draw_particles",
    "frame_map",
    "group_entries",
    "groups_of",
    "legend_line",
    "lightness",
    "new_figure",
    "styled",
    "truth_entry",
    "truth_mark",
]

Dashes = Literal["solid"] | tuple[float, tuple[float, ...]]
P = ParamSpec("P")
T = TypeVar("T")

INK: Final = "#1c1c1c"
MUTED: Final = "#6b6b6b"
WALL: Final = "#333333"
ANSWER: Final = "#b3160b"  # dark red: the filter's answer
TRUTH: Final = "#12a06f"  # bluish green: where the walker truly was
EMPTY: Final = "#e69f00"  # orange: certainly empty space
SCAN: Final = "#0072b2"  # blue: what the scan saw
INTRUDER: Final = "#d7191c"  # bright red, always thick: walls where none can be


class GroupStyle(NamedTuple):
    """How the particles of one drift are drawn.

    Attributes
    ----------
    colour : str
    marker : str
        As matplotlib names it.
    word : str
        What the legend calls it when the drifts differ from picture to picture.
    """

    colour: str
    marker: str
    word: str


GROUPS: Final = (
    GroupStyle("#f0b020", "o", "θ"),
    GroupStyle("#3a2c8c", "s", "θ + 90°"),
    GroupStyle("#4aa3df", "^", "θ + 180°"),
    GroupStyle("#b0508c", "D", "θ − 90°"),
)

ANY_DRIFT: Final = GroupStyle("#6b6b6b", "o", "any drift")  # style 4, of those without labels

STAGE_LINES: Final[dict[Stage, Dashes]] = {
    Stage.SEARCHING: (0, (1, 1.6)),
    Stage.ORIENTED: (0, (4, 1.6)),
    Stage.LOCALIZED: "solid",
    Stage.LOST: (0, (5, 1.5, 1, 1.5)),
}

_RC: Final[dict[Any, Any]] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titlelocation": "left",
    "axes.titleweight": "normal",
    "axes.titlecolor": INK,
    "axes.labelcolor": INK,
    "axes.labelsize": 9.0,
    "axes.edgecolor": MUTED,
    "axes.linewidth": 0.7,
    "axes.unicode_minus": True,
    "text.color": INK,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "figure.facecolor": "white",
    "axes.facecolor": "white",
    "savefig.facecolor": "white",
    "hatch.linewidth": 0.5,
    "svg.hashsalt": "palms",
    "path.simplify": True,
}
_HALO = (patheffects.withStroke(linewidth=2.2, foreground="white"),)
_BAR_SHARE = 0.24  # of the width of a map, at most


def styled(make: Callable[P, T]) -> Callable[P, T]:
    """Run a function with our fonts and strokes, whatever the user's matplotlibrc says.

    Examples
    --------
    >>> styled(lambda: mpl.rcParams["legend.frameon"])()
    False
    """

    @functools.wraps(make)
    def inner(*args: P.args, **kwargs: P.kwargs) -> T:
        with mpl.rc_context(_RC):
            return make(*args, **kwargs)

    return inner


def new_figure(width_in: float, height_in: float, layout: str | None = "constrained") -> Figure:
    """Return an empty figure that no window and no global state knows of.

    Examples
    --------
    >>> new_figure(4, 3).get_size_inches().tolist()
    [4.0, 3.0]
    """
    figure = Figure(figsize=(width_in, height_in), layout=layout)  # type: ignore[arg-type]
    FigureCanvasAgg(figure)
    return figure


def lightness(colour: str) -> float:
    """Return the CIE L* of a colour: 0 is black, 100 white; what is left of it in grey.

    Examples
    --------
    >>> round(lightness("#ffffff")), round(lightness("#777777"))
    (100, 50)
    """
    srgb = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    luminance = float(linear @ (0.2126, 0.7152, 0.0722))
    if luminance <= 216 / 24389:
        return luminance * 24389 / 27
    return 116 * math.cbrt(luminance) - 16


def degrees(angle_rad: float) -> str:
    """Write an angle for a person, in (-180°, 180°].

    Examples
    --------
    >>> degrees(-0.3), degrees(0.0001)
    ('−17°', '0°')
    """
    rounded = round(math.degrees(float(wrap_angle(angle_rad))))
    return f"{'−' if rounded < 0 else ''}{abs(rounded)}°"


def groups_of(
    label: npt.NDArray[np.integer], drift_rad: npt.NDArray[np.floating], by_label: bool
) -> npt.NDArray[np.int8]:
    """Return which of the four styles each particle has.

    Parameters
    ----------
    label, drift_rad : (N,)
        Of the particles.
    by_label : bool
        With four labels or fewer a style is a label. With more it is a quarter of the
        circle: drifts within 45° of 0°, 90°, 180° and −90°.

    Examples
    --------
    >>> groups_of(np.array([0, 40]), np.array([0.1, 3.0]), by_label=False).tolist()
    [0, 2]
    """
    quarter = label if by_label else np.round(np.asarray(drift_rad) / (np.pi / 2))
    return np.mod(quarter, len(GROUPS)).astype(np.int8)


def draw_particles(
    axes: Axes,
    position_m: npt.NDArray[np.floating],
    group: npt.NDArray[np.int8],
    size_pt: float = 2.2,
) -> list[Line2D]:
    """Draw particles (N, 2) in the styles of their groups; the rarest lie on top.

    Parameters
    ----------
    axes : Axes
    position_m : (N, 2)
    group : (N,)
        0 to 3 for one of `GROUPS`, 4 for `ANY_DRIFT`.
    size_pt : float

    Returns
    -------
    list of Line2D
        One for each style, with gid ``particles-<k>``.
    """
    counts = np.bincount(group, minlength=len(GROUPS) + 1)
    drawn = []
    for k, style in enumerate((*GROUPS, ANY_DRIFT)):
        mine = position_m[group == k]
        (line,) = axes.plot(
            mine[:, 0], mine[:, 1], linestyle="none", marker=style.marker, markersize=size_pt,
            color=style.colour, markeredgewidth=0, alpha=0.85, label=style.word,
            zorder=3 + float((counts > counts[k]).sum()) / 10, gid=f"particles-{k}",
        )  # fmt: skip
        drawn.append(line)
    return drawn


def truth_mark(axes: Axes, x_m: float, y_m: float, label: str = "true place") -> None:
    """Mark a true place: a green cross with a white halo."""
    axes.plot(
        [x_m], [y_m], linestyle="none", marker="x", markersize=9, markeredgewidth=2.4,
        color=TRUTH, path_effects=_HALO_WIDE, zorder=8, label=label, gid="truth",
    )  # fmt: skip


def answer_mark(axes: Axes, x_m: float, y_m: float, label: str = "answer") -> None:
    """Mark the filter's answer: a red dot with a white rim."""
    axes.plot(
        [x_m], [y_m], linestyle="none", marker="o", markersize=8, markeredgewidth=1.4,
        color=ANSWER, markeredgecolor="white", zorder=9, label=label, gid="answer",
    )  # fmt: skip


def truth_entry(label: str = "true place") -> Line2D:
    """Return the legend entry of `truth_mark`."""
    return Line2D(
        [], [], linestyle="none", marker="x", markersize=8, markeredgewidth=2.4, color=TRUTH,
        label=label,
    )  # fmt: skip


def answer_entry(label: str = "answer") -> Line2D:
    """Return the legend entry of `answer_mark`."""
    return Line2D([], [], linestyle="none", marker="o", markersize=7, color=ANSWER, label=label)


def group_entries(groups: Iterable[int]) -> list[Line2D]:
    """Return legend entries for groups of particles.

    Examples
    --------
    >>> [entry.get_label() for entry in group_entries([0, 4])]
    ['drift θ', 'any drift']
    """
    styles = [(*GROUPS, ANY_DRIFT)[k] for k in groups]
    return [
        Line2D(
            [], [], linestyle="none", marker=style.marker, markersize=5.5, color=style.colour,
            label=style.word if style == ANY_DRIFT else f"drift {style.word}",
        )
        for style in styles
    ]  # fmt: skip


def legend_line(colour: str, width_pt: float, label: str, dashes: Dashes = "solid") -> Line2D:
    """Return a legend entry that is a line."""
    return Line2D([], [], color=colour, linewidth=width_pt, linestyle=dashes, label=label)


_HALO_WIDE = (patheffects.withStroke(linewidth=4.6, foreground="white"),)


def frame_map(
    axes: Axes, low_m: Sequence[float] | npt.NDArray[np.floating],
    high_m: Sequence[float] | npt.NDArray[np.floating],
) -> None:  # fmt: skip
    """Make axes a map of a box: no ticks, the same scale both ways, a scale bar below.

    Parameters
    ----------
    axes : Axes
    low_m, high_m : (2,)
        Corners of what the map shows.
    """
    (x0, y0), (x1, y1) = (tuple(float(v) for v in corner) for corner in (low_m, high_m))
    width, height = max(x1 - x0, 1e-6), max(y1 - y0, 1e-6)
    margin = 0.03 * max(width, height)
    axes.set_xlim(x0 - margin, x1 + margin)
    axes.set_ylim(y0 - margin - 0.085 * max(width, height), y1 + margin)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.spines[:].set_visible(False)
    add_scale_bar(axes)


def add_scale_bar(axes: Axes) -> None:
    """Draw a scale bar of 1, 2 or 5 times a power of ten metres at the lower left."""
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    length = _round_length(_BAR_SHARE * (x1 - x0))
    size = max(x1 - x0, y1 - y0)
    x, y = x0 + 0.035 * size, y0 + 0.035 * size
    tick = 0.008 * size
    axes.plot(
        [x, x, x, x + length, x + length, x + length],
        [y + tick, y - tick, y, y, y - tick, y + tick],
        color=INK, linewidth=1.2, solid_joinstyle="miter", zorder=10, gid="scale-bar",
    )  # fmt: skip
    axes.text(
        x + length + 0.012 * size, y, f"{length:g} m", fontsize=8, va="center", ha="left",
        zorder=10, path_effects=_HALO,
    )  # fmt: skip


def _round_length(longest_m: float) -> float:
    power = 10.0 ** math.floor(math.log10(longest_m))
    return max(factor * power for factor in (1, 2, 5) if factor * power <= longest_m * (1 + 1e-9))
