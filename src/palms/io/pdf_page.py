"""A page of a PDF document: its shapes with their layers, its texts, or a picture of it.

Runs in a process of its own (`palms.io.apart`), since documents may be damaged.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from palms.errors import FormatError, InputError
from palms.geometry import FloatArray
from palms.io.plan_shapes import Shape, Text
from palms.io.svg_paths import Pen, cubic
from palms.io.values import brief

__all__ = ["PdfPage", "draw_page", "load_page"]

MAX_SEGMENTS = 2_000_000  # ours: a plan of a large building has 100,000
_DEPTH = 12  # ours: of forms in forms
_LARGEST = 1e7  # ours: points; coordinates beyond are damage
_DARK = 0.5  # ours: lighter areas are floors, not walls
_PAPER = 0.9  # ours: lighter strokes cannot be seen
_SIDE_POINTS = 100_000  # ours: 35 m of paper


class PdfPage(NamedTuple):
    """What is drawn on a page, in points of 1/72 inch from its upper left corner, y down.

    Parameters
    ----------
    size : (float, float)
        Width and height in points, as the page is shown.
    shapes : list of Shape
        Each with the name of its layer, if it is on one.
    texts : list of Text
    image_share : float
        How much of the page pictures cover.
    """

    size: tuple[float, float]
    shapes: list[Shape]
    texts: list[Text]
    image_share: float


def load_page(path: str, number: int | None) -> PdfPage:
    """Read what is drawn on a page.

    Parameters
    ----------
    path : str
    number : int, optional
        From 1; needed where there are several pages.

    Raises
    ------
    InputError
        When it is no whole PDF document, needs a password, has no such page, or several pages
        and none is named.
    """
    with _Document(path, number) as page:
        reader = _Reader(page, path)
        return reader.read()


def draw_page(path: str, number: int | None, pixels_per_point: float) -> npt.NDArray[np.uint8]:
    """Return a picture (R, C) of a page, from 0, black, to 255, white."""
    with _Document(path, number) as page:
        picture = page.render(scale=pixels_per_point, grayscale=True, may_draw_forms=False)
        values = np.array(picture.to_numpy(), dtype=np.uint8)
        return values.reshape(values.shape[0], values.shape[1])


class _Document:
    """Opens a page, and closes its document afterwards."""

    def __init__(self, path: str, number: int | None) -> None:
        self.path, self.number = path, number

    def __enter__(self) -> Any:  # noqa: ANN401
        import pypdfium2

        try:
            self.document = pypdfium2.PdfDocument(self.path)
            count = len(self.document)
        except pypdfium2.PdfiumError as error:
            locked = "password" in str(error).lower()
            raise FormatError(
                self.path, expected="a whole PDF document",
                got="one that asks for a password" if locked else brief(str(error), 60),
                fix="save it without" if locked else "export or download it again",
            ) from None  # fmt: skip
        number = self.number if self.number is not None else 1
        if (self.number is None and count != 1) or not 1 <= number <= count:
            raise InputError(
                f"{self.path}, option page", expected=f"a page from 1 to {count}",
                got=f"{count} pages" if self.number is None else str(number),
                fix="choose the plan's with the option page=NUMBER",
            )  # fmt: skip
        try:
            return self.document[number - 1]
        except pypdfium2.PdfiumError as error:
            raise FormatError(
                f"{self.path}, page {number}", expected="a whole page", got=brief(str(error), 60)
            ) from None

    def __exit__(self, *_: object) -> None:
        self.document.close()


class _Reader:
    """Goes through the objects of a page."""

    def __init__(self, page: Any, what: str) -> None:  # noqa: ANN401
        import pypdfium2.raw

        self.raw: Any = pypdfium2.raw
        self.page, self.what = page, what
        self.textpage = page.get_textpage()
        self.counted = 0
        box = self.raw.FS_RECTF()
        self.raw.FPDF_GetPageBoundingBox(page, box)
        x0, y0, x1, y1 = box.left, box.bottom, box.right, box.top
        turned = page.get_rotation() % 360
        self.to_page = np.array({
            0: [[1, 0, -x0], [0, -1, y1]], 90: [[0, 1, -y0], [1, 0, -x0]],
            180: [[-1, 0, x1], [0, 1, -y0]], 270: [[0, -1, y1], [-1, 0, x1]],
        }[turned] + [[0, 0, 1]], dtype=np.float64)  # fmt: skip
        width, height = abs(x1 - x0), abs(y1 - y0)
        self.size = (height, width) if turned in (90, 270) else (width, height)

    def read(self) -> PdfPage:
        width, height = self.size
        if not (0 < width <= _SIDE_POINTS and 0 < height <= _SIDE_POINTS):
            raise FormatError(
                self.what, expected="a page of some size", got=f"{width:g} x {height:g} points"
            )
        shapes: list[Shape] = []
        texts: list[Text] = []
        covered = 0.0
        for item, matrix, layer in self._objects(None, self.to_page, "", _DEPTH):
            kind = self.raw.FPDFPageObj_GetType(item)
            if kind == self.raw.FPDF_PAGEOBJ_PATH:
                shapes.extend(self._shape(item, matrix, layer))
            elif kind == self.raw.FPDF_PAGEOBJ_TEXT:
                texts.extend(self._text(item, matrix))
            elif kind == self.raw.FPDF_PAGEOBJ_IMAGE:
                own = matrix @ self._matrix(item)
                covered += abs(float(np.linalg.det(own[:2, :2])))
        return PdfPage(self.size, shapes, texts, covered / (width * height))

    def _objects(
        self, form: Any, matrix: FloatArray, layer: str, depth: int  # noqa: ANN401
    ) -> Iterator[tuple[Any, FloatArray, str]]:  # fmt: skip
        """Yield the objects of the page or of a form, with what leads to the page."""
        raw = self.raw
        count = (
            raw.FPDFPage_CountObjects(self.page) if form is None
            else raw.FPDFFormObj_CountObjects(form)
        )  # fmt: skip
        for i in range(max(count, 0)):
            item = (
                raw.FPDFPage_GetObject(self.page, i) if form is None
                else raw.FPDFFormObj_GetObject(form, i)
            )  # fmt: skip
            self._count(1)
            named = self._layer(item) or layer
            if raw.FPDFPageObj_GetType(item) == raw.FPDF_PAGEOBJ_FORM:
                if depth:
                    inner = matrix @ self._matrix(item)
                    yield from self._objects(item, inner, named, depth - 1)
            else:
                yield item, matrix, named

    def _count(self, more: int) -> None:
        self.counted += more
        if self.counted > MAX_SEGMENTS:
            raise FormatError(
                self.what, expected=f"at most {MAX_SEGMENTS:,} lines on a page", got="more",
                fix="export the layers of walls and doors alone",
            )  # fmt: skip

    def _matrix(self, item: Any) -> FloatArray:  # noqa: ANN401
        found = self.raw.FS_MATRIX()
        if not self.raw.FPDFPageObj_GetMatrix(item, found):
            return np.eye(3)
        m = [found.a, found.b, found.c, found.d, found.e, found.f]
        a, b, c, d, e, f = (v if abs(v) < _LARGEST else 0.0 for v in m)
        return np.array([[a, c, e], [b, d, f], [0, 0, 1]])

    def _layer(self, item: Any) -> str:  # noqa: ANN401
        """Name of the optional content that an object belongs to."""
        raw = self.raw
        for i in range(raw.FPDFPageObj_CountMarks(item)):
            mark = raw.FPDFPageObj_GetMark(item, i)
            if _utf16(raw.FPDFPageObjMark_GetName, mark) == "OC":
                name = _utf16(raw.FPDFPageObjMark_GetParamStringValue, mark, b"Name")
                if name:
                    return name
        return ""

    def _shape(self, item: Any, matrix: FloatArray, layer: str) -> Iterator[Shape]:  # noqa: ANN401
        raw = self.raw
        fill, stroke, width = ctypes.c_int(), ctypes.c_int(), ctypes.c_float()
        raw.FPDFPath_GetDrawMode(item, fill, stroke)
        raw.FPDFPageObj_GetStrokeWidth(item, width)
        own = matrix @ self._matrix(item)
        subpaths = self._pen(item).subpaths
        whole = [pieces for pieces in subpaths if pieces]
        drawn = stroke.value and self._grey(item, raw.FPDFPageObj_GetStrokeColor) < _PAPER
        filled = fill.value and self._grey(item, raw.FPDFPageObj_GetFillColor) < _DARK
        if whole and (drawn or filled or layer):
            size = math.sqrt(abs(float(np.linalg.det(own[:2, :2]))))
            thick = width.value * size if drawn else None
            yield Shape(whole, (layer, ""), "", "", 0, thick, bool(filled), own)

    def _pen(self, item: Any) -> Pen:  # noqa: ANN401
        """Return the path of an object, drawn."""
        raw, pen = self.raw, Pen()
        handles: list[FloatArray] = []
        x, y = ctypes.c_float(), ctypes.c_float()
        count = max(raw.FPDFPath_CountSegments(item), 0)
        self._count(count)
        for i in range(count):
            segment = raw.FPDFPath_GetPathSegment(item, i)
            raw.FPDFPathSegment_GetPoint(segment, x, y)
            if not (abs(x.value) < _LARGEST and abs(y.value) < _LARGEST):
                return Pen()
            to = np.array([x.value, y.value])
            kind = raw.FPDFPathSegment_GetType(segment)
            if kind == raw.FPDF_SEGMENT_MOVETO:
                pen.move(to)
            elif kind == raw.FPDF_SEGMENT_LINETO:
                pen.draw(to[None], False)
            else:
                handles.append(to)
                if len(handles) == 3:
                    pen.draw(cubic(pen.at, *handles), True)
                    handles = []
            if raw.FPDFPathSegment_GetClose(segment):
                pen.close()
        return pen

    def _grey(self, item: Any, get: Callable[..., int]) -> float:  # noqa: ANN401
        """Brightness of a colour; what cannot be seen is white."""
        red, green, blue, opaque = (ctypes.c_uint(0) for _ in range(4))
        if not get(item, red, green, blue, opaque):
            return 0.0
        mean = (red.value + green.value + blue.value) / 765
        return 1 - (1 - mean) * opaque.value / 255

    def _text(self, item: Any, matrix: FloatArray) -> Iterator[Text]:  # noqa: ANN401
        words = _utf16(self.raw.FPDFTextObj_GetText, item, self.textpage)
        sides = [ctypes.c_float() for _ in range(4)]
        if words.strip() and self.raw.FPDFPageObj_GetBounds(item, *sides):
            left, bottom, right, top = (side.value for side in sides)
            if all(abs(v) < _LARGEST for v in (left, bottom, right, top)):
                middle = np.array([(left + right) / 2, (bottom + top) / 2, 1.0])
                yield Text(" ".join(words.split()), (matrix @ middle)[:2])


def _utf16(get: Callable[..., int], *arguments: Any) -> str:  # noqa: ANN401
    """Return a text that the library writes into a buffer, asked for its size first."""
    if get.__name__ == "FPDFTextObj_GetText":  # returns the size
        size = get(*arguments, None, 0)
        if not 2 < size < 10_000:
            return ""
        buffer = (ctypes.c_ushort * (size // 2 + 1))()
        get(*arguments, buffer, size)
    else:
        length = ctypes.c_ulong(0)
        if not get(*arguments, None, 0, length) or not 2 < length.value < 10_000:
            return ""
        buffer = (ctypes.c_ushort * (length.value // 2 + 1))()
        get(*arguments, buffer, length.value, length)
    return bytes(buffer).decode("utf-16-le", "replace").partition("\x00")[0]
