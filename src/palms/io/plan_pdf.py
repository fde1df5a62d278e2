"""Floor plans from PDF: drawings by their lines and layers, scanned pages as pictures.

Where no layer's name says wall, all lines that are drawn heavily are walls, and quarter circles
with a leaf are doors. The lower left corner of the page is (0, 0).
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Literal

import numpy as np

from palms.errors import FormatError, InputError
from palms.floorplan import FloorPlan, SegmentClass
from palms.io.apart import require, run_apart
from palms.io.files import head, read_bytes, sniff
from palms.io.pdf_page import PdfPage
from palms.io.plan_csv import plan_name
from palms.io.plan_drawing import DOORS, GLASS, OPENINGS, ROOMS, WALLS, Layers
from palms.io.plan_image import WORK_PIXELS, dark_of, plan_of_mask, walls_only
from palms.io.plan_scale import Points, metres_per_unit
from palms.io.plan_shapes import Canvas, Sorter
from palms.io.registry import Format
from palms.io.values import StrPath, locating

__all__ = ["FORMAT", "read_plan_pdf"]

_POINT_M = 0.0254 / 72  # on paper
_DOTS_PER_POINT = 200 / 72  # ours: of a picture; what posted plans are scanned with
_FEW_SHAPES = 12  # ours: a frame and a north arrow are no plan
_COVERED = 0.5  # ours: a page that is half a picture is one
_KIND = "a PDF document"


def read_plan_pdf(  # noqa: PLR0913
    path: StrPath,
    *,
    scale: float | None = None,
    points: Points | None = None,
    distance: float | None = None,
    ratio: float | None = None,
    page: int | None = None,
    mode: Literal["auto", "lines", "picture"] = "auto",
    walls: str = WALLS,
    doors: str = DOORS,
    glass: str = GLASS,
    openings: str = OPENINGS,
    rooms: str = ROOMS,
    min_stroke: float | None = None,
    threshold: float | None = None,
    invert: bool = False,
    text_size: float | None = None,
    min_wall: float = 0.4,
) -> FloorPlan:
    """Read a floor plan from a page of a PDF document.

    Parameters
    ----------
    path : path
    ratio : float
        100 for a plan printed at 1:100. Or else:
    scale : float
        Metres per point, which is 1/72 inch of paper. Or else:
    points, distance
        Two points x1, y1, x2, y2 in points from the upper left corner, and the metres between.
    page : int, optional
        From 1; needed where there are several.
    mode : {"auto", "lines", "picture"}
        Whether to take the lines of the drawing, or to draw the page and look for dark strokes;
        "auto" does the latter where a picture covers half of the page.
    walls, doors, glass, openings, rooms : str
        Patterns, as regular expressions, of the layers of each; upper and lower case are one.
    min_stroke : float, optional
        Where no layer says what is a wall: thinner strokes, in points, are none.
    threshold, invert, text_size, min_wall
        Of pictures, as for the format image; `text_size` in points.

    Raises
    ------
    InputError
        When it cannot be read, has no scale, the page is not named, or nothing is a wall.
    """
    content = read_bytes(path)
    if not content.startswith(b"%PDF") and b"%PDF-" not in content[:1024]:
        got = sniff(content[:1000]) if content else "an empty file"
        raise FormatError(str(path), expected=_KIND, got=got, fix="check that it is the right file")
    require("pypdfium2")
    found: PdfPage = run_apart("palms.io.pdf_page:load_page", (str(path), page), path, _KIND)
    width, height = found.size
    what = f"{path}, a page of {width:.0f} x {height:.0f} points"
    if ratio is not None and scale is None:
        scale = _checked(ratio, what) * _POINT_M
    metres = metres_per_unit(scale, points, distance, what, "point")
    if mode == "picture" or (mode == "auto" and _is_picture(found, walls)):
        fine = min(_DOTS_PER_POINT, math.sqrt(WORK_PIXELS / (width * height)))
        arguments = (str(path), page, fine)
        grey = run_apart("palms.io.pdf_page:draw_page", arguments, path, _KIND)
        dark = dark_of(grey / np.float32(255), threshold, invert)
        sizes = [None if each is None else each * fine for each in (min_stroke, text_size)]
        return plan_of_mask(walls_only(dark, 1, *sizes), metres / fine, min_wall, path)
    patterns = {
        SegmentClass.DOOR: doors, SegmentClass.OPENING: openings, SegmentClass.GLASS: glass,
        SegmentClass.WALL: walls, None: rooms,
    }  # fmt: skip
    canvas = Canvas(0.0, height, metres)
    sorter = Sorter(Layers(patterns, str(path)), canvas, str(path))
    with locating(path):
        sorter.sort(found.shapes, min_stroke)
    sorter.drawing.texts = [(t.words, canvas.place(t.at[None])[0]) for t in found.texts]
    asked = "name the layers with the option walls=PATTERN, or try mode=picture"
    return sorter.drawing.plan(path, plan_name(path), asked)


def _checked(ratio: float, what: str) -> float:
    if not (math.isfinite(ratio) and ratio > 0):
        raise InputError(f"{what}, option ratio", expected="above 0", got=f"{ratio:g}")
    return ratio


def _is_picture(page: PdfPage, walls: str) -> bool:
    """Whether a page is a scan rather than a drawing."""
    layers = Layers({SegmentClass.WALL: walls}, "")
    if any(layers.role(shape.names[0]) is not None for shape in page.shapes):
        return False
    return page.image_share > _COVERED or (page.image_share > 0 and len(page.shapes) < _FEW_SHAPES)


def _recognizes(path: Path) -> bool:
    return b"%PDF-" in head(path, 1024)


FORMAT = Format(
    name="pdf",
    description="a page: lines by layer, or a scan; needs its scale",
    suffixes=(".pdf",),
    recognizes=_recognizes,
    read=read_plan_pdf,
    extra="pdf",
)
