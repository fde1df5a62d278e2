"""Floor plans, scans and walks of any known format, read and written."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palms.errors import InputError, PalmsError
from palms.io.options import parse_options
from palms.io.registry import FLOORPLANS, ODOMETRY, SCANS, WHAT, choose_format, choose_writer
from palms.io.values import StrPath

if TYPE_CHECKING:
    from palms.building import Building
    from palms.floorplan import FloorPlan
    from palms.io.levels import LevelPlan
    from palms.io.walk import RecordedWalk
    from palms.odometry import Odometry
    from palms.scan import Scan

__all__ = [
    "read_any",
    "read_building",
    "read_floorplan",
    "read_levels",
    "read_scan",
    "read_walk",
    "write_floorplan",
]


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


def _read(
    reader: Any,  # noqa: ANN401
    group: str,
    path: StrPath,
    options: dict[str, Any],
    read: Callable[..., Any] | None = None,
) -> Any:  # noqa: ANN401
    """Read by a reader's function, its `read` when left out; what is wrong is said in a line."""
    read = read or reader.read
    try:
        inspect.signature(read).bind(path, **options)
    except TypeError as error:
        raise InputError(f"options for format {reader.name}", got=str(error)) from None
    try:
        return read(path, **options)
    except RecursionError:
        raise InputError(str(path), expected=f"a {WHAT[group]}", got="too deep nesting") from None
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


def read_building(path: StrPath, *, format: str | None = None, **options: Any) -> Building:  # noqa: ANN401
    r"""Read a building: all levels of a file in one frame, and the stairs between them.

    Stairs are areas that the file has as stairs, lifts or escalators, or whose names say so,
    and that another level has at the same place.

    Parameters
    ----------
    path, format, **options
        As `read_levels`.

    Raises
    ------
    InputError
        As `read_levels`; also when two levels have one name.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_json
    >>> def wall(y, level):
    ...     line = {"type": "LineString", "coordinates": [[0, y], [8, y]]}
    ...     return {"type": "Feature", "geometry": line, "properties": {"level": level}}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     features = [wall(0, 1), wall(5, 0)]
    ...     write_json(f"{folder}/a.geojson", {"type": "FeatureCollection", "features": features})
    ...     read_building(f"{folder}/a.geojson").names
    ('0', '1')
    """
    from palms.io.levels import building_of

    return building_of(read_levels(path, format=format, **options), str(path))


def read_levels(
    path: StrPath,
    *,
    format: str | None = None,
    **options: Any,  # noqa: ANN401
) -> tuple[LevelPlan, ...]:
    r"""Read all levels of a file, in one frame; any format's plan is one of one level.

    Parameters
    ----------
    path : path
        The file or folder.
    format : str, optional
        Name of its format; found out when left out.
    **options
        For the reader of that format; `level` is none of them.

    Returns
    -------
    tuple of LevelPlan
        From the lowest up. A level without a wall is left out, with a `PalmsWarning`.

    Raises
    ------
    InputError
        When nothing is there, no format fits, or its content is at fault.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_json
    >>> def wall(y, level):
    ...     line = {"type": "LineString", "coordinates": [[0, y], [8, y]]}
    ...     return {"type": "Feature", "geometry": line, "properties": {"level": level}}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     features = [wall(0, 1), wall(5, 0)]
    ...     write_json(f"{folder}/a.geojson", {"type": "FeatureCollection", "features": features})
    ...     levels = read_levels(f"{folder}/a.geojson")
    >>> [(level.name, level.ordinal, level.plan.segments_m[0].tolist()) for level in levels]
    [('0', 0.0, [[0.0, 5.0], [8.0, 5.0]]), ('1', 1.0, [[0.0, 0.0], [8.0, 0.0]])]
    """
    from palms.io.levels import LevelPlan

    reader = choose_format(FLOORPLANS, path, format)
    read_all = getattr(reader, "read_levels", None)
    if read_all is None:
        plan: FloorPlan = _read(reader, FLOORPLANS, path, options)
        return (LevelPlan(plan.level or "", 0.0, plan),)
    levels: tuple[LevelPlan, ...] = _read(reader, FLOORPLANS, path, options, read_all)
    return levels


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
    choose_writer(FLOORPLANS, path, format).write(plan, path)


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
