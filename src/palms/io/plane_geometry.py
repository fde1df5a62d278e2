"""Upright planes of AR sessions: matrices, poses, corners; from them walls on the ground.

The sessions of ARKit, ARCore, WebXR and RoomPlan are right-handed with y up; on the
ground a point (x, y, z) is (x, -z). A plane lies in the x-z plane of its own frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.values import brief, check_array, check_number

__all__ = [
    "MAX_TILT",
    "on_ground",
    "read_matrices",
    "read_polygon",
    "read_pose",
    "read_vector",
    "rectangle",
    "upright_wall",
    "word_of",
]

MAX_TILT = 0.35  # ours: the sine of 20 degrees: planes that lean more are no walls
_RIGID_TOLERANCE = 0.05  # ours: how far a rotation may be from orthonormal
_UP = np.array([0.0, 1.0, 0.0])


def on_ground(points: FloatArray) -> FloatArray:
    """Points (..., 3) of a session on the ground (..., 2).

    Examples
    --------
    >>> on_ground(np.array([1.0, 5.0, -2.0])).tolist()
    [1.0, 2.0]
    """
    return np.asarray(points[..., [0, 2]] * [1.0, -1.0] + 0.0)  # + 0.0: no negative zero


def word_of(value: object) -> str:
    """Return the word of an enumeration, written as a text, ``{"wall": {}}`` or a number.

    Examples
    --------
    >>> word_of({"Wall": {}}), word_of("wall"), word_of(1), word_of(None)
    ('wall', 'wall', '1', '')
    """
    if isinstance(value, dict):
        named = value.get("name", value.get("rawValue"))
        value = named if named is not None else next(iter(value), "")
    return "" if value is None else str(value).strip().lower()


def read_vector(value: object, what: str, keys: str = "xyz") -> FloatArray:
    """Return a vector written as a list or as an object with keys x, y, z.

    Examples
    --------
    >>> read_vector({"x": 1, "y": 2, "z": 3}, "center").tolist()
    [1.0, 2.0, 3.0]
    """
    if isinstance(value, dict):
        value = [value.get(key) for key in keys]
    if not isinstance(value, list) or len(value) < len(keys):
        raise FormatError(what, expected=f"{len(keys)} numbers", got=brief(value))
    return np.array([check_number(each, what) for each in value[: len(keys)]])


def read_polygon(value: object, what: str, expected: str) -> FloatArray:
    """Return the corners (K, 3) of a plane, written as a list of vectors.

    Examples
    --------
    >>> read_polygon([[0, 0, 0], {"x": 2, "y": 0, "z": 0}], "plane 0, polygon", "points").shape
    (2, 3)
    """
    if not isinstance(value, list) or len(value) < 2:
        raise FormatError(what, expected=expected, got=brief(value))
    return check_array([read_vector(each, what).tolist() for each in value], what, (None, 3))


def rectangle(size_m: tuple[float, float], turn_rad: float, what: str) -> FloatArray:
    """Return the corners (4, 3) of a plane about its middle, by its size along x and z.

    Examples
    --------
    >>> rectangle((2.0, 1.0), 0.0, "plane 0, extent")[:, [0, 2]].tolist()
    [[1.0, 0.5], [1.0, -0.5], [-1.0, -0.5], [-1.0, 0.5]]
    """
    if min(size_m) < 0:
        raise FormatError(what, expected="0 m or more", got=brief([float(v) for v in size_m]))
    x, z = 0.5 * np.array(size_m)[:, None] * [[1.0, 1.0, -1.0, -1.0], [1.0, -1.0, -1.0, 1.0]]
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    return np.column_stack([c * x + s * z, np.zeros(4), c * z - s * x])


def read_matrices(values: Sequence[object], names: Sequence[str]) -> FloatArray:
    """Return the matrices (N, 4, 4) of a file, whichever way they are written.

    Sixteen numbers or four lists of four; by columns, as ARKit holds them, or by rows: the
    place of the translation tells, and where no plane of the file has one, by columns.

    Parameters
    ----------
    values : sequence
        As they stand in the file.
    names : sequence of str
        File and place of each, for messages.

    Raises
    ------
    FormatError
        When one is no rotation and translation.

    Examples
    --------
    >>> flat = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]
    >>> read_matrices([flat], ["a.json plane 0"])[0, :3, 3].tolist()
    [5.0, 6.0, 7.0]
    """
    expected = "a 4x4 matrix: 16 numbers or 4 lists of 4"
    found = []
    for value, what in zip(values, names, strict=True):
        raw = value.get("columns", value) if isinstance(value, dict) else value
        if isinstance(raw, list) and len(raw) == 16:
            raw = [raw[i : i + 4] for i in range(0, 16, 4)]
        if not isinstance(raw, list) or len(raw) != 4:
            raise FormatError(what, expected=expected, got=brief(value), fix="export it again")
        found.append(check_array(raw, what, (4, 4)))
    matrices = np.array(found).reshape(-1, 4, 4)
    below, beside = np.abs(matrices[:, 3, :3]).max(axis=1), np.abs(matrices[:, :3, 3]).max(axis=1)
    if not ((below > 1e-3) & (beside <= 1e-3)).any() and (beside > 1e-3).any():
        matrices = matrices.transpose(0, 2, 1)
    matrices = matrices.transpose(0, 2, 1)
    for matrix, what in zip(matrices, names, strict=True):
        _check_rigid(matrix, what)
    return matrices


def _check_rigid(matrix: FloatArray, what: str) -> None:
    with np.errstate(all="ignore"):
        rotation = matrix[:3, :3]
        off = np.abs(rotation @ rotation.T - np.eye(3)).max()
        rigid = off <= _RIGID_TOLERANCE and np.linalg.det(rotation) > 0
        rigid = rigid and np.abs(matrix[3] - [0, 0, 0, 1]).max() <= 1e-3
    if not rigid:
        raise FormatError(
            what, expected="a rotation and a translation", got="another matrix",
            fix="export it again",
        )  # fmt: skip


def read_pose(value: object, what: str) -> Any:  # noqa: ANN401
    """Return a pose of position and quaternion as a nested 4x4 matrix by columns.

    Parameters
    ----------
    value : object
        ``{"position" or "translation": [x, y, z], "orientation" or "rotation":
        [x, y, z, w]}``, or seven numbers, the quaternion first. Anything else is returned
        as it is: a matrix.
    what : str
        For messages.

    Examples
    --------
    >>> pose = read_pose({"translation": [1, 2, 3], "rotation": [0, 0, 0, 1]}, "plane 0")
    >>> pose[3]
    [1.0, 2.0, 3.0, 1.0]
    """
    if isinstance(value, list) and len(value) == 7:
        value = {"position": value[4:], "orientation": value[:4]}
    if not isinstance(value, dict):
        return value
    if "matrix" in value or "transform" in value:
        return value.get("matrix", value.get("transform"))
    if not {"position", "translation"} & set(value):
        return value
    place = read_vector(value.get("position", value.get("translation")), f"{what}, position")
    q = read_vector(value.get("orientation", value.get("rotation")), f"{what}, orientation", "xyzw")
    norm = float(np.linalg.norm(q))
    if not 0.5 < norm < 2:
        raise FormatError(
            f"{what}, orientation", expected="a unit quaternion x, y, z, w", got=brief(q.tolist())
        )
    x, y, z, w = q / norm
    columns = [
        [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0.0],
        [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0.0],
        [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0.0],
    ]
    return [*columns, [*place.tolist(), 1.0]]


def upright_wall(corners: FloatArray, matrix: FloatArray, what: str) -> FloatArray | None:
    """Return what a plane with these corners covers on the ground.

    Parameters
    ----------
    corners : ndarray (K, 3)
        In the plane's frame, whose y axis is its normal.
    matrix : ndarray (4, 4)
        Plane to session.
    what : str
        For messages.

    Returns
    -------
    ndarray (2, 2) or None
        The wall's ends; None when the plane is not upright.

    Examples
    --------
    >>> stands = np.array([[1.0, 0, 0, 2], [0, 0, -1, 1], [0, 1, 0, -3], [0, 0, 0, 1]])
    >>> corners = np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])
    >>> upright_wall(corners, stands, "plane 0").tolist()
    [[1.0, 3.0], [3.0, 3.0]]
    """
    normal = matrix[:3, 1]
    if abs(normal[1]) > MAX_TILT:
        return None
    with np.errstate(all="ignore"):
        session = corners @ matrix[:3, :3].T + matrix[:3, 3]
        along = np.cross(_UP, normal)
        along /= np.linalg.norm(along)
        middle = session.mean(axis=0)
        places = (session - middle) @ along
        ends = middle + np.array([[places.min()], [places.max()]]) * along
        return check_array(on_ground(ends), f"{what}, ends", (2, 2))
