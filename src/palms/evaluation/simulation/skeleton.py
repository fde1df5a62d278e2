"""The bones of a generated building: right-angled blocks, and foyers that join wings to them.

::

    north row            | stub |
    ---- corridor -----------------------  east end
    core | cross | core  | cross | court     (foyer)
    ---- corridor -----------------------
    south row

A block lies in axes of its own, its lower left corner at the origin; all levels of a
building share one skeleton.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from palms.evaluation.simulation.dice import chance, pick, uniform, weighted, whole
from palms.evaluation.simulation.layout import Pose
from palms.evaluation.simulation.styles import BuildingStyle
from palms.geometry import FloatArray, rotate

__all__ = ["Block", "Foyer", "Port", "Skeleton", "Span", "draw_skeleton"]

_CLEAR_M = 5.8  # ours: stairs and a room beside them, at the ends of a row
_APART_M = 3.2  # ours: rooms between two short corridors are at least so wide
_ALLEY_M = 1.0  # ours: between a wing and another part of the building
_TRIES = 40  # ours
_SIDES = ("east", "north", "west", "south")  # counter-clockwise, from normal +x

Side = Literal["east", "north", "west", "south"]


class Span(NamedTuple):
    """A stretch of an axis, in metres.

    Examples
    --------
    >>> Span(2.0, 5.0).middle
    3.5
    """

    low: float
    high: float

    @property
    def length(self) -> float:
        """Its length."""
        return self.high - self.low

    @property
    def middle(self) -> float:
        """Its middle."""
        return (self.low + self.high) / 2


class Port(NamedTuple):
    """A stretch of a block's outer wall behind which a foyer lies.

    Attributes
    ----------
    side : str
    wall : Span
        The stretch, along x or y.
    way : Span
        The corridor that leads there, along the same axis.
    """

    side: Side
    wall: Span
    way: Span


@dataclass(frozen=True, slots=True)
class Block:
    """A right-angled block: rows of rooms along one to three corridors.

    Parameters
    ----------
    width_m, depth_m : float
        Along the corridors and across them.
    corridors, crosses : tuple of Span
        Corridors along x, by y; corridors that cross from the first to the last, by x.
    dead_ends : tuple
        Side and span in x of short corridors into the outer rows.
    courts : tuple of (int, int)
        Gap between corridors and cell in it, of each courtyard.
    pose : Pose
        Where the block lies.
    ports : tuple of Port

    Examples
    --------
    >>> Block(30.0, 13.0, (Span(5.5, 7.5),)).outline_m().tolist()[2]
    [30.0, 13.0]
    """

    width_m: float
    depth_m: float
    corridors: tuple[Span, ...]
    crosses: tuple[Span, ...] = ()
    dead_ends: tuple[tuple[Side, Span], ...] = ()
    courts: tuple[tuple[int, int], ...] = ()
    pose: Pose = Pose()  # noqa: RUF009
    ports: tuple[Port, ...] = ()

    def outline_m(self) -> FloatArray:
        """Corners (4, 2) where the block lies."""
        w, d = self.width_m, self.depth_m
        return self.pose.apply([[0.0, 0.0], [w, 0.0], [w, d], [0.0, d]])

    def wall_m(self, side: Side, wall: Span) -> FloatArray:
        """Return the right and left end (2, 2) of a stretch of a side, as seen looking outwards."""
        low, high = wall
        ends: list[list[float]] = {
            "east": [[self.width_m, low], [self.width_m, high]],
            "north": [[high, self.depth_m], [low, self.depth_m]],
            "west": [[0.0, high], [0.0, low]],
            "south": [[low, 0.0], [high, 0.0]],
        }[side]
        return self.pose.apply(ends)

    def cuts(self, side: Side) -> list[Span]:
        """Short corridors through the outer row of a long side, in order."""
        found = [span for where, span in self.dead_ends if where == side]
        return sorted(found + [port.way for port in self.ports if port.side == side])


class Foyer(NamedTuple):
    """What joins a wing to its block.

    Attributes
    ----------
    block, port : int
        The block and which of its ports.
    wing : int
        The block whose west side it faces.
    """

    block: int
    port: int
    wing: int


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Blocks and the foyers between them; the first block is the main one.

    Examples
    --------
    >>> Skeleton((Block(40.0, 30.0, (Span(5.5, 7.5),)),)).size_m
    50.0
    """

    blocks: tuple[Block, ...]
    foyers: tuple[Foyer, ...] = ()

    @property
    def size_m(self) -> float:
        """Largest distance between two corners."""
        corners = np.concatenate([block.outline_m() for block in self.blocks])
        return float(np.linalg.norm(corners[:, None] - corners[None], axis=2).max())

    def moved(self, pose: Pose) -> Skeleton:
        """Return the skeleton in another place."""
        blocks = tuple(replace(b, pose=_compose(pose, b.pose)) for b in self.blocks)
        return Skeleton(blocks, self.foyers)

    def ring_m(self, foyer: Foyer) -> FloatArray:
        """Corners (4, 2): right and left end of the block's stretch, then of the wing's."""
        block, wing = self.blocks[foyer.block], self.blocks[foyer.wing]
        port = block.ports[foyer.port]
        ends = block.wall_m(port.side, port.wall), wing.wall_m("west", Span(0.0, wing.depth_m))
        return np.concatenate(ends)


def draw_skeleton(style: BuildingStyle, angled: bool, rng: np.random.Generator) -> Skeleton:
    """Draw blocks and wings.

    Parameters
    ----------
    style : BuildingStyle
    angled : bool
        Whether there are wings at other than right angles.
    rng : numpy.random.Generator

    Examples
    --------
    >>> from palms.evaluation.simulation.styles import style_of
    >>> skeleton = draw_skeleton(style_of("office"), True, np.random.default_rng(0))
    >>> len(skeleton.blocks) > 1, len(skeleton.blocks) - len(skeleton.foyers)
    (True, 1)
    """
    skeleton = Skeleton((_main(style, rng),))
    wings = weighted(rng, style.wing_weights)
    bends = [angled and (k == 0 or chance(rng, 0.5)) for k in range(max(wings, int(angled)))]
    for bent in bends:
        for _ in range(_TRIES * (4 if bent else 1)):
            grown = _with_wing(skeleton, style, bent, rng)
            if grown is not None and grown.size_m <= style.largest_m and _is_clear(grown):
                skeleton = grown
                break
    blocks = tuple(_with_dead_ends(block, style, rng) for block in skeleton.blocks)
    return Skeleton(blocks, skeleton.foyers)


def _main(style: BuildingStyle, rng: np.random.Generator) -> Block:
    count = weighted(rng, style.corridor_weights) + 1
    width = round(uniform(rng, style.length_m[count - 1]), 2)
    corridors, depth = _corridors(style, count, rng)
    crosses = _crosses(style, width, rng) if count > 1 else ()
    courts = []
    for gap in range(count - 1):
        deep = corridors[gap + 1].low - corridors[gap].high > 9.0
        for cell in range(1, len(crosses)):
            wide = crosses[cell].low - crosses[cell - 1].high > 8.0
            if deep and wide and chance(rng, style.court_share):
                courts.append((gap, cell))
    return Block(width, depth, corridors, crosses, courts=tuple(courts))


def _corridors(
    style: BuildingStyle, count: int, rng: np.random.Generator
) -> tuple[tuple[Span, ...], float]:
    """Draw the spans in y of parallel corridors, and the depth of the block."""
    y = 0.0 if chance(rng, style.single_loaded_share) else uniform(rng, style.row_m)
    spans = []
    for k in range(count):
        if k:
            y += uniform(rng, style.core_m)
        low, y = y, y + uniform(rng, style.corridor_m)
        spans.append(Span(round(low, 2), round(y, 2)))
    return tuple(spans), round(spans[-1].high + uniform(rng, style.row_m), 2)


def _crosses(style: BuildingStyle, width: float, rng: np.random.Generator) -> tuple[Span, ...]:
    """Draw the spans in x of crossing corridors: one at least, two or more for a loop."""
    inset = pick(rng, (0.0, 4.0, 6.0, 9.0))
    free = width - 2 * inset
    gaps = max(1, round(free / uniform(rng, style.cross_every_m)))
    wide = round(uniform(rng, style.cross_m), 2)
    places = [inset + k * (free - wide) / gaps for k in range(gaps + 1)]
    moved = [p + uniform(rng, (-2.0, 2.0)) * (0 < k < gaps) for k, p in enumerate(places)]
    if gaps == 1 and chance(rng, 0.25):
        moved = moved[:1]
    return tuple(Span(round(p, 2), round(p + wide, 2)) for p in moved)


def _with_dead_ends(block: Block, style: BuildingStyle, rng: np.random.Generator) -> Block:
    found: list[tuple[Side, Span]] = []
    rows: tuple[tuple[Side, float], ...] = (("south", block.corridors[0].low), ("north", 1.0))
    for side, row in rows:
        if row > 0 and block.width_m > 20.0 and chance(rng, style.dead_end_share):
            wide = round(uniform(rng, style.stub_m), 2)
            low = round(uniform(rng, (_CLEAR_M + 1.0, block.width_m - _CLEAR_M - 1.0 - wide)), 2)
            span = Span(low, round(low + wide, 2))
            if all(_apart(span, other) for other in block.cuts(side)):
                found.append((side, span))
    return replace(block, dead_ends=tuple(found))


def _apart(a: Span, b: Span) -> bool:
    return a.low - b.high > _APART_M or b.low - a.high > _APART_M


def _with_wing(
    skeleton: Skeleton, style: BuildingStyle, bent: bool, rng: np.random.Generator
) -> Skeleton | None:
    """Try to join one more wing; None where it does not fit its block."""
    at = 0 if chance(rng, 0.7) else whole(rng, (0, len(skeleton.blocks) - 1))
    block, side = skeleton.blocks[at], pick(rng, _SIDES)
    corridors, depth = _corridors(style, 1, rng)
    wing = Block(round(uniform(rng, style.wing_m), 2), depth, corridors)
    bend = np.deg2rad(uniform(rng, style.bend_deg)) * pick(rng, (-1.0, 1.0)) if bent else 0.0
    port = _port(block, side, wing, (style, bend), rng)  # type: ignore[arg-type]
    if port is None or not _is_free(block, port):
        return None
    gap = uniform(rng, style.wedge_m if bent else style.foyer_m)
    wing = replace(wing, pose=_pose_of(wing, block, port, gap, bend))
    wing = replace(wing, ports=(Port("west", Span(0.0, depth), corridors[0]),))
    blocks = list(skeleton.blocks)
    blocks[at] = replace(block, ports=(*block.ports, port))
    foyer = Foyer(at, len(block.ports), len(blocks))
    return Skeleton((*blocks, wing), (*skeleton.foyers, foyer))


def _port(
    block: Block, side: Side, wing: Block, how: tuple[BuildingStyle, float],
    rng: np.random.Generator,
) -> Port | None:  # fmt: skip
    """Draw where a wing is joined: a straight one face to face, a bent one at a corner."""
    style, bend = how
    along = block.depth_m if side in ("east", "west") else block.width_m
    if side in ("east", "west"):
        way = pick(rng, block.corridors)
    else:
        wide = round(uniform(rng, style.stub_m), 2)
        low = round(uniform(rng, (_CLEAR_M + 0.1, along - _CLEAR_M - 0.1 - wide)), 2)
        way = Span(low, round(low + wide, 2))
    if bend:
        half = round(uniform(rng, (3.0, 5.0)), 2)
        wall = Span(max(way.middle - half, 0.0), min(way.middle + half, along))
        if len(block.corridors) == 1 and side in ("east", "west"):
            wall = Span(0.0, along)
    else:
        faces = wing.corridors[0].middle
        mirrored = side in ("north", "west")  # the wing's y axis runs against the block's axis
        low = way.middle - (wing.depth_m - faces if mirrored else faces)
        wall = Span(low, low + wing.depth_m)
    wall = Span(round(wall.low, 3), round(wall.high, 3))
    fits = 0 <= wall.low <= way.low and way.high <= wall.high <= along
    return Port(side, wall, way) if fits else None


def _is_free(block: Block, port: Port) -> bool:
    """Whether a side has room for one more port, and a corridor that reaches it."""
    others = [other for other in block.ports if other.side == port.side]
    if port.side == "south" and block.corridors[0].low == 0:
        return False
    if port.side in ("north", "south") and not all(_apart(port.way, o.way) for o in others):
        return False
    return all(port.wall.low > o.wall.high or port.wall.high < o.wall.low for o in others)


def _pose_of(wing: Block, block: Block, port: Port, gap: float, bend: float) -> Pose:
    """Where a wing lies: its west side across the foyer from the port."""
    turn = block.pose.turn_rad + _SIDES.index(port.side) * np.pi / 2
    right, left = block.wall_m(port.side, port.wall)
    out = rotate([gap, 0.0], turn)
    up = rotate([0.0, wing.depth_m], turn + bend)
    origin = left + out - up if bend > 0 else right + out
    return Pose(np.round(origin, 3), float(turn + bend))


def _is_clear(skeleton: Skeleton) -> bool:
    """Whether the last wing and its foyer keep clear of all else."""
    import shapely

    wing = shapely.Polygon(skeleton.blocks[-1].outline_m())
    foyer = shapely.Polygon(skeleton.ring_m(skeleton.foyers[-1]))
    others: list[Any] = [shapely.Polygon(block.outline_m()) for block in skeleton.blocks[:-1]]
    others += [shapely.Polygon(skeleton.ring_m(other)) for other in skeleton.foyers[:-1]]
    rest = shapely.union_all(others)
    if not foyer.is_valid or foyer.intersection(rest.union(wing)).area > 0.05:
        return False
    return bool(wing.distance(rest) > _ALLEY_M)


def _compose(outer: Pose, inner: Pose) -> Pose:
    return Pose(outer.apply(inner.origin_m), outer.turn_rad + inner.turn_rad)
