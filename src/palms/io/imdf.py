"""IMDF as such: the features of a venue by their kind, and the names of its levels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from palms.errors import FormatError, InputError
from palms.geodesy import Origin
from palms.io.archives import member_names, read_members
from palms.io.geojson import Feature, parse_features, parse_json
from palms.io.packed import unzipped
from palms.io.values import StrPath, locating

__all__ = ["Item", "Venue", "is_imdf", "ordinal", "text_in"]

_TYPES = ("level", "unit", "opening", "fixture", "kiosk", "building", "anchor", "occupant")
_NEEDED = ("level", "unit")
_MOST_LEVELS = 1000  # ours: higher ordinals are damage


class Item(NamedTuple):
    """A feature with its identity, as IMDF has it beside the properties."""

    id: str
    feature: Feature

    def get(self, key: str) -> Any:  # noqa: ANN401
        """Return a property; None when there is none."""
        return self.feature.properties.get(key)


@dataclass(frozen=True)
class Venue:
    """What an archive holds, the language of its names, and where its map's (0, 0) lies."""

    path: StrPath
    items: Mapping[str, Sequence[Item]]
    origin: Origin
    language: str | None

    @classmethod
    def of(cls, path: StrPath, language: str | None, origin: tuple[float, float] | None) -> Venue:
        """Read an archive; the origin is the middle of all its levels when left out."""
        items = _load(path)
        rings = [ring for each in items["level"] for ring in each.feature.rings]
        corners = np.concatenate(rings) if rings else np.empty((0, 2))
        if not len(corners):
            raise FormatError(f"{path}, level", expected="areas", got="none")
        middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
        lon, lat = origin or (round(float(v), 7) for v in middle)
        with locating(path):
            return cls(path, items, Origin(lon, lat), language)

    @cached_property
    def buildings(self) -> dict[str, Any]:
        """Names of the buildings by their id."""
        return {each.id: each.get("name") for each in self.items["building"]}

    def title(self, level: Item) -> str:
        """Return what to call a level."""
        return text_in(level.get("name"), self.language) or _ordinal(level)

    def owner(self, level: Item) -> str:
        """Return the name of a level's building; several between commas."""
        names = (text_in(self.buildings.get(each), self.language) for each in _ids(level))
        return ", ".join(filter(None, names))

    def levels(self, level: str | None, building: str | None) -> list[Item]:
        """Return the levels of some name, ordinal or id, and of some building, lowest first.

        Raises
        ------
        InputError
            When there is none; the message lists them.
        """
        fitting = [
            each for each in self.items["level"]
            if (level is None or level in _names(each))
            and (building is None or building in _owners(each, self.buildings))
        ]  # fmt: skip
        if not fitting:
            raise self._not_one(fitting, level, building)
        return sorted(fitting, key=ordinal)

    def level(self, level: str | None, building: str | None) -> Item:
        """Return the one level that fits; see `levels`."""
        fitting = self.levels(level, building)
        if len(fitting) > 1:
            raise self._not_one(fitting, level, building)
        return fitting[0]

    def _not_one(
        self, fitting: Sequence[Item], level: str | None, building: str | None
    ) -> InputError:
        shown = "; ".join(
            f"{text_in(each.get('name'), self.language) or 'no name'} (ordinal {_ordinal(each)}, "
            f"{self.owner(each) or 'no building'}, id {each.id})"
            for each in (fitting or self.items["level"])[:20]
        )
        wanted = {"level": level, "building": building}
        asked = ", ".join(f"{key}={value!r}" for key, value in wanted.items() if value)
        return InputError(
            f"{self.path}, option level",
            expected=f"one of {shown}",
            got=asked if not fitting else f"{len(fitting)} that fit{' ' + asked if asked else ''}",
            fix="choose with the options level=NAME, ordinal or id, and building=NAME",
        )


def _members() -> dict[str, str]:
    endings = (".geojson", ".geojson.gz", ".json", ".json.gz")
    return {f"{kind}{ending}": kind for kind in _TYPES for ending in endings}


def _load(path: StrPath) -> dict[str, list[Item]]:
    contents = read_members(path, _members())
    missing = [f"{kind}.geojson" for kind in _NEEDED if kind not in contents]
    if missing:
        raise FormatError(
            str(path), expected="IMDF with level.geojson and unit.geojson",
            got=f"no {' and no '.join(missing)}", fix="check that it is the whole archive",
        )  # fmt: skip
    items: dict[str, list[Item]] = {kind: [] for kind in _TYPES}
    for kind, content in contents.items():
        what = f"{path}, {kind}"
        collection = parse_json(unzipped(content, what), what, "a GeoJSON FeatureCollection")
        listed = collection.get("features") if isinstance(collection, dict) else None
        features = parse_features(collection, what)
        ids = [each.get("id") for each in listed] if isinstance(listed, list) else []
        items[kind] = [Item(str(i), f) for f, i in zip(features, _padded(ids), strict=False)]
    return items


def _padded(ids: Sequence[Any]) -> list[Any]:
    return [*ids, None]


def text_in(name: object, language: str | None) -> str:
    """Return a name in a language; in the first when the one asked for is missing.

    Examples
    --------
    >>> text_in({"en": "Museum", "fr": "Musée"}, "fr"), text_in(None, "fr")
    ('Musée', '')
    """
    if isinstance(name, str):
        return name.strip()
    if not isinstance(name, dict):
        return ""
    texts = {k: v.strip() for k, v in name.items() if isinstance(v, str) and v.strip()}
    return texts.get(language or "", next(iter(texts.values()), ""))


def _ordinal(level: Item) -> str:
    value = level.get("ordinal")
    return f"{value:g}" if isinstance(value, int | float) else ""


def ordinal(level: Item) -> float:
    """Return the number by which a level is in order; 0 when it has none."""
    value = level.get("ordinal")
    return float(value) if isinstance(value, int | float) and abs(value) < _MOST_LEVELS else 0.0


def _texts(name: object) -> set[str]:
    """All languages of a name."""
    texts = name.values() if isinstance(name, dict) else [name]
    return {text.strip() for text in texts if isinstance(text, str)} - {""}


def _names(level: Item) -> set[str]:
    names = _texts(level.get("name")) | _texts(level.get("short_name"))
    return names | {level.id, _ordinal(level)}


def _ids(level: Item) -> list[str]:
    ids = level.get("building_ids")
    return [each for each in ids if isinstance(each, str)] if isinstance(ids, list) else []


def _owners(level: Item, buildings: Mapping[str, Any]) -> set[str]:
    """Ids and names of the buildings of a level."""
    ids = _ids(level)
    return set(ids).union(*(_texts(buildings.get(each)) for each in ids))


def is_imdf(path: Path) -> bool:
    """Whether a zip archive or folder has the files of a venue.

    Examples
    --------
    >>> is_imdf(Path("no such folder"))
    False
    """
    kinds = {_members().get(name.lower().rpartition("/")[2]) for name in member_names(path)}
    return kinds.issuperset(_NEEDED)
