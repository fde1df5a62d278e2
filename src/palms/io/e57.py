"""Scans from point clouds in E57, the format of surveyors' scanners."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import InputError
from palms.extraction.settings import ExtractionSettings
from palms.geometry import FloatArray
from palms.io.files import head
from palms.io.point_clouds import CloudOptions, Thinned, cloud_file, cloud_scan, parse_position
from palms.io.registry import Format
from palms.io.values import StrPath
from palms.scan import Scan

__all__ = ["FORMAT", "read_e57"]

_MOST_POINTS = 20_000_000  # ours: of one scan; the library reads a scan as a whole


def read_e57(
    path: StrPath,
    *,
    up: str = "z",
    position: object = None,
    floor: object = None,
    settings: ExtractionSettings | None = None,
) -> Scan:
    """Read the walls of all scans of an E57 file, in its common frame.

    Parameters
    ----------
    path : path
        The file.
    up, position, floor, settings
        As in `palms.io.point_clouds.CloudOptions`; when `position` is left out and the file has
        one scan, the place of its scanner.

    Raises
    ------
    InputError
        When it cannot be read or holds no wall.
    """
    import pye57

    here = parse_position(position)
    with cloud_file(path, "an E57 file"):
        points, scanner = _points(pye57.E57(str(path)), path)
    if here is None and scanner is not None and up == "z":
        here = scanner[:2]
    return cloud_scan(points, path, CloudOptions(up, here, floor, settings))


def _points(file: Any, path: StrPath) -> tuple[FloatArray, FloatArray | None]:  # noqa: ANN401
    """All points (P, 3), and the place of the scanner when there was one that says so."""
    headers = [file.get_header(index) for index in range(file.scan_count)]
    counts = [int(header.point_count) for header in headers]
    size = Path(path).stat().st_size
    for count in counts:
        if count > min(_MOST_POINTS, 8 * size):
            raise InputError(
                str(path), expected=f"at most {_MOST_POINTS} points a scan, as the file has room",
                got=f"{count}", fix="thin the cloud first",
            )  # fmt: skip
    points = Thinned(sum(counts))
    for index, count in enumerate(counts):
        scan = file.read_scan(index, ignore_missing_fields=True)
        axes = [points.of(np.asarray(scan[f"cartesian{axis}"])) for axis in "XYZ"]
        points.add(np.stack(axes, axis=1), count)
    single = len(headers) == 1 and headers[0].has_pose()
    return points.stacked(), np.asarray(headers[0].translation) if single else None


def _recognizes(path: Path) -> bool:
    return not path.is_dir() and head(path, 8) == b"ASTM-E57"


FORMAT = Format(
    name="e57",
    description="point cloud in E57; walls are found among the points",
    suffixes=(".e57",),
    recognizes=_recognizes,
    read=read_e57,
    extra="e57",
)
