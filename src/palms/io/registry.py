"""Which formats there are, and which of them a file is of.

Readers are found by the entry point groups `palms.floorplans`, `palms.scans` and
`palms.odometry`, so that other packages can add their own. A reader is any object with
``name``, ``description``, ``suffixes``, ``extra``, ``recognizes(path)``,
``read(path, **options)`` and ``write`` (a function, or None); `Format` is ours.
"""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
import os
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

from palms.errors import InputError, OutputError, PalmsWarning
from palms.io.files import head, sniff
from palms.io.values import StrPath

__all__ = [
    "BUILT_IN",
    "FLOORPLANS",
    "ODOMETRY",
    "SCANS",
    "WHAT",
    "Format",
    "choose_format",
    "choose_writer",
    "formats",
]

FLOORPLANS = "palms.floorplans"
SCANS = "palms.scans"
ODOMETRY = "palms.odometry"

BUILT_IN: dict[str, tuple[str, ...]] = {
    FLOORPLANS: (
        "palms.io.plan_csv:FORMAT",
        "palms.io.plan_geojson:FORMAT",
        "palms.io.plan_imdf:FORMAT",
        "palms.io.plan_image:FORMAT",
        "palms.io.plan_ros:FORMAT",
        "palms.io.plan_dxf:FORMAT",
        "palms.io.plan_osm:FORMAT",
        "palms.io.plan_svg:FORMAT",
        "palms.io.plan_pdf:FORMAT",
        "palms.io.plan_gpkg:FORMAT",
        "palms.io.plan_shapefile:FORMAT",
        "palms.io.plan_ifc:FORMAT",
    ),
    SCANS: (
        "palms.io.planes:FORMAT",
        "palms.io.arkit_planes:FORMAT",
        "palms.io.roomplan:FORMAT",
        "palms.io.webxr_planes:FORMAT",
        "palms.io.arcore_planes:FORMAT",
        "palms.io.depth_folder:FORMAT",
        "palms.io.ply:FORMAT",
        "palms.io.npz_cloud:FORMAT",
        "palms.io.stray_scanner:FORMAT",
        "palms.io.las:FORMAT",
        "palms.io.e57:FORMAT",
    ),
    ODOMETRY: (
        "palms.io.tracking:FORMAT",
        "palms.io.tum:FORMAT",
        "palms.io.poses:FORMAT",
        "palms.io.android:FORMAT",
        "palms.io.sensor_logger:FORMAT",
        "palms.io.ronin:FORMAT",
        "palms.io.step_heading:FORMAT",
    ),
}
WHAT = {FLOORPLANS: "floor plan", SCANS: "scan", ODOMETRY: "walk"}


@dataclass(frozen=True, slots=True)
class Format:
    """One file format: how to know, read and write it.

    Parameters
    ----------
    name : str
        Short, for `--format` and messages.
    description : str
        One line for people.
    suffixes : tuple of str
        Endings of such files, with the dot, in lower case.
    recognizes : callable
        ``(path) -> bool``, by content; never raises.
    read : callable
        ``(path, **options) -> value``.
    write : callable, optional
        ``(value, path) -> None``.
    extra : str, optional
        The extra of the package that brings what it needs; None when nothing is needed.
    read_levels : callable, optional
        ``(path, **options) -> levels``, of a floor plan's format that can hold several: a
        tuple of `palms.io.LevelPlan` in one frame, from the lowest up.

    Examples
    --------
    >>> from palms.io.plan_csv import FORMAT
    >>> FORMAT.name, FORMAT.suffixes
    ('csv', ('.csv',))
    """

    name: str
    description: str
    suffixes: tuple[str, ...]
    recognizes: Callable[[Path], bool]
    read: Callable[..., Any]
    write: Callable[..., None] | None = None
    extra: str | None = None
    read_levels: Callable[..., tuple[Any, ...]] | None = None


def _load(reference: str) -> Any:  # noqa: ANN401
    module, _, attribute = reference.partition(":")
    return getattr(importlib.import_module(module), attribute)


def _load_plugin(entry: importlib.metadata.EntryPoint) -> Any:  # noqa: ANN401
    try:
        reader = entry.load()
        missing = [
            part for part in ("name", "suffixes", "recognizes", "read") if not hasattr(reader, part)
        ]
        problem = f"it has no {', '.join(missing)}" if missing else ""
    except Exception as error:  # a plug-in of others may raise anything
        problem = f"{type(error).__name__}: {error}"
    if not problem:
        return reader
    warnings.warn(
        f"format plug-in {entry.name} ({entry.value}) is left out: {' '.join(problem.split())}",
        PalmsWarning,
        stacklevel=4,
    )
    return None


def _ours(group: str) -> Iterator[Any]:
    """Return our readers, each loaded when its turn comes: a common file needs the first alone."""
    return map(_load, BUILT_IN.get(group, ()))


@functools.cache
def _plugins(group: str) -> tuple[Any, ...]:
    """Readers of other packages."""
    ours = BUILT_IN.get(group, ())
    entries = importlib.metadata.entry_points(group=group)
    found = (_load_plugin(entry) for entry in entries if entry.value not in ours)
    return tuple(reader for reader in found if reader is not None)


def formats(group: str) -> tuple[Any, ...]:
    """Return the readers of a group: ours first, then those of other packages.

    A plug-in that cannot be loaded is named in a `PalmsWarning` and left out.

    Parameters
    ----------
    group : str
        `FLOORPLANS`, `SCANS` or `ODOMETRY`.

    Examples
    --------
    >>> "csv" in [reader.name for reader in formats(FLOORPLANS)]
    True
    """
    return (*_ours(group), *_plugins(group))


def _recognizes(reader: Any, path: Path) -> bool:  # noqa: ANN401
    try:
        return bool(reader.recognizes(path))
    except Exception as error:  # a plug-in of others may raise anything
        warnings.warn(
            f"format {reader.name} could not look at {path}: {' '.join(str(error).split())}",
            PalmsWarning,
            stacklevel=4,
        )
        return False


def _has_suffix(reader: Any, path: Path) -> bool:  # noqa: ANN401
    return path.name.lower().endswith(tuple(reader.suffixes))


def _fitting(group: str, path: Path) -> Any:  # noqa: ANN401
    """Return the first reader that knows content and suffix, else content, else suffix."""
    knowing = [reader for reader in _plugins(group) if _recognizes(reader, path)]
    fitting = []
    for reader in _ours(group):
        if _recognizes(reader, path):
            if _has_suffix(reader, path):
                return reader
            fitting.append(reader)
    fitting += knowing
    by_suffix = [reader for reader in fitting or formats(group) if _has_suffix(reader, path)]
    return next(iter(by_suffix or fitting), None)


def _listed(readers: Sequence[Any]) -> str:
    return ", ".join(f"{r.name} ({' '.join(r.suffixes) or 'a folder'})" for r in readers)


def choose_format(group: str, path: StrPath, name: str | None = None) -> Any:  # noqa: ANN401
    """Return the reader for a file: by name, else by content, else by suffix.

    Parameters
    ----------
    group : str
        `FLOORPLANS`, `SCANS` or `ODOMETRY`.
    path : path
        A file, or a folder where the format is one.
    name : str, optional
        The format, when it is known.

    Raises
    ------
    InputError
        When there is nothing at `path`, no format of that name, or none fits.

    Examples
    --------
    >>> choose_format(FLOORPLANS, ".", name="dwg")
    Traceback (most recent call last):
    palms.errors.InputError: format of .: expected one of csv..., got 'dwg'
    """
    if name is not None:
        for reader in chain(_ours(group), _plugins(group)):
            if reader.name == name:
                return reader
        known = ", ".join(reader.name for reader in formats(group))
        raise InputError(f"format of {path}", expected=f"one of {known}", got=repr(name))
    place = Path(path)
    if "\x00" in str(path) or not os.path.exists(path):
        raise InputError(
            str(path).replace("\x00", "?"),
            expected=f"a {WHAT[group]}",
            got="nothing there",
            fix="check the name and the folder",
        )
    reader = _fitting(group, place)
    if reader is not None:
        return reader
    got = "a folder" if place.is_dir() else sniff(head(place)) if head(place) else "an empty file"
    raise InputError(
        str(path), expected=f"a {WHAT[group]} as {_listed(formats(group))}", got=got,
        fix="convert it, or name its format; palms formats tells more",
    )  # fmt: skip


def choose_writer(group: str, path: StrPath, name: str | None = None) -> Any:  # noqa: ANN401
    """Return the format to write a file in: by name, else by how the file's name ends.

    Parameters
    ----------
    group : str
        `FLOORPLANS`, `SCANS` or `ODOMETRY`.
    path : path
        The file to be.
    name : str, optional
        The format, when the name of the file does not tell.

    Raises
    ------
    OutputError
        When no format that can be written fits.

    Examples
    --------
    >>> choose_writer(FLOORPLANS, "hall.csv").name
    'csv'
    """
    writers = [r for r in formats(group) if getattr(r, "write", None) is not None]
    place = Path(path)
    fitting = [r for r in writers if (r.name == name if name else _has_suffix(r, place))]
    if fitting:
        return fitting[0]
    known = ", ".join(f"{' '.join(r.suffixes)} ({r.name})" for r in writers)
    raise OutputError(
        str(path), expected=f"a name that ends in {known}", got=repr(name or place.name)
    )
