"""Scans of messages: planes into walls, and no more of them than a scanner can see."""

from __future__ import annotations

from typing import Any

import numpy as np

from palms.errors import InputError
from palms.geometry import FloatArray, check_finite, lengths
from palms.io.arkit_planes import arkit_scan
from palms.io.values import check_array
from palms.io.webxr_planes import webxr_scan
from palms.scan import Scan
from palms.server import messages
from palms.server.intake import ground_pose

__all__ = ["clipped", "read_scan", "scan_message"]

REACH_M = 30.0  # ours: three times a phone's LiDAR; planes grow while one walks
MOST_WALLS = 400  # ours: a scan of the sample building has 40
MOST_M = 800.0  # ours: the metres of wall that are judged against 60,000 poses


def read_scan(message: messages.Scan, here_m: tuple[float, float]) -> Scan:
    """Return the scan of a message, taken where it says, else where the phone is.

    Walls are cut to what lies within `REACH_M` of the observation point.

    Parameters
    ----------
    message : messages.Scan
    here_m : (float, float)
        Where the phone is by its odometry.

    Raises
    ------
    InputError
        When there is no wall, or there are more than a scan can have.
    """
    position = message.position_m
    if position is None:
        position = here_m if message.pose is None else ground_pose(message.pose).position_m
    walls = clipped(_walls(message), np.array(position), REACH_M)
    if len(walls) > MOST_WALLS or lengths(walls).sum() > MOST_M:
        raise InputError(
            "scan", expected=f"at most {MOST_WALLS} walls and {MOST_M:g} m of them",
            got=f"{len(walls)} and {lengths(walls).sum():.0f} m", fix="send large planes only",
        )  # fmt: skip
    coverage = None
    if message.coverage_m is not None:
        coverage = np.array([np.nan if r is None else r for r in message.coverage_m])
    place = check_finite(position, "the scan's position", (2,))
    return Scan(walls, place, coverage, message.t_s)


def scan_message(scan: Scan) -> messages.Scan:
    """Return a scan as a phone would send it, its first input.

    Examples
    --------
    >>> scan_message(Scan([[[2.0, -2.5], [2.0, 0.5]]])).planes
    ([[2.0, -2.5], [2.0, 0.5]],)
    """
    free = None
    if scan.coverage_m is not None:
        free = tuple(None if np.isnan(r) else float(r) for r in scan.coverage_m)
    x, y = (float(value) for value in scan.position_m)
    return messages.Scan(
        seq=1, t_s=0.0, planes=tuple(scan.walls_m.tolist()), coverage_m=free, position_m=(x, y)
    )


def _walls(message: messages.Scan) -> FloatArray:
    planes = _listed(message.planes)
    if message.form == "walls":
        return check_array(planes, "scan, planes", (None, 2, 2))
    read = webxr_scan if message.form == "webxr" else arkit_scan
    return read({"planes": planes}, "scan").walls_m


def _listed(planes: Any) -> Any:  # noqa: ANN401 - tuples of callers in Python, lists of JSON
    return [_listed(each) for each in planes] if isinstance(planes, list | tuple) else planes


def clipped(walls_m: FloatArray, centre_m: FloatArray, radius_m: float) -> FloatArray:
    """Cut walls (N, 2, 2) to a disc; those outside of it are left out.

    Examples
    --------
    >>> walls = np.array([[[-50.0, 3.0], [50.0, 3.0]], [[9.0, 9.0], [8.0, 8.0]]])
    >>> clipped(walls, np.zeros(2), 5.0).tolist()
    [[[-4.0, 3.0], [4.0, 3.0]]]
    """
    start, along = walls_m[:, 0] - centre_m, walls_m[:, 1] - walls_m[:, 0]
    a = (along**2).sum(axis=1)
    b, c = (start * along).sum(axis=1), (start**2).sum(axis=1) - radius_m**2
    root = np.sqrt(np.maximum(b**2 - a * c, 0.0))
    safe = np.where(a > 0, a, 1.0)
    first = np.clip((-b - root) / safe, 0.0, 1.0)
    last = np.clip((-b + root) / safe, 0.0, 1.0)
    ends = walls_m[:, :1] + np.stack([first, last], axis=1)[:, :, None] * along[:, None]
    inside = (b**2 - a * c > 0) & (last > first)
    return np.asarray(ends[inside])
