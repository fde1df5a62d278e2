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
import inspect
import os
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palms.errors import InputError, OutputError, PalmsError, PalmsWarning
from palms.io.files import head, sniff
from palms.io.options import parse_options
from palms.io.values import StrPath

if TYPE_CHECKING:
    from palms.floorplan import FloorPlan
    from palms.io.walk import RecordedWalk
    from palms.odometry import Odometry
    from palms.scan import Scan

__all__ = [
    "BUILT_IN",
    "FLOORPLANS",
    "ODOMETRY",
    "SCANS",
    "Format",
    "choose_format",
    "formats",
    "read_any",
    "read_floorplan",
    "read_scan",
    "read_walk",
    "write_floorplan",
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
_WHAT = {FLOORPLANS: "floor plan", SCANS: "scan", ODOMETRY: "walk"}


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


@functools.cache
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
    ours = BUILT_IN.get(group, ())
    found = [_load(reference) for reference in ours]
    for entry in importlib.metadata.entry_points(group=group):
        if entry.value not in ours and (reader := _load_plugin(entry)) is not None:
            found.append(reader)
    return tuple(found)


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
    readers = formats(group)
    if name is not None:
        for reader in readers:
            if reader.name == name:
                return reader
        known = ", ".join(reader.name for reader in readers)
        raise InputError(f"format of {path}", expected=f"one of {known}", got=repr(name))
    place = Path(path)
    if "\x00" in str(path) or not os.path.exists(path):
        raise InputError(
            str(path).replace("\x00", "?"),
            expected=f"a {_WHAT[group]}",
            got="nothing there",
            fix="check the name and the folder",
        )
    fitting = [reader for reader in readers if _recognizes(reader, place)]
    by_suffix = [reader for reader in fitting or readers if _has_suffix(reader, place)]
    if by_suffix or fitting:
        return (by_suffix or fitting)[0]
    got = "a folder" if place.is_dir() else sniff(head(place)) if head(place) else "an empty file"
    raise InputError(
        str(path), expected=f"a {_WHAT[group]} as {_listed(readers)}", got=got,
        fix="convert it, or name its format; palms formats tells more",
    )  # fmt: skip


def read_any(group: str, path: StrPath, name: str | None = None, texts: Sequence[str] = ()) -> Any:  # noqa: ANN401
    """Read a file of a group with options given as text, as the command line has them.

    Parameters
    ----------
    group : str
        `FLOORPLANS`, `SCANS` or `ODOMETRY`.
    path : path
        The file or folder.
    name : str, optional
        Name of its format; found out when left out.
    texts : sequence of str
        Options for the reader of that format, as ``scale=0.02``.

    Raises
    ------
    InputError
        As `read_floorplan`; also for an option that the format does not have.

    Examples
    --------
    >>> read_any(FLOORPLANS, "hall.csv", "csv", ["colour=red"])
    Traceback (most recent call last):
    palms.errors.InputError: option of format csv: expected ..., got 'colour'
    """
    reader = choose_format(group, path, name)
    options = parse_options(reader.read, texts, f"option of format {reader.name}")
    value = _read(reader, group, path, options)
    return _recorded(value, path) if group == ODOMETRY else value


def _read(reader: Any, group: str, path: StrPath, options: dict[str, Any]) -> Any:  # noqa: ANN401
    try:
        inspect.signature(reader.read).bind(path, **options)
    except TypeError as error:
        raise InputError(f"options for format {reader.name}", got=str(error)) from None
    try:
        return reader.read(path, **options)
    except RecursionError:
        raise InputError(str(path), expected=f"a {_WHAT[group]}", got="too deep nesting") from None
    except ImportError as error:
        if isinstance(error, PalmsError) or not getattr(reader, "extra", None):
            raise
        raise InputError(
            str(path),
            expected=f"what reads {reader.name}",
            got=f"no package {error.name}",
            fix=f'pip install "palms-localization[{reader.extra}]"',
        ) from None


def read_floorplan(path: StrPath, *, format: str | None = None, **options: Any) -> FloorPlan:  # noqa: ANN401
    r"""Read a floor plan of any known format.

    Parameters
    ----------
    path : path
        The file or folder.
    format : str, optional
        Name of its format; found out when left out.
    **options
        For the reader of that format.

    Raises
    ------
    InputError
        When nothing is there, no format fits, or its content is at fault.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_text
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/hall.csv", "0,0,8,0\n8,0,8,5\n")
    ...     read_floorplan(f"{folder}/hall.csv").size_m.tolist()
    [8.0, 5.0]
    """
    reader = choose_format(FLOORPLANS, path, format)
    plan: FloorPlan = _read(reader, FLOORPLANS, path, options)
    return plan


def write_floorplan(plan: FloorPlan, path: StrPath, *, format: str | None = None) -> None:
    """Write a floor plan in the format that the file's name ends for.

    Parameters
    ----------
    plan : FloorPlan
    path : path
        The file; replaced when it exists. Its folder must exist.
    format : str, optional
        Name of the format, when the name of the file does not tell.

    Raises
    ------
    OutputError
        When no format that can be written fits, or the file cannot be written.

    Examples
    --------
    >>> from palms.floorplan import FloorPlan
    >>> write_floorplan(FloorPlan([[[0, 0], [8, 0]]]), "hall.dwg")
    Traceback (most recent call last):
    palms.errors.OutputError: hall.dwg: expected a name that ends in ..., got 'hall.dwg'
    """
    writers = [r for r in formats(FLOORPLANS) if getattr(r, "write", None) is not None]
    place = Path(path)
    fitting = [r for r in writers if (r.name == format if format else _has_suffix(r, place))]
    if not fitting:
        known = " or ".join(f"{r.suffixes[0]} ({r.name})" for r in writers)
        raise OutputError(
            str(path), expected=f"a name that ends in {known}", got=repr(format or place.name)
        )
    fitting[0].write(plan, path)


def read_scan(path: StrPath, *, format: str | None = None, **options: Any) -> Scan:  # noqa: ANN401
    """Read a scan of any known format.

    Parameters
    ----------
    path : path
        The file, or the folder of the session.
    format : str, optional
        Name of its format; found out when left out.
    **options
        For the reader of that format.

    Raises
    ------
    InputError
        When nothing is there, no format fits, or its content is at fault.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_json
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/scan.json", [[[2, -2.5], [2, 0.5]]])
    ...     read_scan(f"{folder}/scan.json").walls_m.tolist()
    [[[2.0, -2.5], [2.0, 0.5]]]
    """
    reader = choose_format(SCANS, path, format)
    scan: Scan = _read(reader, SCANS, path, options)
    return scan


def read_walk(path: StrPath, *, format: str | None = None, **options: Any) -> RecordedWalk:  # noqa: ANN401
    """Read a recorded walk of any known format.

    Parameters
    ----------
    path : path
        The file, or a folder that holds one walk.
    format : str, optional
        Name of its format; found out when left out.
    **options
        For the reader of that format.

    Raises
    ------
    InputError
        When nothing is there, no format fits, or its content is at fault.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_json
    >>> walk = {"ARKit_raw_2D": [[-1, 0], [-2, 0]], "time_intervals": [1.0, 0.5]}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/walk.json", walk)
    ...     read_walk(f"{folder}/walk.json").odometry("arkit").position_m.tolist()
    [[1.0, 0.0], [2.0, 0.0]]
    """
    reader = choose_format(ODOMETRY, path, format)
    return _recorded(_read(reader, ODOMETRY, path, options), path)


def _recorded(walk: RecordedWalk | Odometry, path: StrPath) -> RecordedWalk:
    from palms.io.walk import RecordedWalk
    from palms.odometry import Odometry

    return RecordedWalk.of(walk, path=Path(path)) if isinstance(walk, Odometry) else walk
