"""The real world behind a floor plan: thick walls, furniture, doors shut, plan errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.evaluation.simulation.furniture import place_furniture
from palms.evaluation.simulation.rays import group_lines, rings_to_segments
from palms.evaluation.simulation.settings import WorldNoise
from palms.floorplan import FloorPlan, SegmentClass
from palms.geometry import FloatArray, as_readonly, check_segments, directions, lengths

__all__ = ["World", "faces_of", "inside_of", "make_world", "solid_walls"]

_SAME_LINE_M, _SAME_LINE_RAD = 0.03, 0.01  # ours: pieces of one wall line
_CLOSING_M = 0.08  # ours: closes the joints that shifted walls leave, at most 10 cm wide
_DOORWAY_M = 1.0  # ours: half the widest gap in a wall that is taken for a doorway
_MISSING_M = (1.0, 7.0)  # simulation: lengths of partitions that builders leave out


@dataclass(frozen=True, slots=True)
class World:
    """What is really there, in the map frame.

    Parameters
    ----------
    seen_m : array_like (N, 2, 2)
        Faces of walls, shut doors, tall furniture and glass: what light meets.
    is_glass : array_like (N,)
        Whether each of them is a pane of glass.
    blocking_m : array_like (M, 2, 2)
        What nobody walks through; doors are not among it.
    plan : FloorPlan
        The plan that people have of it.

    Raises
    ------
    InputError
        When lengths differ or a number is not finite.

    Examples
    --------
    >>> plan = FloorPlan([[[0, 0], [4, 0]]])
    >>> World(plan.segments_m, [False], plan.segments_m, plan).seen_m.shape
    (1, 2, 2)
    """

    seen_m: FloatArray
    is_glass: npt.NDArray[np.bool_]
    blocking_m: FloatArray
    plan: FloorPlan

    def __post_init__(self) -> None:
        object.__setattr__(self, "seen_m", check_segments(self.seen_m, "world, seen"))
        object.__setattr__(self, "blocking_m", check_segments(self.blocking_m, "world, blocking"))
        object.__setattr__(self, "is_glass", as_readonly(self.is_glass, np.bool_))
        if self.is_glass.shape != (len(self.seen_m),):
            raise InputError(
                "world",
                expected=f"{len(self.seen_m)} flags for glass",
                got=str(self.is_glass.shape),
            )


def make_world(plan: FloorPlan, noise: WorldNoise, rng: np.random.Generator) -> World:
    """Draw a real world that this plan may have been drawn of.

    Parameters
    ----------
    plan : FloorPlan
        In the map frame, walls as centre lines.
    noise : WorldNoise
        How far the world is from it.
    rng : numpy.random.Generator

    Returns
    -------
    World

    Examples
    --------
    >>> square = FloorPlan([[[0, 0], [4, 0]], [[4, 0], [4, 3]], [[4, 3], [0, 3]], [[0, 3], [0, 0]]])
    >>> make_world(square, WorldNoise.none(), np.random.default_rng(0)).seen_m.shape
    (4, 2, 2)
    >>> make_world(square, WorldNoise(furniture_per_m=0), np.random.default_rng(0)).seen_m.shape
    (12, 2, 2)
    """
    inside = inside_of(plan)
    line = group_lines(plan.segments_m, _SAME_LINE_M, _SAME_LINE_RAD)
    segments = _shifted(plan.segments_m, line, noise, rng)
    thickness = np.maximum(rng.normal(noise.thickness_m, noise.thickness_sd_m, line.max() + 1), 0.0)
    kept = ~_missing(plan, segments, noise.missing_walls, rng)
    kinds = np.where(kept, plan.classes, SegmentClass.OPENING)
    walls = kinds == SegmentClass.WALL
    solid = solid_walls(segments, walls, plan.classes != SegmentClass.WALL, thickness[line])
    faces = faces_of(segments[walls], solid)
    doors = _shut_doors(segments[kinds == SegmentClass.DOOR], noise, rng)
    panes = segments[kinds == SegmentClass.GLASS]
    passages = segments[(kinds == SegmentClass.DOOR) | (kinds == SegmentClass.OPENING)]
    boxes = place_furniture(
        segments[walls], thickness[line][walls], (solid, passages, inside), noise, rng
    )
    tall = rng.random(len(boxes)) < noise.furniture_tall_share
    seen = [faces, doors, boxes[tall].reshape(-1, 2, 2), panes]
    is_glass = np.arange(sum(map(len, seen))) >= sum(map(len, seen[:-1]))
    blocking = [faces, boxes.reshape(-1, 2, 2), panes]
    return World(np.concatenate(seen), is_glass, np.concatenate(blocking), plan)


def inside_of(plan: FloorPlan) -> Any:  # noqa: ANN401
    """Return the inside of a building as a shapely area.

    Its rooms; else its outline; else what the walls enclose once doors are closed; else, for
    walls that enclose little, their hull.

    Examples
    --------
    >>> inside_of(FloorPlan([[[0, 0], [4, 0]], [[4, 0], [4, 3]]])).area
    6.0
    """
    import shapely

    if plan.rooms:
        rooms = [shapely.Polygon(room.polygon_m) for room in plan.rooms]
        area = shapely.union_all(shapely.buffer(rooms, 0.01, join_style="mitre"))
    elif plan.outline_m is not None:
        area = shapely.Polygon(plan.outline_m)
    else:
        area = _enclosed(plan.segments_m)
    shapely.prepare(area)
    return area


def _enclosed(segments: FloatArray) -> Any:  # noqa: ANN401
    """Return what walls enclose, gaps closed that are no wider than a double door."""
    import shapely

    grown = shapely.union_all(shapely.buffer(shapely.linestrings(segments), _DOORWAY_M))
    parts = shapely.get_parts(grown)
    filled = shapely.union_all([shapely.Polygon(part.exterior) for part in parts])
    area = filled.buffer(0.01 - _DOORWAY_M, join_style="mitre")
    hull = shapely.convex_hull(shapely.MultiPoint(segments.reshape(-1, 2)))
    return area if area.area > hull.area / 3 else hull


def _normals(segments: FloatArray) -> FloatArray:
    """Left normals (N, 2), of the direction that points right (or straight up)."""
    angle = np.mod(directions(segments) + 1e-6, np.pi) - 1e-6
    return np.column_stack([-np.sin(angle), np.cos(angle)])


def _shifted(
    segments: FloatArray, line: npt.NDArray[np.int64], noise: WorldNoise, rng: np.random.Generator
) -> FloatArray:
    """Move each wall line, with its doors, off the place where the plan has it."""
    drawn = rng.normal(0.0, noise.offset_sd_m, line.max() + 1)
    offset = np.clip(drawn, -noise.offset_max_m, noise.offset_max_m)[line]
    return np.asarray(segments + (offset[:, None] * _normals(segments))[:, None])


def _missing(
    plan: FloorPlan, segments: FloatArray, count: int, rng: np.random.Generator
) -> npt.NDArray[np.bool_]:
    """Choose partitions that the plan has and the world has not."""
    import shapely

    deep_inside = inside_of(plan).buffer(-0.3)
    length = lengths(segments)
    inner = shapely.contains_xy(deep_inside, segments.mean(axis=1))
    fits = (length > _MISSING_M[0]) & (length < _MISSING_M[1])
    candidates = np.flatnonzero(inner & fits & (plan.classes == SegmentClass.WALL))
    gone = np.zeros(len(segments), bool)
    gone[rng.choice(candidates, min(count, len(candidates)), replace=False)] = True
    return gone


def solid_walls(
    segments: FloatArray,
    is_wall: npt.NDArray[np.bool_],
    is_gap: npt.NDArray[np.bool_],
    thickness: FloatArray,
) -> Any:  # noqa: ANN401
    """Area of the walls: thick, joined at corners, cut out where doors and glass are."""
    import shapely

    bars = shapely.buffer(
        shapely.linestrings(segments[is_wall]),
        thickness[is_wall] / 2,
        cap_style="square",
        join_style="mitre",
    )
    area = shapely.union_all(bars)
    area = area.buffer(_CLOSING_M, join_style="mitre").buffer(-_CLOSING_M, join_style="mitre")
    gaps = shapely.buffer(
        shapely.linestrings(segments[is_gap]),
        thickness[is_gap] / 2 + 2 * _CLOSING_M,
        cap_style="flat",
    )
    return area.difference(shapely.union_all(gaps)).simplify(0.005)


def faces_of(walls: FloatArray, solid: Any) -> FloatArray:  # noqa: ANN401
    """Sides of the solid; the walls themselves when they have no thickness."""
    import shapely

    if solid.area < 1e-6:
        return walls
    rings = shapely.get_rings(shapely.get_parts(solid))
    return rings_to_segments([shapely.get_coordinates(ring) for ring in rings])


def _shut_doors(doors: FloatArray, noise: WorldNoise, rng: np.random.Generator) -> FloatArray:
    recess = rng.uniform(-1.0, 1.0, len(doors)) * noise.door_recess_m
    moved = doors + (recess[:, None] * _normals(doors))[:, None]
    return np.asarray(moved[rng.random(len(doors)) < noise.door_shut_share])
