"""Floor plans as GeoJSON: lines and areas in longitude and latitude, or in local metres.

A property names what each feature is (see `palms.io.plan_words`). Where the file names walls,
areas are rooms and only rooms; where it names none, the edges of areas are the walls.
"""

from __future__ import annotations

import json
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from palms.errors import FormatError, InputError, OutputError, PalmsWarning
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geodesy import Origin
from palms.geometry import FloatArray
from palms.io.files import head, read_bytes, sniff, write_json
from palms.io.packed import unzipped
from palms.io.plan_parts import PlanParts, check_scale, middle_line, segments_along
from palms.io.plan_words import Role, parse_classes, role_of
from palms.io.registry import Format
from palms.io.values import StrPath, brief, check_array, locating

__all__ = ["FORMAT", "Feature", "parse_features", "read_plan_geojson", "write_plan_geojson"]

_EXPECTED = "a GeoJSON FeatureCollection of walls, doors and rooms"
_CLASS_KEYS = ("class", "type", "kind", "category", "indoor", "feature_type", "layer")
_NAME_KEYS = ("name", "ref", "roomnumber", "room", "label")
_LONLAT_SPAN = 0.5  # ours: no building is half a degree wide, and none half a metre
_REACH_M = 0.3  # ours: a door's line may lie that far from the wall's
_NESTING = {"LineString": 0, "MultiLineString": 1, "Polygon": 1, "MultiPolygon": 2}
_DEPTH = 8  # ours: of geometry collections in each other
_FRAME = Literal["auto", "lonlat", "metres"]


class Feature(NamedTuple):
    """Lines and rings of a feature, each points (N, 2), with its properties."""

    lines: tuple[FloatArray, ...]
    rings: tuple[FloatArray, ...]
    properties: Mapping[str, Any]


def load_json(path: StrPath, expected: str) -> Any:  # noqa: ANN401
    """Return what a JSON file holds, packed by gzip or not."""
    return parse_json(unzipped(read_bytes(path), str(path)), str(path), expected)


def parse_json(content: bytes, what: str, expected: str) -> Any:  # noqa: ANN401
    """Return what JSON in UTF-8 holds, or say in one line what is wrong."""
    if not content.strip():
        raise FormatError(what, expected=expected, got="an empty file")
    try:
        return json.loads(content.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        kind = sniff(content[:1000])
        got = brief(str(error), 80) if kind == "JSON" else kind
        raise FormatError(
            what, expected=expected, got=got, fix="it may be cut off or of another format"
        ) from None


def parse_features(collection: object, what: str) -> Iterator[Feature]:
    """Yield lines and rings of the features of a collection, a feature or a bare geometry.

    Raises
    ------
    FormatError
        When it is no GeoJSON, or coordinates are no finite numbers.

    Examples
    --------
    >>> line = {"type": "LineString", "coordinates": [[0, 0], [4, 0, 7]]}
    >>> [feature.lines[0].tolist() for feature in parse_features(line, "a.geojson")]
    [[[0.0, 0.0], [4.0, 0.0]]]
    """
    kind = collection.get("type") if isinstance(collection, dict) else None
    if kind == "FeatureCollection" and isinstance(collection, dict):
        features = collection.get("features")
    elif kind == "Feature":
        features = [collection]
    else:
        features = [{"type": "Feature", "properties": {}, "geometry": collection}]
    if not isinstance(features, list):
        raise FormatError(what, expected=_EXPECTED, got=brief(features))
    for index, feature in enumerate(features):
        where = f"{what} feature {index}"
        if not isinstance(feature, dict):
            raise FormatError(where, expected="a GeoJSON Feature", got=brief(feature))
        properties = feature.get("properties")
        lines, rings = _geometry(feature.get("geometry"), where, _DEPTH)
        known = properties if isinstance(properties, dict) else {}
        yield Feature(tuple(lines), tuple(rings), known)


def _geometry(geometry: Any, what: str, depth: int) -> tuple[list[FloatArray], list[FloatArray]]:  # noqa: ANN401
    """Lines and rings of a geometry."""
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind == "GeometryCollection" and depth:
        parts = _listed(geometry.get("geometries"), what)
        found = [_geometry(each, what, depth - 1) for each in parts]
        return [a for lines, _ in found for a in lines], [r for _, rings in found for r in rings]
    if geometry is None or kind in ("Point", "MultiPoint"):
        return [], []
    if kind not in _NESTING:
        raise FormatError(what, expected="a GeoJSON geometry", got=brief(kind or geometry))
    found_lines = [geometry.get("coordinates")]
    for _ in range(_NESTING[kind]):
        found_lines = [line for each in found_lines for line in _listed(each, what)]
    lines = [_points(line, what) for line in found_lines]
    return (lines, []) if kind.endswith("LineString") else ([], lines)


def _listed(value: object, what: str) -> list[Any]:
    if not isinstance(value, list):
        raise FormatError(what, expected="nested lists of coordinates", got=brief(value))
    return value


def _points(value: object, what: str) -> FloatArray:
    """Points (N, 2); heights are dropped."""
    flat = [point[:2] if isinstance(point, list) else point for point in _listed(value, what)]
    return check_array(flat, f"{what}, coordinates", (None, 2))


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
        Of the features that have a property ``level``, those to take.

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
    from palms.io.plan_csv import plan_name

    check_scale(scale, f"{path}, option scale")
    document = load_json(path, _EXPECTED)
    every = list(parse_features(document, str(path)))
    if not any(feature.lines or feature.rings for feature in every):
        raise FormatError(str(path), expected=_EXPECTED, got="no line and no area")
    features, level = _of_level(every, level, str(path))
    to_map, known = _frame(every, frame, scale, origin, document)
    words = parse_classes(classes)
    key = class_property or _class_key(features)
    names = (name_property,) if name_property else _NAME_KEYS
    parts = _Sorter(key, words, names).sort(features, to_map, str(path))
    named = document.get("name") if isinstance(document, dict) else None
    title = named if isinstance(named, str) and named else plan_name(_without_gz(path))
    if level is None and isinstance(document, dict) and document.get("level") is not None:
        level = str(document["level"])
    return parts.build(path, title, level, known)


def _without_gz(path: StrPath) -> Path:
    place = Path(path)
    return place.with_suffix("") if place.suffix.lower() == ".gz" else place


def _of_level(
    features: Sequence[Feature], level: str | None, what: str
) -> tuple[list[Feature], str | None]:
    """Features of one level; those without a level are on all of them."""
    levels = Counter(
        str(value) for f in features if (value := f.properties.get("level")) not in (None, "")
    )
    if level is None and len(levels) > 1:
        raise InputError(
            what, expected="one level", got=f"levels {', '.join(sorted(levels))}",
            fix="choose one with the option level=NAME",
        )  # fmt: skip
    if level is not None and level not in levels:
        known = ", ".join(sorted(levels)) or "no feature with a level"
        raise InputError(f"{what}, option level", expected=f"one of {known}", got=brief(level))
    chosen = level if level is not None else next(iter(levels), None)
    return [f for f in features if str(f.properties.get("level") or chosen) == str(chosen)], chosen


def _frame(
    features: Sequence[Feature],
    frame: _FRAME,
    scale: float,
    origin: tuple[float, float] | None,
    document: Any,  # noqa: ANN401
) -> tuple[Any, Origin | None]:
    """Return what turns coordinates into metres of the map, and the map's origin."""
    points = np.concatenate([p for f in features for p in (*f.lines, *f.rings)])
    low, high = points.min(axis=0), points.max(axis=0)
    span = float((high - low).max())
    on_earth = bool((np.abs(low) <= 360).all() and np.abs([low[1], high[1]]).max() <= 89.9)
    if frame == "metres" or (frame == "auto" and not (on_earth and span < _LONLAT_SPAN)):
        stated = document.get("origin") if isinstance(document, dict) else None
        place = origin or (tuple(stated) if isinstance(stated, list) and len(stated) == 2 else None)
        known = None if place is None else Origin(*(float(v) for v in place))
        return (lambda each: each * scale), known
    if not on_earth:
        raise InputError(
            "option frame=lonlat", expected="degrees", got=f"coordinates up to {high.max():g}"
        )
    lon, lat = origin or (round(float(v), 7) for v in (low + high) / 2)
    centre = Origin(lon, lat)
    return centre.to_local, centre


def _class_key(features: Sequence[Feature]) -> str | None:
    """Return the property that names classes: the one most of whose words are known."""
    known = {
        key: sum(role_of(_text(f.properties.get(key))) is not None for f in features)
        for key in _CLASS_KEYS
    }
    best = max(known, key=lambda key: known[key])
    return best if known[best] else None


def _text(value: object) -> str | None:
    return value if isinstance(value, str) else None


class _Sorter(NamedTuple):
    """Sorts features into walls, doors, glass, rooms and outline."""

    class_key: str | None
    words: Mapping[str, Role]
    name_keys: Sequence[str]

    def sort(self, features: Sequence[Feature], to_map: Any, what: str) -> PlanParts:  # noqa: ANN401
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
)
