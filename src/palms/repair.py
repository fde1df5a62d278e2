"""What looks wrong with a floor plan, and simple repairs; each says what it did."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.floorplan import FloorPlan, SegmentClass
from palms.geometry import FloatArray, directions, lengths
from palms.settings import RasterSettings

__all__ = ["FreeSpace", "close_gaps", "crop", "find_problems", "free_space", "merge", "snap"]

TOUCH_M = 0.05  # ours: ends that near to a segment touch it
GAP_M = 0.5  # ours: narrower than any door, so not meant
ALONG_M = 0.02  # ours: segments that near to one line lie on it
ALONG_RAD = math.radians(0.5)  # ours
CELLS = 2_000_000  # ours: enough to see a door in the largest mall
ROOM_M2 = 2.0  # ours: smaller pockets of free space are shafts
WIDE_M = 0.3  # ours: narrower strips, such as those along the outer walls, hold nobody
UNIT_M = 1000.0  # ours: few floors are longer
SHARE = 0.02  # ours: less is not worth a word


@dataclass(frozen=True, slots=True)
class FreeSpace:
    """Free area inside a building, and how much of it no way leads to."""

    area_m2: float
    unreachable_m2: float
    pockets: int


def free_space(plan: FloorPlan) -> FreeSpace:
    """Measure the free area inside, and what cannot be reached from its largest part.

    Examples
    --------
    >>> square = [[[0, 0], [4, 0]], [[4, 0], [4, 4]], [[4, 4], [0, 4]], [[0, 4], [0, 0]]]
    >>> space = free_space(FloorPlan(square))
    >>> 13 < space.area_m2 < 16, space.pockets
    (True, 0)
    """
    from scipy import ndimage

    from palms.raster import rasterize

    area = float(np.prod(np.maximum(plan.size_m, 1.0) + 2.0))
    cell = min(1.0, max(0.1, math.sqrt(area / CELLS)))
    settings = RasterSettings(
        cell_size_m=cell, margin_m=1.0, door_weight=0.0, opening_weight=0.0, glass_weight=1.0
    )
    raster = rasterize(plan, settings)
    free = raster.inside & (raster.density <= 0.05)
    labels, count = ndimage.label(free)
    if not count:
        return FreeSpace(0.0, 0.0, 0)
    depth = ndimage.maximum(ndimage.distance_transform_edt(free), labels, np.arange(1, count + 1))
    sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:] * cell**2
    sizes = sizes[np.asarray(depth) * cell >= WIDE_M]
    if not len(sizes):
        return FreeSpace(0.0, 0.0, 0)
    others = np.sort(sizes)[:-1]
    rooms = others[others >= ROOM_M2]
    return FreeSpace(float(sizes.sum()), float(rooms.sum()), len(rooms))


def find_problems(plan: FloorPlan, space: FreeSpace | None = None) -> list[str]:
    """Say what looks wrong with a plan, one sentence each; nothing when all looks well.

    Examples
    --------
    >>> walls = [[[0, 0], [8, 0]], [[8, 0.3], [8, 5]], [[8, 5], [0, 5]], [[8, 5], [0, 5]]]
    >>> for problem in find_problems(FloorPlan(walls)):
    ...     print(problem)
    walls overlap along 8.0 m; repair: --merge
    1 gap of up to 0.30 m between ends of walls; repair: --close-gaps 0.5
    no doors or openings: particles cannot leave rooms unless walls have gaps
    """
    space = space or free_space(plan)
    found = []
    if float(plan.size_m.max()) > UNIT_M:
        found.append(f"{plan.size_m.max():.0f} m long: check the unit")
    blocking = plan.blocking_m
    merged, _ = merge(plan)
    twice = float(lengths(blocking).sum() - lengths(merged.blocking_m).sum())
    if twice > SHARE * float(lengths(blocking).sum()):
        found.append(f"walls overlap along {twice:.1f} m; repair: --merge")
    gaps = _gaps(plan, GAP_M)
    if len(gaps):
        word = "gap" if len(gaps) == 1 else "gaps"
        found.append(
            f"{len(gaps)} {word} of up to {lengths(gaps).max():.2f} m between ends of walls; "
            f"repair: --close-gaps {GAP_M:g}"
        )
    if not len(plan.of_class(SegmentClass.DOOR, SegmentClass.OPENING)):
        found.append("no doors or openings: particles cannot leave rooms unless walls have gaps")
    if space.unreachable_m2 > SHARE * space.area_m2:
        found.append(
            f"no way leads to {space.unreachable_m2:.0f} m² of free space in {space.pockets} "
            f"place{'s' * (space.pockets != 1)}: doors may be missing"
        )
    return found


def snap(plan: FloorPlan, tolerance_m: float) -> tuple[FloorPlan, str]:
    """Move ends of segments that are near to each other to their mean.

    Parameters
    ----------
    plan : FloorPlan
    tolerance_m : float
        What counts as near, above 0.

    Returns
    -------
    plan, text
        What came out, and what was done.

    Examples
    --------
    >>> plan = FloorPlan([[[0, 0], [8, 0]], [[8, 0.02], [8, 5]]])
    >>> snap(plan, 0.05)[1]
    'snap: 2 ends moved by up to 0.010 m'
    """
    _check(tolerance_m, "--snap")
    ends = plan.segments_m.reshape(-1, 2)
    from scipy.spatial import cKDTree

    pairs = cKDTree(ends).query_pairs(tolerance_m, output_type="ndarray")
    label = _together(len(ends), pairs)
    count = np.bincount(label)
    mean = np.column_stack([np.bincount(label, ends[:, k]) / count for k in (0, 1)])[label]
    moved = np.hypot(*(mean - ends).T)
    text = f"snap: {np.sum(moved > 1e-9)} ends moved by up to {moved.max():.3f} m"
    segments = mean.reshape(-1, 2, 2)
    kept = lengths(segments) > 1e-9
    return replace(plan, segments_m=segments[kept], classes=plan.classes[kept]), text


def merge(plan: FloorPlan) -> tuple[FloorPlan, str]:
    """Join segments of one class that overlap or touch on one line.

    Examples
    --------
    >>> plan = FloorPlan([[[0, 0], [5, 0]], [[3, 0], [8, 0]], [[8, 0], [8, 5]]])
    >>> merge(plan)[0].segments_m.tolist()
    [[[0.0, 0.0], [8.0, 0.0]], [[8.0, 0.0], [8.0, 5.0]]]
    """
    segments, classes = [], []
    for kind in SegmentClass:
        joined = _merged(plan.of_class(kind))
        segments.append(joined)
        classes += [kind] * len(joined)
    together = np.concatenate(segments)
    text = f"merge: {len(plan.segments_m)} segments became {len(together)}"
    return replace(plan, segments_m=together, classes=np.array(classes, np.uint8)), text


def close_gaps(plan: FloorPlan, widest_m: float) -> tuple[FloorPlan, str]:
    """Add walls between loose ends that are near to each other.

    Examples
    --------
    >>> plan = FloorPlan([[[0, 0], [8, 0]], [[8, 0.3], [8, 5]]])
    >>> close_gaps(plan, 0.5)[1]
    'close-gaps: 1 closed, 0.30 m of wall added'
    """
    _check(widest_m, "--close-gaps")
    gaps = _gaps(plan, widest_m)
    segments = np.concatenate([plan.segments_m, gaps])
    classes = np.concatenate([plan.classes, np.zeros(len(gaps), np.uint8)])
    text = f"close-gaps: {len(gaps)} closed, {lengths(gaps).sum():.2f} m of wall added"
    return replace(plan, segments_m=segments, classes=classes), text


def crop(plan: FloorPlan, box_m: tuple[float, float, float, float]) -> tuple[FloorPlan, str]:
    """Keep what lies in a box x0, y0, x1, y1; rooms whose middle lies in it.

    Raises
    ------
    InputError
        When no wall is left.

    Examples
    --------
    >>> crop(FloorPlan([[[0, 0], [8, 0]]]), (0, -1, 5, 1))[0].segments_m.tolist()
    [[[0.0, 0.0], [5.0, 0.0]]]
    """
    import shapely

    x0, x1 = sorted((box_m[0], box_m[2]))
    y0, y1 = sorted((box_m[1], box_m[3]))
    low, high = _inside(plan.segments_m, np.array([x0, y0]), np.array([x1, y1]))
    kept = low < high
    start, move = plan.segments_m[:, 0], plan.segments_m[:, 1] - plan.segments_m[:, 0]
    segments = np.stack([start + low[:, None] * move, start + high[:, None] * move], axis=1)[kept]
    if not len(segments):
        raise InputError("--crop", expected="a box with walls in it", got=f"{box_m}")
    area = shapely.box(x0, y0, x1, y1)
    rooms = tuple(r for r in plan.rooms if area.contains(shapely.Polygon(r.polygon_m).centroid))
    text = f"crop: {np.sum(~kept)} of {len(kept)} segments left out"
    return replace(
        plan, segments_m=segments, classes=plan.classes[kept], rooms=rooms, outline_m=None
    ), text


def _check(value: float, what: str) -> None:
    if not (math.isfinite(value) and value > 0):
        raise InputError(what, expected="metres above 0", got=f"{value:g}")


def _inside(
    segments: FloatArray, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Shares (N,), (N,) of segments at which they enter and leave a box."""
    start, move = segments[:, 0], segments[:, 1] - segments[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (low - start) / move, (high - start) / move
    still = move == 0
    outside = still & ((start < low) | (start > high))
    enter = np.where(still, np.where(outside, np.inf, -np.inf), np.minimum(a, b)).max(axis=1)
    leave = np.where(still, np.where(outside, -np.inf, np.inf), np.maximum(a, b)).min(axis=1)
    return np.clip(enter, 0, 1), np.clip(leave, 0, 1)


def _together(count: int, pairs: npt.NDArray[Any]) -> npt.NDArray[np.int32]:
    """Label (N,) of the group of each of N things of which some pairs belong together."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ones = np.ones(len(pairs))
    graph = coo_array((ones, (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def _merged(segments: FloatArray) -> FloatArray:
    if len(segments) < 2:
        return segments
    angle, length = directions(segments), lengths(segments)
    along = np.column_stack([np.cos(angle), np.sin(angle)])
    pairs = [np.empty((0, 2), int)]
    for i in range(len(segments) - 1):
        rel = segments[i + 1 :] - segments[i, 0]
        off = np.abs(rel[..., 0] * along[i, 1] - rel[..., 1] * along[i, 0])
        t = rel @ along[i]
        turned = np.abs(np.sin(angle[i + 1 :] - angle[i]))
        near = (off.max(axis=1) <= ALONG_M) & (turned <= ALONG_RAD)
        near &= (t.max(axis=1) >= -ALONG_M) & (t.min(axis=1) <= length[i] + ALONG_M)
        found = np.flatnonzero(near) + i + 1
        pairs.append(np.column_stack([np.full(len(found), i), found]))
    label = _together(len(segments), np.concatenate(pairs))
    order = np.unique(label, return_index=True)[1]
    return np.array([_hull(segments[label == label[i]]) for i in np.sort(order)])


def _hull(group: FloatArray) -> FloatArray:
    """Return the segment (2, 2) from end to end of segments on one line."""
    if len(group) == 1:
        return np.asarray(group[0])
    base = group[int(lengths(group).argmax())]
    along = (base[1] - base[0]) / np.hypot(*(base[1] - base[0]))
    t = (group.reshape(-1, 2) - base[0]) @ along
    return np.array([base[0] + t.min() * along, base[0] + t.max() * along])


def _gaps(plan: FloorPlan, widest_m: float) -> FloatArray:
    """Segments (N, 2, 2) between loose ends of walls that are nearest to each other."""
    loose = _loose_ends(plan)
    if len(loose) < 2:
        return np.empty((0, 2, 2))
    from scipy.spatial import cKDTree

    away, nearest = cKDTree(loose).query(loose, k=2)
    other = nearest[:, 1]
    index = np.arange(len(loose))
    mutual = (other[other] == index) & (index < other) & (away[:, 1] <= widest_m)
    mutual &= away[:, 1] > TOUCH_M
    return np.stack([loose[index[mutual]], loose[other[mutual]]], axis=1)


def _loose_ends(plan: FloorPlan) -> FloatArray:
    """Return the ends (N, 2) of walls that no other segment touches."""
    import shapely

    segments = plan.segments_m
    tree = shapely.STRtree(shapely.linestrings(segments))
    walls = np.flatnonzero(np.isin(plan.classes, [c for c in SegmentClass if c.blocks]))
    owner = walls.repeat(2)
    ends = segments[walls].reshape(-1, 2)
    touching = tree.query(shapely.points(ends), predicate="dwithin", distance=TOUCH_M)
    others = touching[1] != owner[touching[0]]
    touched = np.zeros(len(ends), np.bool_)
    touched[touching[0][others]] = True
    return np.asarray(ends[~touched])
