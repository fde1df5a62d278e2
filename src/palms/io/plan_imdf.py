"""Floor plans from IMDF, the Indoor Mapping Data Format: a zip archive or a folder.

IMDF has no walls. They are the edges of units, without those that two walkway-like units share,
and without what openings stand in. A unit of a wall's material is a solid, and so are fixtures.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from palms.errors import FormatError, InputError
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geodesy import Origin
from palms.geometry import FloatArray
from palms.io.archives import member_names, read_members
from palms.io.geojson import Feature, parse_features, parse_json
from palms.io.levels import LevelPlan, gather_levels
from palms.io.packed import unzipped
from palms.io.plan_parts import PlanParts, segments_along
from palms.io.registry import Format
from palms.io.values import StrPath, brief, locating
from palms.repair import merge

__all__ = ["FORMAT", "read_levels_imdf", "read_plan_imdf"]

_TYPES = ("level", "unit", "opening", "fixture", "kiosk", "building", "anchor", "occupant")
_NEEDED = ("level", "unit")
_WALKWAYS = (
    "walkway", "walkway.island", "lobby", "concourse", "footbridge", "movingwalkway", "platform",
    "ramp", "road", "terrace", "unenclosedarea", "escalator", "steps",
)  # fmt: skip
_SOLIDS = ("brick", "column", "concrete", "drywall", "structure", "wood", "glass")
_NO_ROOM = (*_SOLIDS, "opentobelow", "nonpublic")
_MOST_LEVELS = 1000  # ours: higher ordinals are damage
_GRID_M = 0.001  # ours: corners that near are one
_SLIVER_M = 0.03  # ours: gaps between units that are drawing errors
_REACH_M = 0.3  # ours: an opening may lie that far from the wall's line


class _Item(NamedTuple):
    """A feature with its identity, as IMDF has it beside the properties."""

    id: str
    feature: Feature

    def get(self, key: str) -> Any:  # noqa: ANN401
        return self.feature.properties.get(key)


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
    venue = _Venue.of(path, language, fixtures, origin)
    return venue.plan(_choose(venue.items["level"], (level, building), venue))


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
    venue = _Venue.of(path, language, fixtures, origin)
    levels = _fitting(venue.items["level"], (None, building), venue)
    if not levels:
        raise _not_one(venue.items["level"], levels, (None, building), venue)
    return gather_levels(
        (venue.title(each), _number(each), functools.partial(venue.plan, each)) for each in levels
    )


@dataclass(frozen=True)
class _Venue:
    """What an archive holds, and how its plans are to be made."""

    path: StrPath
    items: Mapping[str, Sequence[_Item]]
    origin: Origin
    language: str | None
    fixtures: bool

    @classmethod
    def of(
        cls,
        path: StrPath,
        language: str | None,
        fixtures: bool,
        origin: tuple[float, float] | None,
    ) -> _Venue:
        """Read an archive; the origin is the middle of all its levels when left out."""
        items = _load(path)
        rings = [ring for each in items["level"] for ring in each.feature.rings]
        corners = np.concatenate(rings) if rings else np.empty((0, 2))
        if not len(corners):
            raise FormatError(f"{path}, level", expected="areas", got="none")
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        lon, lat = origin or (round(float(v), 7) for v in middle)
        with locating(path):
            return cls(path, items, Origin(lon, lat), language, fixtures)

    @cached_property
    def buildings(self) -> dict[str, Any]:
        """Names of the buildings by their id."""
        return {each.id: each.get("name") for each in self.items["building"]}

    def title(self, level: _Item) -> str:
        """Return what to call a level."""
        return _label(level.get("name"), self.language) or _ordinal(level)

    def plan(self, level: _Item) -> FloorPlan:
        """Return the plan of a level."""
        here = {
            kind: [each for each in found if each.get("level_id") == level.id]
            for kind, found in self.items.items()
        }
        parts = _walls(here, self.origin, self.fixtures)
        tenants = _tenants(self.items, self.language)
        parts.rooms = _rooms(here["unit"], tenants, self.origin, self.language, str(self.path))
        if level.feature.rings:
            parts.outline_m = self.origin.to_local(max(level.feature.rings, key=len))[:-1]
        name = _owner(level, self) or Path(self.path).resolve().stem
        plan, _ = merge(parts.build(self.path, name, self.title(level), self.origin))
        return plan  # merged: two units share an edge


def _members() -> dict[str, str]:
    endings = (".geojson", ".geojson.gz", ".json", ".json.gz")
    return {f"{kind}{ending}": kind for kind in _TYPES for ending in endings}


def _load(path: StrPath) -> dict[str, list[_Item]]:
    contents = read_members(path, _members())
    missing = [f"{kind}.geojson" for kind in _NEEDED if kind not in contents]
    if missing:
        raise FormatError(
            str(path), expected="IMDF with level.geojson and unit.geojson",
            got=f"no {' and no '.join(missing)}", fix="check that it is the whole archive",
        )  # fmt: skip
    items: dict[str, list[_Item]] = {kind: [] for kind in _TYPES}
    for kind, content in contents.items():
        what = f"{path}, {kind}"
        collection = parse_json(unzipped(content, what), what, "a GeoJSON FeatureCollection")
        listed = collection.get("features") if isinstance(collection, dict) else None
        features = parse_features(collection, what)
        ids = [each.get("id") for each in listed] if isinstance(listed, list) else []
        items[kind] = [_Item(str(i), f) for f, i in zip(features, _padded(ids), strict=False)]
    return items


def _padded(ids: Sequence[Any]) -> list[Any]:
    return [*ids, None]


def _label(name: object, language: str | None) -> str:
    """Text of a name by language; the first language when the one asked for is missing."""
    if isinstance(name, str):
        return name.strip()
    if not isinstance(name, dict):
        return ""
    texts = {k: v.strip() for k, v in name.items() if isinstance(v, str) and v.strip()}
    return texts.get(language or "", next(iter(texts.values()), ""))


def _ordinal(level: _Item) -> str:
    value = level.get("ordinal")
    return f"{value:g}" if isinstance(value, int | float) else ""


def _number(level: _Item) -> float:
    value = level.get("ordinal")
    return float(value) if isinstance(value, int | float) and abs(value) < _MOST_LEVELS else 0.0


_Wanted = tuple[str | None, str | None]


def _fitting(levels: Sequence[_Item], wanted: _Wanted, venue: _Venue) -> list[_Item]:
    """Return the levels of some name, ordinal or id, and of some building."""
    level, building = wanted
    return [
        each for each in levels
        if (level is None or level in _names(each))
        and (building is None or building in _owners(each, venue.buildings))
    ]  # fmt: skip


def _choose(levels: Sequence[_Item], wanted: _Wanted, venue: _Venue) -> _Item:
    """Return the level that was asked for, or say which there are."""
    fitting = _fitting(levels, wanted, venue)
    if len(fitting) == 1:
        return fitting[0]
    raise _not_one(levels, fitting, wanted, venue)


def _not_one(
    levels: Sequence[_Item], fitting: Sequence[_Item], wanted: _Wanted, venue: _Venue
) -> InputError:
    shown = "; ".join(
        f"{_label(each.get('name'), venue.language) or 'no name'} (ordinal {_ordinal(each)}, "
        f"{_owner(each, venue) or 'no building'}, "
        f"id {each.id})"
        for each in (fitting or levels)[:20]
    )
    asked = ", ".join(f"{k}={v!r}" for k, v in zip(("level", "building"), wanted, strict=True) if v)
    return InputError(
        f"{venue.path}, option level",
        expected=f"one of {shown}",
        got=asked if not fitting else f"{len(fitting)} that fit{' ' + asked if asked else ''}",
        fix="choose with the options level=NAME, ordinal or id, and building=NAME",
    )


def _texts(name: object) -> set[str]:
    """All languages of a name."""
    texts = name.values() if isinstance(name, dict) else [name]
    return {text.strip() for text in texts if isinstance(text, str)} - {""}


def _names(level: _Item) -> set[str]:
    names = _texts(level.get("name")) | _texts(level.get("short_name"))
    return names | {level.id, _ordinal(level)}


def _ids(level: _Item) -> list[str]:
    ids = level.get("building_ids")
    return [each for each in ids if isinstance(each, str)] if isinstance(ids, list) else []


def _owners(level: _Item, buildings: Mapping[str, Any]) -> set[str]:
    """Ids and names of the buildings of a level."""
    ids = _ids(level)
    return set(ids).union(*(_texts(buildings.get(each)) for each in ids))


def _owner(level: _Item, venue: _Venue) -> str:
    names = (_label(venue.buildings.get(each), venue.language) for each in _ids(level))
    return ", ".join(filter(None, names))


def _polygon(item: _Item, place: Origin) -> Any:  # noqa: ANN401
    """Return the area of a feature in metres, its parts and holes told by even and odd."""
    import shapely

    area = shapely.Polygon()
    for ring in item.feature.rings:
        if len(ring) >= 4:
            area = area.symmetric_difference(
                shapely.make_valid(shapely.Polygon(place.to_local(ring)))
            )
    return area


def _walls(here: Mapping[str, Sequence[_Item]], place: Origin, fixtures: bool) -> PlanParts:
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


def _tenants(items: Mapping[str, Sequence[_Item]], language: str | None) -> dict[str, str]:
    """Names of occupants by the unit that their anchor stands in."""
    units = {each.id: str(each.get("unit_id")) for each in items["anchor"]}
    return {
        units[anchor]: name
        for each in items["occupant"]
        if (anchor := str(each.get("anchor_id"))) in units
        and (name := _label(each.get("name"), language))
    }


def _rooms(
    units: Sequence[_Item],
    tenants: Mapping[str, str],
    place: Origin,
    language: str | None,
    what: str,
) -> list[Room]:
    rooms = []
    for unit in units:
        name = _label(unit.get("name"), language) or tenants.get(unit.id, "")
        name = name or _label(unit.get("alt_name"), language)
        if not name or unit.get("category") in _NO_ROOM or not unit.feature.rings:
            continue
        ring = place.to_local(unit.feature.rings[0])
        if len(ring) > 3:
            with locating(f"{what}, unit {brief(name)}"):
                rooms.append(Room(name, ring[:-1]))
    return rooms


def _recognizes(path: Path) -> bool:
    kinds = {_members().get(name.lower().rpartition("/")[2]) for name in member_names(path)}
    return kinds.issuperset(_NEEDED)


FORMAT = Format(
    name="imdf",
    description="one level of a venue: zip archive or folder",
    suffixes=(".imdf", ".zip"),
    recognizes=_recognizes,
    read=read_plan_imdf,
    read_levels=read_levels_imdf,
)
