"""Scans from the planes that ARCore detects, written out as JSON."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.files import read_json
from palms.io.plane_geometry import read_vector, rectangle, word_of
from palms.io.plane_json import Plane, has_keys, planes_scan
from palms.io.registry import Format
from palms.io.values import StrPath, check_array, check_number
from palms.scan import Scan

__all__ = ["FORMAT", "read_arcore_planes"]

_EXPECTED = "ARCore planes: an object with planes, each with centerPose and polygon"
_LYING = ("0", "1", "horizontal", "horizontal_upward_facing", "horizontal_downward_facing")
_LOST = ("stopped", "2")


def read_arcore_planes(path: StrPath) -> Scan:
    """Read planes of ARCore.

    Parameters
    ----------
    path : path
        A JSON file: a list of planes, or an object with them under `planes`.

    Raises
    ------
    InputError
        When it cannot be read or holds no upright plane.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_json
    >>> plane = {
    ...     "type": "VERTICAL", "extentX": 2.0, "extentZ": 2.4, "subsumedBy": None,
    ...     "centerPose": {"translation": [2, 1, -3], "rotation": [0.7071068, 0, 0, 0.7071068]},
    ... }
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/planes.json", {"planes": [plane]})
    ...     read_arcore_planes(f"{folder}/planes.json").walls_m.round(3).tolist()
    [[[1.0, 3.0], [3.0, 3.0]]]
    """
    content = read_json(path, _EXPECTED)
    return planes_scan(content, path, _EXPECTED, _may_be_wall, _matrix, _corners)


def _may_be_wall(plane: Plane) -> bool:
    """Whether a plane is upright by its own word, tracked, and not part of another."""
    return (
        word_of(plane.get("type")) not in _LYING
        and word_of(plane.get("subsumedBy")) in ("", "false")
        and word_of(plane.get("trackingState")) not in _LOST
    )


def _matrix(plane: Plane, what: str) -> object:
    if "centerPose" not in plane:
        raise FormatError(f"{what}, centerPose", expected="translation and rotation", got="nothing")
    return plane["centerPose"]


def _corners(plane: Plane, what: str) -> FloatArray:
    """Corners (K, 3): of the polygon, whose numbers are x, z, x, z, ...; else of the extent."""
    polygon = plane.get("polygon")
    if isinstance(polygon, list) and polygon:
        if not isinstance(polygon[0], list | dict):
            polygon = [polygon[i : i + 2] for i in range(0, len(polygon) - 1, 2)]
        flat = [read_vector(point, f"{what}, polygon", "xz").tolist() for point in polygon]
        flat_m = check_array(flat, f"{what}, polygon", (None, 2))
        return np.insert(flat_m, 1, 0.0, axis=1)
    width, height = (
        check_number(plane.get(key), f"{what}, {key}") for key in ("extentX", "extentZ")
    )
    return rectangle((width, height), 0.0, f"{what}, extentX")


def _recognizes(path: Path) -> bool:
    return not path.is_dir() and has_keys(path, b"centerPose", (b"polygon", b"extentX"))


FORMAT = Format(
    name="arcore-planes",
    description="planes of ARCore as JSON: type, centerPose, polygon or extentX and extentZ",
    suffixes=(".json",),
    recognizes=_recognizes,
    read=read_arcore_planes,
)
