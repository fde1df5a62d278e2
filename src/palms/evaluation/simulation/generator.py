"""Buildings from a seed: university floors that nobody has seen before."""

from __future__ import annotations

import numpy as np

from palms.building import Building, Stairs
from palms.errors import InputError
from palms.evaluation.simulation.blocks import STAIRS, Piece, fill_block
from palms.evaluation.simulation.dice import chance, pick, uniform
from palms.evaluation.simulation.layout import Pose
from palms.evaluation.simulation.rows import Names, columns_in
from palms.evaluation.simulation.skeleton import Foyer, Skeleton, draw_skeleton
from palms.evaluation.simulation.styles import BUILDING_KINDS, BuildingStyle, style_of
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geometry import FloatArray

__all__ = ["generate_building", "generate_levels", "is_angled"]

_FACADE_M = 3.4  # simulation: outer walls of foyers longer than this may have an entrance
_ENTRANCE_M = 1.8  # simulation
_LEVELS = (1, 6)  # simulation: the floor that a building of one level shows
_LARGE_M2 = 60.0  # simulation: foyers larger than this have columns


def is_angled(seed: int) -> bool:
    """Whether the building of a seed has wings at other than right angles: every third has.

    Examples
    --------
    >>> [seed for seed in range(1000, 1008) if is_angled(seed)]
    [1001, 1004, 1007]
    """
    return seed % 3 == 2


def generate_building(kind: str, seed: int) -> FloorPlan:
    """Draw one floor of a building: the same for the same kind and seed, for ever.

    Parameters
    ----------
    kind : str
        One of `BUILDING_KINDS`.
    seed : int
        From 0 up.

    Returns
    -------
    FloorPlan
        In the map frame, turned by any angle: walls as centre lines that nowhere overlap,
        doors, openings and glass; named rooms that cover the inside.

    Raises
    ------
    InputError
        When there is no such kind, or the seed is negative.

    Examples
    --------
    >>> plan = generate_building("office", 7)
    >>> plan.name, plan.level, len(plan.rooms) > 20
    ('office-7', '2', True)
    """
    return generate_levels(kind, seed, 1).levels[0]


def generate_levels(kind: str, seed: int, count: int) -> Building:
    """Draw several floors of a building: one above the other, with other rooms on each.

    The first is that of `generate_building`; corridors, wings and stairs are the same on all.

    Parameters
    ----------
    kind : str
        One of `BUILDING_KINDS`.
    seed : int
    count : int
        How many; at least 1.

    Raises
    ------
    InputError
        When there is no such kind, or a number is too small.

    Examples
    --------
    >>> building = generate_levels("office", 7, 2)
    >>> building.names, building.stairs[0].name
    (('2', '3'), 'Stairs A')
    """
    style = style_of(kind)
    if seed < 0 or count < 1:
        raise InputError(
            "generated building", expected="a seed of 0 or more and at least 1 level",
            got=f"seed {seed}, {count} levels",
        )  # fmt: skip
    key = [BUILDING_KINDS.index(kind), seed]
    rng = np.random.default_rng(key)
    skeleton = draw_skeleton(style, is_angled(seed), rng)
    skeleton = skeleton.moved(_pose(skeleton, rng))
    first = int(uniform(rng, _LEVELS))
    plans = tuple(
        _floor(skeleton, style, (f"{kind}-{seed}", first + k), np.random.default_rng([*key, k]))
        for k in range(count)
    )
    stairs = [room for room in plans[0].rooms if room.name.startswith(STAIRS)]
    return Building(plans, tuple(Stairs(room.name, room.polygon_m) for room in stairs))


def _pose(skeleton: Skeleton, rng: np.random.Generator) -> Pose:
    """Turn by any angle; the lower left corner lies a few metres off the origin."""
    turned = Pose(turn_rad=uniform(rng, (-np.pi, np.pi)))
    corners = np.concatenate([block.outline_m() for block in skeleton.moved(turned).blocks])
    corner = np.array([uniform(rng, (0.0, 15.0)), uniform(rng, (0.0, 15.0))])
    return Pose(np.round(corner - corners.min(axis=0), 3), turned.turn_rad)


def _floor(
    skeleton: Skeleton, style: BuildingStyle, label: tuple[str, int], rng: np.random.Generator
) -> FloorPlan:
    name, level = label
    names = Names(level)
    pieces = [
        fill_block(block, style, names, rng, main=k == 0) for k, block in enumerate(skeleton.blocks)
    ]
    pieces += [_foyer(skeleton, foyer, names, rng) for foyer in skeleton.foyers]
    return FloorPlan(
        np.concatenate([piece.segments_m for piece in pieces]),
        np.concatenate([piece.classes for piece in pieces]),
        rooms=tuple(room for piece in pieces for room in piece.rooms),
        name=name,
        level=str(level),
    )


def _foyer(skeleton: Skeleton, foyer: Foyer, names: Names, rng: np.random.Generator) -> Piece:
    """Draw the room between a block and its wing: two outer walls, columns in a large one."""
    import shapely

    ring = skeleton.ring_m(foyer)
    right, left, wing_left, wing_right = ring
    parts = [*_facade(left, wing_left, rng), *_facade(wing_right, right, rng)]
    shape, turn = shapely.Polygon(ring), skeleton.blocks[foyer.wing].pose.turn_rad
    if shape.area > _LARGE_M2 and chance(rng, 0.7):
        parts += [(wall, SegmentClass.WALL) for c in columns_in(shape, turn, rng) for wall in c]
    segments = np.array([segment for segment, _ in parts])
    classes = np.array([kind for _, kind in parts], np.uint8)
    return Piece(segments, classes, (Room(names.other("Foyer"), ring),))


def _facade(
    start: FloatArray, end: FloatArray, rng: np.random.Generator
) -> list[tuple[FloatArray, SegmentClass]]:
    """Draw an outer wall, of brick or of glass with an entrance in it."""
    length = float(np.linalg.norm(end - start))
    if length < _FACADE_M or not chance(rng, 0.6):
        return [(np.stack([start, end]), SegmentClass.WALL)]
    middle = uniform(rng, (0.35, 0.65)) * length
    side = pick(rng, (SegmentClass.GLASS, SegmentClass.GLASS, SegmentClass.WALL))
    marks = np.array([0.0, middle - _ENTRANCE_M / 2, middle + _ENTRANCE_M / 2, length]) / length
    points = np.round(start + marks[:, None] * (end - start), 3)
    kinds = (side, SegmentClass.DOOR, side)
    return [(points[k : k + 2], kind) for k, kind in enumerate(kinds)]
