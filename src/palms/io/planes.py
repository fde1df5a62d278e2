"""Scans as the PALMS data set has them: ``Session_<id>/detectedPlanes.json``.

Three forms are read: planes with histories (`centers`, `extents`), the older form
(`planeCenter`, `planeExtent`), and plain segments ``[[[x1, y1], [x2, y2]], ...]``.
A file ``scan.json`` beside it may add ``t_s``, ``position_m``, and of ours
``coverage_m`` (null where nobody looked) and ``session``. Without `coverage_m`, depth images
in folders beside the planes tell what is empty.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from palms.errors import FormatError, InputError, PalmsWarning
from palms.geometry import FloatArray, lengths
from palms.io.files import head, make_folder, read_json, remove_stale, write_json
from palms.io.registry import Format
from palms.io.values import StrPath, brief, check_array, check_number, locating, null_for_nan
from palms.scan import Scan

if TYPE_CHECKING:
    from palms.io.plane_models import HistoryPlane, OlderPlane

__all__ = [
    "FORMAT",
    "PLANES_FILE",
    "read_scan_json",
    "read_sidecar",
    "scan_time_s",
    "session_of",
    "write_scan_json",
]

PLANES_FILE = "detectedPlanes.json"
VERTICAL = 1  # planeAlignment of a wall
WALL_HEIGHT_M = 2.4  # ours: what is written as the height of walls; nothing reads it
_EXPECTED = "a scan: a list of planes, or of segments [[x1,y1],[x2,y2]]"
_RIGID_TOLERANCE = 0.05  # ours: how far a rotation may be from orthonormal
_PLAIN = re.compile(rb"^(\xef\xbb\xbf)?\s*\[\s*\[\s*\[\s*[-+\d.]")


def session_of(path: StrPath) -> str | None:
    """Return X when a scan's file lies in a folder ``Session_X``, else None.

    Examples
    --------
    >>> session_of("Session_1717523676/detectedPlanes.json")
    '1717523676'
    """
    place = Path(path)
    folder = place if place.suffix.lower() != ".json" or place.is_dir() else place.parent
    name = folder.name or folder.resolve().name
    return name.removeprefix("Session_") or None if name.startswith("Session_") else None


def _planes_path(path: StrPath) -> Path:
    place = Path(path)
    if not place.is_dir():
        return place
    if not (place / PLANES_FILE).is_file():
        raise InputError(
            str(path),
            expected=f"a folder with {PLANES_FILE}",
            got="a folder without it",
            fix="name the scan's file or its Session_ folder",
        )
    return place / PLANES_FILE


def _sidecar(planes: Path) -> Path:
    """Return ``scan.json`` for a session's planes, ``<stem>.scan.json`` for other files."""
    in_session = planes.parent.name.startswith("Session_") or planes.name == PLANES_FILE
    own = in_session and planes.name != "scan.json"
    return planes.with_name("scan.json" if own else f"{planes.stem}.scan.json")


def read_scan_json(path: StrPath) -> Scan:
    """Read a scan in any of the data set's three forms.

    Parameters
    ----------
    path : path
        The JSON file, or the folder ``Session_<id>`` with ``detectedPlanes.json`` in it.

    Raises
    ------
    InputError
        When it cannot be read or holds no vertical plane.

    Examples
    --------
    >>> import tempfile
    >>> plane = {
    ...     "anchorTransform": [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, -2], [0, 0, 0, 1]],
    ...     "centers": [[0, 0, 0]], "extents": [[3, 2.4, 0]], "planeAlignment": 1,
    ... }
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/detectedPlanes.json", [plane])
    ...     read_scan_json(folder).walls_m.tolist()
    [[[2.0, -2.5], [2.0, 0.5]]]
    """
    planes = _planes_path(path)
    walls = _walls(read_json(planes, _EXPECTED), planes)
    extras = {"session": session_of(planes)} | read_sidecar(planes)
    with locating(planes):
        scan = Scan(walls, **extras)
    return scan if scan.coverage_m is not None else _with_depth(scan, planes.parent)


def _with_depth(scan: Scan, folder: Path) -> Scan:
    """Say what the depth images beside a session's planes prove empty, if there are any."""
    from palms.io.depth_folder import FORMAT as DEPTH
    from palms.io.depth_folder import read_coverage

    if not DEPTH.recognizes(folder):
        return scan
    try:
        return replace(scan, coverage_m=read_coverage(folder, scan.position_m))
    except InputError as error:
        warnings.warn(f"the depth images are left out: {error}", PalmsWarning, stacklevel=4)
        return scan


def scan_time_s(folder: StrPath) -> float:
    """Return when the scan of a session's folder was taken; 0 when it does not say.

    Examples
    --------
    >>> scan_time_s("Session_7")
    0.0
    """
    return float(read_sidecar(Path(folder) / PLANES_FILE).get("time_s", 0.0))


def _walls(listed: object, path: Path) -> FloatArray:
    if not isinstance(listed, list) or not listed:
        got = "an empty list" if isinstance(listed, list) else brief(listed)
        raise FormatError(str(path), expected=_EXPECTED, got=got, fix="scan again near walls")
    if not any(isinstance(item, dict) for item in listed):
        return check_array(listed, f"{path}: segments", (None, 2, 2))
    walls = []
    for index, plane in enumerate(listed):
        what = f"{path} plane {index}"
        if not isinstance(plane, dict):
            raise FormatError(what, expected="a plane", got=brief(plane))
        if _is_vertical(plane, what):
            walls.append(_wall(plane, what))
    if not walls:
        raise FormatError(
            str(path),
            expected=f"at least one vertical plane (planeAlignment {VERTICAL})",
            got=f"{len(listed)} planes, none vertical",
            fix="scan again, turning all the way round near walls",
        )
    return np.array(walls)


def _is_vertical(plane: dict[str, Any], what: str) -> bool:
    """Whether a plane is a wall; the older form does not say, and holds walls only."""
    alignment = plane.get("planeAlignment", VERTICAL)
    if isinstance(alignment, bool) or not isinstance(alignment, int | float):
        raise FormatError(
            f"{what}, planeAlignment", expected="0 or 1", got=brief(alignment),
            fix="record or export the scan again",
        )  # fmt: skip
    return bool(alignment == VERTICAL)


def _wall(plane: dict[str, Any], what: str) -> FloatArray:
    """End points (2, 2) of a plane on the ground, ``(-z, -x)`` of the session's frame."""
    from palms.io.plane_models import parse_plane

    parsed: HistoryPlane | OlderPlane = parse_plane(plane, what)
    transform = np.array(parsed.anchorTransform)
    _check_rigid(transform, f"{what}, anchorTransform")
    width, _, turn = parsed.extent
    if width < 0:
        raise FormatError(f"{what}, width", expected="0 m or more", got=f"{width:.6g}")
    half = 0.5 * width * np.array([np.cos(turn), 0.0, -np.sin(turn)])
    with np.errstate(all="ignore"):
        ends = np.array([parsed.center + half, parsed.center - half])
        session = ends @ transform[:3, :3].T + transform[:3, 3]
    ground: FloatArray = -session[:, [2, 0]] + 0.0  # + 0.0: no negative zero
    return check_array(ground, f"{what}, end points", (2, 2))


def _check_rigid(transform: FloatArray, what: str) -> None:
    expected = "a rotation and a translation as nested rows, the last 0 0 0 1"
    with np.errstate(all="ignore"):
        rotation = transform[:3, :3]
        off = np.abs(rotation @ rotation.T - np.eye(3)).max()
        proper = off <= _RIGID_TOLERANCE and np.linalg.det(rotation) > 0
    last = transform[3]
    if np.abs(last - [0, 0, 0, 1]).max() > 1e-3:
        turned = np.abs(transform[:, 3] - [0, 0, 0, 1]).max() <= 1e-3
        raise FormatError(
            what,
            expected=expected,
            got=f"the last row {brief(last.tolist())}",
            fix="transpose it: its columns are stored as rows" if turned else "export it again",
        )
    if not proper:
        raise FormatError(
            what, expected=expected, got="a matrix that is no rotation", fix="export it again"
        )


def read_sidecar(planes: Path) -> dict[str, Any]:
    """Return what the file beside a session's planes says of the scan; nothing without one.

    Examples
    --------
    >>> read_sidecar(Path("Session_7/detectedPlanes.json"))
    {}
    """
    path = _sidecar(planes)
    if not path.is_file():
        return {}
    content = read_json(path, "an object with t_s and position_m")
    if not isinstance(content, dict):
        raise FormatError(
            str(path), expected="an object with t_s and position_m", got=brief(content)
        )
    found: dict[str, Any] = {}
    if content.get("t_s") is not None:
        found["time_s"] = check_number(content["t_s"], f"{path}: t_s")
    if content.get("position_m") is not None:
        found["position_m"] = check_array(content["position_m"], f"{path}: position_m", (2,))
    if content.get("coverage_m") is not None:
        found["coverage_m"] = _coverage(content["coverage_m"], f"{path}: coverage_m")
    if content.get("session") is not None:
        found["session"] = str(content["session"]).removeprefix("Session_")
    return found


def _coverage(values: object, what: str) -> FloatArray:
    if not isinstance(values, list):
        raise FormatError(what, expected="a list of ranges or null", got=brief(values))
    unseen = np.array([value is None for value in values], dtype=bool)
    ranges = check_array([0.0 if value is None else value for value in values], what, (None,))
    return np.where(unseen, np.nan, ranges)


def write_scan_json(scan: Scan, path: StrPath) -> None:
    """Write a scan as planes with histories, such that reading gives it back.

    Parameters
    ----------
    scan : Scan
        The scan.
    path : path
        A file ending in ``.json``, whose folder must exist; or a folder, created when it is
        not there, that receives ``detectedPlanes.json``. What planes cannot say goes into
        ``scan.json`` beside it (``<stem>.scan.json`` outside a session's folder).

    Raises
    ------
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_scan_json(Scan([[[2, -2], [2, 2]]], time_s=3.5), f"{folder}/Session_7")
    ...     again = read_scan_json(f"{folder}/Session_7")
    >>> again.walls_m.tolist(), again.time_s, again.session
    ([[[2.0, -2.0], [2.0, 2.0]]], 3.5, '7')
    """
    place = Path(path)
    if place.is_dir() or place.suffix.lower() != ".json":
        place = make_folder(place) / PLANES_FILE
    write_json(place, [_plane(i, wall) for i, wall in enumerate(scan.walls_m)])
    extras = _extras(scan, session_of(place))
    if extras:
        write_json(_sidecar(place), extras)
    else:
        remove_stale(_sidecar(place))


def _extras(scan: Scan, folder_session: str | None) -> dict[str, Any]:
    extras: dict[str, Any] = {}
    if scan.time_s or scan.position_m.any():
        extras |= {"t_s": float(scan.time_s), "position_m": scan.position_m.tolist()}
    if scan.coverage_m is not None:
        extras["coverage_m"] = null_for_nan(scan.coverage_m)
    if scan.session is not None and scan.session != folder_session:
        extras["session"] = scan.session
    return extras


def _plane(index: int, wall: FloatArray) -> dict[str, Any]:
    """Return a vertical plane: anchor x along the wall, y its normal, z down."""
    width = float(lengths(wall[None])[0])
    along = (wall[0] - wall[1]) / width
    middle = wall.mean(axis=0)
    x_axis = np.array([-along[1], 0.0, -along[0]])
    down = np.array([0.0, -1.0, 0.0])
    transform = np.eye(4)
    transform[:3, :3] = np.stack([x_axis, np.cross(down, x_axis), down], axis=1)
    transform[:3, 3] = [-middle[1], 0.0, -middle[0]]
    return {
        "index": index,
        "id": f"wall-{index}",
        "anchorTransform": (transform + 0.0).tolist(),
        "centers": [[0.0, 0.0, 0.0]],
        "extents": [[width, WALL_HEIGHT_M, 0.0]],
        "updatedTimes": [0.0],
        "planeAlignment": VERTICAL,
    }


def _recognizes(path: Path) -> bool:
    if path.is_dir():
        return (path / PLANES_FILE).is_file()
    start = head(path)
    listed = start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"[")
    return (listed and b'"anchorTransform"' in start) or bool(_PLAIN.match(start))


FORMAT = Format(
    name="planes",
    description="the PALMS data set's detectedPlanes.json, or its Session_ folder",
    suffixes=(".json",),
    recognizes=_recognizes,
    read=read_scan_json,
    write=write_scan_json,
)
