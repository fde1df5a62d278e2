"""What drawings share: layers by their names, doors as leaves with swings, names within rooms.

A door drawn as a leaf with its swing becomes the segment that the leaf fills when shut.
"""

from __future__ import annotations

import math
import re
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from palms.errors import InputError, PalmsWarning
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geometry import FloatArray
from palms.io.plan_parts import PlanParts, middle_line, segments_along
from palms.io.values import StrPath, brief, locating

__all__ = [
    "DOORS",
    "GLASS",
    "OPENINGS",
    "ROOMS",
    "WALLS",
    "DoorGroup",
    "Drawing",
    "Layers",
    "Stroke",
    "swing_of",
]

WALLS = r"wall|mur|wand|muro|parete|column|pillar|stütze|poteau"
DOORS = r"door|tuer|tür|porte|puerta|porta"
GLASS = r"glaz|glass|window|fenster|fenetre|fenêtre|ventana|curtain"
OPENINGS = r"opening|passage|durchgang"
ROOMS = r"room|raum|space|zone|a-area|pièce|piece"
_TOUCH_M = 0.06  # ours: a leaf's end and its swing's meet
_SWEEP_RAD = (math.radians(30), math.radians(135))  # ours: a door's swing
_LEAF_M = (0.5, 2.0)  # ours: a door's width, where no layer says that it is one
_ROUND = 0.01  # ours: a swing's points lie that near to a circle, as a share of its radius
_REACH_M = 0.15  # ours: a door's line may lie that far from the wall's


class Stroke(NamedTuple):
    """A line of a drawing: points (N, 2) in metres, whether it is a curve, how thick it is."""

    points_m: FloatArray
    curved: bool = False
    width: float = math.inf


@dataclass
class DoorGroup:
    """What one door symbol, or all loose lines of the door layers, is drawn with."""

    lines: list[FloatArray] = field(default_factory=list)
    swings: list[FloatArray] = field(default_factory=list)  # centre, two ends

    def add(self, stroke: Stroke) -> None:
        """Add a stroke: a swing where it is one, else a line."""
        swing = swing_of(stroke.points_m) if stroke.curved else None
        if swing is None:
            self.lines.append(stroke.points_m)
        else:
            self.swings.append(swing)

    def shut(self) -> Iterator[FloatArray]:
        """Yield the segments (N, 2, 2) that the doors fill when they are shut."""
        near = _Nearby(self.lines)
        leaves: set[int] = set()
        for swing in self.swings:
            leaf = [near.distance(end) for end in swing[1:]]
            shut = swing[1] if leaf[1] <= leaf[0] else swing[2]
            turning = near.within(swing[0])
            leaves |= turning
            yield np.array([[self._hinge(swing[0], turning), shut]])
        for i, line in enumerate(self.lines):
            if i not in leaves:
                middle = middle_line(line) if _is_ring(line) else None
                yield segments_along(line) if middle is None else middle

    def _hinge(self, centre: FloatArray, turning: set[int]) -> FloatArray:
        """Return the end of the leaf that turns there; curves tell their centre less well."""
        ends = [self.lines[i][end] for i in sorted(turning) for end in (0, -1)]
        near = min(ends, key=lambda end: math.dist(end, centre), default=centre)
        return near if math.dist(near, centre) <= _TOUCH_M else centre


class _Nearby:
    """Which of many lines have a point near to a place."""

    def __init__(self, lines: Sequence[FloatArray]) -> None:
        from scipy.spatial import cKDTree

        counts = [len(line) for line in lines]
        self.owners = np.repeat(np.arange(len(lines)), counts)
        self.tree = cKDTree(np.concatenate([np.empty((0, 2)), *lines]))

    def within(self, place: FloatArray) -> set[int]:
        """Return the numbers of the lines that touch a place."""
        return set(self.owners[self.tree.query_ball_point(place, _TOUCH_M)].tolist())

    def distance(self, place: FloatArray) -> float:
        """Return how far the nearest point is; infinite without lines."""
        return float(self.tree.query(place)[0])


def swing_of(points_m: FloatArray) -> FloatArray | None:
    """Return centre and both ends (3, 2) of a door's swing; None when the curve is none.

    Examples
    --------
    >>> angle = np.linspace(0, np.pi / 2, 9)
    >>> swing = swing_of(0.9 * np.column_stack([np.cos(angle), np.sin(angle)]))
    >>> (swing.round(6) + 0.0).tolist()
    [[0.0, 0.0], [0.9, 0.0], [0.0, 0.9]]
    >>> swing_of(np.array([[0.0, 0], [1, 0], [2, 0.1]])) is None
    True
    """
    if len(points_m) < 3 or _is_ring(points_m):
        return None
    offset = points_m - points_m[0]
    system = np.column_stack([2 * offset, np.ones(len(offset))])
    (x, y, rest), *_ = np.linalg.lstsq(system, (offset**2).sum(axis=1), rcond=None)
    radius = math.sqrt(max(float(rest + x * x + y * y), 0.0))
    arms = offset - [x, y]
    if not radius or np.abs(np.hypot(*arms.T) - radius).max() > _ROUND * radius:
        return None
    angles = np.unwrap(np.arctan2(arms[:, 1], arms[:, 0]))
    if not _SWEEP_RAD[0] <= abs(angles[-1] - angles[0]) <= _SWEEP_RAD[1]:
        return None
    return np.array([points_m[0] + [x, y], points_m[0], points_m[-1]])


class Layers:
    """Which names of layers, groups or blocks hold what, by regular expressions.

    Parameters
    ----------
    patterns : mapping
        Pattern of each class, None for rooms; the first that fits counts. Upper and lower case
        are one. An empty pattern fits nothing.
    what : str
        What to call the file in a message.

    Examples
    --------
    >>> layers = Layers({SegmentClass.WALL: "wall|mur", None: "room"}, "a.svg")
    >>> layers.role("A-WALL-PRTN"), layers.role("text"), layers.holds_rooms("Rooms")
    (<SegmentClass.WALL: 0>, None, True)
    """

    def __init__(self, patterns: Mapping[SegmentClass | None, str], what: str) -> None:
        try:
            self.patterns = {
                kind: re.compile(text, re.IGNORECASE) for kind, text in patterns.items() if text
            }
        except re.error as error:
            raise InputError(
                f"{what}, option", expected="a regular expression", got=str(error)
            ) from None

    @property
    def is_guess(self) -> bool:
        """Whether the pattern of walls is ours, not one that the user gave."""
        walls = self.patterns.get(SegmentClass.WALL)
        return walls is not None and walls.pattern == WALLS

    def role(self, name: str) -> SegmentClass | None:
        """Class of what a layer holds; None when its name says none."""
        found = (kind for kind, pattern in self.patterns.items() if kind is not None
                 and pattern.search(name))  # fmt: skip
        return next(found, None)

    def holds_rooms(self, name: str) -> bool:
        """Whether a layer without a class holds outlines of rooms."""
        rooms = self.patterns.get(None)
        return rooms is not None and self.role(name) is None and bool(rooms.search(name))


class Drawing:
    """Gathers the strokes of a drawing; `plan` makes the plan of them."""

    def __init__(self, what: str) -> None:
        self.what = what
        self.parts = PlanParts()
        self.counted: Counter[str] = Counter()  # strokes by layer
        self.left_out: Counter[str] = Counter()  # those that no class takes
        self.loose = DoorGroup()
        self.groups = [self.loose]
        self.texts: list[tuple[str, FloatArray]] = []
        self.rings: list[tuple[str, str, FloatArray]] = []

    def new_group(self) -> DoorGroup:
        """Return a group for the strokes of one door."""
        self.groups.append(DoorGroup())
        return self.groups[-1]

    def add(self, stroke: Stroke, role: SegmentClass, group: DoorGroup | None = None) -> None:
        """Add a stroke of a class; those of a door to its group."""
        if role is SegmentClass.DOOR:
            (group or self.loose).add(stroke)
            return
        solid = role is SegmentClass.WALL or not _is_ring(stroke.points_m)
        middle = None if solid else middle_line(stroke.points_m)
        self.parts.add(segments_along(stroke.points_m) if middle is None else middle, role)

    def add_room(self, points_m: FloatArray, name: str = "", otherwise: str = "") -> None:
        """Add the outline of a room; without a name, the texts within it name it."""
        if len(points_m) > 3 and np.allclose(points_m[0], points_m[-1]):
            self.rings.append((name, otherwise, points_m[:-1]))

    def add_unnamed(self, strokes: Sequence[Stroke], min_width: float | None = None) -> None:
        """Add strokes of which no layer says what they are: walls, and doors told by swings.

        Strokes thinner than `min_width` are left out; when it is None, than half of the width
        that most of the length has.
        """
        least = _typical_width(strokes) / 2 if min_width is None else min_width
        kept, swings = [], []
        for stroke in strokes:
            swing = swing_of(stroke.points_m) if stroke.curved else None
            if swing is not None and _LEAF_M[0] <= math.dist(*swing[:2]) <= _LEAF_M[1]:
                swings.append(swing)
            else:
                kept.append(stroke)
        near = _Nearby([stroke.points_m for stroke in kept])
        leaves = set()
        for swing in swings:
            turning = near.within(swing[0])
            for i in sorted(turning & (near.within(swing[1]) | near.within(swing[2]))):
                if _extent(kept[i].points_m) <= math.dist(*swing[:2]) + 2 * _TOUCH_M:
                    leaves.add(i)
                    door = self.new_group()
                    door.lines.append(kept[i].points_m)
                    door.swings.append(swing)
                    break
        for i, stroke in enumerate(kept):
            if i not in leaves and stroke.width >= least:
                self.add(stroke, SegmentClass.WALL)

    def plan(self, path: StrPath, name: str, asked: str) -> FloorPlan:
        """Return the plan of what was gathered.

        Raises
        ------
        InputError
            When there is no wall; it lists the layers and says what `asked` says.
        """
        if not len(self.parts.of_class(SegmentClass.WALL, SegmentClass.GLASS)):
            listed = ", ".join(f"{layer} ({n})" for layer, n in self.counted.most_common(12))
            raise InputError(
                str(path), expected="lines on a layer of walls", got=listed or "no lines at all",
                fix=asked,
            )  # fmt: skip
        for group in self.groups:
            for door in group.shut():
                self.parts.add(door, SegmentClass.DOOR)
        self.parts.cut_doors(_REACH_M)
        self._name_rooms()
        skipped = self.left_out.total()
        if skipped > self.counted.total() / 2:
            names = ", ".join(layer for layer, _ in self.left_out.most_common())
            warnings.warn(
                f"{path}: {skipped} lines on layers {brief(names, 80)} are left out",
                PalmsWarning,
                stacklevel=3,
            )
        return self.parts.build(path, name)

    def _name_rooms(self) -> None:
        import shapely

        for name, otherwise, ring in self.rings:
            area = shapely.Polygon(ring)
            inside = [text for text, at in self.texts if shapely.contains_xy(area, *at)]
            called = name or " ".join(inside[:3]) or otherwise
            if called:
                with locating(self.what):
                    self.parts.rooms.append(Room(called, ring))


def _is_ring(points_m: FloatArray) -> bool:
    return len(points_m) > 4 and np.allclose(points_m[0], points_m[-1])


def _extent(points_m: FloatArray) -> float:
    return float(np.hypot(*np.ptp(points_m, axis=0)))


def _typical_width(strokes: Sequence[Stroke]) -> float:
    """Width that most of the length has; 0 where no stroke has one."""
    known = [stroke for stroke in strokes if math.isfinite(stroke.width)]
    if not known:
        return 0.0
    widths = np.array([stroke.width for stroke in known])
    long = np.array([np.hypot(*np.diff(stroke.points_m, axis=0).T).sum() for stroke in known])
    order = np.argsort(widths)
    half = np.searchsorted(np.cumsum(long[order]), long.sum() / 2)
    return float(widths[order][min(int(half), len(known) - 1)])
