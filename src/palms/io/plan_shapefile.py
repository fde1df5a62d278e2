"""Floor plans from shapefiles: one, or all of a folder or zip archive, each a layer."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from palms.errors import FormatError
from palms.floorplan import FloorPlan
from palms.io.archives import member_names, read_members
from palms.io.esri_shapefile import SHP_MAGIC, parse_shapefile
from palms.io.files import head, read_bytes, sniff
from palms.io.plan_layers import Choice, Layer, plan_of_layers
from palms.io.registry import Format
from palms.io.values import StrPath

__all__ = ["FORMAT", "read_plan_shapefile"]

_PARTS = ("shp", "dbf", "prj", "cpg")
_EXPECTED = "a shapefile, or a folder or zip archive with some"


def read_plan_shapefile(  # noqa: PLR0913
    path: StrPath,
    *,
    layers: str | None = None,
    where: str | None = None,
    level: str | None = None,
    class_property: str | None = None,
    classes: str | None = None,
    name_property: str | None = None,
    crs: str | None = None,
    scale: float = 1.0,
    origin: tuple[float, float] | None = None,
) -> FloorPlan:
    """Read a floor plan from a shapefile, or from all of a folder or zip archive.

    Parameters
    ----------
    path : path
        The .shp file, with .dbf, .prj and .cpg beside it; or the folder or archive.
    layers : str, optional
        Of a folder or archive: names of files to take, as ``walls,doors``; all when left out.
    where, level, class_property, classes, name_property, crs, scale, origin
        As for `palms.io.plan_gpkg.read_plan_gpkg`.

    Raises
    ------
    InputError
        When it cannot be read, holds several levels and none is named, or no wall.
    """
    choice = Choice(
        layers, where, level, class_property, classes, name_property, crs, scale, origin
    )
    found = _files(path)
    if not found:
        raise FormatError(str(path), expected=_EXPECTED, got="none", fix="name the .shp file")
    several = len(found) > 1 or Path(path).is_dir()
    return plan_of_layers(
        [_layer(name, parts, f"{path}, {name}" if several else str(path))
         for name, parts in found.items()],
        choice, path,
    )  # fmt: skip


def _layer(name: str, parts: Mapping[str, bytes], what: str) -> Layer:
    projection = parts.get("prj", b"").decode("utf-8", "replace").strip()
    return Layer(name, parse_shapefile(parts, what), projection)


def _files(path: StrPath) -> dict[str, dict[str, bytes]]:
    """Return the parts of each shapefile by its name."""
    place = Path(path)
    if not place.is_dir() and head(place, 4)[:2] != b"PK":
        content = read_bytes(place)
        if content[:4] != SHP_MAGIC:
            got = sniff(content[:1000]) if content else "an empty file"
            raise FormatError(str(path), expected=_EXPECTED, got=got,
                              fix="name the .shp file")  # fmt: skip
        beside = {p: place.with_suffix(f".{p}") for p in _PARTS[1:]}
        parts = {p: read_bytes(each) for p, each in beside.items() if each.is_file()}
        return {place.stem: {"shp": content, **parts}}
    names = [PurePosixPath(name.replace("\\", "/")).name for name in member_names(place)]
    stems = [name[:-4] for name in names if name.lower().endswith(".shp")]
    wanted = {f"{stem}.{part}".lower(): f"{stem}.{part}" for stem in stems for part in _PARTS}
    contents = read_members(path, wanted)
    return {
        stem: {part: contents[f"{stem}.{part}"] for part in _PARTS if f"{stem}.{part}" in contents}
        for stem in stems if f"{stem}.shp" in contents
    }  # fmt: skip


def _recognizes(path: Path) -> bool:
    if head(path, 4) == SHP_MAGIC:
        return True
    return any(name.lower().endswith(".shp") for name in member_names(path))


FORMAT = Format(
    name="shapefile",
    description="shapefile, or several in a folder or zip archive",
    suffixes=(".shp", ".zip"),
    recognizes=_recognizes,
    read=read_plan_shapefile,
    extra="gis",
)
