"""What an OpenStreetMap file holds: nodes, ways and relations with their tags, and levels."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.values import StrPath, brief, parse_number
from palms.io.xml_events import parse_xml

__all__ = ["Area", "Node", "OsmFile", "Way", "load_osm", "parse_levels"]

_MOST_LEVELS = 300  # ours: the tallest building has 163
_RANGE = re.compile(r"(-?\d+(?:\.\d+)?)\s*-\s*(-?\d+(?:\.\d+)?)$")
Tags = Mapping[str, str]


class Node(NamedTuple):
    """A node with tags, such as a door."""

    id: int
    tags: Tags


class Way(NamedTuple):
    """A line through nodes."""

    id: int
    refs: tuple[int, ...]
    tags: Tags

    @property
    def is_ring(self) -> bool:
        """Whether it ends where it begins."""
        return len(self.refs) > 3 and self.refs[0] == self.refs[-1]


class Area(NamedTuple):
    """A closed way, or the rings of a multipolygon: refs of each, the outer ones first."""

    id: int
    rings: tuple[tuple[int, ...], ...]
    tags: Tags


def parse_levels(tags: Tags) -> frozenset[float]:
    """Return the levels that an element is on: lists and ranges, negative and half ones.

    Examples
    --------
    >>> sorted(parse_levels({"level": "-1;2", "repeat_on": "4-6"}))
    [-1.0, 2.0, 4.0, 5.0, 6.0]
    >>> sorted(parse_levels({"level": "-2--1"})), sorted(parse_levels({"level": "mezzanine"}))
    ([-2.0, -1.0], [])
    """
    text = f"{tags.get('level', '')};{tags.get('repeat_on', '')}".replace(",", ";")
    return frozenset(level for part in text.split(";") for level in _span(part.strip()))


def _span(part: str) -> Iterator[float]:
    found = _RANGE.match(part)
    if found is None:
        number = parse_number(part) if part else None
        if number is not None and math.isfinite(number):
            yield number
        return
    low, high = sorted(float(each) for each in found.groups())
    for k in range(min(int(high - low) + 1, _MOST_LEVELS)):
        yield low + k


@dataclass
class OsmFile:
    """The elements of a file that are there and not deleted."""

    what: str
    places: dict[int, tuple[float, float]] = field(default_factory=dict)  # lon, lat
    nodes: list[Node] = field(default_factory=list)
    ways: dict[int, Way] = field(default_factory=dict)
    relations: list[tuple[int, list[tuple[int, str]], Tags]] = field(default_factory=list)

    def lonlat(self, refs: Sequence[int]) -> FloatArray:
        """Longitude and latitude (N, 2) of nodes; those that the file lacks are left out."""
        known = [self.places[ref] for ref in refs if ref in self.places]
        return np.array(known, dtype=np.float64).reshape(-1, 2)

    def areas(self) -> Iterator[Area]:
        """Yield closed ways, and multipolygons whose rings close."""
        for way in self.ways.values():
            if way.is_ring:
                yield Area(way.id, (way.refs,), way.tags)
        for identity, members, tags in self.relations:
            if tags.get("type") == "multipolygon":
                rings = [
                    ring
                    for inner in (False, True)
                    for ring in _rings([
                        self.ways[ref].refs for ref, role in members
                        if ref in self.ways and (role == "inner") is inner
                    ])
                ]  # fmt: skip
                if rings:
                    yield Area(identity, tuple(rings), tags)


def _rings(lines: Sequence[tuple[int, ...]]) -> Iterator[tuple[int, ...]]:
    """Join lines end to end into rings; those that stay open are left out."""
    left = {i: line for i, line in enumerate(lines) if len(line) > 1}
    ending: defaultdict[int, list[int]] = defaultdict(list)
    for i, line in left.items():
        ending[line[0]].append(i)
        ending[line[-1]].append(i)
    while left:
        ring = list(left.popitem()[1])
        while ring[0] != ring[-1]:
            here = ending[ring[-1]]
            while here and here[-1] not in left:
                here.pop()
            if not here:
                break
            line = left.pop(here.pop())
            ring += line[1:] if line[0] == ring[-1] else line[-2::-1]
        if ring[0] == ring[-1] and len(ring) > 3:
            yield tuple(ring)


class _Gatherer:
    """Takes the events of an OSM file."""

    def __init__(self, what: str) -> None:
        self.file = OsmFile(what)
        self.identity: int | None = None
        self.tags: dict[str, str] = {}
        self.refs: list[int] = []
        self.members: list[tuple[int, str]] = []

    def start(self, name: str, attributes: Mapping[str, str]) -> None:
        if name in ("node", "way", "relation"):
            self._begin(name, attributes)
        elif self.identity is None:
            return
        elif name == "tag":
            self.tags[attributes.get("k", "")] = attributes.get("v", "").strip()
        elif name == "nd":
            self.refs.append(self._number(attributes, "ref"))
        elif name == "member" and attributes.get("type") == "way":
            self.members.append((self._number(attributes, "ref"), attributes.get("role", "")))

    def _begin(self, name: str, attributes: Mapping[str, str]) -> None:
        self.tags, self.refs, self.members = {}, [], []
        gone = attributes.get("action") == "delete" or attributes.get("visible") == "false"
        self.identity = None if gone else self._number(attributes, "id")
        if name == "node" and self.identity is not None:
            place = [parse_number(attributes.get(key, "")) for key in ("lon", "lat")]
            lon, lat = (math.nan if each is None else each for each in place)
            if not (abs(lon) <= 360 and abs(lat) <= 89.9):
                raise FormatError(
                    f"{self.file.what}, node {self.identity}", expected="lon and lat in degrees",
                    got=f"{attributes.get('lon')}, {attributes.get('lat')}",
                )  # fmt: skip
            self.file.places[self.identity] = (lon, lat)

    def _number(self, attributes: Mapping[str, str], key: str) -> int:
        text = attributes.get(key, "")
        if not re.fullmatch(r"-?\d{1,19}", text):
            raise FormatError(
                self.file.what, expected=f"whole numbers as {key} of nodes, ways and members",
                got=brief(text),
            )  # fmt: skip
        return int(text)

    def end(self, name: str) -> None:
        if self.identity is None or name not in ("node", "way", "relation"):
            return
        if name == "node" and self.tags:
            self.file.nodes.append(Node(self.identity, self.tags))
        elif name == "way":
            self.file.ways[self.identity] = Way(self.identity, tuple(self.refs), self.tags)
        elif name == "relation":
            self.file.relations.append((self.identity, self.members, self.tags))
        self.identity = None

    def text(self, text: str) -> None:
        """Let white space between elements go."""


def load_osm(path: StrPath) -> OsmFile:
    """Read the elements of an OSM XML file.

    Raises
    ------
    FormatError
        When it is not whole XML of OpenStreetMap.
    """
    gatherer = _Gatherer(str(path))
    parse_xml(path, "osm", gatherer)
    return gatherer.file
