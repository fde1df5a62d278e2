"""GeoJSON as such: features with their lines, rings and properties, whatever they mean."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.files import read_bytes, sniff
from palms.io.packed import unzipped
from palms.io.values import StrPath, brief, check_array

__all__ = ["Feature", "load_json", "parse_features", "parse_json"]

_EXPECTED = "a GeoJSON FeatureCollection of walls, doors and rooms"
_NESTING = {"LineString": 0, "MultiLineString": 1, "Polygon": 1, "MultiPolygon": 2}
_DEPTH = 8  # ours: of geometry collections in each other


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
