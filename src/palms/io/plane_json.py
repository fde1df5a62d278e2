"""What the JSON files of planes have in common: a list of them, and perhaps a place."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.files import head
from palms.io.plane_geometry import on_ground, read_matrices, read_pose, read_vector, upright_wall
from palms.io.planes import session_of
from palms.io.values import StrPath, brief, locating
from palms.scan import Scan

__all__ = ["Plane", "has_keys", "list_of", "planes_scan"]

Plane = dict[str, Any]
_PLACES = ("position", "viewer", "camera", "devicePosition")


def has_keys(path: Path, *needed: bytes | tuple[bytes, ...]) -> bool:
    """Whether the start of a JSON file has all keys, or one of each tuple.

    Examples
    --------
    >>> has_keys(Path("no such file"), b"planes")
    False
    """
    start = head(path)
    if start.removeprefix(b"\xef\xbb\xbf").lstrip()[:1] not in (b"[", b"{"):
        return False
    return all(
        any(b'"' + key + b'"' in start for key in (keys if isinstance(keys, tuple) else (keys,)))
        for keys in needed
    )


def list_of(content: object, keys: tuple[str, ...], path: StrPath, expected: str) -> list[Plane]:
    """Return the planes of a file: a list, or an object that holds one under a known key."""
    listed = content
    if isinstance(content, dict):
        listed = next((content[key] for key in keys if key in content), None)
    if not isinstance(listed, list) or not listed:
        got = "an empty list" if listed == [] else brief(content)
        raise FormatError(str(path), expected=expected, got=got, fix="scan again near walls")
    for index, plane in enumerate(listed):
        if not isinstance(plane, dict):
            raise FormatError(f"{path} plane {index}", expected="a plane", got=brief(plane))
    return listed


def planes_scan(
    content: object,
    path: StrPath,
    expected: str,
    is_wall: Callable[[Plane], bool],
    matrix_of: Callable[[Plane, str], object],
    corners_of: Callable[[Plane, str], FloatArray],
) -> Scan:
    """Return the scan that a list of planes of an AR session makes.

    Parameters
    ----------
    content : object
        What the file held.
    path : path
        What to call it in messages.
    expected : str
        What it should hold, for messages.
    is_wall : callable
        Whether a plane may be a wall, by its class; whether it is upright is found here.
    matrix_of, corners_of : callable
        From a plane and its name to its matrix, as written, and its corners (K, 3).

    Raises
    ------
    FormatError
        When it holds no upright plane.
    """
    planes = list_of(content, ("planes", "anchors", "detectedPlanes"), path, expected)
    kept = [(i, plane) for i, plane in enumerate(planes) if is_wall(plane)]
    names = [f"{path} plane {i}" for i, _ in kept]
    written = [
        read_pose(matrix_of(plane, name), name)
        for (_, plane), name in zip(kept, names, strict=True)
    ]
    matrices = read_matrices(written, [f"{name}, transform" for name in names])
    walls = [
        upright_wall(corners_of(plane, name), matrix, name)
        for (_, plane), name, matrix in zip(kept, names, matrices, strict=True)
    ]
    upright = [wall for wall in walls if wall is not None]
    if not upright:
        raise FormatError(
            str(path), expected="at least one upright plane", got=f"{len(planes)} planes, none",
            fix="scan again, turning all the way round near walls",
        )  # fmt: skip
    with locating(path):
        return Scan(np.array(upright), _position(content, path), session=session_of(path))


def _position(content: object, path: StrPath) -> FloatArray:
    """Observation point (2,) that a file states, else the origin."""
    if not isinstance(content, dict):
        return np.zeros(2)
    for key in _PLACES:
        place = content.get(key)
        if isinstance(place, dict) and "position" in place:
            place = place["position"]
        if place is not None:
            return on_ground(read_vector(place, f"{path}: {key}"))
    return np.zeros(2)
