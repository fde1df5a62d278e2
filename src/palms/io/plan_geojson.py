"""Floor plans as GeoJSON: lines and areas in longitude and latitude, or in local metres.

A property names what each feature is (see `palms.io.plan_words`). Where the file names walls,
areas are rooms and only rooms; where it names none, the edges of areas are the walls.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from palms.errors import FormatError, InputError, OutputError
from palms.floorplan import FloorPlan, SegmentClass
from palms.geodesy import Origin
from palms.geometry import FloatArray
from palms.io.files import head, sniff, write_json
from palms.io.geojson import Feature, load_json, parse_features
from palms.io.levels import LevelPlan, gather_levels, is_stairs_word
from palms.io.plan_features import CLASS_KEYS, Sorter, ToMap, class_key, levels_of
from palms.io.plan_parts import check_scale
from palms.io.plan_words import Role, parse_classes
from palms.io.registry import Format
from palms.io.values import StrPath, brief, parse_number

if TYPE_CHECKING:
    from palms.building import Stairs

__all__ = ["FORMAT", "read_levels_geojson", "read_plan_geojson", "write_plan_geojson"]

_EXPECTED = "a GeoJSON FeatureCollection of walls, doors and rooms"
_NAME_KEYS = ("name", "ref", "roomnumber", "room", "label")
_STAIRS_KEYS = ("room", "highway")  # where OpenStreetMap's indoor tags have stairs and lifts
_MOST_LEVELS = 1000  # ours: higher numbers are none of a level
_LONLAT_SPAN = 0.5  # ours: no building is half a degree wide, and none half a metre
_FRAME = Literal["auto", "lonlat", "metres"]


def read_plan_geojson(  # noqa: PLR0913
    path: StrPath,
    *,
    frame: _FRAME = "auto",
    scale: float = 1.0,
    origin: tuple[float, float] | None = None,
    class_property: str | None = None,
    classes: str | None = None,
    name_property: str | None = None,
    level: str | None = None,
) -> FloorPlan:
    """Read a floor plan from GeoJSON.

    Parameters
    ----------
    path : path
        The file; it may be compressed by gzip.
    frame : {"auto", "lonlat", "metres"}
        What coordinates are; "auto" tells by their extent, since no building is half a degree
        wide.
    scale : float
        Metres of one unit, where coordinates are local.
    origin : (float, float), optional
        Longitude and latitude that become (0, 0); the middle of the file when left out. Give
        the same to all levels of a building.
    class_property : str, optional
        Property that names the class; found among class, type, kind, category, indoor,
        feature_type and layer when left out.
    classes : str, optional
        Words of your own, as ``muro:wall,vidrio:glass,mueble:nothing``.
    name_property : str, optional
        Property that names a room; name, ref, roomnumber, room or label when left out.
    level : str, optional
        Of the features that have a property ``level``, those to take; one of several levels
        lists them as ``0;1``.

    Raises
    ------
    InputError
        When it cannot be read, or holds several levels and none is named.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     walls = {"type": "LineString", "coordinates": [[0, 0], [8, 0], [8, 5]]}
    ...     write_json(f"{folder}/hall.geojson", walls)
    ...     read_plan_geojson(f"{folder}/hall.geojson").size_m.tolist()
    [8.0, 5.0]
    """
    options = _Options(frame, scale, origin, class_property, parse_classes(classes), name_property)
    drawing = _Drawing.of(path, options)
    return drawing.plan(_choose(level, drawing.levels, str(path)))


def read_levels_geojson(  # noqa: PLR0913
    path: StrPath,
    *,
    frame: _FRAME = "auto",
    scale: float = 1.0,
    origin: tuple[float, float] | None = None,
    class_property: str | None = None,
    classes: str | None = None,
    name_property: str | None = None,
) -> tuple[LevelPlan, ...]:
    """Read all levels that the property ``level`` of features names, in one frame.

    Parameters
    ----------
    path, frame, scale, origin, class_property, classes, name_property
        As in `read_plan_geojson`.

    Returns
    -------
    tuple of LevelPlan
        From the lowest up: by the levels' numbers, or in the order in which the file has
        them where one is no number.

    Raises
    ------
    InputError
        When it cannot be read.
    """
    options = _Options(frame, scale, origin, class_property, parse_classes(classes), name_property)
    drawing = _Drawing.of(path, options)
    names = drawing.levels or (None,)
    return gather_levels(
        (name or drawing.own_level or "", ordinal, functools.partial(drawing.with_stairs, name))
        for name, ordinal in zip(names, _ordinals(names), strict=True)
    )


def _ordinals(names: Sequence[str | None]) -> list[float]:
    """Return the numbers of levels; their places in the file where one has none."""
    numbers = [parse_number(name or "0") for name in names]
    known = [number for number in numbers if number is not None and abs(number) < _MOST_LEVELS]
    return known if len(known) == len(names) else [float(k) for k in range(len(names))]


def _choose(level: str | None, known: Sequence[str], what: str) -> str | None:
    """Return the level to read: the one that was asked for, or the only one."""
    if level is None and len(known) > 1:
        raise InputError(
            what, expected="one level", got=f"levels {', '.join(sorted(known))}",
            fix="choose one with the option level=NAME",
        )  # fmt: skip
    if level is not None and level not in known:
        listed = ", ".join(sorted(known)) or "no feature with a level"
        raise InputError(f"{what}, option level", expected=f"one of {listed}", got=brief(level))
    return level if level is not None else next(iter(known), None)


class _Options(NamedTuple):
    """What a user may say of the file; see `read_plan_geojson`."""

    frame: _FRAME
    scale: float
    origin: tuple[float, float] | None
    class_property: str | None
    words: Mapping[str, Role]
    name_property: str | None


@dataclass(frozen=True)
class _Drawing:
    """The features of a file, and how its plans are to be made."""

    path: StrPath
    document: Any
    features: Sequence[Feature]
    to_map: ToMap
    origin: Origin | None
    options: _Options

    @classmethod
    def of(cls, path: StrPath, options: _Options) -> _Drawing:
        """Read a file."""
        check_scale(options.scale, f"{path}, option scale")
        document = load_json(path, _EXPECTED)
        features = list(parse_features(document, str(path)))
        if not any(feature.lines or feature.rings for feature in features):
            raise FormatError(str(path), expected=_EXPECTED, got="no line and no area")
        to_map, origin = _frame(features, options, document)
        return cls(path, document, features, to_map, origin, options)

    @cached_property
    def levels(self) -> tuple[str, ...]:
        """Names of the levels, in the order of the file."""
        return tuple(dict.fromkeys(name for each in self.features for name in levels_of(each)))

    @property
    def own_level(self) -> str | None:
        """What the file as a whole says of its level."""
        known = self.document.get("level") if isinstance(self.document, dict) else None
        return None if known is None else str(known)

    @property
    def name(self) -> str:
        """What to call its plans."""
        from palms.io.plan_csv import plan_name

        named = self.document.get("name") if isinstance(self.document, dict) else None
        return named if isinstance(named, str) and named else plan_name(_without_gz(self.path))

    def with_stairs(self, level: str | None) -> tuple[FloorPlan, tuple[Stairs, ...]]:
        """Return the plan of a level, and the areas of it that are stairs or lifts."""
        return self.plan(level), tuple(self._stairs(level))

    def _stairs(self, level: str | None) -> Iterator[Stairs]:
        from palms.building import Stairs

        for each in self.features:
            words = [each.properties.get(key) for key in self._stairs_keys]
            word = next((str(word) for word in words if is_stairs_word(word)), None)
            if word and level in (levels_of(each) or (level,)):
                for ring in (ring for ring in each.rings if len(ring) > 3):
                    name = each.properties.get(self.options.name_property or "name") or word
                    yield Stairs(str(name), self.to_map(ring)[:-1])

    @property
    def _stairs_keys(self) -> tuple[str, ...]:
        own = self.options.class_property
        return (*CLASS_KEYS, *_STAIRS_KEYS, *(() if own is None else (own,)))

    def plan(self, level: str | None) -> FloorPlan:
        """Return the plan of a level; features without a level are on all of them."""
        here = [each for each in self.features if level in (levels_of(each) or (level,))]
        options = self.options
        names = (options.name_property,) if options.name_property else _NAME_KEYS
        sorter = Sorter(options.class_property or class_key(here), options.words, names)
        parts = sorter.sort(here, self.to_map, str(self.path))
        shown = self.own_level if level is None else level
        return parts.build(self.path, self.name, shown, self.origin)


def _without_gz(path: StrPath) -> Path:
    place = Path(path)
    return place.with_suffix("") if place.suffix.lower() == ".gz" else place


def _frame(
    features: Sequence[Feature],
    options: _Options,
    document: Any,  # noqa: ANN401
) -> tuple[ToMap, Origin | None]:
    """Return what turns coordinates into metres of the map, and the map's origin."""
    points = np.concatenate([p for f in features for p in (*f.lines, *f.rings)])
    low, high = points.min(axis=0), points.max(axis=0)
    span, frame = float((high - low).max()), options.frame
    on_earth = bool((np.abs(low) <= 360).all() and np.abs([low[1], high[1]]).max() <= 89.9)
    if frame == "metres" or (frame == "auto" and not (on_earth and span < _LONLAT_SPAN)):
        stated = document.get("origin") if isinstance(document, dict) else None
        stated = tuple(stated) if isinstance(stated, list) and len(stated) == 2 else None
        place = options.origin or stated
        known = None if place is None else Origin(*(float(v) for v in place))
        return (lambda each: each * options.scale), known
    if not on_earth:
        raise InputError(
            "option frame=lonlat", expected="degrees", got=f"coordinates up to {high.max():g}"
        )
    lon, lat = options.origin or (round(float(v), 7) for v in (low + high) / 2)
    centre = Origin(lon, lat)
    return centre.to_local, centre


def write_plan_geojson(plan: FloorPlan, path: StrPath) -> None:
    """Write a floor plan as GeoJSON: a LineString for each segment, a Polygon for each room.

    Coordinates are longitude and latitude where the plan knows its origin, else local metres.

    Raises
    ------
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_plan_geojson(FloorPlan([[[0, 0], [8, 0]]]), f"{folder}/a.geojson")
    ...     read_plan_geojson(f"{folder}/a.geojson").segments_m.tolist()
    [[[0.0, 0.0], [8.0, 0.0]]]
    """

    def place(points: FloatArray) -> list[list[float]]:
        if plan.origin is None:
            return points.round(4).tolist()  # type: ignore[no-any-return]
        return plan.origin.to_lonlat(points).round(9).tolist()  # type: ignore[no-any-return]

    def feature(kind: str, coordinates: list[Any], **properties: str) -> dict[str, Any]:
        geometry = {"type": kind, "coordinates": coordinates}
        return {"type": "Feature", "properties": properties, "geometry": geometry}

    words = [SegmentClass(c).name.lower() for c in plan.classes.tolist()]
    features = [
        feature("LineString", place(segment), type=word)
        for segment, word in zip(plan.segments_m, words, strict=True)
    ]
    for room in plan.rooms:
        ring = place(np.concatenate([room.polygon_m, room.polygon_m[:1]]))
        features.append(feature("Polygon", [ring], type="room", name=room.name))
    if plan.outline_m is not None and len(plan.outline_m):
        ring = place(np.concatenate([plan.outline_m, plan.outline_m[:1]]))
        features.append(feature("Polygon", [ring], type="outline"))
    known: dict[str, Any] = {"name": plan.name}
    if plan.level is not None:
        known["level"] = plan.level
    if str(path).lower().endswith(".gz"):
        raise OutputError(str(path), expected="a name that ends in .geojson", got=".gz")
    write_json(path, {"type": "FeatureCollection", **known, "features": features})


def _recognizes(path: Path) -> bool:
    start = head(path)
    if start[:2] == b"\x1f\x8b":
        return path.name.lower().endswith(tuple(f"{each}.gz" for each in (".geojson", ".json")))
    if sniff(start) != "JSON":
        return False
    kinds = (b"FeatureCollection", b"LineString", b"Polygon", b'"Feature"', b"GeometryCollection")
    return start.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{" and any(k in start for k in kinds)


FORMAT = Format(
    name="geojson",
    description="lines and areas, lon/lat or metres, class by property",
    suffixes=(".geojson", ".geojson.gz"),
    recognizes=_recognizes,
    read=read_plan_geojson,
    write=write_plan_geojson,
    read_levels=read_levels_geojson,
)
