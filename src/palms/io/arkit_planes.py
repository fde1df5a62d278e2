"""Scans from ARKit's plane anchors, written out as JSON by one app or another."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.files import read_json
from palms.io.plane_geometry import read_polygon, read_vector, rectangle, word_of
from palms.io.plane_json import Plane, has_keys, planes_scan
from palms.io.registry import Format
from palms.io.values import StrPath
from palms.scan import Scan

__all__ = ["FORMAT", "arkit_scan", "read_arkit_planes"]

_EXPECTED = "ARKit planes: a list of anchors with transform and planeExtent"
_TRANSFORMS = ("transform", "worldTransform", "anchorTransform")
_NO_WALLS = ("floor", "ceiling", "table", "seat", "2", "3", "4", "5")
_LYING = ("horizontal", "0")


def read_arkit_planes(path: StrPath) -> Scan:
    """Read plane anchors of ARKit.

    Parameters
    ----------
    path : path
        A JSON file: a list of anchors, or an object with them under `planes` or `anchors`.

    Raises
    ------
    InputError
        When it cannot be read or holds no upright plane.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_json
    >>> plane = {
    ...     "transform": [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 2, 1, -3, 1],
    ...     "alignment": "vertical", "classification": "wall", "center": [0, 0, 0],
    ...     "planeExtent": {"width": 2.0, "height": 2.4, "rotationOnYAxis": 0},
    ... }
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/planes.json", [plane])
    ...     read_arkit_planes(f"{folder}/planes.json").walls_m.round(3).tolist()
    [[[1.0, 3.0], [3.0, 3.0]]]
    """
    return arkit_scan(read_json(path, _EXPECTED), path)


def arkit_scan(content: object, what: StrPath) -> Scan:
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
    alignment = word_of(plane.get("alignment", plane.get("planeAlignment")))
    kind = word_of(plane.get("classification", plane.get("planeClassification")))
    return alignment not in _LYING and kind not in _NO_WALLS


def _matrix(plane: Plane, what: str) -> object:
    for key in _TRANSFORMS:
        if key in plane:
            return plane[key]
    raise FormatError(f"{what}, transform", expected="a 4x4 matrix", got="nothing")


def _corners(plane: Plane, what: str) -> FloatArray:
    """Corners (4, 3) of a plane's rectangle, else the vertices (K, 3) of its outline."""
    center = plane.get("center", plane.get("planeCenter"))
    middle = np.zeros(3) if center is None else read_vector(center, f"{what}, center")
    extent = plane.get("planeExtent", plane.get("extent"))
    if extent is None:
        geometry = plane.get("geometry")
        outline = geometry if isinstance(geometry, dict) else plane
        vertices = outline.get("boundaryVertices")
        return read_polygon(vertices, f"{what}, extent", "planeExtent or extent")
    width, height, turn = _extent(extent, f"{what}, extent")
    return np.asarray(middle + rectangle((width, height), turn, f"{what}, extent"))


def _extent(extent: Any, what: str) -> tuple[float, float, float]:  # noqa: ANN401
    """Width, height and rotation of a plane, from what iOS before 16 had, or since."""
    if isinstance(extent, dict) and "width" in extent:
        values = [extent["width"], extent.get("height", 0.0), extent.get("rotationOnYAxis", 0.0)]
        width, height, turn = read_vector(values, what)
    elif isinstance(extent, dict) or (isinstance(extent, list) and len(extent) == 2):
        width, height = read_vector(extent, what, "xz")
        turn = 0.0
    else:
        width, _, height = read_vector(extent, what)
        turn = 0.0
    return float(width), float(height), float(turn)


def _recognizes(path: Path) -> bool:
    return (
        not path.is_dir()
        and has_keys(
            path, (b"transform", b"worldTransform"),
            (b"planeExtent", b"extent", b"boundaryVertices"),
        )
        and not has_keys(path, (b"dimensions", b"centerPose", b"semanticLabel"))
    )  # fmt: skip


FORMAT = Format(
    name="arkit-planes",
    description="plane anchors of ARKit as JSON: transform, planeExtent or extent, classification",
    suffixes=(".json",),
    recognizes=_recognizes,
    read=read_arkit_planes,
)
