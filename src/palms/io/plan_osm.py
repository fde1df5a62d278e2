"""Floor plans from OpenStreetMap: one level of what is mapped indoors (Simple Indoor Tagging).

Walls are lines of ``indoor=wall``, the outlines of rooms, and the building's. Outlines of corridors
and areas are none. Doors are nodes on them, as wide as they say.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from palms.errors import FormatError, InputError
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geodesy import Origin
from palms.geometry import FloatArray
from palms.io.files import head
from palms.io.levels import LevelPlan, gather_levels
from palms.io.options import number_option
from palms.io.osm_doors import WIDTHS_M, Doors
from palms.io.osm_elements import Area, OsmFile, load_osm, parse_levels
from palms.io.plan_csv import plan_name
from palms.io.plan_parts import PlanParts, middle_line, segments_along
from palms.io.registry import Format
from palms.io.values import StrPath, brief, locating, parse_number
from palms.io.xml_events import looks_like
from palms.repair import merge
from palms.settings import LIMITS

__all__ = ["FORMAT", "read_levels_osm", "read_plan_osm"]

_EXPECTED = "OpenStreetMap data with rooms or walls mapped indoors (indoor=room, indoor=wall)"
_ROOMS = ("room", "hall", "verticalpassage", "elevator", "stairs", "stairwell", "toilets")
_WALLS = ("wall", "column", "pillar", "shaft")
_OPEN = ("corridor", "area", "lobby")
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
    mapped = _Mapped.of(path, building, origin, _Options(language, shell, door_width))
    return mapped.plan(_choose(mapped.shapes, level, str(path)))


def read_levels_osm(
    path: StrPath,
    *,
    building: str | None = None,
    language: str | None = None,
    shell: bool = True,
    door_width: float = 0.9,
    origin: tuple[float, float] | None = None,
) -> tuple[LevelPlan, ...]:
    """Read all levels of a building, in one frame.

    Parameters
    ----------
    path, building, language, shell, door_width, origin
        As in `read_plan_osm`.

    Returns
    -------
    tuple of LevelPlan
        By the levels' numbers, from the lowest up.

    Raises
    ------
    InputError
        When it cannot be read, or nothing is mapped indoors.
    """
    mapped = _Mapped.of(path, building, origin, _Options(language, shell, door_width))
    return gather_levels(
        (_label(mapped.shapes, level, language) or "", level or 0.0,
         functools.partial(mapped.alone, level))
        for level in (_levels(mapped.shapes) or (None,))
    )  # fmt: skip


class _Options(NamedTuple):
    """What a user may say of the file; see `read_plan_osm`."""

    language: str | None
    shell: bool
    door_width_m: float


class _Mapped(NamedTuple):
    """What a file has mapped indoors of a building, and where its (0, 0) is."""

    path: StrPath
    file: OsmFile
    shapes: Sequence[_Shape]
    place: Origin
    options: _Options

    @classmethod
    def of(
        cls,
        path: StrPath,
        building: str | None,
        origin: tuple[float, float] | None,
        options: _Options,
    ) -> _Mapped:
        """Read a file."""
        number_option(options.door_width_m, "door_width", *WIDTHS_M)
        file = load_osm(path)
        shapes = _of_building(_shapes(file), file, building)
        if not shapes:
            raise FormatError(str(path), expected=_EXPECTED, got="none")
        points = np.concatenate([file.lonlat(line) for each in shapes for line in each.lines])
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        with locating(path):
            place = Origin(*(origin or (round(float(v), 7) for v in middle)))
        width_m, height_m = np.ptp(place.to_local(points), axis=0).tolist()
        if max(width_m, height_m) > LIMITS.max_plan_m:
            raise InputError(
                str(path), expected=f"one building, at most {LIMITS.max_plan_m:g} m wide",
                got=f"{width_m:.0f} x {height_m:.0f} m",
                fix="choose with the option building=NAME or id",
            )  # fmt: skip
        return cls(path, file, shapes, place, options)

    def alone(self, level: float | None) -> tuple[FloorPlan, tuple[()]]:
        """Return the plan of a level; its stairs are those of its rooms that are called so."""
        return self.plan(level), ()

    def plan(self, level: float | None) -> FloorPlan:
        """Return the plan of a level."""
        language, place = self.options.language, self.place
        here = [each for each in self.shapes if not each.levels or level in each.levels]
        shells = _shells(self.file, here)
        parts = _walls(self.file, [*here, *(shells if self.options.shell else ())], place)
        bearing = [each for each in here if each.kind in ("wall", "room", "area")]
        doors = Doors(self.file, place, level, self.options.door_width_m)
        doors.add_to(parts, [line for each in (*bearing, *shells) for line in each.lines])
        parts.rooms = list(_rooms(self.file, here, place, language, str(self.path)))
        extent = [each for each in here if each.kind == "level"] or shells
        if extent:
            parts.outline_m = place.to_local(self.file.lonlat(extent[0].lines[0]))[:-1]
        named = next((_name(each.tags, language) for each in shells), "")
        label = _label(self.shapes, level, language)
        plan, _ = merge(parts.build(self.path, named or plan_name(self.path), label, place))
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
    levels = _levels(shapes)
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


def _levels(shapes: Sequence[_Shape]) -> list[float]:
    return sorted(set().union(*(each.levels for each in shapes)))


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
    read_levels=read_levels_osm,
)
