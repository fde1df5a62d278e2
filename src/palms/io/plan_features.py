"""From features of a map, with words for what they are, to the parts of a floor plan."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from palms.errors import PalmsWarning
from palms.floorplan import Room, SegmentClass
from palms.geometry import FloatArray
from palms.io.geojson import Feature
from palms.io.plan_parts import PlanParts, middle_line, segments_along
from palms.io.plan_words import Role, role_of
from palms.io.values import brief, locating

__all__ = ["CLASS_KEYS", "Sorter", "ToMap", "class_key", "levels_of"]

CLASS_KEYS = ("class", "type", "kind", "category", "indoor", "feature_type", "layer")
_REACH_M = 0.3  # ours: a door's line may lie that far from the wall's

ToMap = Callable[[FloatArray], FloatArray]


def class_key(features: Sequence[Feature]) -> str | None:
    """Return the property that names classes: the one most of whose words are known."""
    known = {
        key: sum(role_of(_text(f.properties.get(key))) is not None for f in features)
        for key in CLASS_KEYS
    }
    best = max(known, key=lambda key: known[key])
    return best if known[best] else None


def levels_of(feature: Feature) -> tuple[str, ...]:
    """Return the levels that a feature is on; none when it does not say.

    Examples
    --------
    >>> levels_of(Feature((), (), {"level": 0})), levels_of(Feature((), (), {"level": "1; 2"}))
    (('0',), ('1', '2'))
    """
    level = feature.properties.get("level")
    if isinstance(level, float) and level.is_integer():
        level = int(level)
    listed = level if isinstance(level, list) else str("" if level is None else level).split(";")
    return tuple(name for each in listed if (name := str(each).strip()))


def _text(value: object) -> str | None:
    return value if isinstance(value, str) else None


class Sorter(NamedTuple):
    """Sorts features into walls, doors, glass, rooms and outline."""

    class_key: str | None
    words: Mapping[str, Role]
    name_keys: Sequence[str]

    def sort(self, features: Sequence[Feature], to_map: ToMap, what: str) -> PlanParts:
        """Return the parts of a plan."""
        roles = [self._role(feature) for feature in features]
        explicit = Role.WALL in roles
        parts, left_out = PlanParts(), Counter[str]()
        for feature, role in zip(features, roles, strict=True):
            lines = [to_map(line) for line in feature.lines]
            rings = [to_map(ring) for ring in feature.rings if len(ring) >= 3]
            if role is None and explicit and lines and self._word(feature):
                left_out[str(self._word(feature))] += 1
                continue
            self._add(parts, role, lines, rings, explicit)
            self._name(parts, feature, role, rings, what)
        if left_out:
            shown = ", ".join(brief(word) for word in sorted(left_out)[:5])
            warnings.warn(
                f"{what}: {sum(left_out.values())} lines of class {shown} are left out; "
                "say what they are with the option classes=WORD:wall",
                PalmsWarning,
                stacklevel=4,
            )
        parts.cut_doors(_REACH_M)
        return parts

    def _word(self, feature: Feature) -> str | None:
        return _text(feature.properties.get(self.class_key)) if self.class_key else None

    def _role(self, feature: Feature) -> Role | None:
        return role_of(self._word(feature), self.words)

    def _add(
        self,
        parts: PlanParts,
        role: Role | None,
        lines: list[FloatArray],
        rings: list[FloatArray],
        explicit: bool,
    ) -> None:
        kind = SegmentClass.WALL if role is None else role.segment_class
        if kind is not None:
            for line in lines:
                parts.add(segments_along(line), kind)
        if role is Role.OUTLINE and rings and parts.outline_m is None:
            parts.outline_m = _open(max(rings, key=_area))
        hollow = role is Role.ROOM and (self.class_key == "indoor" or not explicit)
        bare = role in (None, Role.OUTLINE) and not explicit
        for ring in rings:
            if role in (Role.DOOR, Role.OPENING, Role.GLASS) and kind is not None:
                middle = middle_line(ring)
                parts.add(segments_along(ring, True) if middle is None else middle, kind)
            elif role is Role.WALL or hollow or bare:
                parts.add(segments_along(ring, True), SegmentClass.WALL)

    def _name(
        self,
        parts: PlanParts,
        feature: Feature,
        role: Role | None,
        rings: list[FloatArray],
        what: str,
    ) -> None:
        """Add a room when the feature is an area with a name."""
        named = (feature.properties.get(key) for key in self.name_keys)
        name = next((str(n).strip() for n in named if isinstance(n, str | int) and str(n)), "")
        if name and rings and role in (None, Role.ROOM, Role.OPEN_AREA):
            with locating(what):
                parts.rooms.append(Room(name, _open(rings[0])))


def _open(ring: FloatArray) -> FloatArray:
    return ring[:-1] if len(ring) > 3 and (ring[0] == ring[-1]).all() else ring


def _area(ring: FloatArray) -> float:
    x, y = ring.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
