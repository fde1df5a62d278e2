"""Floor plans from OpenStreetMap: one level of what is mapped indoors (Simple Indoor Tagging).

Walls are lines of ``indoor=wall``, the outlines of rooms, and the building's. Outlines of corridors
and areas are none. Doors are nodes on them, as wide as they say.
"""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from palms.errors import FormatError, InputError
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geodesy import Origin
from palms.geometry import FloatArray
from palms.io.files import head
from palms.io.options import number_option
from palms.io.osm_elements import Area, OsmFile, load_osm, parse_levels
from palms.io.plan_csv import plan_name
from palms.io.plan_parts import PlanParts, cut, middle_line, segments_along
from palms.io.registry import Format
from palms.io.values import StrPath, brief, locating, parse_number
from palms.io.xml_events import looks_like
from palms.repair import merge
from palms.settings import LIMITS

__all__ = ["FORMAT", "read_plan_osm"]

_EXPECTED = "OpenStreetMap data with rooms or walls mapped indoors (indoor=room, indoor=wall)"
_ROOMS = ("room", "hall", "verticalpassage", "elevator", "stairs", "stairwell", "toilets")
_WALLS = ("wall", "column", "pillar", "shaft")
_OPEN = ("corridor", "area", "lobby")
_REACH_M = 0.3  # ours: rooms on both sides of a wall may be drawn so far apart
_STRAIGHT = math.cos(math.radians(20.0))  # ours: flatter corners are none to a door
_WIDTHS_M = (0.3, 12.0)  # ours: what a door's width may be
_UNITS = {"": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001, "ft": 0.3048, "'": 0.3048}
Tags = Mapping[str, str]


class _Shape(NamedTuple):
    """Something mapped indoors: refs of its lines or rings, in which `closed` tells which."""

    id: int
    kind: str
    lines: tuple[tuple[int, ...], ...]
    closed: bool
    tags: Tags
    levels: frozenset[float]


def read_plan_osm(  # noqa: PLR0913
    path: StrPath,
    *,
    level: str | None = None,
    building: str | None = None,
    language: str | None = None,
    shell: bool = True,
    door_width: float = 0.9,
    origin: tuple[float, float] | None = None,
) -> FloorPlan:
    """Read one level of a building from OpenStreetMap XML.

    Parameters
    ----------
    path : path
        The .osm file.
    level : str, optional
        Number of the level as in ``level=*``, or name, ref or id of its ``indoor=level``; needed
        where there are several.
    building : str, optional
        Name or id of the building, where the file holds several.
    language : str, optional
        Of names, as "en" for ``name:en``.
    shell : bool
        Whether the outline of the building is a wall.
    door_width : float
        Metres, for doors that do not say.
    origin : (float, float), optional
        Longitude and latitude that become (0, 0); the middle of all levels when left out, so
        that levels of a building share their frame.

    Raises
    ------
    InputError
        When it cannot be read, nothing is mapped indoors, or the level is not named and there
        are several; the message lists them.
    """
    width = number_option(door_width, "door_width", *_WIDTHS_M)
    file = load_osm(path)
    shapes = _of_building(_shapes(file), file, building)
    if not shapes:
        raise FormatError(str(path), expected=_EXPECTED, got="none")
    points = np.concatenate([file.lonlat(line) for each in shapes for line in each.lines])
    if not len(points):
        raise FormatError(str(path), expected=_EXPECTED, got="ways without their nodes")
    lon, lat = origin or (round(float(v), 7) for v in (points.min(axis=0) + points.max(axis=0)) / 2)
    with locating(path):
        place = Origin(lon, lat)
    width_m, height_m = np.ptp(place.to_local(points), axis=0).tolist()
    if max(width_m, height_m) > LIMITS.max_plan_m:
        raise InputError(
            str(path), expected=f"one building, at most {LIMITS.max_plan_m:g} m wide",
            got=f"{width_m:.0f} x {height_m:.0f} m",
            fix="choose with the option building=NAME or id",
        )  # fmt: skip
    chosen = _choose(shapes, level, str(path))
    here = [each for each in shapes if not each.levels or chosen in each.levels]
    shells = _shells(file, here)
    parts = _walls(file, [*here, *(shells if shell else ())], place)
    bearing = [each for each in here if each.kind in ("wall", "room", "area")]
    _add_doors(parts, _Doors(file, place, chosen, width), [*bearing, *shells])
    parts.rooms = list(_rooms(file, here, place, language, str(path)))
    extent = [each for each in here if each.kind == "level"] or shells
    if extent:
        parts.outline_m = place.to_local(file.lonlat(extent[0].lines[0]))[:-1]
    named = next((_name(each.tags, language) for each in shells), "")
    label = _label(shapes, chosen, language)
    plan, _ = merge(parts.build(path, named or plan_name(path), label, place))
    return plan  # of walls that two rooms share, one is left


def _shapes(file: OsmFile) -> list[_Shape]:
    """Return what is mapped indoors."""
    shapes, rings = [], set()
    for area in file.areas():
        kind = _kind(area.tags)
        if kind:
            levels = parse_levels(area.tags)
            shapes.append(_Shape(area.id, kind, area.rings, True, area.tags, levels))
            rings.add(area.id)
    for way in file.ways.values():
        kind = _kind(way.tags)
        if kind and way.id not in rings and len(way.refs) > 1:
            levels = parse_levels(way.tags)
            shapes.append(_Shape(way.id, kind, (way.refs,), False, way.tags, levels))
    return [each for each in shapes if any(len(file.lonlat(line)) > 1 for line in each.lines)]


def _kind(tags: Tags) -> str:
    """Return wall, room, area, level or door for what is mapped indoors, else nothing."""
    said = tags.get("indoor") or tags.get("buildingpart") or ""
    if said == "door" or (said in ("", "yes") and tags.get("door", "no") != "no"):
        return "door"
    if said in ("window", "level"):
        return said
    for kind, words in (("wall", _WALLS), ("room", _ROOMS), ("area", _OPEN)):
        if said in words:
            return kind
    return "room" if said == "yes" and "room" in tags else ""


def _of_building(shapes: list[_Shape], file: OsmFile, wanted: str | None) -> list[_Shape]:
    """Return what lies in a building; everything when none is asked for."""
    if wanted is None:
        return shapes
    buildings = [area for area in file.areas() if _is_building(area.tags)]
    chosen = [each for each in buildings if wanted in (*_names(each.tags), str(each.id))]
    if not chosen:
        listed = "; ".join(
            f"{_name(b.tags, None) or 'no name'} (id {b.id})" for b in buildings[:20]
        )
        raise InputError(
            f"{file.what}, option building", expected=f"one of {listed or 'none, there are none'}",
            got=brief(wanted),
        )  # fmt: skip
    middles = _middles(file, shapes)
    inside = [_holds(file, each, middles) for each in chosen]
    return [s for s, each in zip(shapes, np.any(inside, axis=0), strict=True) if each]


def _is_building(tags: Tags) -> bool:
    return tags.get("building", "no") != "no"


def _middles(file: OsmFile, shapes: Sequence[_Shape]) -> FloatArray:
    """Longitude and latitude (N, 2) of a place in each shape."""
    places = [file.lonlat(each.lines[0]).mean(axis=0) for each in shapes]
    return np.array(places).reshape(-1, 2)


def _holds(file: OsmFile, building: Area, places: FloatArray) -> np.typing.NDArray[np.bool_]:
    """Tell which places (N, 2) lie within a building."""
    import shapely

    ring = file.lonlat(building.rings[0])
    if len(ring) < 4:
        return np.zeros(len(places), np.bool_)
    outline = shapely.Polygon(ring).buffer(0)
    return np.asarray(shapely.intersects_xy(outline, *places.T))


def _shells(file: OsmFile, here: Sequence[_Shape]) -> list[_Shape]:
    """Return the outlines of the buildings that something of this level lies in."""
    middles = _middles(file, here)
    return [
        _Shape(area.id, "wall", area.rings, True, area.tags, frozenset())
        for area in file.areas()
        if _is_building(area.tags) and _holds(file, area, middles).any()
    ]


def _choose(shapes: Sequence[_Shape], wanted: str | None, what: str) -> float | None:
    """Return the level that was asked for, or the only one, or say which there are."""
    levels = sorted(set().union(*(each.levels for each in shapes)))
    if wanted is None and len(levels) <= 1:
        return levels[0] if levels else None
    found = {
        level for level in levels
        if wanted is not None and (parse_number(wanted) == level or wanted in _refs(shapes, level))
    }  # fmt: skip
    if len(found) == 1:
        return found.pop()
    listed = "; ".join(_described(shapes, level) for level in levels) or "none, there are none"
    raise InputError(
        f"{what}, option level", expected=f"one of {listed}",
        got=f"{len(levels)} levels" if wanted is None else brief(wanted),
        fix="choose with the option level=NUMBER, name, ref or id",
    )  # fmt: skip


def _level_shapes(shapes: Sequence[_Shape], level: float | None) -> Iterator[_Shape]:
    return (each for each in shapes if each.kind == "level" and each.levels == {level})


def _refs(shapes: Sequence[_Shape], level: float) -> set[str]:
    """Names, refs and ids of a level."""
    return {
        word for each in _level_shapes(shapes, level) for word in (*_names(each.tags), str(each.id))
    }


def _described(shapes: Sequence[_Shape], level: float) -> str:
    name = _label(shapes, level, None)
    return f"{level:g}" if name == f"{level:g}" else f"{level:g} ({name})"


def _label(shapes: Sequence[_Shape], level: float | None, language: str | None) -> str | None:
    """Return what to call a level: its name where it has one, else its number."""
    named = (_name(each.tags, language) for each in _level_shapes(shapes, level))
    return next(filter(None, named), None if level is None else f"{level:g}")


def _names(tags: Tags) -> set[str]:
    keys = ("name", "ref", "level:ref", "short_name", "loc_name", "alt_name")
    return {value for key, value in tags.items() if key in keys or key.startswith("name:")}


def _name(tags: Tags, language: str | None) -> str:
    keys = (f"name:{language}", "name", "ref", "level:ref")
    return next((tags[key] for key in keys if tags.get(key)), "")


def _walls(file: OsmFile, shapes: Sequence[_Shape], place: Origin) -> PlanParts:
    parts = PlanParts()
    for each in shapes:
        kind = _segment_class(each)
        if kind is None:
            continue
        for line in each.lines:
            points = place.to_local(file.lonlat(line))
            thin = each.closed and kind is not SegmentClass.WALL
            middle = middle_line(points) if thin else None
            parts.add(segments_along(points) if middle is None else middle, kind)
    return parts


def _segment_class(shape: _Shape) -> SegmentClass | None:
    if shape.kind in ("wall", "room"):
        keys = ("material", "wall", "wall:material")
        glass = "glass" in (shape.tags.get(key) for key in keys)
        return SegmentClass.GLASS if glass else SegmentClass.WALL
    return {"door": SegmentClass.DOOR, "window": SegmentClass.GLASS}.get(shape.kind)


class _Doors(NamedTuple):
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


def _add_doors(parts: PlanParts, doors: _Doors, bearing: Sequence[_Shape]) -> None:
    """Put doors and windows into the walls that their nodes belong to, each once."""
    nodes = doors.nodes()
    found: defaultdict[SegmentClass, list[FloatArray]] = defaultdict(list)
    for line in (line for each in bearing for line in each.lines):
        for at, ref in enumerate(line):
            if ref in nodes and ref in doors.file.places:
                kind, width_m = nodes.pop(ref)
                segment = doors.segment(line, at, width_m)
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
    return width if _WIDTHS_M[0] <= width <= _WIDTHS_M[1] else otherwise


def _rooms(
    file: OsmFile, here: Sequence[_Shape], place: Origin, language: str | None, what: str
) -> Iterator[Room]:
    for each in here:
        name = _name(each.tags, language)
        if name and each.closed and each.kind in ("room", "area"):
            ring = place.to_local(file.lonlat(each.lines[0]))[:-1]
            if len(ring) > 2:
                with locating(f"{what}, {brief(name)}"):
                    yield Room(name, ring)


def _recognizes(path: Path) -> bool:
    return looks_like(head(path), "osm")


FORMAT = Format(
    name="osm",
    description="OpenStreetMap: one level of what is mapped indoors",
    suffixes=(".osm",),
    recognizes=_recognizes,
    read=read_plan_osm,
)
