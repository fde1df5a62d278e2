"""Poses in three dimensions, as logs of them have it, and the walk on the ground below."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from palms.errors import FormatError, PalmsWarning
from palms.geometry import FloatArray
from palms.io.values import StrPath, locating
from palms.io.walk import RecordedWalk
from palms.odometry import Odometry

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

__all__ = [
    "EVERY_S",
    "GROUNDS",
    "TIME_UNITS",
    "Ground",
    "PoseLog",
    "ground_walk",
    "seconds",
    "thinned",
]

EVERY_S: Final = 0.4  # ours: about a step; trackers give 30 to 60 poses a second
FAR_M: Final = 5.0  # ours: who scans and then walks begins nearer to the origin
TIME_UNITS: Final = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_SLOWEST_S = 1.3  # ours: a pose every second at least; read in the unit before, every 17 minutes
_STEEP = 0.15  # ours: looking straight up or down there is no direction on the ground
_ALONG = 0.7  # ours: cosine from which an axis of the phone counts as looking ahead


@dataclass(frozen=True, slots=True)
class Ground:
    """How axes in space become the ground plane, right-handed seen from above.

    Parameters
    ----------
    up : int
        Index of the axis that stands upright.
    first, second : tuple of int and float
        Index and sign of the axes that become x and y.

    Examples
    --------
    >>> GROUNDS["x,-z"].project(np.array([[1.0, 2.0, -3.0]])).tolist()
    [[1.0, 3.0]]
    """

    up: int
    first: tuple[int, float]
    second: tuple[int, float]

    def project(self, points_m: FloatArray) -> FloatArray:
        """Return points (N, 2) on the ground of points (N, 3) in space."""
        (i, a), (j, b) = self.first, self.second
        return np.column_stack([a * points_m[:, i], b * points_m[:, j]]) + 0.0


GROUNDS: Final = {
    "x,-z": Ground(1, (0, 1.0), (2, -1.0)),  # y up, as ARKit, ARCore and WebXR have it
    "-z,-x": Ground(1, (2, -1.0), (0, -1.0)),  # y up, as the PALMS data set has it
    "x,y": Ground(2, (0, 1.0), (1, 1.0)),  # z up
    "x,z": Ground(1, (0, 1.0), (2, 1.0)),  # y down, as cameras of computer vision have it
}


@dataclass(frozen=True, slots=True)
class PoseLog:
    """Poses of a phone in space.

    Parameters
    ----------
    time_s : ndarray (T,)
        Not decreasing, from the first pose.
    position_m : ndarray (T, 3)
    rotation : scipy Rotation or None
        T of them, from the phone's or camera's axes to those of the log.

    Examples
    --------
    >>> len(PoseLog(np.zeros(1), np.zeros((1, 3)), None).time_s)
    1
    """

    time_s: FloatArray
    position_m: FloatArray
    rotation: Rotation | None


def thinned(time_s: FloatArray, every_s: float) -> list[int]:
    """Return which samples to keep: the first, those `every_s` or more apart, and the last.

    Examples
    --------
    >>> thinned(np.array([0.0, 0.2, 0.4, 0.6]), 0.4)
    [0, 2, 3]
    """
    kept, last = [0], float(time_s[0])
    for index, time in enumerate(time_s.tolist()):
        if time > last and time - last >= every_s - 1e-6:
            kept.append(index)
            last = time
    return kept if time_s[-1] <= last else [*kept, len(time_s) - 1]


def seconds(times: FloatArray, what: StrPath, unit: str | None = None) -> FloatArray:
    """Return times in seconds since the first, whatever their unit is.

    The unit is told by the spacing: phones write a pose at least every second and at most
    a thousand times a second.

    Parameters
    ----------
    times : ndarray (T,)
        T at least 2.
    what : path
        Where they come from, for the message.
    unit : {"s", "ms", "us", "ns"}, optional
        When it is known.

    Raises
    ------
    FormatError
        When there are fewer than two, they decrease, or they never change.

    Examples
    --------
    >>> seconds(np.array([105230574092166.0, 105230590753958.0]), "log.txt").round(4).tolist()
    [0.0, 0.0167]
    """
    since = times - times[:1]
    step = np.diff(since)
    if len(times) < 2 or (step < 0).any() or since[-1] <= 0:
        at = int(np.argmax(step < 0)) + 1 if len(times) > 1 and (step < 0).any() else 0
        got = f"{times[at]:.10g} after {times[at - 1]:.10g} in pose {at + 1}" if at else "one time"
        raise FormatError(
            str(what), expected="two poses or more at times that increase", got=got,
            fix="sort them, or record again",
        )  # fmt: skip
    if unit is None:
        spacing = float(np.median(step[step > 0]))
        fitting = (name for name, size in TIME_UNITS.items() if spacing * size < _SLOWEST_S)
        unit = next(fitting, "ns")
    return np.asarray(since * TIME_UNITS[unit])


def ground_walk(
    log: PoseLog, ground: Ground, frame: Literal["scan", "own"], forward: str, path: StrPath
) -> RecordedWalk:
    """Return the walk below a log of poses; it begins at the first pose.

    Parameters
    ----------
    log : PoseLog
    ground : Ground
    frame : {"scan", "own"}
        Whether the log's axes are those of the scan.
    forward : {"-z", "z", "x", "auto"}
        Which axis of the phone or camera looks ahead, for `facing_rad`; auto: the one that
        goes along with the walk, if any.
    path : path
        The file, for messages.

    Raises
    ------
    InputError
        When the walk has fewer than two moves, or moves that nobody makes.

    Warns
    -----
    PalmsWarning
        When a walk in the scan's frame begins far from its origin.

    Examples
    --------
    >>> log = PoseLog(np.arange(3.0), np.array([[0.0, 1, 0], [0, 1, -1], [1, 1, -1]]), None)
    >>> walk = ground_walk(log, GROUNDS["x,-z"], "scan", "-z", "log.txt")
    >>> walk.odometry().position_m.tolist()
    [[0.0, 1.0], [1.0, 1.0]]
    """
    place = ground.project(log.position_m)
    start, away = place[0], float(np.hypot(*place[0]))
    if frame == "scan" and away > FAR_M:
        warnings.warn(
            f"{path}: the walk begins {away:.1f} m from the origin of its frame, where the scan "
            "is taken to be made",
            PalmsWarning,
            stacklevel=3,
        )
    if frame == "own":
        place, start = place - start, np.zeros(2)
    with locating(path):
        odometry = Odometry(
            log.time_s[1:], place[1:], _facing(log, ground, forward), start, frame
        )  # fmt: skip
    return RecordedWalk.of(odometry, path=Path(path))


def _facing(log: PoseLog, ground: Ground, forward: str) -> FloatArray | None:
    """Direction (T - 1,) on the ground in which the phone looked; None when that is not known."""
    if log.rotation is None:
        return None
    axes = {"-z": (0.0, 0.0, -1.0), "z": (0.0, 0.0, 1.0), "x": (1.0, 0.0, 0.0)}
    wanted = axes if forward == "auto" else {forward: axes[forward]}
    looks = {name: ground.project(log.rotation.apply(axis)) for name, axis in wanted.items()}
    if forward == "auto":
        moves = np.diff(ground.project(log.position_m), axis=0)
        forward = max(looks, key=lambda name: _along(looks[name][1:], moves))
        if _along(looks[forward][1:], moves) < _ALONG:
            return None
    angles = _continued(looks[forward])
    return None if angles is None else angles[1:]


def _along(looks: FloatArray, moves: FloatArray) -> float:
    """Return the mean cosine between where the phone looks and where it goes, by distance."""
    walked = float(np.linalg.norm(moves, axis=1).sum())
    return float((looks * moves).sum() / walked) if walked > 0 else 0.0


def _continued(looks: FloatArray) -> FloatArray | None:
    """Angles of directions; where it looks up or down, the angle before."""
    clear = np.linalg.norm(looks, axis=1) > _STEEP
    if not clear.any():
        return None
    last = np.maximum.accumulate(np.where(clear, np.arange(len(looks)), -1))
    angle = np.arctan2(looks[:, 1], looks[:, 0])
    return np.asarray(angle[np.where(last < 0, int(clear.argmax()), last)])
