"""A block of a generated building, filled with corridors and rooms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from palms.evaluation.simulation.dice import chance, pick, uniform
from palms.evaluation.simulation.layout import OUTSIDE, Passage, Pose, box, carve, plan_of_rooms
from palms.evaluation.simulation.rows import Names, Rooms, Row, fill_row
from palms.evaluation.simulation.skeleton import Block, Port, Span
from palms.evaluation.simulation.styles import BuildingStyle
from palms.floorplan import Room, SegmentClass
from palms.geometry import FloatArray, lengths

__all__ = ["STAIRS", "Piece", "fill_block"]

STAIRS = "Stairs"  # what rooms with stairs are called
_STAIRS_M = 3.2  # simulation: their width
_TWO_STAIRS_M = 45.0  # simulation: blocks longer than this have stairs at both ends
_BESIDE = "@"  # begins the names of what lies beside the block and is no room of it
_DEEP_M = 9.5  # simulation: two rows back to back need this much
_ALCOVE_M = (1.5, 4.0), (0.5, 1.6)  # simulation: width and depth
_PLAIN_CORE_SHARE = 0.2  # simulation: cores that are one deep row of large rooms
_SLIVER_M = 0.05  # ours: no piece of wall is shorter
_WINDOW_SHARE = 0.4  # simulation: corridors with a window at their ends


class Piece(NamedTuple):
    """Part of a plan, in the map frame.

    Attributes
    ----------
    segments_m : ndarray (N, 2, 2)
    classes : ndarray (N,)
    rooms : tuple of Room
    """

    segments_m: FloatArray
    classes: npt.NDArray[np.uint8]
    rooms: tuple[Room, ...]


class _Kit(NamedTuple):
    """What it takes to fill rows."""

    style: BuildingStyle
    names: Names
    rng: np.random.Generator

    def row(self, x: Span, y: Span, corridors: Sequence[str], outer: bool) -> Rooms:
        theme = pick(self.rng, self.style.themes)
        return fill_row(Row(x, y, tuple(corridors), theme, outer), self.style, self.names, self.rng)


def fill_block(
    block: Block, style: BuildingStyle, names: Names, rng: np.random.Generator, main: bool = False
) -> Piece:
    """Fill a block with corridors and rows of rooms.

    Parameters
    ----------
    block : Block
    style : BuildingStyle
    names : Names
        Counts on.
    rng : numpy.random.Generator
    main : bool
        Whether the stairs are in it.

    Examples
    --------
    >>> from palms.evaluation.simulation.styles import style_of
    >>> block = Block(30.0, 13.0, (Span(5.5, 7.5),))
    >>> piece = fill_block(block, style_of("office"), Names(1), np.random.default_rng(0))
    >>> piece.rooms[0].name, len(piece.segments_m) == len(piece.classes)
    ('Corridor A', True)
    """
    kit = _Kit(style, names, rng)
    ways = [names.other("Corridor") for _ in block.corridors]
    rooms = Rooms(
        {
            name: box(0.0, y.low, block.width_m, y.high)
            for name, y in zip(ways, block.corridors, strict=True)
        },
        tuple(
            Passage(name, OUTSIDE, width_m=None, kind=SegmentClass.GLASS)
            for name in ways
            if chance(rng, _WINDOW_SHARE)
        ),
    )
    for gap in range(len(ways) - 1):
        rooms += _gap(block, gap, ways, kit)
    rooms += _outer_row(block, "south", ways[0], kit, None)
    rooms += _outer_row(block, "north", ways[-1], kit, _stairs(block) if main else None)
    rooms += _ports(block, ways, rooms, rng)
    return _drawn(block, _with_alcoves(rooms, kit))


def _stairs(block: Block) -> list[Span]:
    both = [Span(0.0, _STAIRS_M), Span(block.width_m - _STAIRS_M, block.width_m)]
    return both if block.width_m > _TWO_STAIRS_M else both[:1]


def _without(whole: Span, cuts: Sequence[Span]) -> list[Span]:
    """Return what is left of a span when others are cut out of it."""
    edges = [whole.low, *(v for cut in sorted(cuts) for v in cut), whole.high]
    return [Span(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _gap(block: Block, gap: int, ways: Sequence[str], kit: _Kit) -> Rooms:
    """Crossing corridors between two corridors, and the rooms or courtyards between them."""
    y = Span(block.corridors[gap].high, block.corridors[gap + 1].low)
    sides = ways[gap : gap + 2]
    rooms = Rooms()
    for x in block.crosses:
        name = kit.names.other("Cross corridor")
        joints = tuple(Passage(name, way, width_m=None, kind=None) for way in sides)
        rooms += Rooms({name: box(x.low, y.low, x.high, y.high)}, joints)
    for cell, x in enumerate(_without(Span(0.0, block.width_m), block.crosses)):
        if x.length < 0.1:
            continue
        if (gap, cell) in block.courts:
            rooms += _court(
                f"{_BESIDE}court {gap} {cell}", box(x.low, y.low, x.high, y.high), sides, kit
            )
        else:
            rooms += _cell(x, y, sides, kit)
    return rooms


def _court(name: str, shape: Any, sides: Sequence[str], kit: _Kit) -> Rooms:  # noqa: ANN401
    glazed = [side for side in sides if chance(kit.rng, 0.7)]
    panes = [Passage(name, side, width_m=None, kind=SegmentClass.GLASS) for side in glazed]
    door = Passage(name, pick(kit.rng, sides), uniform(kit.rng, (0.2, 0.8)), 1.2)
    return Rooms({name: shape}, (*panes, door))


def _cell(x: Span, y: Span, sides: Sequence[str], kit: _Kit) -> Rooms:
    """Rooms between two corridors: one deep row, or two back to back."""
    if y.length < _DEEP_M or chance(kit.rng, _PLAIN_CORE_SHARE):
        return kit.row(x, y, sides, False)
    middle = round(y.low + y.length * uniform(kit.rng, (0.42, 0.58)), 2)
    lower = kit.row(x, Span(y.low, middle), sides[:1], False)
    return lower + kit.row(x, Span(middle, y.high), sides[1:], False)


def _outer_row(
    block: Block, side: str, way: str, kit: _Kit, stairs: Sequence[Span] | None
) -> Rooms:
    """Rooms along an outer wall, with stairs and short corridors between them."""
    if side == "south":
        y = Span(0.0, block.corridors[0].low)
    else:
        y = Span(block.corridors[-1].high, block.depth_m)
    rooms = Rooms()
    if y.length <= 0:
        return rooms
    cuts = block.cuts(side)  # type: ignore[arg-type]
    for x in cuts:
        name = kit.names.other("Short corridor")
        joint = Passage(name, way, width_m=None, kind=None)
        rooms += Rooms({name: box(x.low, y.low, x.high, y.high)}, (joint,))
    for x in stairs or ():
        name = kit.names.other(STAIRS)
        door = Passage(name, way, 0.5, 1.1)
        rooms += Rooms({name: box(x.low, y.low, x.high, y.high)}, (door,))
    for x in _without(Span(0.0, block.width_m), [*cuts, *(stairs or ())]):
        if x.length > 0.1:
            rooms += kit.row(x, y, (way,), True)
    return rooms


def _ports(block: Block, ways: Sequence[str], rooms: Rooms, rng: np.random.Generator) -> Rooms:
    """Ways into the foyers beside the block."""
    found = Rooms()
    for k, port in enumerate(block.ports):
        name = f"{_BESIDE}foyer {k}"
        if port.side in ("east", "west"):
            way = ways[block.corridors.index(port.way)]
        else:
            way = next(n for n, s in rooms.shapes.items() if _is_way(n, s, port))
        kind = pick(rng, (None, None, SegmentClass.OPENING, SegmentClass.DOOR))
        wide = min(1.8, round(port.way.length - 0.45, 2)) if kind is SegmentClass.DOOR else None
        found += Rooms({name: _beside(block, port)}, (Passage(name, way, 0.5, wide, kind),))
    return found


def _is_way(name: str, shape: Any, port: Port) -> bool:  # noqa: ANN401
    low, low_y, high, _ = shape.bounds
    at_south = low_y < 0.01
    right_side = at_south == (port.side == "south")
    return name.startswith("Short") and (low, high) == tuple(port.way) and right_side


def _beside(block: Block, port: Port) -> Any:  # noqa: ANN401
    """Return a metre of the foyer behind a port."""
    low, high = port.wall
    w, d = block.width_m, block.depth_m
    return {
        "east": box(w, low, w + 1.0, high),
        "north": box(low, d, high, d + 1.0),
        "west": box(-1.0, low, 0.0, high),
        "south": box(low, -1.0, high, 0.0),
    }[port.side]


def _with_alcoves(rooms: Rooms, kit: _Kit) -> Rooms:
    """Let corridors take a corner of some wide rooms."""
    shapes = rooms.shapes
    for door in rooms.passages:
        room, way = shapes[door.room], shapes.get(door.other)
        if door.kind is not SegmentClass.DOOR or not door.other.startswith("Corridor"):
            continue
        low_x, low_y, high_x, high_y = room.bounds
        wide, deep = high_x - low_x, high_y - low_y
        is_whole = abs(room.area - wide * deep) < 1e-6
        if wide < 6.4 or not is_whole or door.room[0] == _BESIDE:
            continue
        if not chance(kit.rng, kit.style.alcove_share):
            continue
        a = round(uniform(kit.rng, (_ALCOVE_M[0][0], min(_ALCOVE_M[0][1], wide - 4.6))), 2)
        b = round(uniform(kit.rng, _ALCOVE_M[1]), 2)
        x = low_x if chance(kit.rng, 0.5) else round(high_x - a, 3)
        above = way is not None and way.bounds[1] < low_y
        y = low_y if above else round(high_y - b, 3)
        shapes = carve(shapes, door.room, door.other, box(x, y, round(x + a, 3), round(y + b, 3)))
    return Rooms(shapes, rooms.passages, rooms.columns_m)


def _drawn(block: Block, rooms: Rooms) -> Piece:
    """Draw the walls, without those of what lies beside the block."""
    plan = plan_of_rooms(rooms.shapes, rooms.passages, Pose())
    corner = np.array([block.width_m, block.depth_m])
    low, high = plan.segments_m.min(axis=1), plan.segments_m.max(axis=1)
    beyond = ((high < -1e-6) | (low > corner + 1e-6)).any(axis=1)
    clipped = np.clip(plan.segments_m, 0.0, corner)
    kept = ~beyond & (lengths(clipped) > _SLIVER_M)
    columns = np.concatenate([np.empty((0, 2, 2)), *rooms.columns_m])
    segments = np.concatenate([clipped[kept], columns])
    classes = np.concatenate([plan.classes[kept], np.zeros(len(columns), np.uint8)])
    named = [room for room in plan.rooms if not room.name.startswith(_BESIDE)]
    moved = tuple(Room(room.name, block.pose.apply(room.polygon_m)) for room in named)
    return Piece(block.pose.apply(segments), classes, moved)
