"""Floor plans from SVG drawings: shapes whose names, or whose groups' names, say what they are.

Where no name says wall, the outlines of rooms are the walls; where none says room either, all
that is drawn. The lower left corner of the drawing is (0, 0).
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from palms.errors import InputError
from palms.floorplan import FloorPlan, SegmentClass
from palms.geometry import FloatArray
from palms.io.files import head
from palms.io.plan_csv import plan_name
from palms.io.plan_drawing import (
    DOORS,
    GLASS,
    OPENINGS,
    ROOMS,
    WALLS,
    Layers,
)
from palms.io.plan_scale import Points, metres_per_unit
from palms.io.plan_shapes import Canvas, Shape, Sorter, Text
from palms.io.registry import Format
from palms.io.svg_elements import Element, load_svg, parse_length, shapes_of
from palms.io.svg_paths import numbers_of
from palms.io.values import StrPath, locating
from palms.io.xml_events import looks_like

__all__ = ["FORMAT", "read_plan_svg"]

_INCH_M = 0.0254
_PIXELS_PER_INCH = 96.0


def read_plan_svg(  # noqa: PLR0913
    path: StrPath,
    *,
    scale: float | None = None,
    points: Points | None = None,
    distance: float | None = None,
    ratio: float | None = None,
    walls: str = WALLS,
    doors: str = DOORS,
    glass: str = GLASS,
    openings: str = OPENINGS,
    rooms: str = ROOMS,
    min_stroke: float | None = None,
) -> FloorPlan:
    """Read a floor plan from an SVG drawing.

    Parameters
    ----------
    path : path
    scale : float
        Metres per unit, as the drawing's viewBox counts. Or else:
    points, distance
        Two points x1, y1, x2, y2 in units, y down, and the metres between.
    ratio : float
        Or 100 for a sheet drawn at 1:100; its size on paper must be stated in the file.
    walls, doors, glass, openings, rooms : str
        Patterns, as regular expressions, of the ids, classes and labels of each, the shape's
        own before its group's; upper and lower case are one.
    min_stroke : float, optional
        Where no name says what is a wall: thinner strokes, in units, are none. When left out,
        than half of the thickness that most of them have.

    Raises
    ------
    InputError
        When it cannot be read, has no scale, or nothing is a wall.
    """
    root, sheets = load_svg(path)
    found = list(shapes_of(root, sheets, str(path)))
    low, high, unit = _frame(root, found)
    what = f"{path}, a drawing of {high[0] - low[0]:g} x {high[1] - low[1]:g} units"
    scale = _scale_of_ratio(ratio, unit, what) if ratio is not None and scale is None else scale
    metres = metres_per_unit(scale, points, distance, what, "unit")
    patterns: Mapping[SegmentClass | None, str] = {
        SegmentClass.DOOR: doors, SegmentClass.OPENING: openings, SegmentClass.GLASS: glass,
        SegmentClass.WALL: walls, None: rooms,
    }  # fmt: skip
    canvas = Canvas(low[0], high[1], metres)
    sorter = Sorter(Layers(patterns, str(path)), canvas, str(path))
    with locating(path):
        sorter.sort([each for each in found if isinstance(each, Shape)], min_stroke)
    sorter.drawing.texts = [(each.words, canvas.place(each.at[None])[0])
                            for each in found if isinstance(each, Text)]  # fmt: skip
    asked = "name what is a wall with the option walls=PATTERN"
    return sorter.drawing.plan(path, plan_name(path), asked)


def _frame(
    root: Element, found: Sequence[Shape | Text]
) -> tuple[FloatArray, FloatArray, float | None]:
    """Return the corners of the drawing, and the metres of a unit on paper if it says."""
    width = root.attributes.get("width", "")
    size = [parse_length(root.attributes.get(key, "")) for key in ("width", "height")]
    box = numbers_of(root.attributes.get("viewBox", ""))
    if len(box) == 4 and box[2] > 0 and box[3] > 0:
        low, extent = np.array(box[:2]), np.array(box[2:])
    elif size[0] and size[1]:
        low, extent = np.zeros(2), np.array([size[0], size[1]])
    else:
        points = [piece.points for shape in found if isinstance(shape, Shape)
                  for pieces in shape.subpaths for piece in pieces]  # fmt: skip
        whole = np.concatenate([np.zeros((1, 2)), *points])
        low, extent = whole.min(axis=0), np.ptp(whole, axis=0)
    on_paper = size[0] and re.search(r"(mm|cm|in|pt|pc|m|q)\s*$", width, re.IGNORECASE)
    unit = (size[0] or 0.0) / _PIXELS_PER_INCH * _INCH_M / extent[0] if on_paper else None
    return low, low + extent, unit


def _scale_of_ratio(ratio: float, unit_m: float | None, what: str) -> float:
    if unit_m is None:
        raise InputError(
            f"{what}, option ratio", expected="a drawing that says its width in mm, cm or in",
            got="none", fix="give scale=METRES per unit",
        )  # fmt: skip
    if not (math.isfinite(ratio) and ratio > 0):
        raise InputError(f"{what}, option ratio", expected="above 0", got=f"{ratio:g}")
    return ratio * unit_m


def _recognizes(path: Path) -> bool:
    return looks_like(head(path), "svg")


FORMAT = Format(
    name="svg",
    description="drawing: shapes named walls, doors, rooms; needs its scale",
    suffixes=(".svg",),
    recognizes=_recognizes,
    read=read_plan_svg,
)
