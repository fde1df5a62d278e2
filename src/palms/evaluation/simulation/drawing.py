"""The drawing of a building that people have: stale, off in scale, in one style or another.

The building as it was planned is what `make_world` builds; the drawing is what a method is
given. Its coordinates are the map frame: a place of the building lies in the drawing where
its `Stretch` says.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.evaluation.simulation.settings import PlanNoise
from palms.evaluation.simulation.world import faces_of, solid_walls
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geometry import FloatArray, check_finite, directions, lengths, rotate

__all__ = ["Stretch", "draw_plan", "draw_stretch"]

_PARTITION_M = (2.2, 12.0)  # simulation: lengths of walls between two rooms that get moved
_SIDE_M = 0.3  # ours: a point this far from a wall lies in the room beside it
_LEAST_MOVE_M = 0.25  # simulation
_COLUMN_M = 0.9  # ours: rings of walls no longer than this are columns
_FACES_M = (0.1, 0.22)  # simulation: thickness as drawn
_PASSING = ("corridor", "foyer", "lobby", "lounge", "stairs")  # their walls stay


@dataclass(frozen=True, slots=True)
class Stretch:
    """How the places of a building lie in a drawing whose scale is off.

    Parameters
    ----------
    centre_m : array_like (2,)
        Stays where it is.
    matrix : array_like (2, 2)
        Turns offsets from the centre into those of the drawing.

    Examples
    --------
    >>> Stretch((1.0, 0.0), [[1.01, 0.0], [0.0, 1.0]]).apply([11.0, 5.0]).tolist()
    [11.1, 5.0]
    """

    centre_m: FloatArray = (0.0, 0.0)  # type: ignore[assignment]
    matrix: FloatArray = ((1.0, 0.0), (0.0, 1.0))  # type: ignore[assignment]

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre_m", check_finite(self.centre_m, "stretch", (2,)))
        object.__setattr__(self, "matrix", check_finite(self.matrix, "stretch", (2, 2)))

    def apply(self, points_m: npt.ArrayLike) -> FloatArray:
        """Points (..., 2) of the building in the drawing."""
        off = np.asarray(points_m, dtype=np.float64) - self.centre_m
        return np.asarray(self.centre_m + off @ self.matrix.T)


def draw_stretch(plan: FloorPlan, noise: PlanNoise, rng: np.random.Generator) -> Stretch:
    """Draw by how much a drawing's scale is off, along the building's axes.

    Examples
    --------
    >>> plan = FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 4]]])
    >>> draw_stretch(plan, PlanNoise.none(), np.random.default_rng(0)).matrix.tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    scale = np.full(2, 1.0 + noise.scale_sd * rng.normal())
    one_way, way = rng.random() < noise.one_way_share, rng.integers(2)
    if one_way:
        scale[way] = 1.0
    axis = float(directions(plan.segments_m)[lengths(plan.segments_m).argmax()])
    turn = rotate(np.eye(2), axis)  # rows: the building's axes
    low, high = plan.bounds_m
    matrix = np.eye(2) if scale.max() == scale.min() == 1.0 else turn.T @ np.diag(scale) @ turn
    return Stretch((low + high) / 2, matrix)


def draw_plan(
    plan: FloorPlan, noise: PlanNoise, stretch: Stretch, rng: np.random.Generator
) -> FloorPlan:
    """Draw a building as somebody did long ago.

    Parameters
    ----------
    plan : FloorPlan
        The building as planned, walls as centre lines.
    noise : PlanNoise
    stretch : Stretch
        How its places lie in the drawing.
    rng : numpy.random.Generator

    Returns
    -------
    FloorPlan
        The drawing, with the names of the rooms.

    Examples
    --------
    >>> plan = FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 4]]])
    >>> drawn = draw_plan(plan, PlanNoise.none(), Stretch(), np.random.default_rng(0))
    >>> drawn.segments_m.tolist() == plan.segments_m.tolist()
    True
    """
    segments, classes = plan.segments_m.copy(), plan.classes.copy()
    sides = _sides(plan)
    moved, gone = _moved_and_gone(plan, sides, noise, rng)
    segments += moved
    merged, rooms = _merged(plan, sides, noise, rng)
    walled = (classes == SegmentClass.DOOR) & (rng.random(len(classes)) < noise.door_undrawn_share)
    classes[walled] = SegmentClass.WALL
    kept = ~(gone | merged | _undrawn_columns(plan, noise, rng))
    faces = rng.random() < noise.two_faces_share
    segments, classes = segments[kept], classes[kept]
    thickness = rng.uniform(*_FACES_M)
    if faces:
        segments, classes = _as_faces(segments, classes, thickness)
    outline = None if plan.outline_m is None else stretch.apply(plan.outline_m)
    return replace(
        plan,
        segments_m=stretch.apply(segments),
        classes=classes,
        rooms=tuple(Room(room.name, stretch.apply(room.polygon_m)) for room in rooms),
        outline_m=outline,
    )


def _sides(plan: FloorPlan) -> npt.NDArray[np.int64]:
    """Numbers (N, 2) of the rooms on either side of each segment's middle; -1 for none."""
    import shapely

    middle, angle = plan.segments_m.mean(axis=1), directions(plan.segments_m)
    normal = _SIDE_M * np.column_stack([-np.sin(angle), np.cos(angle)])
    found = np.full((len(middle), 2), -1)
    for number, room in enumerate(plan.rooms):
        shape = shapely.Polygon(room.polygon_m)
        shapely.prepare(shape)
        for side, points in enumerate((middle + normal, middle - normal)):
            found[shapely.contains_xy(shape, points), side] = number
    return found


def _moved_and_gone(
    plan: FloorPlan, sides: npt.NDArray[np.int64], noise: PlanNoise, rng: np.random.Generator
) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """Shift (N, 1, 2) of each segment, and whether (N,) it is not drawn."""
    length, angle = lengths(plan.segments_m), directions(plan.segments_m)
    stays = [any(word in room.name.casefold() for word in _PASSING) for room in plan.rooms]
    between = (sides >= 0).all(axis=1) & (sides[:, 0] != sides[:, 1])
    if stays:
        between &= ~np.array(stays)[sides].any(axis=1)
    fits = (plan.classes == SegmentClass.WALL) & between
    fits &= (length > _PARTITION_M[0]) & (length < _PARTITION_M[1])
    dice = rng.random(len(length))
    gone = fits & (dice < noise.missing_share)
    moves = fits & ~gone & (dice < noise.missing_share + noise.moved_share)
    far = rng.uniform(min(_LEAST_MOVE_M, noise.moved_m), noise.moved_m, len(length))
    far *= rng.choice([-1.0, 1.0], len(length)) * moves
    normal = np.column_stack([-np.sin(angle), np.cos(angle)])
    return (far[:, None] * normal)[:, None], gone


def _merged(
    plan: FloorPlan, sides: npt.NDArray[np.int64], noise: PlanNoise, rng: np.random.Generator
) -> tuple[npt.NDArray[np.bool_], list[Room]]:
    """Which segments (N,) are not drawn as two rooms have become one, and the rooms then."""
    import shapely

    shapes: dict[int, Any] = {k: shapely.Polygon(r.polygon_m) for k, r in enumerate(plan.rooms)}
    gone = np.zeros(len(sides), bool)
    dice = rng.random(len(plan.rooms))
    for number, room in enumerate(plan.rooms):
        if dice[number] >= noise.merged_share or number not in shapes or _passes(room):
            continue
        next_one = number + 1
        if next_one not in shapes or _passes(plan.rooms[next_one]):
            continue
        both = shapely.union_all([shapes[number], shapes[next_one]], grid_size=0.002)
        if both.geom_type != "Polygon" or len(both.interiors):
            continue
        between = np.sort(sides, axis=1) == (number, next_one)
        gone |= between.all(axis=1)
        shapes[number] = both
        del shapes[next_one]
    rings = {k: shapely.get_coordinates(shape)[:-1] for k, shape in shapes.items()}
    return gone, [Room(plan.rooms[k].name, ring) for k, ring in rings.items()]


def _passes(room: Room) -> bool:
    return any(word in room.name.casefold() for word in _PASSING)


def _undrawn_columns(
    plan: FloorPlan, noise: PlanNoise, rng: np.random.Generator
) -> npt.NDArray[np.bool_]:
    """Sides (N,) of columns that are left out: four short walls in a ring, one after another."""
    segments = plan.segments_m
    small = (lengths(segments) < _COLUMN_M) & (plan.classes == SegmentClass.WALL)
    gone = np.zeros(len(segments), bool)
    for k in range(len(segments) - 3):
        ring = segments[k : k + 4]
        if small[k : k + 4].all() and np.allclose(ring[:, 1], np.roll(ring[:, 0], -1, axis=0)):
            gone[k : k + 4] = rng.random() < noise.column_undrawn_share
    return gone


def _as_faces(
    segments: FloatArray, classes: npt.NDArray[np.uint8], thickness_m: float
) -> tuple[FloatArray, npt.NDArray[np.uint8]]:
    """Draw walls as two faces; all else stays a line."""
    walls = classes == SegmentClass.WALL
    solid = solid_walls(segments, walls, ~walls, np.full(len(segments), thickness_m))
    faces = faces_of(segments[walls], solid)
    faces = faces[lengths(faces) > 0.0]
    kinds = np.concatenate([np.zeros(len(faces), np.uint8), classes[~walls]])
    return np.concatenate([faces, segments[~walls]]), kinds
