"""What formats of geographic information systems share: layers of features with attributes.

A feature's class comes from an attribute, or else from the name of its layer. Coordinates are
degrees, or those of a coordinate system that the file names, or local metres.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from palms.errors import FormatError, InputError
from palms.floorplan import FloorPlan
from palms.geodesy import Origin
from palms.geometry import FloatArray
from palms.io.geojson import Feature
from palms.io.plan_csv import plan_name
from palms.io.plan_features import Sorter, class_key
from palms.io.plan_parts import check_scale
from palms.io.plan_words import parse_classes, role_of
from palms.io.values import StrPath, brief, locating
from palms.repair import merge

__all__ = ["Choice", "Layer", "plan_of_layers"]

_NAME_KEYS = ("name", "ref", "roomnumber", "room_number", "room", "label", "number")
_LEVEL_KEYS = ("level", "floor", "storey", "story", "level_id", "floor_id")
_LONLAT_SPAN = 0.5  # ours: no building is half a degree wide, and none half a metre
_DEGREES = re.compile(r"^\s*(GEOGCS|GEOGCRS|GEODCRS)\b", re.IGNORECASE)
_LIKE_WGS84 = re.compile(r"WGS[ _]?(19)?84|CRS:?84|ETRS[ _]?(19)?89|NAD[ _]?(19)?83", re.IGNORECASE)
_LOCAL = re.compile(r"^\s*(LOCAL_CS|ENGCRS|ENGINEERINGCRS)\b", re.IGNORECASE)
_WGS84 = ("epsg:4326", "ogc:crs84", "wgs84")
_ON_EARTH_DEG = (360.0, 89.9)


class Layer(NamedTuple):
    """Features of one table or file.

    Parameters
    ----------
    name : str
    features : sequence of Feature
        Properties hold the attributes.
    crs : str
        Its coordinate system as text, such as WKT or ``EPSG:25832``; empty when not known,
        ``local`` for metres of no place.
    """

    name: str
    features: Sequence[Feature]
    crs: str


class Choice(NamedTuple):
    """What a user says of a file of layers; see `palms.io.plan_gpkg.read_plan_gpkg`."""

    layers: str | None = None
    where: str | None = None
    level: str | None = None
    class_property: str | None = None
    classes: str | None = None
    name_property: str | None = None
    crs: str | None = None
    scale: float = 1.0
    origin: tuple[float, float] | None = None


def plan_of_layers(layers: Sequence[Layer], choice: Choice, path: StrPath) -> FloorPlan:
    """Return the floor plan of layers of features.

    Raises
    ------
    InputError
        When a layer, level or attribute that was asked for is not there, several levels are and
        none is named, or there is no wall.
    """
    check_scale(choice.scale, f"{path}, option scale")
    chosen = _of_names(layers, choice.layers, str(path))
    everything = [f for layer in chosen for f in _where(_worded(layer), choice.where, str(path))]
    everything = [each for each in everything if each.lines or each.rings]
    if not everything:
        listed = ", ".join(f"{each.name} ({len(each.features)})" for each in layers[:12])
        raise FormatError(
            str(path), expected="lines or areas in its layers", got=listed or "no layers",
            fix="choose with the options layers=NAME,NAME and where=ATTRIBUTE:VALUE",
        )  # fmt: skip
    features, level = _of_level(everything, choice.level, str(path))
    with locating(path):
        systems = sorted({layer.crs for layer in chosen if layer.features})
        to_map, place = _frame(everything, choice, systems, str(path))
    key = choice.class_property or class_key(features)
    names = (choice.name_property,) if choice.name_property else _NAME_KEYS
    parts = Sorter(key, parse_classes(choice.classes), names).sort(features, to_map, str(path))
    plan, _ = merge(parts.build(path, plan_name(path), level, place))
    return plan  # of edges that two rooms share, one is left


def _of_names(layers: Sequence[Layer], wanted: str | None, what: str) -> Sequence[Layer]:
    names = [name.strip() for name in (wanted or "").split(",") if name.strip()]
    missing = [name for name in names if name not in {layer.name for layer in layers}]
    if missing:
        known = ", ".join(layer.name for layer in layers[:30])
        raise InputError(
            f"{what}, option layers", expected=f"some of {known}", got=brief(missing[0])
        )
    return [layer for layer in layers if not names or layer.name in names]


def _worded(layer: Layer) -> list[Feature]:
    """Return the features of a layer with keys in lower case, and the layer's word for them."""
    tokens = [layer.name, *reversed(re.split(r"[\W_\d]+", layer.name))]  # level_1_doors: doors
    word = next((token for token in tokens if role_of(token) is not None), layer.name)
    features = []
    for each in layer.features:
        values = {key.lower(): value for key, value in each.properties.items()}
        features.append(each._replace(properties={"layer": word, **values}))
    return features


def _text(value: object) -> str:
    """Return a value as a person writes it: 2.0 is 2."""
    return f"{value:g}" if isinstance(value, float) else str(value).strip()


def _where(features: Sequence[Feature], condition: str | None, what: str) -> Sequence[Feature]:
    """Return the features whose attribute has a value, as ``floor:2``."""
    if condition is None:
        return features
    key, colon, wanted = (part.strip() for part in condition.partition(":"))
    if not key or not colon:
        raise InputError(f"{what}, option where", expected="ATTRIBUTE:VALUE", got=brief(condition))
    return [each for each in features if _text(each.properties.get(key.lower())) == wanted]


def _of_level(
    features: Sequence[Feature], wanted: str | None, what: str
) -> tuple[Sequence[Feature], str | None]:
    """Return the features of one level; those without a level are on all."""

    def level_of(feature: Feature) -> str:
        found = (feature.properties.get(key) for key in _LEVEL_KEYS)
        return next((_text(each) for each in found if each not in (None, "")), "")

    levels = sorted({level_of(each) for each in features} - {""})
    if wanted is None and len(levels) > 1:
        raise InputError(
            what, expected="one level", got=f"levels {', '.join(levels[:50])}",
            fix="choose one with the option level=NAME",
        )  # fmt: skip
    if wanted is not None and wanted not in levels:
        known = ", ".join(levels[:50]) or "no feature with a level"
        raise InputError(f"{what}, option level", expected=f"one of {known}", got=brief(wanted))
    chosen = wanted if wanted is not None else next(iter(levels), None)
    return [each for each in features if level_of(each) in ("", chosen)], chosen


def _points(features: Sequence[Feature]) -> Iterator[FloatArray]:
    for each in features:
        yield from each.lines
        yield from each.rings


def _frame(
    features: Sequence[Feature], choice: Choice, systems: Sequence[str], what: str
) -> tuple[Callable[[FloatArray], FloatArray], Origin | None]:
    """Return what turns coordinates into metres of the map, and the map's origin."""
    points = np.concatenate(list(_points(features)))
    low, high = points.min(axis=0), points.max(axis=0)
    crs = choice.crs if choice.crs is not None else systems[0]
    if choice.crs is None and len(systems) > 1:
        raise FormatError(
            what, expected="one coordinate system", got=f"{len(systems)} of them",
            fix="choose layers of one with the option layers=NAME,NAME",
        )  # fmt: skip
    on_earth = bool((np.abs([low, high]) <= _ON_EARTH_DEG).all())
    if not crs:
        narrow = float((high - low).max()) < _LONLAT_SPAN
        crs = "epsg:4326" if on_earth and narrow else "local"
    if crs.lower() == "local" or _LOCAL.match(crs):
        known = None if choice.origin is None else Origin(*choice.origin)
        return (lambda each: each * choice.scale), known
    if crs.lower() in _WGS84 or (_DEGREES.match(crs) and _LIKE_WGS84.search(crs)):
        if not on_earth:
            raise FormatError(
                what, expected="degrees", got=f"coordinates up to {np.abs([low, high]).max():g}",
                fix="name its coordinate system with the option crs=EPSG:NUMBER, or crs=local",
            )  # fmt: skip
        lon, lat = choice.origin or (round(float(v), 7) for v in (low + high) / 2)
        place = Origin(lon, lat)
        return place.to_local, place
    return _projected(crs, (low + high) / 2, choice.origin, what)


def _projected(
    crs: str, middle: FloatArray, origin: tuple[float, float] | None, what: str
) -> tuple[Callable[[FloatArray], FloatArray], Origin]:
    """Return the frame of a coordinate system that needs pyproj."""
    import pyproj

    try:
        transform = pyproj.Transformer.from_crs(crs, "EPSG:4326", always_xy=True).transform
        lon, lat = origin or (round(float(v), 7) for v in transform(*middle))
    except pyproj.exceptions.ProjError as error:
        raise FormatError(
            what, expected="a coordinate system that is known", got=brief(str(error), 80),
            fix="name it with the option crs=EPSG:NUMBER, or crs=local for plain metres",
        ) from None  # fmt: skip
    if not np.isfinite([lon, lat]).all():
        raise FormatError(
            what, expected="places in its coordinate system", got=f"{middle.tolist()}",
            fix="name the right one with the option crs=EPSG:NUMBER, or crs=local",
        )  # fmt: skip
    place = Origin(lon, lat)
    return (lambda each: place.to_local(np.column_stack(transform(*each.T)))), place
