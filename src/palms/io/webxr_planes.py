"""Scans from the planes that a WebXR session detects, written out as JSON."""

from __future__ import annotations

from pathlib import Path

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.files import read_json
from palms.io.plane_geometry import read_polygon, word_of
from palms.io.plane_json import Plane, has_keys, planes_scan
from palms.io.registry import Format
from palms.io.values import StrPath
from palms.scan import Scan

__all__ = ["FORMAT", "read_webxr_planes", "webxr_scan"]

_EXPECTED = "WebXR planes: an object with planes, each with pose and polygon"
_WALLS = ("", "wall", "door", "window", "other", "unknown", "none")
_POSES = ("pose", "transform", "matrix", "planeSpace")


def read_webxr_planes(path: StrPath) -> Scan:
    """Read planes of a WebXR session.

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
    ...     "semanticLabel": "wall", "orientation": "vertical",
    ...     "polygon": [{"x": x, "y": 0, "z": z} for x, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))],
    ...     "pose": {"position": {"x": 2, "y": 1, "z": -3},
    ...              "orientation": {"x": 0.7071068, "y": 0, "z": 0, "w": 0.7071068}},
    ... }
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/planes.json", {"planes": [plane]})
    ...     read_webxr_planes(f"{folder}/planes.json").walls_m.round(3).tolist()
    [[[1.0, 3.0], [3.0, 3.0]]]
    """
    return webxr_scan(read_json(path, _EXPECTED), path)


def webxr_scan(content: object, what: StrPath) -> Scan:
    """Return the scan of planes that were read before.

    Parameters
    ----------
    content : object
        As the file has it.
    what : path
        What to call it in messages.

    Raises
    ------
    FormatError
        When it holds no upright plane.
    """
    return planes_scan(content, what, _EXPECTED, _may_be_wall, _matrix, _corners)


def _may_be_wall(plane: Plane) -> bool:
    lies = (
        isinstance(plane.get("orientation"), str) and word_of(plane["orientation"]) == "horizontal"
    )
    return not lies and word_of(plane.get("semanticLabel")) in _WALLS


def _matrix(plane: Plane, what: str) -> object:
    for key in _POSES:
        if key in plane:
            return plane[key]
    raise FormatError(
        f"{what}, pose", expected="position and orientation, or a 4x4 matrix", got="nothing",
        fix="write frame.getPose(plane.planeSpace, space).transform beside each polygon",
    )  # fmt: skip


def _corners(plane: Plane, what: str) -> FloatArray:
    return read_polygon(plane.get("polygon"), f"{what}, polygon", "points x, y, z")


def _recognizes(path: Path) -> bool:
    return (
        not path.is_dir()
        and has_keys(path, b"polygon", (b"semanticLabel", b"orientation", b"planeSpace"))
        and not has_keys(path, (b"centerPose", b"extentX"))
    )


FORMAT = Format(
    name="webxr-planes",
    description="planes of a WebXR session as JSON: pose, polygon, semanticLabel",
    suffixes=(".json",),
    recognizes=_recognizes,
    read=read_webxr_planes,
)
