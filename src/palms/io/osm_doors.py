"""Doors and windows of OpenStreetMap: nodes on walls, as wide as their tags say."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from palms.floorplan import SegmentClass
from palms.geodesy import Origin
from palms.geometry import FloatArray
from palms.io.osm_elements import OsmFile, parse_levels
from palms.io.plan_parts import PlanParts, cut

__all__ = ["WIDTHS_M", "Doors"]

WIDTHS_M = (0.3, 12.0)  # ours: what a door's width may be
_REACH_M = 0.3  # ours: rooms on both sides of a wall may be drawn so far apart
_STRAIGHT = math.cos(math.radians(20.0))  # ours: flatter corners are none to a door
_UNITS = {"": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "'": 0.3048}
Tags = Mapping[str, str]


class Doors(NamedTuple):
    """Finds the segments of doors and windows that are nodes of walls."""

    file: OsmFile
    place: Origin
    level: float | None
    width_m: float

    def nodes(self) -> dict[int, tuple[SegmentClass, float]]:
        """Class and width of the doors and windows of the level."""
        found = {}
        for node in self.file.nodes:
            kind = _door_class(node.tags)
            levels = parse_levels(node.tags)
            if kind is not None and (not levels or self.level in levels):
                found[node.id] = (kind, _width_m(node.tags, self.width_m))
        return found

    def segment(self, line: Sequence[int], at: int, width_m: float) -> FloatArray | None:
        """Return the segment (2, 2) of a door at a node of a line; None when it has no room."""
        ring = line[0] == line[-1]
        before = line[at - 1] if at else line[-2] if ring else None
        after = line[at + 1] if at + 1 < len(line) else line[1] if ring else None
        here = self._point(line[at])
        near = [ref for ref in (before, after) if ref in self.file.places]
        arms = [self._point(ref) - here for ref in near if ref is not None]
        arms = [arm for arm in arms if np.hypot(*arm) > 1e-3]
        if not arms:
            return None
        arms.sort(key=lambda arm: float(np.hypot(*arm)))
        along = arms[-1] / np.hypot(*arms[-1])
        straight = len(arms) == 2 and float(-along @ arms[0]) > _STRAIGHT * np.hypot(*arms[0])
        start = here - along * width_m / 2 if straight else here
        return np.array([start, start + along * width_m])

    def _point(self, ref: int) -> FloatArray:
        return self.place.to_local(np.array(self.file.places[ref]))

    def add_to(self, parts: PlanParts, lines: Sequence[Sequence[int]]) -> None:
        """Put doors and windows into the walls along lines of nodes, each once."""
        nodes = self.nodes()
        found: defaultdict[SegmentClass, list[FloatArray]] = defaultdict(list)
        for line in lines:
            for at, ref in enumerate(line):
                if ref in nodes and ref in self.file.places:
                    kind, width_m = nodes.pop(ref)
                    segment = self.segment(line, at, width_m)
                    if segment is not None:
                        found[kind].append(segment)
        panes = np.array(found.pop(SegmentClass.GLASS, [])).reshape(-1, 2, 2)
        if len(panes):
            parts.segments = [cut(each, panes, _REACH_M) for each in parts.segments]
            parts.add(panes, SegmentClass.GLASS)
        for kind, segments in found.items():
            parts.add(np.array(segments), kind)
        parts.cut_doors(_REACH_M)


def _door_class(tags: Tags) -> SegmentClass | None:
    if tags.get("door") == "no" or tags.get("indoor") == "opening":
        return SegmentClass.OPENING
    if "door" in tags or tags.get("indoor") == "door" or tags.get("entrance", "no") != "no":
        return SegmentClass.DOOR
    return SegmentClass.GLASS if tags.get("window", "no") != "no" else None


def _width_m(tags: Tags, otherwise: float) -> float:
    """Width of a door, by its tag where that is likely."""
    text = tags.get("door:width") or tags.get("width") or ""
    found = re.fullmatch(r"(\d+(?:[.,]\d+)?)\s*(m|cm|mm|ft|'|)", text.strip().lower())
    if not found:
        return otherwise
    width = float(found[1].replace(",", ".")) * _UNITS[found[2]]
    return width if WIDTHS_M[0] <= width <= WIDTHS_M[1] else otherwise
