"""Floor plans from IMDF, the Indoor Mapping Data Format: a zip archive or a folder.

IMDF has no walls. They are the edges of units, without those that two walkway-like units share,
and without what openings stand in. A unit of a wall's material is a solid, and so are fixtures.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geodesy import Origin
from palms.geometry import FloatArray
from palms.io.imdf import Item, Venue, is_imdf, ordinal, text_in
from palms.io.levels import LevelPlan, gather_levels, is_stairs_word
from palms.io.plan_parts import PlanParts, segments_along
from palms.io.registry import Format
from palms.io.values import StrPath, brief, locating
from palms.repair import merge

if TYPE_CHECKING:
    from palms.building import Stairs

__all__ = ["FORMAT", "read_levels_imdf", "read_plan_imdf"]

_WALKWAYS = (
    "walkway", "walkway.island", "lobby", "concourse", "footbridge", "movingwalkway", "platform",
    "ramp", "road", "terrace", "unenclosedarea", "escalator", "steps",
)  # fmt: skip
_SOLIDS = ("brick", "column", "concrete", "drywall", "structure", "wood", "glass")
_NO_ROOM = (*_SOLIDS, "opentobelow", "nonpublic")
_GRID_M = 0.001  # ours: corners that near are one
_SLIVER_M = 0.03  # ours: gaps between units that are drawing errors
_REACH_M = 0.3  # ours: an opening may lie that far from the wall's line


def read_plan_imdf(
    path: StrPath,
    *,
    level: str | None = None,
    building: str | None = None,
    language: str | None = None,
    fixtures: bool = True,
    origin: tuple[float, float] | None = None,
) -> FloorPlan:
    """Read one level of a venue from IMDF.

    Parameters
    ----------
    path : path
        The zip archive, or the folder with level.geojson and unit.geojson; a manifest is not
        needed, and members may be compressed by gzip.
    level : str, optional
        Name, short name, ordinal or id of the level; needed where there are several.
    building : str, optional
        Name or id of the building, where levels of several have the same name.
    language : str, optional
        Of names, such as "en"; the first when left out.
    fixtures : bool
        Whether fixtures and kiosks are walls.
    origin : (float, float), optional
        Longitude and latitude that become (0, 0); the middle of all levels when left out, so
        that levels of a venue share their frame.

    Raises
    ------
    InputError
        When it cannot be read, or the level is not named and there are several; the message
        lists them.
    """
    venue = Venue.of(path, language, origin)
    return _plan(venue, venue.level(level, building), fixtures)


def read_levels_imdf(
    path: StrPath,
    *,
    building: str | None = None,
    language: str | None = None,
    fixtures: bool = True,
    origin: tuple[float, float] | None = None,
) -> tuple[LevelPlan, ...]:
    """Read all levels of a venue, or of one of its buildings, in one frame.

    Parameters
    ----------
    path, building, language, fixtures, origin
        As in `read_plan_imdf`.

    Returns
    -------
    tuple of LevelPlan
        By ordinal, from the lowest up; a plan's name is that of its building.

    Raises
    ------
    InputError
        When it cannot be read, or there is no such building.
    """
    venue = Venue.of(path, language, origin)
    return gather_levels(
        (venue.title(each), ordinal(each), functools.partial(_level, venue, each, fixtures))
        for each in venue.levels(None, building)
    )


def _level(venue: Venue, level: Item, fixtures: bool) -> tuple[FloorPlan, tuple[Stairs, ...]]:
    units = [each for each in venue.items["unit"] if each.get("level_id") == level.id]
    return _plan(venue, level, fixtures), tuple(_stairs(units, venue))


def _stairs(units: Sequence[Item], venue: Venue) -> Iterator[Stairs]:
    """Units of such a category, whatever they are called."""
    from palms.building import Stairs

    for unit in units:
        rings = unit.feature.rings
        if is_stairs_word(unit.get("category")) and rings and len(rings[0]) > 3:
            name = text_in(unit.get("name"), venue.language) or str(unit.get("category"))
            yield Stairs(name, venue.origin.to_local(rings[0])[:-1])


def _plan(venue: Venue, level: Item, fixtures: bool) -> FloorPlan:
    here = {
        kind: [each for each in found if each.get("level_id") == level.id]
        for kind, found in venue.items.items()
    }
    parts = _walls(here, venue.origin, fixtures)
    parts.rooms = _rooms(here["unit"], venue)
    if level.feature.rings:
        parts.outline_m = venue.origin.to_local(max(level.feature.rings, key=len))[:-1]
    name = venue.owner(level) or Path(venue.path).resolve().stem
    plan, _ = merge(parts.build(venue.path, name, venue.title(level), venue.origin))
    return plan  # merged, as two units share an edge


def _polygon(item: Item, place: Origin) -> Any:  # noqa: ANN401
    """Return the area of a feature in metres, its parts and holes told by even and odd."""
    import shapely

    area = shapely.Polygon()
    for ring in item.feature.rings:
        if len(ring) >= 4:
            area = area.symmetric_difference(
                shapely.make_valid(shapely.Polygon(place.to_local(ring)))
            )
    return area


def _walls(here: Mapping[str, Sequence[Item]], place: Origin, fixtures: bool) -> PlanParts:
    import shapely

    ways: list[Any] = []
    walls: list[Any] = []
    glass: list[Any] = []
    for unit in here["unit"]:
        category = str(unit.get("category") or "").lower()
        area = _polygon(unit, place)
        if category in _WALKWAYS:
            ways.append(area)
        else:
            (glass if category == "glass" else walls).append(area.boundary)
    if fixtures:
        walls += [_polygon(each, place).boundary for each in (*here["fixture"], *here["kiosk"])]
    together = shapely.union_all(ways).buffer(_SLIVER_M, join_style="mitre")
    walls.append(together.buffer(-_SLIVER_M, join_style="mitre").boundary)
    parts = PlanParts()
    parts.add(_lines(glass), SegmentClass.GLASS)
    parts.add(_lines(walls), SegmentClass.WALL)
    for opening in here["opening"]:
        door = opening.get("door")
        free = isinstance(door, dict) and door.get("type") == "open"
        kind = SegmentClass.OPENING if free and door.get("material") is None else SegmentClass.DOOR
        for line in opening.feature.lines:
            parts.add(segments_along(place.to_local(line)), kind)
    parts.cut_doors(_REACH_M)
    return parts


def _lines(boundaries: Sequence[Any]) -> FloatArray:
    """Segments of boundaries, each piece once, straight runs joined."""
    import shapely

    united = shapely.union_all(boundaries, grid_size=_GRID_M)
    joined = shapely.line_merge(united) if united.geom_type == "MultiLineString" else united
    lines = [each for each in shapely.get_parts(joined) if each.geom_type == "LineString"]
    runs = [segments_along(shapely.get_coordinates(each.simplify(_GRID_M))) for each in lines]
    return np.concatenate([np.empty((0, 2, 2)), *runs])


def _tenants(venue: Venue) -> dict[str, str]:
    """Names of occupants by the unit that their anchor stands in."""
    units = {each.id: str(each.get("unit_id")) for each in venue.items["anchor"]}
    return {
        units[anchor]: name
        for each in venue.items["occupant"]
        if (anchor := str(each.get("anchor_id"))) in units
        and (name := text_in(each.get("name"), venue.language))
    }


def _rooms(units: Sequence[Item], venue: Venue) -> list[Room]:
    rooms, tenants = [], _tenants(venue)
    for unit in units:
        name = text_in(unit.get("name"), venue.language) or tenants.get(unit.id, "")
        name = name or text_in(unit.get("alt_name"), venue.language)
        if not name or unit.get("category") in _NO_ROOM or not unit.feature.rings:
            continue
        ring = venue.origin.to_local(unit.feature.rings[0])
        if len(ring) > 3:
            with locating(f"{venue.path}, unit {brief(name)}"):
                rooms.append(Room(name, ring[:-1]))
    return rooms


FORMAT = Format(
    name="imdf",
    description="one level of a venue: zip archive or folder",
    suffixes=(".imdf", ".zip"),
    recognizes=is_imdf,
    read=read_plan_imdf,
    read_levels=read_levels_imdf,
)
