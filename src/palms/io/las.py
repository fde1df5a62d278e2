"""Scans from point clouds in LAS and LAZ."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import FormatError
from palms.extraction.settings import ExtractionSettings
from palms.geometry import FloatArray
from palms.io.files import head
from palms.io.point_clouds import CHUNK_ROWS, CloudOptions, Thinned, cloud_file, cloud_scan
from palms.io.registry import Format
from palms.io.values import StrPath
from palms.scan import Scan

__all__ = ["FORMAT", "read_las"]

_MOST_POINTS = 500_000_000  # ours: of compressed files, whose size tells little
_LEAST_BYTES = 20  # of a point, by the format
_PACKED = 0x80  # of the point format's number: compressed
_LEAST_CHUNK = 8  # ours: bytes of a compressed chunk of points


def read_las(
    path: StrPath,
    *,
    up: str = "z",
    position: object = None,
    floor: object = None,
    settings: ExtractionSettings | None = None,
) -> Scan:
    """Read the walls of a point cloud in LAS or LAZ.

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
    import laspy

    with cloud_file(path, "a LAS or LAZ file"):
        _check_header(path)
        points = _points(laspy, path)
    return cloud_scan(points, path, CloudOptions(up, position, floor, settings))


def _check_header(path: StrPath) -> None:
    """Make sure that a file has room for what its header claims, before it is believed.

    Offsets by the specification, LAS 1.2 to 1.4.
    """
    start, size = head(path, 375), Path(path).stat().st_size
    if len(start) < 227:
        raise FormatError(str(path), expected="a LAS or LAZ file", got="a header cut off")
    header, data, records = struct.unpack_from("<HII", start, 94)
    room = (min(data, size) - header) // 54
    if not 227 <= header <= data <= size or records > room:
        raise FormatError(
            str(path), expected=f"at most {max(room, 0)} records before its points",
            got=f"{records}", fix="the file may be cut off or damaged; export it again",
        )  # fmt: skip
    if start[25] >= 4 and len(start) >= 255:
        (extended,) = struct.unpack_from("<I", start, 243)
        if extended > size // 60:
            raise FormatError(
                str(path), expected=f"at most {size // 60} records after its points",
                got=f"{extended}", fix="export it again",
            )  # fmt: skip

    if start[104] & _PACKED:
        _check_chunks(path, data, size)


def _check_chunks(path: StrPath, data: int, size: int) -> None:
    """Make sure that the table of compressed chunks is no longer than the file."""
    with open(path, "rb") as file:
        file.seek(data)
        (at,) = struct.unpack("<q", file.read(8).ljust(8, b"\xff"))
        if at == -1:  # written to a stream: the table's place stands at the end
            file.seek(max(size - 8, 0))
            (at,) = struct.unpack("<q", file.read(8).ljust(8, b"\xff"))
        if data < at <= size - 8:
            file.seek(at)
            _, chunks = struct.unpack("<II", file.read(8))
            if chunks <= (size - data) // _LEAST_CHUNK:
                return
    raise FormatError(
        str(path), expected="a table of its chunks", got="none that fits the file",
        fix="the file may be cut off; export it again",
    )  # fmt: skip


def _points(laspy: Any, path: StrPath) -> FloatArray:  # noqa: ANN401
    with laspy.open(str(path)) as reader:
        count, packed = int(reader.header.point_count), bool(reader.header.are_points_compressed)
        if packed and not laspy.LazBackend.detect_available():
            raise ImportError("LAZ needs lazrs", name="lazrs")
        room = _MOST_POINTS if packed else Path(path).stat().st_size // _LEAST_BYTES
        if count > room:
            raise FormatError(
                str(path), expected=f"{count} points, as its header says", got=f"room for {room}"
            )
        points = Thinned(count)
        for block in reader.chunk_iterator(CHUNK_ROWS):
            kept = [points.of(np.asarray(getattr(block, axis))) for axis in "xyz"]
            points.add(np.stack(kept, axis=1), len(block))
    return points.stacked()


def _recognizes(path: Path) -> bool:
    return not path.is_dir() and head(path, 4) == b"LASF"


FORMAT = Format(
    name="las",
    description="point cloud in LAS or LAZ; walls are found among the points",
    suffixes=(".las", ".laz"),
    recognizes=_recognizes,
    read=read_las,
    extra="las",
)
