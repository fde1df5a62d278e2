"""A floor plan as a picture: strokes for walls, doors, openings and glass; names in rooms."""

from __future__ import annotations

import itertools
import math
from typing import Any, Final, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, Stroke

from palms.building import Sheets
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geometry import FloatArray, rotate
from palms.plot.style import INK, MUTED, SCAN, WALL, Dashes, frame_map, new_figure, styled

__all__ = ["draw_plan", "figure_size", "plan_figure", "plan_legend"]

_NAME_PT: Final = (7.5, 6.5, 5.5, 4.5)  # sizes of a room's name, to be tried in this order
_LARGE: Final = 0.6  # strokes this wide are of maps with room for words
_CHARACTER: Final = 0.62  # width of a character over its size


class _Stroke(NamedTuple):
    colour: str
    width_pt: float
    dashes: Dashes
    word: str


_STROKES: Final = {
    SegmentClass.OPENING: _Stroke(MUTED, 0.9, (0, (1, 2.2)), "opening"),
    SegmentClass.DOOR: _Stroke("#c26a1a", 1.8, (0, (1.1, 0.7)), "door"),
    SegmentClass.GLASS: _Stroke(SCAN, 2.8, "solid", "glass"),
    SegmentClass.WALL: _Stroke(WALL, 1.5, "solid", "wall"),
}


def draw_plan(axes: Axes, plan: FloorPlan, width: float = 1.0, colour: str | None = None) -> None:
    """Draw the segments of a plan, each class with its own stroke; and names of several levels.

    Parameters
    ----------
    axes : Axes
    plan : FloorPlan
    width : float
        Strokes are wider by this factor; small maps want less than 1.
    colour : str, optional
        One colour for all classes: a plan that other things are drawn over.
    """
    for kind, stroke in _STROKES.items():
        segments = plan.of_class(kind)
        if not len(segments):
            continue
        gid = f"plan-{stroke.word}"
        axes.add_collection(
            LineCollection(
                list(segments), colors=colour or stroke.colour, linestyles=[stroke.dashes],
                linewidths=width * stroke.width_pt, zorder=2, gid=gid,
                capstyle="butt" if kind == SegmentClass.DOOR else "round",
            ),
            autolim=False,
        )  # fmt: skip
        if kind == SegmentClass.GLASS:  # a double stroke, to be told apart in grey
            inner = LineCollection(
                list(segments), colors="white", linewidths=width * 1.1, capstyle="butt", zorder=2
            )
            axes.add_collection(inner, autolim=False)
    if isinstance(plan, Sheets):
        for name, corner in plan.corners_m:
            axes.annotate(
                f"level {name}", corner, xytext=(0, 2), textcoords="offset points",
                fontsize=9 if width >= _LARGE else 6, fontweight="bold", color=colour or INK,
                zorder=4, gid="level",
            )  # fmt: skip


def plan_legend(plan: FloorPlan) -> list[Line2D]:
    """Return legend entries for the classes that a plan has.

    Examples
    --------
    >>> [entry.get_label() for entry in plan_legend(FloorPlan([[[0, 0], [4, 0]]]))]
    ['wall']
    """
    kinds = [kind for kind in reversed(_STROKES) if len(plan.of_class(kind))]
    entries = []
    for stroke in (_STROKES[kind] for kind in kinds):
        entry = Line2D(
            [], [], color=stroke.colour, linewidth=stroke.width_pt, linestyle=stroke.dashes,
            label=stroke.word,
        )  # fmt: skip
        if stroke.word == "glass":
            entry.set_path_effects([Normal(), Stroke(linewidth=1.1, foreground="white")])
        entries.append(entry)
    return entries


def figure_size(plan: FloorPlan, area_in2: float, extra_in: float = 0.0) -> tuple[float, float]:
    """Return width and height in inches for a map of a plan.

    Parameters
    ----------
    plan : FloorPlan
    area_in2 : float
        Of the map; its shape follows the plan's, between 1 to 2 and 3 to 1.
    extra_in : float
        Height for what stands above and below the map.

    Examples
    --------
    >>> figure_size(FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 4]]]), 32.0)
    (8.0, 4.0)
    """
    width, height = (float(v) for v in plan.size_m)
    aspect = min(max(width / max(height, 1e-6), 0.5), 3.0)
    tall = math.sqrt(area_in2 / aspect)
    return round(aspect * tall, 2), round(tall + extra_in, 2)


@styled
def plan_figure(plan: FloorPlan, title: str | None = None) -> Figure:
    """Draw a floor plan with the names of its rooms.

    Parameters
    ----------
    plan : FloorPlan
    title : str, optional
        The plan's name, level and size when left out.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> figure = plan_figure(FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]], name="Hall"))
    >>> figure.axes[0].get_title(loc="left")
    'Hall, 8 × 5 m'
    """
    figure = new_figure(*figure_size(plan, 70.0, extra_in=0.6))
    axes = figure.add_subplot()
    frame_map(axes, *plan.bounds_m)
    draw_plan(axes, plan)
    axes.set_title(title or _title(plan))
    scale = _points_per_metre(figure, plan)
    for room in plan.rooms:
        _name_room(axes, room, scale)
    entries = plan_legend(plan)
    figure.legend(handles=entries, loc="outside lower center", ncols=4)
    return figure


def _title(plan: FloorPlan) -> str:
    if isinstance(plan, Sheets):
        return f"{plan.name}, levels {', '.join(name for name, _ in plan.corners_m)}"
    width, height = plan.size_m
    level = f", level {plan.level}" if plan.level else ""
    return f"{plan.name}{level}, {width:.0f} × {height:.0f} m"


def _points_per_metre(figure: Figure, plan: FloorPlan) -> float:
    """Scale of a map that fills its figure, a little on the safe side."""
    (width_in, height_in), (width, height) = figure.get_size_inches(), plan.size_m
    return float(72 * min(0.92 * width_in / max(width, 1), 0.86 * height_in / max(height, 1)))


def _name_room(axes: Axes, room: Room, points_per_m: float) -> None:
    """Write a room's name where it fits, or its number, or nothing."""
    import shapely

    shape = shapely.make_valid(shapely.Polygon(room.polygon_m))
    shapely.prepare(shape)
    angles, middles = _long_directions(shape), _middles(shape)
    texts = dict.fromkeys((room.name, room.name.split()[-1])) if room.name.strip() else ()
    for text, size, angle, middle in itertools.product(texts, _NAME_PT, angles, middles):
        box = _box(middle, (_CHARACTER * len(text) + 0.5, 1.25), size / points_per_m, angle)
        if shape.contains(shapely.Polygon(box)):
            axes.text(
                middle[0], middle[1], text, fontsize=size, rotation=angle, rotation_mode="anchor",
                ha="center", va="center", color=INK, zorder=4, gid="room-name",
            )  # fmt: skip
            return


def _box(
    middle: tuple[float, float], characters: tuple[float, float], size_m: float, angle: float
) -> FloatArray:
    """Corners (4, 2) of a text of some characters' width and height."""
    half = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * characters * (size_m / 2)
    return rotate(half, math.radians(angle)) + middle


def _long_directions(shape: Any) -> tuple[float, float]:  # noqa: ANN401
    """Directions in degrees, in (-90, 90], of the longer and the shorter side of a room."""
    import shapely

    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(shape))
    sides = sorted(corners[1:3] - corners[:2], key=lambda side: -math.hypot(*side))
    long, short = (90 - (90 - math.degrees(math.atan2(y, x))) % 180 for x, y in sides)
    square = math.hypot(*sides[0]) < 1.25 * math.hypot(*sides[1])
    return (short, long) if square and abs(short) < abs(long) else (long, short)


def _middles(shape: Any) -> tuple[tuple[float, float], ...]:  # noqa: ANN401
    """Return the centroid and the centre of the largest circle inside."""
    import shapely

    circle = shapely.maximum_inscribed_circle(shape, tolerance=0.05)
    points = shape.centroid.coords[0], circle.coords[0]
    return tuple((float(x), float(y)) for x, y in points)
