"""The geometry of SVG: path data, transforms, lengths; as points, curves as chords."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence

import numpy as np

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.plan_shapes import Piece
from palms.io.values import brief

__all__ = ["Pen", "cubic", "ellipse", "numbers_of", "parse_path", "parse_transform", "pieces_of"]

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_TOKEN = re.compile(rf"[MmZzLlHhVvCcSsQqTtAa]|{_NUMBER}|[^\s,]")
_TRANSFORM = re.compile(r"(matrix|translate|scale|rotate|skewX|skewY)\s*\(([^()]*)\)")
_TAKES = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
_CHORDS = 16  # ours: of a quarter circle; off by a thousandth of its radius
_CUSP = math.cos(math.radians(30.0))  # ours: curves that meet at a sharper angle are two
_LARGEST = 1e9  # ours: coordinates beyond are damage


def numbers_of(text: str) -> list[float]:
    """Return the numbers in a list of coordinates.

    Examples
    --------
    >>> numbers_of("10,20 -5.5.5")
    [10.0, 20.0, -5.5, 0.5]
    """
    return [float(each) for each in re.findall(_NUMBER, text)]


def cubic(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> FloatArray:
    """Points (N, 2) along a cubic Bezier curve, without its first.

    Examples
    --------
    >>> cubic(*np.array([[0.0, 0], [0, 3], [3, 3], [3, 0]]))[-1].tolist()
    [3.0, 0.0]
    """
    t = np.linspace(0, 1, _CHORDS + 1)[1:, None]
    curve = (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t**2 * (1 - t) * c + t**3 * d
    return np.asarray(curve)


def ellipse(centre: Sequence[float], radii: Sequence[float]) -> FloatArray:
    """Return the closed ring (N, 2) of an ellipse along the axes.

    Examples
    --------
    >>> len(ellipse((0, 0), (2, 1)))
    65
    """
    angle = np.linspace(0, 2 * math.pi, 4 * _CHORDS + 1)
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * radii + centre
    ring[-1] = ring[0]
    return np.asarray(ring)


def _arc(a: FloatArray, values: Sequence[float], b: FloatArray) -> FloatArray:
    """Points along an elliptical arc, without its first; the standard's appendix F.6."""
    rx, ry = abs(values[0]), abs(values[1])
    if not rx or not ry or (a == b).all():
        return b[None]
    turn = math.radians(values[2])
    axes = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    half = axes @ (a - b) / 2 / [rx, ry]  # where both radii are 1
    size = math.hypot(*half)
    if size > 1:  # radii too small for the distance grow
        rx, ry, half, size = rx * size, ry * size, half / size, 1.0
    if not size:
        return b[None]
    side = 1.0 if bool(values[3]) != bool(values[4]) else -1.0
    centre = side * math.sqrt(max(1 / size**2 - 1, 0.0)) * np.array([half[1], -half[0]])
    start, end = half - centre, -half - centre
    first = math.atan2(start[1], start[0])
    sweep = (math.atan2(end[1], end[0]) - first) % (2 * math.pi)
    if not values[4]:
        sweep -= 2 * math.pi
    count = max(2, math.ceil(abs(sweep) / (math.pi / 2) * _CHORDS))
    angle = first + sweep * np.linspace(0, 1, count + 1)[1:]
    circle = np.column_stack([np.cos(angle), np.sin(angle)]) + centre
    points = (circle * [rx, ry]) @ axes + (a + b) / 2
    points[-1] = b
    return np.asarray(points)


class Pen:
    """Draws one subpath after another; `subpaths` holds the pieces of each.

    Examples
    --------
    >>> pen = Pen()
    >>> pen.move(np.array([0.0, 0.0]))
    >>> pen.draw(np.array([[4.0, 0.0], [4.0, 3.0]]), curved=False)
    >>> pen.close()
    >>> len(pen.subpaths[0][0].points)
    4
    """

    def __init__(self) -> None:
        self.subpaths: list[list[Piece]] = []
        self.at = self.start = np.zeros(2)
        self.handle: FloatArray | None = None  # of the curve before, for smooth ones
        self.before = ""

    def move(self, to: FloatArray) -> None:
        """Begin a subpath."""
        self.at = self.start = to
        self.subpaths.append([])

    def draw(self, points: FloatArray, curved: bool) -> None:
        """Go on along points (N, 2)."""
        if not self.subpaths or self.before == "Z":
            self.subpaths.append([])
        pieces = self.subpaths[-1]
        whole = np.concatenate([self.at[None], points])
        if pieces and pieces[-1].curved == curved and (not curved or _smooth(pieces[-1], whole)):
            pieces[-1] = Piece(np.concatenate([pieces[-1].points, points]), curved)
        else:
            pieces.append(Piece(whole, curved))
        self.at = points[-1]

    def close(self) -> None:
        """Go back to where the subpath began."""
        if (self.at != self.start).any():
            self.draw(self.start[None], False)

    def command(self, letter: str, values: list[float]) -> None:
        """Obey one command with its numbers."""
        kind = letter.upper()
        offset = self.at if letter.islower() else np.zeros(2)
        if kind == "A":
            ends = np.array([values[5:7]]) + offset
        elif kind in "HV":
            axis = int(kind == "V")
            ends = self.at[None].copy()
            ends[0, axis] = values[0] + offset[axis]
        else:
            ends = np.array(values, dtype=np.float64).reshape(-1, 2) + offset
        handle = None
        if kind == "M":
            self.move(ends[0])
        elif kind == "A":
            self.draw(_arc(self.at, values, ends[0]), True)
        elif kind in "LHV":
            self.draw(ends, False)
        elif kind in "CSQT":
            handle = self._curve(kind, ends)
        else:
            self.close()
        self.handle, self.before = handle, kind

    def _curve(self, kind: str, ends: FloatArray) -> FloatArray:
        """Draw a cubic or quadratic curve; return the handle that a smooth one reflects."""
        family = "CS" if kind in "CS" else "QT"
        if kind in "ST":
            known = self.handle is not None and self.before in family
            first = 2 * self.at - self.handle if known and self.handle is not None else self.at
            ends = np.concatenate([first[None], ends])
        a, d = self.at, ends[-1]
        if family == "CS":
            b, c = ends[0], ends[1]
        else:
            b, c = a + 2 / 3 * (ends[0] - a), d + 2 / 3 * (ends[0] - d)
        self.draw(cubic(a, b, c, d), True)
        return np.asarray(ends[-2])


def _smooth(piece: Piece, following: FloatArray) -> bool:
    """Whether a curve goes on without a cusp."""
    a, b = piece.points[-1] - piece.points[-2], following[1] - following[0]
    return float(a @ b) >= _CUSP * math.hypot(*a) * math.hypot(*b)


def parse_path(data: str, what: str) -> list[list[Piece]]:
    """Return the subpaths of path data, each as pieces end to end.

    Raises
    ------
    FormatError
        When it is no path data.

    Examples
    --------
    >>> ((line, curve),) = parse_path("M0 0h4a2 2 0 0 1 2 2", "a.svg")
    >>> line.points.tolist(), curve.curved, curve.points[-1].tolist()
    ([[0.0, 0.0], [4.0, 0.0]], True, [6.0, 2.0])
    """
    pen = Pen()
    for letter, values in _commands(data, what):
        if any(abs(value) > _LARGEST for value in values):
            raise FormatError(what, expected="path data", got=f"{max(values, key=abs):g}")
        pen.command(letter, values)
    return [pieces for pieces in pen.subpaths if pieces]


def _commands(data: str, what: str) -> Iterator[tuple[str, list[float]]]:
    """Yield letters with their numbers; letters left out are put back."""
    tokens = _TOKEN.findall(data)
    letter, i = "", 0
    while i < len(tokens):
        if tokens[i].upper() in _TAKES:
            letter, i = tokens[i], i + 1
        elif letter in ("", "Z", "z"):
            raise FormatError(what, expected="path data", got=brief(data))
        count = _TAKES[letter.upper()]
        values: list[float] = []
        while len(values) < count and i < len(tokens):
            token, i = tokens[i], i + 1
            flags = letter in "Aa" and len(values) in (3, 4) and len(token) > 1
            if flags and token[0] in "01":  # flags may stand together: a1 1 0 01 5 5
                tokens[i - 1], i, token = token[1:], i - 1, token[0]
            if not re.fullmatch(_NUMBER, token):
                raise FormatError(what, expected="path data", got=brief(token))
            values.append(float(token))
        if len(values) < count:
            raise FormatError(what, expected="path data", got=f"{brief(data[-20:])} cut off")
        yield letter, values
        letter = {"M": "L", "m": "l"}.get(letter, letter)


def parse_transform(text: str, what: str) -> FloatArray:
    """Return the matrix (3, 3) of a transform attribute.

    Raises
    ------
    FormatError
        When one of its functions has a wrong number of values.

    Examples
    --------
    >>> (parse_transform("translate(10) scale(2)", "a.svg") @ [1, 1, 1]).tolist()
    [12.0, 2.0, 1.0]
    """
    matrix = np.eye(3)
    for name, inside in _TRANSFORM.findall(text):
        matrix = matrix @ _matrix(name, numbers_of(inside), what)
    if not (np.abs(matrix) < _LARGEST).all():
        raise FormatError(what, expected="a transform", got=brief(text))
    return matrix


def _matrix(name: str, values: list[float], what: str) -> FloatArray:
    match name, values:
        case "matrix", [a, b, c, d, e, f]:
            rows = [[a, c, e], [b, d, f], [0, 0, 1]]
        case "translate", [x, *more] if len(more) < 2:
            rows = [[1, 0, x], [0, 1, more[0] if more else 0.0], [0, 0, 1]]
        case "scale", [x, *more] if len(more) < 2:
            rows = [[x, 0, 0], [0, more[0] if more else x, 0], [0, 0, 1]]
        case "rotate", [degrees, *more] if len(more) in (0, 2):
            c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
            x, y = more or (0.0, 0.0)
            rows = [[c, -s, x - c * x + s * y], [s, c, y - s * x - c * y], [0, 0, 1]]
        case "skewX", [degrees]:
            rows = [[1, math.tan(math.radians(degrees)), 0], [0, 1, 0], [0, 0, 1]]
        case "skewY", [degrees]:
            rows = [[1, 0, 0], [math.tan(math.radians(degrees)), 1, 0], [0, 0, 1]]
        case _:
            raise FormatError(
                what, expected=f"the values of {name}()", got=f"{len(values)} of them"
            )
    return np.array(rows, dtype=np.float64)


def pieces_of(name: str, attributes: dict[str, float]) -> list[list[Piece]]:
    """Return a basic shape as `parse_path` returns a path: line, rect, circle or ellipse.

    Examples
    --------
    >>> ((ring,),) = pieces_of("rect", {"x": 1.0, "width": 4.0, "height": 2.0})
    >>> ring.points.tolist()
    [[1.0, 0.0], [5.0, 0.0], [5.0, 2.0], [1.0, 2.0], [1.0, 0.0]]
    """

    def get(*keys: str) -> list[float]:
        return [attributes.get(key, 0.0) for key in keys]

    if name == "line":
        return [[Piece(np.array([get("x1", "y1"), get("x2", "y2")]), False)]]
    if name == "rect":
        x, y, width, height = get("x", "y", "width", "height")
        if not (width > 0 and height > 0):
            return []
        corners = [[0, 0], [width, 0], [width, height], [0, height], [0, 0]]
        return [[Piece(np.array(corners) + [x, y], False)]]
    radii = get("r", "r") if name == "circle" else get("rx", "ry")
    return [[Piece(ellipse(get("cx", "cy"), radii), True)]] if min(radii) > 0 else []
