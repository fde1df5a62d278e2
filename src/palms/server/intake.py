"""From samples of a phone to moves: its clock, late samples, frames; values, no state.

The phone's clock is its own: only differences count, and it may be set while a session runs.
Everything here depends on the inputs alone, so that a journal replayed gives the same moves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from palms.errors import InputError
from palms.io.plane_geometry import on_ground, read_matrices, read_pose
from palms.odometry import Move
from palms.server.messages.inputs import Pose, Sample

__all__ = ["Intake", "away_s", "clocked", "ground_pose", "in_new_frame", "taken"]

LATE_S = 60.0  # ours: a sample that is older than this says that the clock was set
GAP_S = 3600.0  # ours: a longer gap, too
LONGEST_M = 100.0  # ours: no move is longer; the frame has jumped
UNKNOWN_S = 300.0  # ours: the phone was away so long if its clock was set meanwhile
LEVEL = 0.3  # ours: the sine of 17 degrees; who looks more steeply than that faces nowhere


@dataclass(frozen=True, slots=True)
class Intake:
    """What is known of a phone's clock and odometry between two samples.

    Parameters
    ----------
    offset_s : float or None
        The phone's clock less the session's; None before the first time.
    time_s : float
        Of the latest move, on the session's clock.
    position_m : (float, float) or None
        Latest position in the odom frame; None when the frame is new.
    left_m : (float, float)
        Displacement of late samples, to be added to the next move.
    facing_rad : float or None
        Where the phone looked last, odom frame.
    walked_m : float
        Length of all moves.
    n_late : int
        Samples that came too late to be moves of their own.
    is_paused : bool

    Examples
    --------
    >>> intake, _ = taken(Intake(), Sample(t_s=1000.0, position_m=(5.0, 5.0)))
    >>> intake, move = taken(intake, Sample(t_s=1000.5, position_m=(5.6, 5.0)))
    >>> move.time_s, round(move.dx_m, 3)
    (0.5, 0.6)
    """

    offset_s: float | None = None
    time_s: float = 0.0
    position_m: tuple[float, float] | None = None
    left_m: tuple[float, float] = (0.0, 0.0)
    facing_rad: float | None = None
    walked_m: float = 0.0
    n_late: int = 0
    is_paused: bool = False


class Ground(NamedTuple):
    """A pose on the ground: place, and where it looks unless up or down."""

    position_m: tuple[float, float]
    facing_rad: float | None


def clocked(intake: Intake, t_s: float) -> Intake:
    """Return an intake whose clock agrees with a time of the phone.

    Examples
    --------
    >>> clocked(Intake(), 50.0).offset_s
    50.0
    >>> clocked(Intake(offset_s=50.0, time_s=10.0), 1e6).offset_s  # set: it goes on from 10 s
    999990.0
    """
    if intake.offset_s is not None and -LATE_S <= _ahead_s(intake, t_s) <= GAP_S:
        return intake
    return replace(intake, offset_s=t_s - intake.time_s)


def _ahead_s(intake: Intake, t_s: float) -> float:
    return t_s - (intake.offset_s or 0.0) - intake.time_s


def in_new_frame(intake: Intake) -> Intake:
    """Return an intake whose odometry begins anew; its clock goes on.

    Examples
    --------
    >>> in_new_frame(Intake(50.0, 10.0, (3.0, 4.0), walked_m=7.0)).position_m is None
    True
    """
    return replace(
        intake, position_m=None, left_m=(0.0, 0.0), facing_rad=None, is_paused=False
    )  # fmt: skip


def away_s(intake: Intake, t_s: float) -> float:
    """Return how long nothing was known of a phone, at the first time that it tells again.

    Examples
    --------
    >>> away_s(Intake(50.0, 10.0), 75.0), away_s(Intake(50.0, 10.0), 0.0), away_s(Intake(), 5.0)
    (15.0, 0.0, 0.0)
    >>> away_s(Intake(5000.0, 10.0), 0.0)  # its clock was set
    300.0
    """
    if intake.offset_s is None:
        return 0.0
    ahead_s = _ahead_s(intake, t_s)
    return UNKNOWN_S if ahead_s < -LATE_S else max(ahead_s, 0.0)


def taken(intake: Intake, sample: Sample) -> tuple[Intake, Move | None]:
    """Take a sample; return the move that it makes, if any.

    The first position of a frame makes none. A late sample makes none either: a position is
    covered by those after it, a displacement is added to the next move.

    Parameters
    ----------
    intake : Intake
    sample : Sample

    Raises
    ------
    InputError
        When its pose is none.
    """
    if intake.is_paused:
        return intake, None
    position, facing = _seen(sample)
    intake = clocked(intake, sample.t_s)
    ahead_s = _ahead_s(intake, sample.t_s)
    if ahead_s < 0 or (ahead_s == 0 and intake.walked_m > 0):
        left = _plus(intake.left_m, sample.displacement_m or (0.0, 0.0))
        return replace(intake, left_m=left, n_late=intake.n_late + 1), None
    known = intake.position_m
    if position is None:
        assert sample.displacement_m is not None
        known = known or (0.0, 0.0)
        position = _plus(_plus(known, sample.displacement_m), intake.left_m)
        intake = replace(intake, left_m=(0.0, 0.0))
    time_s = intake.time_s + ahead_s
    after = replace(
        intake, time_s=time_s, position_m=position,
        facing_rad=intake.facing_rad if facing is None else facing,
    )  # fmt: skip
    if known is None:
        return after, None
    dx, dy = position[0] - known[0], position[1] - known[1]
    length = math.hypot(dx, dy)
    if length > LONGEST_M:
        return after, None
    return replace(after, walked_m=intake.walked_m + length), Move(time_s, dx, dy, facing)


def _plus(a: tuple[float, float], b: tuple[float, float]) -> tuple[float, float]:
    return a[0] + b[0], a[1] + b[1]


def _seen(sample: Sample) -> tuple[tuple[float, float] | None, float | None]:
    if sample.pose is None:
        return sample.position_m, sample.facing_rad
    ground = ground_pose(sample.pose)
    told = sample.facing_rad
    return ground.position_m, ground.facing_rad if told is None else told


def ground_pose(pose: Pose) -> Ground:
    """Return a pose of an AR session (y up, looking along -z) on the ground, (x, -z).

    Raises
    ------
    InputError
        When its matrix or quaternion is no rotation.

    Examples
    --------
    >>> ground_pose(Pose(position=(1.0, 1.4, -2.0), orientation=(0.0, 0.0, 0.0, 1.0)))
    Ground(position_m=(1.0, 2.0), facing_rad=1.5707963267948966)
    """
    if pose.matrix is not None:
        matrix = read_matrices([list(pose.matrix)], ["pose"])[0]
        x, y, z = (float(v) for v in matrix[:3, 3])
        if max(abs(x), abs(y), abs(z)) > 1e5:
            raise InputError("pose", expected="metres", got=f"{x:g}, {y:g}, {z:g}")
    else:
        assert pose.position is not None
        x, _, z = pose.position
        turned = {
            "position": list(pose.position),
            "orientation": list(pose.orientation or (0.0, 0.0, 0.0, 1.0)),
        }
        matrix = np.array(read_pose(turned, "pose")).T
    ahead = on_ground(-matrix[:3, 2])
    looks = float(np.hypot(*ahead)) >= LEVEL and (pose.matrix or pose.orientation) is not None
    facing = float(np.arctan2(ahead[1], ahead[0])) if looks else None
    return Ground((x, 0.0 - z), facing)
