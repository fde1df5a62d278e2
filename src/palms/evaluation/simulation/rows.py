"""Rows of rooms along a corridor: offices, laboratories, lobbies with columns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from palms.evaluation.simulation.dice import chance, pick, uniform, weighted
from palms.evaluation.simulation.layout import OUTSIDE, Passage, box
from palms.evaluation.simulation.skeleton import Span
from palms.evaluation.simulation.styles import BuildingStyle, RowTheme
from palms.floorplan import SegmentClass
from palms.geometry import FloatArray

__all__ = ["Names", "Rooms", "Row", "columns_in", "fill_row"]

_NARROW_M = 2.2  # simulation: rooms narrower than this are closets
_LOBBY_M = (9.0, 15.0)  # simulation
_LONG_M = 24.0  # simulation: rows that may have a lobby
_WIDE_M = 6.4  # simulation: rooms that may have two doors, and an alcove beside them
_COLUMN_M = 0.45  # simulation
_CLEAR_M = -1.9  # simulation: columns stand so far inside


@dataclass
class Names:
    """Hand out the names of rooms, corridors and the like, each once.

    Examples
    --------
    >>> names = Names(2)
    >>> names.room("Room"), names.room("Lab"), names.other("Corridor")
    ('Room 201', 'Lab 202', 'Corridor A')
    """

    level: int
    count: int = 0
    others: dict[str, int] = field(default_factory=dict)

    def room(self, word: str) -> str:
        """Return the next room's name."""
        self.count += 1
        return f"{word} {self.level * 100 + self.count}"

    def other(self, word: str) -> str:
        """Return a word with the next letter: Corridor A."""
        number = self.others[word] = self.others.get(word, -1) + 1
        letters = chr(ord("A") + number % 26)
        return f"{word} {letters * (1 + number // 26)}"


@dataclass(frozen=True, slots=True)
class Rooms:
    """Part of a block: rooms by name, passages, and walls that belong to no room.

    Examples
    --------
    >>> (Rooms() + Rooms({"A": box(0, 0, 1, 1)})).shapes.keys()
    dict_keys(['A'])
    """

    shapes: dict[str, Any] = field(default_factory=dict)
    passages: tuple[Passage, ...] = ()
    columns_m: tuple[FloatArray, ...] = ()

    def __add__(self, other: Rooms) -> Rooms:
        return Rooms(
            {**self.shapes, **other.shapes},
            self.passages + other.passages,
            self.columns_m + other.columns_m,
        )


@dataclass(frozen=True, slots=True)
class Row:
    """Where a row lies, and the corridors that it opens to.

    Parameters
    ----------
    x, y : Span
    corridors : tuple of str
        Names; doors go to one of them.
    theme : RowTheme
    outer : bool
        Whether its other side is the outer wall.
    """

    x: Span
    y: Span
    corridors: tuple[str, ...]
    theme: RowTheme
    outer: bool


_KINDS = ("Room", "Studio", "Lab", "Storage")
_FACTORS = ((1.0, 1.0), (1.5, 2.1), (2.3, 4.0), (0.75, 1.2))  # of the module's width


def fill_row(row: Row, style: BuildingStyle, names: Names, rng: np.random.Generator) -> Rooms:
    """Fill a row with rooms and give each its door.

    Examples
    --------
    >>> from palms.evaluation.simulation.styles import style_of
    >>> style, rng = style_of("office"), np.random.default_rng(0)
    >>> row = Row(Span(0, 20), Span(0, 5), ("Corridor A",), style.themes[0], True)
    >>> rooms = fill_row(row, style, Names(1), rng)
    >>> round(sum(shape.area for shape in rooms.shapes.values())), len(rooms.passages) >= 4
    (100, True)
    """
    if row.x.length > _LONG_M and chance(rng, style.lobby_share):
        wide = uniform(rng, _LOBBY_M)
        low = round(row.x.low + uniform(rng, (4.0, row.x.length - wide - 4.0)), 2)
        span = Span(low, round(low + wide, 2))
        before, after = (
            replace(row, x=Span(row.x.low, low)),
            replace(row, x=Span(span[1], row.x[1])),
        )
        parts = _plain(before, style, names, rng), _plain(after, style, names, rng)
        return parts[0] + _lobby(replace(row, x=span), names, rng) + parts[1]
    return _plain(row, style, names, rng)


def _plain(row: Row, style: BuildingStyle, names: Names, rng: np.random.Generator) -> Rooms:
    kinds, widths = _widths(row, rng)
    labels = [names.room("Room" if kind == "Studio" else kind) for kind in kinds]
    edges = [*np.round(row.x.low + np.cumsum([0.0, *widths[:-1]]), 3).tolist(), row.x.high]
    shapes = {
        label: box(low, row.y.low, high, row.y.high)
        for label, low, high in zip(labels, edges[:-1], edges[1:], strict=True)
    }
    doors: list[Passage] = []
    mirrored, at = chance(rng, 0.6), uniform(rng, (0.08, 0.3))
    for i, (name, kind, wide) in enumerate(zip(labels, kinds, widths, strict=True)):
        place = 1.0 - at if mirrored and i % 2 else at
        place = 0.5 if chance(rng, 0.1) else place
        doors += _doors(name, row, (kind, wide, place), rng)
    for a, b in pairwise(labels):
        if chance(rng, style.suite_share):
            doors.append(Passage(a, b, uniform(rng, (0.2, 0.8))))
    return Rooms(shapes, tuple(doors))


def _doors(
    name: str, row: Row, room: tuple[str, float, float], rng: np.random.Generator
) -> list[Passage]:
    """Doors of a room: one, or two for wide ones and for those between two corridors."""
    kind, wide, place = room
    corridors: Sequence[str] = row.corridors
    if len(corridors) > 1 and not chance(rng, 0.5):
        corridors = [pick(rng, corridors)]
    if wide > _WIDE_M and chance(rng, 0.6):
        width = 1.6 if kind == "Lab" and chance(rng, 0.3) else 0.95
        return [Passage(name, c, spot, width) for c in corridors for spot in (0.08, 0.92)]
    return [Passage(name, corridor, place) for corridor in corridors]


def _widths(row: Row, rng: np.random.Generator) -> tuple[list[str], list[float]]:
    """Kinds and widths of rooms that fill a row exactly."""
    module, total = uniform(rng, row.theme.module_m), row.x.length
    if total < 1.6 * _NARROW_M:
        return ["Storage"], [total]
    theme = row.theme
    weights = (theme.offices, theme.doubles, theme.labs, theme.services)
    kinds: list[str] = []
    widths: list[float] = []
    while sum(widths) < total:
        kind = weighted(rng, weights)
        factor = uniform(rng, _FACTORS[kind])
        kinds.append(_KINDS[kind])
        widths.append(max(module * factor, _NARROW_M))
    over = sum(widths) - total
    if len(widths) > 1 and over > widths[-1] / 2:
        kinds, widths = kinds[:-1], widths[:-1]
    scale = total / sum(widths)
    return kinds, [width * scale for width in widths]


def _lobby(row: Row, names: Names, rng: np.random.Generator) -> Rooms:
    """Make a lobby: wide open to the corridor, with columns, a glass front and an entrance."""
    name = names.other("Lobby" if row.outer else "Lounge")
    opening = uniform(rng, (4.0, row.x.length - 1.5))
    corridor = pick(rng, row.corridors)
    ways = [Passage(name, corridor, uniform(rng, (0.1, 0.9)), opening, SegmentClass.OPENING)]
    if row.outer and chance(rng, 0.7):
        ways.insert(0, Passage(name, OUTSIDE, width_m=None, kind=SegmentClass.GLASS))
        ways.append(Passage(name, OUTSIDE, uniform(rng, (0.3, 0.7)), 1.9))
    shape = box(row.x.low, row.y.low, row.x.high, row.y.high)
    columns = columns_in(shape, 0.0, rng) if chance(rng, 0.7) else ()
    return Rooms({name: shape}, tuple(ways), tuple(columns))


def columns_in(
    shape: Any,  # noqa: ANN401
    turn_rad: float,
    rng: np.random.Generator,
) -> tuple[FloatArray, ...]:
    """Square columns on a grid well inside a shape, as closed rings (4, 2, 2) of walls.

    Examples
    --------
    >>> len(columns_in(box(0, 0, 12, 5), 0.0, np.random.default_rng(0)))
    2
    """
    import shapely

    spacing = uniform(rng, (3.6, 5.0))
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    turn = np.array([[c, s], [-s, c]])  # from the grid's axes, for rows of points
    inner = shapely.transform(shape.buffer(_CLEAR_M, join_style="mitre"), lambda xy: xy @ turn.T)
    if inner.is_empty:
        return ()
    low_x, low_y, high_x, high_y = inner.bounds
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * _COLUMN_M
    found = []
    for x in _spread(low_x, high_x, spacing):
        for y in _spread(low_y, high_y, spacing):
            if inner.buffer(1e-6).covers(shapely.Point(x, y)):
                corners = np.round((square + np.array([x, y])) @ turn, 3)
                found.append(np.stack([corners, np.roll(corners, -1, axis=0)], axis=1))
    return tuple(found)


def _spread(low: float, high: float, spacing: float) -> FloatArray:
    """Points about a spacing apart between two ends; the middle alone where it is short."""
    count = int((high - low) / spacing) + 1
    return np.linspace(low, high, count) if count > 1 else np.array([(low + high) / 2])
