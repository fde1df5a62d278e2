"""Pose logs of ARKit, ARCore and the like: a time, and where the camera was, in each row.

Rows of text (blanks, commas, semicolons or tabs; ``#`` comments; a header or none), a JSON list
of objects, or one object a line. Position and quaternion, a 3x4 or a 4x4 matrix from camera to
session, by rows or by columns; times in any unit. y is up and the camera looks along -z.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from palms.errors import FormatError, PalmsWarning
from palms.geometry import FloatArray
from palms.io.files import sniff
from palms.io.options import choice_option, number_option
from palms.io.packed import text_head
from palms.io.pose_log import EVERY_S, GROUNDS, TIME_UNITS, PoseLog, ground_walk, seconds, thinned
from palms.io.pose_table import Table, cells_of, named_parts, read_table
from palms.io.registry import Format
from palms.io.values import StrPath, parse_number
from palms.io.walk import RecordedWalk

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

__all__ = ["FORMAT", "pose_log", "read_poses"]

_EXPECTED = "poses: time and position, with a quaternion, or time and a 3x4 or 4x4 matrix"
_BARE: Final = {  # columns by their number, where they have no names
    4: ("time", "x", "y", "z"),
    8: ("time", "x", "y", "z", "qx", "qy", "qz", "qw"),
    13: ("time", *(f"matrix.{k}" for k in range(12))),
    17: ("time", *(f"matrix.{k}" for k in range(16))),
}
_STIFF = 0.02  # ours: how far a rotation may be from one; logs round to six digits
_POINTS = ("x", "y", "z")
_TURNS = ("qx", "qy", "qz", "qw")


def read_poses(
    path: StrPath,
    *,
    ground: Literal["x,-z", "-z,-x", "x,y"] = "x,-z",
    frame: Literal["scan", "own"] = "scan",
    time_unit: Literal["auto", "s", "ms", "us", "ns"] = "auto",
    every_s: float | str = EVERY_S,
) -> RecordedWalk:
    r"""Read a pose log.

    Parameters
    ----------
    path : path
        The file; may be packed by gzip.
    ground : {"x,-z", "-z,-x", "x,y"}
        What becomes the ground plane: "x,-z" (x to the right, y ahead), "-z,-x" as the
        PALMS data set has it, for walks whose scan is of its kind, or "x,y" for logs with z
        up. Scan and walk must have the same.
    frame : {"scan", "own"}
        Whether the log is of the same session as the scan.
    time_unit : {"auto", "s", "ms", "us", "ns"}
        Unit of the times; told by their spacing when left out.
    every_s : float
        Poses nearer in time are left out; 0 keeps them all.

    Raises
    ------
    InputError
        When it cannot be read, or an option is wrong.
    FormatError
        When its content is no pose log; the message names the line.

    Warns
    -----
    PalmsWarning
        When the rotations cannot be read as such; then nobody knows where the phone looked.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_text
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/log.txt", "0 0 1 0 0 0 0 1\n1 0 1 -1 0 0 0 1\n2 1 1 -1 0 0 0 1\n")
    ...     walk = read_poses(f"{folder}/log.txt").odometry()
    >>> walk.position_m.tolist(), walk.facing_rad.round(4).tolist()
    ([[0.0, 1.0], [1.0, 1.0]], [1.5708, 1.5708])
    """
    choice_option(frame, "frame", ("scan", "own"))
    plane = GROUNDS[choice_option(ground, "ground", ("x,-z", "-z,-x", "x,y"))]
    unit = choice_option(time_unit, "time_unit", ("auto", *TIME_UNITS))
    every = number_option(every_s, "every_s", 0.0, 60.0)
    log = pose_log(read_table(path, _EXPECTED), path, None if unit == "auto" else unit, every)
    return ground_walk(log, plane, frame, "-z", path)


def pose_log(table: Table, path: StrPath, unit: str | None, every_s: float) -> PoseLog:
    """Return the poses of a table.

    Parameters
    ----------
    table : Table
    path : path
        The file, for messages.
    unit : str, optional
        Of its times.
    every_s : float
        Poses nearer in time are left out.

    Raises
    ------
    FormatError
        When columns are missing, times decrease, or there are fewer than three poses left.
    """
    names = table.names or _BARE.get(table.values.shape[1], ())
    parts = named_parts(names)
    columns, values = parts.columns, table.values
    has_points = all(name in columns for name in _POINTS)
    if "time" not in columns or not (has_points or len(parts.matrix) in (12, 16)):
        raise FormatError(
            str(path), expected=_EXPECTED,
            got=f"the columns {', '.join(names)[:80]}" if names else f"{values.shape[1]} numbers",
            fix="name the columns in a header: timestamp, x, y, z, qx, qy, qz, qw",
        )  # fmt: skip
    time = seconds(values[:, columns["time"]], path, unit or parts.unit)
    kept = thinned(time, every_s)
    if len(kept) < 3:
        raise FormatError(
            str(path), expected=f"three poses or more that lie {every_s:g} s apart",
            got=f"{len(time)} in {time[-1]:.3g} s", fix="record longer, or give the unit of time",
        )  # fmt: skip
    if has_points:
        points = values[np.ix_(kept, [columns[name] for name in _POINTS])]
        turns = [columns[name] for name in _TURNS if name in columns]
        rotation = _of_quaternions(values[np.ix_(kept, turns)], path) if len(turns) == 4 else None
        return PoseLog(time[kept], points, rotation)
    return _of_matrices(time[kept], values[np.ix_(kept, parts.matrix)], path)


def _of_quaternions(values: FloatArray, path: StrPath) -> Rotation | None:
    from scipy.spatial.transform import Rotation

    length = np.linalg.norm(values, axis=1)
    if (np.abs(length - 1) > _STIFF).any():
        _warn_of_rotations(path)
        return None
    return Rotation.from_quat(values)


def _warn_of_rotations(path: StrPath) -> None:
    warnings.warn(
        f"{path}: its rotations are none, so it is not known where the phone looked",
        PalmsWarning,
        stacklevel=5,
    )


def _of_matrices(time_s: FloatArray, values: FloatArray, path: StrPath) -> PoseLog:
    """Read matrices by the layout in which the rotation is one."""
    from scipy.spatial.transform import Rotation

    for turn, place in _layouts(values):
        off = np.abs(np.swapaxes(turn, 1, 2) @ turn - np.eye(3)).max(axis=(1, 2))
        if (off < _STIFF).all() and (np.linalg.det(turn) > 0).all():
            return PoseLog(time_s, place, Rotation.from_matrix(turn))
    raise FormatError(
        str(path), expected="matrices of a rotation and a position, by rows or by columns",
        got="a first one that holds no rotation", fix="export poses from camera to session",
    )  # fmt: skip


def _layouts(values: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
    """Rotations (T, 3, 3) and positions (T, 3) as the numbers would have them, each way."""
    if values.shape[1] == 12:
        rows = values.reshape(-1, 3, 4)
        columns = np.swapaxes(values.reshape(-1, 4, 3), 1, 2)
        return [(m[:, :, :3], m[:, :, 3]) for m in (rows, columns)]
    square = values.reshape(-1, 4, 4)
    both = (square, np.swapaxes(square, 1, 2))
    last = np.array([0.0, 0.0, 0.0, 1.0])
    return [(m[:, :3, :3], m[:, :3, 3]) for m in both if np.allclose(m[:, 3], last, atol=1e-6)]


def _recognizes(path: Path) -> bool:
    """Whether the first row or object holds a time and a pose."""
    start = text_head(path)
    if path.is_dir() or sniff(start) not in ("text", "JSON"):
        return False
    lines = start.decode("utf-8-sig", "replace").splitlines()
    rows = [line for line in lines if line.strip() and not line.lstrip().startswith(("#", "//"))]
    if not rows:
        return False
    if sniff(start) == "JSON":
        return _has_pose_keys(start)
    cells = cells_of(rows[0])
    if cells and parse_number(cells[0]) is None:
        parts = named_parts(tuple(cells))
        return "time" in parts.columns and all(name in parts.columns for name in _POINTS)
    return len(cells) in (8, 13, 17) and all(parse_number(cell) is not None for cell in cells)


def _has_pose_keys(start: bytes) -> bool:
    text = start[:4000].lower()
    has_time = any(b'"%s' % key in text for key in (b"time", b't"', b"ts"))
    places = (b'"transform', b'"camera', b'"pose', b'"position', b'"translation', b'"tx"', b'"x"')
    others = (b'"anchor', b'"payload"', b'"sensor"')  # planes, and what Sensor Logger writes
    return has_time and any(key in text for key in places) and not any(o in text for o in others)


FORMAT = Format(
    name="poses",
    description="pose logs of ARKit, ARCore and the like: text or JSON, quaternions or matrices",
    suffixes=(".txt", ".csv", ".json", ".jsonl"),
    recognizes=_recognizes,
    read=read_poses,
)
