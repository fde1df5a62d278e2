"""Shapes of a drawing, wherever they come from: what their names say becomes a floor plan."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from palms.errors import PalmsWarning
from palms.floorplan import SegmentClass
from palms.geometry import FloatArray
from palms.io.plan_drawing import DoorGroup, Drawing, Layers, Stroke
from palms.io.plan_words import Role
from palms.io.values import brief

__all__ = ["Canvas", "Piece", "Shape", "Sorter", "Text"]

_MADE_UP = re.compile(  # ours: ids that programs make up, as path12 and g8-3
    r"(path|rect|polygon|polyline|circle|ellipse|line|shape|g|svg|use)?[-_\d]*", re.IGNORECASE
)
_NO_NAME = "without a name"
_LETTER_M = 1.0  # ours: letters on plans are smaller


class Piece(NamedTuple):
    """Points (N, 2) of a run of straight lines, or of a smooth curve."""

    points: FloatArray
    curved: bool


class Shape(NamedTuple):
    """A drawn shape in the units of the drawing, y down.

    Names come from the inside out: those of the shape, then of each group around it.
    """

    subpaths: list[list[Piece]]
    names: tuple[str, ...]
    title: str
    element_id: str
    group: int  # number of the group that it is in
    stroke_width: float | None  # None when its outline is not drawn
    dark: bool  # filled dark
    matrix: FloatArray


class Text(NamedTuple):
    """A text with its place, in the units of the drawing, y down."""

    words: str
    at: FloatArray


class Canvas(NamedTuple):
    """Turns units, y down, into metres of the map."""

    left: float
    bottom: float
    metres: float

    def place(self, points: FloatArray) -> FloatArray:
        """Return points (N, 2) in the map."""
        return np.asarray((points * [1, -1] + [-self.left, self.bottom]) * self.metres)

    def strokes(self, shape: Shape, closed: bool = True) -> Iterator[Stroke]:
        """Yield the lines of a shape; one that is filled only may be closed."""
        width = math.inf if shape.stroke_width is None else shape.stroke_width
        for pieces in shape.subpaths:
            for piece in pieces:
                yield Stroke(self._turned(shape, piece.points), piece.curved, width)
            ends = np.array([pieces[-1].points[-1], pieces[0].points[0]])
            if closed and shape.stroke_width is None and (ends[0] != ends[1]).any():
                yield Stroke(self._turned(shape, ends), False, width)

    def ring(self, shape: Shape) -> FloatArray:
        """Return the outline (N, 2) of the first part of a shape, closed."""
        points = [piece.points[:-1] for piece in shape.subpaths[0]]
        whole = np.concatenate([*points, shape.subpaths[0][-1].points[-1:], points[0][:1]])
        return self._turned(shape, whole)

    def _turned(self, shape: Shape, points: FloatArray) -> FloatArray:
        return self.place(points @ shape.matrix[:2, :2].T + shape.matrix[:2, 2])


class Sorter:
    """Puts shapes where their names say that they belong."""

    def __init__(self, layers: Layers, canvas: Canvas, what: str) -> None:
        self.layers, self.canvas = layers, canvas
        self.drawing = Drawing(what)
        self.groups: dict[int, DoorGroup] = {}

    def sort(self, shapes: Sequence[Shape], min_stroke: float | None) -> None:
        """Add all shapes to the drawing."""
        roles = [self._role(shape.names[:-1]) for shape in shapes]  # not those of the whole
        said = set(roles)
        bare = not said & {Role.WALL, Role.GLASS}
        guess = bare and Role.ROOM not in said and self.layers.is_guess
        unnamed: list[Stroke] = []
        for shape, role in zip(shapes, roles, strict=True):
            layer = next(filter(None, shape.names[:-1]), _NO_NAME)
            self.drawing.counted[layer] += 1
            if role is Role.ROOM:
                self._room(shape, bare)
            elif role is not None and role.segment_class is not None:
                self._add(shape, role.segment_class)
            elif guess and not self._is_letter(shape):
                unnamed += self.canvas.strokes(shape)
            else:
                self.drawing.left_out[layer] += 1
        self.drawing.add_unnamed(unnamed, min_stroke)
        named = [f"{n} ({k})" for n, k in self.drawing.counted.most_common()
                 if n != _NO_NAME and not _MADE_UP.fullmatch(n)]  # fmt: skip
        if guess and named:
            warnings.warn(
                f"{self.drawing.what}: no layer says wall, so all that is drawn heavily is one; "
                f"layers {brief(', '.join(named), 120)}",
                PalmsWarning,
                stacklevel=4,
            )

    def _role(self, names: Sequence[str]) -> Role | None:
        for name in filter(None, names):
            kind = self.layers.role(name)
            if kind is not None:
                return Role[kind.name]
            if self.layers.holds_rooms(name):
                return Role.ROOM
        return None

    def _add(self, shape: Shape, kind: SegmentClass) -> None:
        group = None
        if kind is SegmentClass.DOOR:
            if shape.group not in self.groups:
                self.groups[shape.group] = self.drawing.new_group()
            group = self.groups[shape.group]
        for stroke in self.canvas.strokes(shape, closed=group is None):
            self.drawing.add(stroke, kind, group)

    def _room(self, shape: Shape, is_wall: bool) -> None:
        if shape.subpaths:
            made_up = _MADE_UP.fullmatch(shape.element_id)
            otherwise = "" if made_up else re.sub(r"[_\s]+", " ", shape.element_id).strip()
            self.drawing.add_room(self.canvas.ring(shape), shape.title, otherwise)
        if is_wall:
            self._add(shape, SegmentClass.WALL)

    def _is_letter(self, shape: Shape) -> bool:
        """Whether a shape shows nothing, or is a letter turned into a path."""
        if shape.stroke_width is not None:
            return False
        points = [piece.points for pieces in shape.subpaths for piece in pieces if piece.curved]
        if not shape.dark or not points:
            return not shape.dark
        extent = np.ptp(np.concatenate(points) @ shape.matrix[:2, :2].T, axis=0)
        return bool(extent.max() * self.canvas.metres < _LETTER_M)
