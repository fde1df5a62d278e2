"""Scans from point clouds and meshes in PLY, ascii and binary: a small reader of our own."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from palms.errors import FormatError, InputError
from palms.extraction.settings import ExtractionSettings
from palms.geometry import FloatArray
from palms.io.files import head
from palms.io.point_clouds import CHUNK_ROWS, CloudOptions, Thinned, cloud_file, cloud_scan
from palms.io.registry import Format
from palms.io.values import StrPath, brief
from palms.scan import Scan

__all__ = ["FORMAT", "read_ply", "read_ply_points"]

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_HEADER_BYTES = 65_536  # ours: no header is longer
_MAX_BYTES = 4_000_000_000  # ours: what is read piece by piece
_EXPECTED = "a PLY file with vertices x, y, z"


class _Element(NamedTuple):
    """Name, number of rows, and names and types of the columns."""

    name: str
    rows: int
    columns: list[tuple[str, str]]


@dataclass(frozen=True, slots=True)
class _Header:
    """What a PLY header says: order of bytes, where data starts, vertices, what precedes."""

    order: str
    start: int
    count: int
    columns: tuple[tuple[str, str], ...]
    rows_before: int
    bytes_before: int

    @property
    def dtype(self) -> np.dtype[Any]:
        return np.dtype([(name, self.order + kind) for name, kind in self.columns])


def read_ply(
    path: StrPath,
    *,
    up: str = "auto",
    position: object = None,
    floor: object = None,
    settings: ExtractionSettings | None = None,
) -> Scan:
    """Read the walls of a point cloud, or of the vertices of a mesh.

    Parameters
    ----------
    path : path
        The file.
    up, position, floor, settings
        As in `palms.io.point_clouds.CloudOptions`.

    Raises
    ------
    InputError
        When it cannot be read or holds no wall.
    """
    return cloud_scan(read_ply_points(path), path, CloudOptions(up, position, floor, settings))


def read_ply_points(path: StrPath) -> FloatArray:
    """Read the vertices (P, 3) of a PLY file; every n-th of very many.

    Raises
    ------
    InputError
        When it cannot be read, or holds less than its header says.
    """
    with cloud_file(path, _EXPECTED), open(path, "rb") as file:
        size = os.path.getsize(path)
        header = _header(file.read(_HEADER_BYTES), path)
        if size > _MAX_BYTES:
            raise InputError(
                str(path), expected=f"at most {_MAX_BYTES / 1e9:g} GB", got=f"{size / 1e9:.3g}"
            )
        file.seek(header.start)
        read = _binary if header.order else _ascii
        return read(file, header, size, path)


def _header(start: bytes, path: StrPath) -> _Header:
    end = start.find(b"end_header")
    newline = start.find(b"\n", end)
    if not start.startswith(b"ply") or end < 0 or newline < 0:
        got = "no header" if start else "an empty file"
        raise FormatError(str(path), expected=_EXPECTED, got=got, fix="export it again")
    order, elements = _elements(start[:end].decode("ascii", "replace").splitlines()[1:], path)
    names = [element.name for element in elements]
    if order is None or names.count("vertex") != 1:
        raise FormatError(
            str(path), expected=_EXPECTED, got=f"elements {brief(' '.join(names)) or 'none'}"
        )
    before, vertex = elements[: names.index("vertex")], elements[names.index("vertex")]
    columns = [name for name, _ in vertex.columns]
    if not {"x", "y", "z"} <= set(columns) or len(columns) != len(set(columns)):
        raise FormatError(
            str(path), expected=_EXPECTED, got=f"properties {brief(' '.join(columns))}"
        )
    if any(kind == "list" for element in (*before, vertex) for _, kind in element.columns):
        raise FormatError(
            f"{path}: header", expected="vertices before lists", got="a list", fix="export it again"
        )
    bytes_before = sum(
        each.rows * sum(np.dtype(kind).itemsize for _, kind in each.columns) for each in before
    )
    rows_before = sum(each.rows for each in before)
    return _Header(
        order, newline + 1, vertex.rows, tuple(vertex.columns), rows_before, bytes_before
    )


def _elements(lines: list[str], path: StrPath) -> tuple[str | None, list[_Element]]:
    """Order of bytes and elements, from the lines of a header."""
    order: str | None = None
    elements: list[_Element] = []
    for line in lines:
        match line.split():
            case ["format", name, _] if name in _ORDERS:
                order = _ORDERS[name]
            case ["element", name, number] if number.isascii() and number.isdigit():
                elements.append(_Element(name, int(number[:19]), []))
            case ["property", "list", *_] if elements:
                elements[-1].columns.append((f"list {len(elements[-1].columns)}", "list"))
            case ["property", kind, name] if kind in _TYPES and elements:
                elements[-1].columns.append((name, _TYPES[kind]))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise FormatError(f"{path}: header", expected="PLY 1.0", got=brief(line))
    return order, elements


def _check_count(header: _Header, room: int, path: StrPath) -> None:
    """Make sure that a file has room for what its header claims."""
    if header.count > room:
        raise FormatError(
            str(path), expected=f"{header.count} vertices, as its header says",
            got=f"room for {max(room, 0)}", fix="the file may be cut off; export it again",
        )  # fmt: skip
    if not header.count:
        raise FormatError(str(path), expected=_EXPECTED, got="no vertex", fix="export it again")


def _binary(file: BinaryIO, header: _Header, size: int, path: StrPath) -> FloatArray:
    dtype = header.dtype
    _check_count(header, (size - header.start - header.bytes_before) // dtype.itemsize, path)
    file.seek(header.start + header.bytes_before)
    points = Thinned(header.count)
    while points.seen < header.count:
        rows = min(CHUNK_ROWS, header.count - points.seen)
        block = points.of(np.frombuffer(file.read(rows * dtype.itemsize), dtype))
        points.add(np.stack([block[axis].astype(np.float64) for axis in "xyz"], axis=1), rows)
    return points.stacked()


def _ascii(file: BinaryIO, header: _Header, size: int, path: StrPath) -> FloatArray:
    names = [name for name, _ in header.columns]
    _check_count(header, (size - header.start + 1) // (2 * len(names)), path)
    _check_count(header, (size - header.start) - 2 * header.rows_before, path)
    for _ in range(header.rows_before):
        file.readline(_HEADER_BYTES)
    wanted = [names.index(axis) for axis in "xyz"]
    points = Thinned(header.count)
    while points.seen < header.count:
        rows = min(CHUNK_ROWS, header.count - points.seen)
        lines = [file.readline(_HEADER_BYTES) for _ in range(rows)]
        if not lines[-1].strip():
            raise FormatError(
                str(path), expected=f"{header.count} vertices, as its header says",
                got="fewer lines", fix="the file may be cut off; export it again",
            )  # fmt: skip
        points.add(np.loadtxt(points.of(lines), usecols=wanted, ndmin=2, comments=None), rows)
    return points.stacked()


def _recognizes(path: Path) -> bool:
    return not path.is_dir() and head(path, 4) in (b"ply\n", b"ply\r")


FORMAT = Format(
    name="ply",
    description="point cloud or mesh in PLY, ascii or binary; walls are found among the points",
    suffixes=(".ply",),
    recognizes=_recognizes,
    read=read_ply,
)
