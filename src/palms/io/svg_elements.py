"""The elements of an SVG drawing with all that they inherit: transforms, names, and paint."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.plan_shapes import Piece, Shape, Text
from palms.io.svg_paths import numbers_of, parse_path, parse_transform, pieces_of
from palms.io.values import StrPath, parse_number
from palms.io.xml_events import parse_xml

__all__ = ["Element", "load_svg", "parse_length", "shapes_of"]

MAX_SHAPES = 500_000  # ours; those that `use` repeats are counted
_DEPTH = 16  # ours: of `use` in `use`
_SHAPES = {"path", "polyline", "polygon", "line", "rect", "circle", "ellipse"}
_GROUPS = {"svg", "g", "a", "switch"}
_NAMES = ("id", "label", "data-name", "class", "aria-label")  # label: of Inkscape's layers
_PAINT = ("stroke", "fill", "stroke-width", "display", "visibility")
_UNITS = {"": 1.0, "px": 1.0, "pt": 96 / 72, "pc": 16.0, "in": 96.0, "cm": 96 / 2.54,
          "mm": 96 / 25.4, "m": 96 / 0.0254, "q": 96 / 101.6}  # fmt: skip
_LENGTH = re.compile(r"\s*([-+.\deE]+?)\s*(px|pt|pc|in|cm|mm|m|q|)\s*$", re.IGNORECASE)
_LIGHT = {"none", "transparent", "white", "snow", "ivory", "ghostwhite", "whitesmoke"}
_DARK = 0.5  # ours: lighter areas are floors, not walls


@dataclass
class Element:
    """An element as the file has it."""

    name: str
    attributes: dict[str, str]
    children: list[Element] = field(default_factory=list)
    text: str = ""


class _Tree:
    """Builds the tree of elements, and collects style sheets."""

    def __init__(self) -> None:
        self.stack = [Element("", {})]
        self.sheets: list[Element] = []

    def start(self, name: str, attributes: Mapping[str, str]) -> None:
        element = Element(name, dict(attributes))
        self.stack[-1].children.append(element)
        self.stack.append(element)

    def end(self, name: str) -> None:
        element = self.stack.pop()
        if name == "style":
            self.sheets.append(element)

    def text(self, text: str) -> None:
        if self.stack[-1].name in ("text", "tspan", "title", "style"):
            self.stack[-1].text += text


class _State(NamedTuple):
    """What a group hands down."""

    matrix: FloatArray
    names: tuple[str, ...] = ()
    paint: Mapping[str, str] = {}
    group: int = 0


def load_svg(path: StrPath) -> tuple[Element, Mapping[str, Mapping[str, str]]]:
    """Return the outermost element of an SVG file, and the paint of each class.

    Raises
    ------
    FormatError
        When it is not whole XML of SVG.
    """
    tree = _Tree()
    parse_xml(path, "svg", tree)
    sheets: dict[str, dict[str, str]] = {}
    for sheet in tree.sheets:
        for selectors, body in re.findall(r"([^{}]+)\{([^{}]*)\}", sheet.text):
            for name in re.findall(r"\.([-\w]+)", selectors):
                sheets.setdefault(name, {}).update(_declarations(body))
    return tree.stack[0].children[0], sheets


def _declarations(text: str) -> dict[str, str]:
    pairs = (each.partition(":") for each in text.split(";"))
    return {key.strip(): value.strip() for key, colon, value in pairs if colon}


def parse_length(text: str) -> float | None:
    """Return a length in pixels of 1/96 inch; None when it is none, or a percentage.

    Examples
    --------
    >>> parse_length("25.4mm"), parse_length("100%")
    (96.0, None)
    """
    found = _LENGTH.match(text)
    number = parse_number(found[1]) if found else None
    if found is None or number is None or not abs(number) < 1e9:
        return None
    return number * _UNITS[found[2].lower()]


class _Walker:
    """Goes through the tree and yields what is drawn."""

    def __init__(self, root: Element, sheets: Mapping[str, Mapping[str, str]], what: str) -> None:
        self.sheets, self.what = sheets, what
        self.by_id: dict[str, Element] = {}
        self.count = 0
        waiting = [root]
        while waiting:
            element = waiting.pop()
            self.by_id.setdefault(element.attributes.get("id", ""), element)
            waiting += element.children

    def walk(self, element: Element, state: _State, depth: int) -> Iterator[Shape | Text]:
        """Yield shapes and texts in and below an element."""
        paint = self._paint(element, state.paint)
        if paint.get("display") == "none":
            return
        self.count += 1
        if self.count > MAX_SHAPES:
            raise FormatError(
                self.what, expected=f"at most {MAX_SHAPES:,} shapes, those of use counted",
                got="more", fix="save the layers of walls and doors alone",
            )  # fmt: skip
        own = " ".join(element.attributes[key] for key in _NAMES if key in element.attributes)
        matrix = state.matrix @ parse_transform(element.attributes.get("transform", ""), self.what)
        inside = _State(matrix, (own, *state.names), paint, self.count)
        if element.name in _GROUPS or (element.name == "symbol" and depth < _DEPTH):
            for child in element.children:
                yield from self.walk(child, inside, depth)
        elif element.name == "use" and depth:
            yield from self._use(element, inside, depth)
        elif element.name == "text":
            yield from _texts(element, matrix)
        elif element.name in _SHAPES and paint.get("visibility") not in ("hidden", "collapse"):
            yield self._shape(element, inside, state.group)

    def _paint(self, element: Element, inherited: Mapping[str, str]) -> Mapping[str, str]:
        attributes = element.attributes
        found = {key: attributes[key] for key in _PAINT if key in attributes}
        for name in attributes.get("class", "").split():
            found |= self.sheets.get(name, {})
        found |= _declarations(attributes.get("style", ""))
        return {**inherited, **found} if found else inherited

    def _use(self, element: Element, state: _State, depth: int) -> Iterator[Shape | Text]:
        target = self.by_id.get(element.attributes.get("href", "").removeprefix("#"))
        if target is None:
            return
        x, y = (parse_length(element.attributes.get(key, "0")) or 0.0 for key in "xy")
        matrix = state.matrix @ np.array([[1, 0, x], [0, 1, y], [0, 0, 1.0]])
        yield from self.walk(target, state._replace(matrix=matrix), depth - 1)

    def _shape(self, element: Element, state: _State, group: int) -> Shape:
        paint = state.paint
        stroke = paint.get("stroke", "none")
        width = parse_length(paint.get("stroke-width", "1"))
        size = abs(float(np.linalg.det(state.matrix[:2, :2]))) ** 0.5
        drawn = not _is_light(stroke) and width is not None and width > 0
        title = next((each.text for each in element.children if each.name == "title"), "")
        keys = ("label", "data-name", "aria-label")
        named = (element.attributes[key] for key in keys if key in element.attributes)
        return Shape(
            self._subpaths(element), state.names, " ".join(title.split()) or next(named, ""),
            element.attributes.get("id", ""), group,
            (width or 0.0) * size if drawn else None,
            not _is_light(paint.get("fill", "black"), _DARK), state.matrix,
        )  # fmt: skip

    def _subpaths(self, element: Element) -> list[list[Piece]]:
        attributes = element.attributes
        if element.name == "path":
            return parse_path(attributes.get("d", ""), self.what)
        if element.name in ("polyline", "polygon"):
            numbers = numbers_of(attributes.get("points", ""))
            points = np.array(numbers[: len(numbers) // 2 * 2]).reshape(-1, 2)
            if element.name == "polygon" and len(points):
                points = np.concatenate([points, points[:1]])
            return [[Piece(points, False)]] if len(points) > 1 else []
        values = {key: parse_length(value) for key, value in attributes.items()}
        known = {key: value for key, value in values.items() if value is not None}
        return pieces_of(element.name, known)


def _is_light(colour: str, limit: float = 0.9) -> bool:
    """Whether nothing, or nearly white, is painted; gradients count as dark."""
    text = colour.strip().lower()
    if text in _LIGHT:
        return True
    if re.fullmatch(r"#[0-9a-f]{3,8}", text):
        wide = text[1:4] if len(text) < 6 else text[1:7]
        step = len(wide) // 3
        parts = [int(wide[i : i + step], 16) / (16**step - 1) for i in (0, step, 2 * step)]
    elif text.startswith("rgb"):
        parts = [value / (100 if "%" in text else 255) for value in numbers_of(text)[:3]]
    else:
        return False
    return len(parts) == 3 and sum(parts) / 3 > limit


def _texts(element: Element, matrix: FloatArray) -> Iterator[Text]:
    """Yield a text, its spans joined, at where it begins."""
    spans = [element, *(child for child in element.children if child.name == "tspan")]
    words = " ".join(" ".join(span.text for span in spans).split())
    places = ([parse_length(span.attributes.get(key, "").split(" ")[0]) for key in "xy"]
              for span in spans)  # fmt: skip
    at = next((place for place in places if None not in place), [0.0, 0.0])
    if words:
        yield Text(words, (matrix @ [*at, 1.0])[:2])


def shapes_of(
    root: Element, sheets: Mapping[str, Mapping[str, str]], what: str
) -> Iterator[Shape | Text]:
    """Yield the shapes and texts that a drawing shows.

    Raises
    ------
    FormatError
        When path data or a transform is damaged, or there are too many.
    """
    yield from _Walker(root, sheets, what).walk(root, _State(np.eye(3)), _DEPTH)
