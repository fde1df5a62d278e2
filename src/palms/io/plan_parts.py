"""What readers of plans share: lines and polygons become segments, segments a FloorPlan."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from palms.errors import FormatError, InputError
from palms.floorplan import FloorPlan, Room, SegmentClass, likely_factor
from palms.geodesy import Origin
from palms.geometry import FloatArray, lengths
from palms.io.values import StrPath, locating
from palms.settings import LIMITS

__all__ = ["PlanParts", "check_scale", "cut", "middle_line", "segments_along", "unique_segments"]

MAX_SEGMENTS = 1_000_000  # ours: the largest plans we know have 20,000
_SAME_M = 1e-4  # ours: segments whose ends are that near are one
_PARALLEL = math.sin(math.radians(20.0))  # ours: doors are drawn by hand
_THIN = 0.5  # ours: a door or window drawn as an area is at most half as deep as wide


@dataclass
class PlanParts:
    """Segments, rooms and names as they are found in a file; `build` makes the plan of them."""

    segments: list[FloatArray] = field(default_factory=list)
    classes: list[SegmentClass] = field(default_factory=list)
    rooms: list[Room] = field(default_factory=list)
    outline_m: FloatArray | None = None

    def add(self, segments_m: FloatArray, kind: SegmentClass) -> None:
        """Add segments (N, 2, 2) of one class."""
        self.segments.append(np.asarray(segments_m, dtype=np.float64).reshape(-1, 2, 2))
        self.classes.append(kind)

    def of_class(self, *kinds: SegmentClass) -> FloatArray:
        """Segments (N, 2, 2) of some classes."""
        chosen = [s for s, kind in zip(self.segments, self.classes, strict=True) if kind in kinds]
        return np.concatenate([np.empty((0, 2, 2)), *chosen])

    def cut_doors(self, reach_m: float) -> None:
        """Take out of the walls what doors and openings stand in."""
        doors = self.of_class(SegmentClass.DOOR, SegmentClass.OPENING)
        if len(doors):
            self.segments = [
                cut(s, doors, reach_m) if kind.blocks else s
                for s, kind in zip(self.segments, self.classes, strict=True)
            ]

    def build(
        self, path: StrPath, name: str, level: str | None = None, origin: Origin | None = None
    ) -> FloorPlan:
        """Return the plan: every segment once, none without a length.

        Raises
        ------
        FormatError
            When there is no wall, or its size is none of a building; then with the likely
            factor.
        """
        segments = np.concatenate([np.empty((0, 2, 2)), *self.segments])
        counts = [len(each) for each in self.segments]
        classes = np.repeat(np.array(self.classes, dtype=np.uint8), counts)
        if len(segments) > MAX_SEGMENTS:
            raise FormatError(
                str(path), expected=f"at most {MAX_SEGMENTS:,} segments", got=f"{len(segments):,}",
                fix="choose layers or classes, or simplify it",
            )  # fmt: skip
        with locating(path):
            _check_size(segments, path)
            segments, classes = unique_segments(segments, classes)
            return FloorPlan(
                segments, classes, tuple(self.rooms), self.outline_m, name, level, origin
            )


def _check_size(segments: FloatArray, path: StrPath) -> None:
    if not len(segments) or not np.isfinite(segments).all():
        return
    points = segments.reshape(-1, 2)
    width, height = (float(v) for v in points.max(axis=0) - points.min(axis=0))
    largest = max(width, height)
    if largest and not LIMITS.min_plan_m <= largest <= LIMITS.max_plan_m:
        raise FormatError(
            str(path),
            expected=f"a building of {LIMITS.min_plan_m:g} to {LIMITS.max_plan_m:g} m",
            got=f"{width:.4g} x {height:.4g} m",
            fix=f"{likely_factor(largest)}, with the option scale=FACTOR",
        )


def unique_segments(
    segments_m: FloatArray, classes: np.typing.NDArray[np.uint8]
) -> tuple[FloatArray, np.typing.NDArray[np.uint8]]:
    """Return segments without those that have no length or are there before, either way round.

    Examples
    --------
    >>> twice = np.array([[[0.0, 0], [4, 0]], [[4, 0], [0, 0]]])
    >>> len(unique_segments(twice, np.zeros(2, np.uint8))[0])
    1
    """
    rounded = np.round(segments_m / _SAME_M).astype(np.int64)
    swap = (rounded[:, 0, 0] > rounded[:, 1, 0]) | (
        (rounded[:, 0, 0] == rounded[:, 1, 0]) & (rounded[:, 0, 1] > rounded[:, 1, 1])
    )
    rounded[swap] = rounded[swap][:, ::-1]
    keys = np.column_stack([rounded.reshape(-1, 4), classes])
    _, first = np.unique(keys, axis=0, return_index=True)
    kept = np.zeros(len(segments_m), np.bool_)
    kept[first] = True
    kept &= lengths(segments_m) > _SAME_M
    return segments_m[kept], classes[kept]


def segments_along(points_m: Any, closed: bool = False) -> FloatArray:  # noqa: ANN401
    """Segments (N, 2, 2) along a line of points (M, 2).

    Examples
    --------
    >>> len(segments_along([[0, 0], [1, 0], [1, 1]], closed=True))
    3
    """
    points = np.asarray(points_m, dtype=np.float64).reshape(-1, 2)
    if closed and len(points) > 1 and (points[0] != points[-1]).any():
        points = np.concatenate([points, points[:1]])
    return np.stack([points[:-1], points[1:]], axis=1)


def middle_line(ring_m: FloatArray) -> FloatArray | None:
    """Return the middle line (1, 2, 2) of a thin area, as doors and windows are drawn.

    None when the area is not thin.

    Examples
    --------
    >>> middle_line(np.array([[0.0, 0], [1, 0], [1, 0.2], [0, 0.2]])).tolist()
    [[[0.0, 0.1], [1.0, 0.1]]]
    """
    import shapely

    box = shapely.minimum_rotated_rectangle(shapely.Polygon(ring_m))
    if box.geom_type != "Polygon":
        return None
    a, b, c, d = shapely.get_coordinates(box)[:4]
    if np.hypot(*(b - a)) < np.hypot(*(c - b)):
        a, b, c, d = b, c, d, a
    if np.hypot(*(c - b)) > _THIN * np.hypot(*(b - a)):
        return None
    ends = sorted([((a + d) / 2).tolist(), ((b + c) / 2).tolist()])
    return np.array([ends])


def cut(walls_m: FloatArray, doors_m: FloatArray, reach_m: float) -> FloatArray:
    """Take doors out of walls: what of a wall runs along a door that is near goes.

    Parameters
    ----------
    walls_m : ndarray (N, 2, 2)
    doors_m : ndarray (K, 2, 2)
    reach_m : float
        How far a door's ends may be from the wall's line.

    Returns
    -------
    ndarray (M, 2, 2)

    Examples
    --------
    >>> wall, door = np.array([[[0.0, 0], [8, 0]]]), np.array([[[3.0, 0.05], [4, 0]]])
    >>> cut(wall, door, 0.3).tolist()
    [[[0.0, 0.0], [3.0, 0.0]], [[4.0, 0.0], [8.0, 0.0]]]
    """
    length = np.maximum(lengths(walls_m), 1e-12)
    along = (walls_m[:, 1] - walls_m[:, 0]) / length[:, None]
    gaps: dict[int, list[tuple[float, float]]] = {}
    for door in doors_m:
        rel = door[None] - walls_m[:, :1]  # (N, 2 ends, 2)
        t = (rel * along[:, None]).sum(axis=-1)
        off = np.abs(rel[..., 0] * along[:, None, 1] - rel[..., 1] * along[:, None, 0])
        low, high = t.min(axis=1), t.max(axis=1)
        steep = np.abs(rel[:, 1] - rel[:, 0])
        slant = np.hypot(*steep.T) * _PARALLEL + 1e-9
        meets = (off.max(axis=1) <= reach_m) & (low < length) & (high > 0)
        meets &= np.abs(off[:, 1] - off[:, 0]) <= slant
        for i in np.flatnonzero(meets).tolist():
            gaps.setdefault(i, []).append((float(low[i]), float(high[i])))
    whole = [i for i in range(len(walls_m)) if i not in gaps]
    pieces = [walls_m[whole]]
    for i, holes in gaps.items():
        spans = np.array(list(_left(holes, float(length[i])))).reshape(-1, 2)
        pieces.append(walls_m[i, 0] + spans[..., None] * along[i])
    return np.concatenate(pieces)


def _left(holes: Sequence[tuple[float, float]], length: float) -> Iterable[tuple[float, float]]:
    """Yield what of 0 to `length` no hole covers; crumbs of a centimetre go."""
    start = 0.0
    for low, high in sorted(holes):
        if low - start > 0.01:
            yield start, low
        start = max(start, high)
    if length - start > 0.01:
        yield start, length


def check_scale(scale: float | None, what: str) -> float | None:
    """Return metres per unit when it is above 0.

    Examples
    --------
    >>> check_scale(0.0, "option scale")
    Traceback (most recent call last):
    palms.errors.InputError: option scale: expected metres per unit, above 0, got 0
    """
    if scale is not None and not (math.isfinite(scale) and scale > 0):
        raise InputError(what, expected="metres per unit, above 0", got=f"{scale:g}")
    return scale
