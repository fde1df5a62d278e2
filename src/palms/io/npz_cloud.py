"""Scans from point clouds in numpy's npz and npy files."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import IO, Any

import numpy as np

from palms.errors import FormatError, InputError
from palms.extraction.settings import ExtractionSettings
from palms.geometry import FloatArray
from palms.io.files import head
from palms.io.point_clouds import CHUNK_ROWS, CloudOptions, Thinned, cloud_file, cloud_scan
from palms.io.registry import Format
from palms.io.values import StrPath, brief
from palms.scan import Scan

__all__ = ["FORMAT", "read_npz_cloud"]

_EXPECTED = "an array (P, 3) of points, such as xyz"
_UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0}
_MAX_BYTES = 2_000_000_000  # ours: of an array, unpacked; read piece by piece
_CHUNK_BYTES = 64_000_000  # ours
_MOST_COLUMNS = 1000  # ours: a point with colour and normal has 9
_HEADER_BYTES = 10_000  # ours: as numpy's own limit


def read_npz_cloud(
    path: StrPath,
    *,
    up: str = "auto",
    unit: str = "auto",
    position: object = None,
    floor: object = None,
    settings: ExtractionSettings | None = None,
) -> Scan:
    """Read the walls of a point cloud that numpy saved.

    Parameters
    ----------
    path : path
        An npz or npy file. In an npz the array is called xyz, points or whatever else; it
        is the only one of shape (P, 3) or more columns, or the first by name with xyz.
    unit : {"auto", "m", "cm", "mm"}
        Of the numbers; when auto, what the array's name ends in, such as xyz_mm, else m.
    up, position, floor, settings
        As in `palms.io.point_clouds.CloudOptions`, in metres.

    Raises
    ------
    InputError
        When it cannot be read or holds no wall.
    """
    if unit != "auto" and unit not in _UNITS:
        raise InputError("option unit", expected="auto, m, cm or mm", got=repr(unit))
    with cloud_file(path, "an npz file that can be read", "save it again"):
        name, points = _points(path)
    scale = _UNITS.get(name.rpartition("_")[2], 1.0) if unit == "auto" else _UNITS[unit]
    return cloud_scan(points * scale, path, CloudOptions(up, position, floor, settings))


def _points(path: StrPath) -> tuple[str, FloatArray]:
    """Name and content (P, 3) of the array that holds points."""
    with open(path, "rb") as file:
        if file.read(6) == b"\x93NUMPY":
            file.seek(0)
            return Path(path).stem, _read(file, str(path))
    with zipfile.ZipFile(path) as archive:
        shapes = {}
        for member in archive.infolist():
            if member.filename.endswith(".npy"):
                with archive.open(member) as stream:
                    shapes[member.filename] = _shape(stream, f"{path}: {member.filename}")[0]
        fitting = [n for n, shape in shapes.items() if len(shape) == 2 and shape[1] >= 3]
        if not fitting:
            listed = ", ".join(f"{name} {shape}" for name, shape in shapes.items()) or "no array"
            raise FormatError(str(path), expected=_EXPECTED, got=brief(listed, 80))
        member_name = min(fitting, key=lambda n: ("xyz" not in n, "point" not in n, n))
        with archive.open(member_name) as stream:
            return member_name.removesuffix(".npy"), _read(stream, f"{path}: {member_name}")


def _shape(stream: IO[bytes], what: str) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Shape, order and type that the start of an npy stream states."""
    version = np.lib.format.read_magic(stream)
    read = {
        (1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0,
    }.get(version)  # fmt: skip
    if read is None:
        raise FormatError(what, expected="an npy array", got=f"version {version}")
    shape, fortran, dtype = read(stream, max_header_size=_HEADER_BYTES)
    return shape, fortran, dtype


def _read(stream: IO[bytes], what: str) -> FloatArray:
    """First three columns of every n-th row of an array, read piece by piece."""
    shape, fortran, dtype = _shape(stream, what)
    if len(shape) != 2 or not 3 <= shape[1] <= _MOST_COLUMNS or dtype.kind not in "fiu":
        raise FormatError(what, expected=_EXPECTED, got=f"{dtype} of shape {shape}")
    size = shape[0] * shape[1] * dtype.itemsize
    if size > _MAX_BYTES:
        raise InputError(
            what, expected=f"at most {_MAX_BYTES / 1e9:g} GB of points", got=f"{size / 1e9:.3g} GB",
            fix="thin the cloud first",
        )  # fmt: skip
    if fortran:
        columns = [_pieces(stream, shape[0], 1, dtype, what)[:, 0] for _ in range(3)]
        return np.stack(columns, axis=1)
    return _pieces(stream, shape[0], shape[1], dtype, what)


def _pieces(
    stream: IO[bytes], rows: int, width: int, dtype: np.dtype[Any], what: str
) -> FloatArray:
    """First three columns of the rows that are kept."""
    row_bytes, points = width * dtype.itemsize, Thinned(rows)
    chunk = max(1, min(CHUNK_ROWS, _CHUNK_BYTES // row_bytes))
    while points.seen < rows:
        count = min(chunk, rows - points.seen)
        content = stream.read(count * row_bytes)
        if len(content) < count * row_bytes:
            raise FormatError(
                what, expected=f"{rows} points, as its header says", got="fewer",
                fix="the file may be cut off; save it again",
            )  # fmt: skip
        block = np.frombuffer(content, dtype).reshape(count, width)
        points.add(points.of(block)[:, :3], count)
    return points.stacked()


def _recognizes(path: Path) -> bool:
    if path.is_dir():
        return False
    start = head(path, 512)
    return start.startswith(b"\x93NUMPY") or (start.startswith(b"PK\x03\x04") and b".npy" in start)


FORMAT = Format(
    name="npz-cloud",
    description="point cloud saved by numpy; walls are found among the points",
    suffixes=(".npz", ".npy"),
    recognizes=_recognizes,
    read=read_npz_cloud,
)
