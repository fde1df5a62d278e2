"""Odometry: timed positions of the phone, and the moves between them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from palms.errors import InputError
from palms.geometry import FloatArray, check_finite, check_points
from palms.settings import LIMITS

__all__ = ["Move", "Odometry"]


class Move(NamedTuple):
    """One move of the odometry.

    Attributes
    ----------
    time_s : float
        When it ended, on the walk's clock.
    dx_m, dy_m : float
        Displacement in the odom frame.
    facing_rad : float or None
        Where the phone looked at its end, in the odom frame.
    duration_s : float or None
        How long it took; None: since the move before.

    Examples
    --------
    >>> Move(0.5, 0.6, 0.0).length_m
    0.6
    """

    time_s: float
    dx_m: float
    dy_m: float
    facing_rad: float | None = None
    duration_s: float | None = None

    @property
    def length_m(self) -> float:
        """Length of the move."""
        return float(np.hypot(self.dx_m, self.dy_m))


@dataclass(frozen=True, slots=True)
class Odometry:
    """A walk as the phone's odometry has it.

    Parameters
    ----------
    time_s : array_like (T,)
        End of each move, increasing; T at least 2.
    position_m : array_like (T, 2)
        Position at those times, in the odom frame.
    facing_rad : array_like (T,), optional
        Where the phone looked, in the odom frame.
    start_m : array_like (2,)
        Where the first move began; the origin unless the frame was moved.
    frame : {"scan", "own"}
        Whether the walk shares the scan's frame. In a frame of its own the rotation
        between them is unknown.
    source : {"vio", "inertial"}
        What made it.
    session : tuple of str
        Names under which the walk goes as a session; empty when it names none.

    Raises
    ------
    InputError
        When there are fewer than two samples, lengths differ, times do not increase, a
        number is not finite, or most moves are faster than anything indoors.

    Examples
    --------
    >>> walk = Odometry([0.5, 1.0], [[0.6, 0.0], [1.2, 0.0]])
    >>> [move.dx_m for move in walk.moves()]
    [0.6, 0.6]
    """

    time_s: FloatArray
    position_m: FloatArray
    facing_rad: FloatArray | None = None
    start_m: FloatArray = (0.0, 0.0)  # type: ignore[assignment]
    frame: Literal["scan", "own"] = "scan"
    source: Literal["vio", "inertial"] = "vio"
    session: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        time = check_finite(self.time_s, "the walk's times", (None,))
        position = check_points(self.position_m, "the walk's positions")
        object.__setattr__(self, "time_s", time)
        object.__setattr__(self, "position_m", position)
        object.__setattr__(self, "start_m", check_finite(self.start_m, "the walk's start", (2,)))
        if self.facing_rad is not None:
            facing = check_finite(self.facing_rad, "the walk's facing", (len(time),))
            object.__setattr__(self, "facing_rad", facing)
        if len(time) != len(position):
            raise InputError(
                "walk",
                expected=f"{len(time)} positions, one for each time",
                got=str(len(position)),
                fix="record the walk again",
            )
        if len(time) < 2:
            raise InputError(
                "walk",
                expected="at least 2 samples",
                got=str(len(time)),
                fix="record while walking",
            )
        self._check_motion()

    def _check_motion(self) -> None:
        step = np.diff(self.time_s)
        if (step <= 0).any() or self.time_s[0] < 0:
            at = 0 if self.time_s[0] < 0 else int(np.argmax(step <= 0)) + 1
            raise InputError(
                "walk",
                expected="times that increase",
                got=f"{self.time_s[at]:.6g} s at sample {at}, after "
                f"{self.time_s[at - 1] if at else 0:.6g} s",
                fix="sort the samples and drop repeated ones",
            )
        length = np.linalg.norm(self.displacements_m, axis=1)
        speed = float(np.median(length[1:] / step))
        if speed > LIMITS.max_speed_m_s:
            raise InputError(
                "walk",
                expected="metres and seconds",
                got=f"{speed:.4g} m/s at most samples",
                fix="convert its units",
            )
        if length.max() > LIMITS.max_jump_m:
            at = int(length.argmax())
            raise InputError(
                "walk",
                expected=f"moves of at most {LIMITS.max_jump_m:g} m",
                got=f"{length[at]:.4g} m at sample {at}",
                fix="remove that sample",
            )

    @property
    def displacements_m(self) -> FloatArray:
        """Moves (T, 2); the first runs from `start_m` to the first position."""
        return np.diff(self.position_m, axis=0, prepend=self.start_m[None])

    @property
    def walked_m(self) -> FloatArray:
        """Distance walked (T,) at the end of each move."""
        return np.cumsum(np.linalg.norm(self.displacements_m, axis=1))

    def __len__(self) -> int:
        return len(self.time_s)

    def moves(self) -> Iterator[Move]:
        """Yield the moves one by one, as a live stream would."""
        facing = [None] * len(self) if self.facing_rad is None else self.facing_rad.tolist()
        rows = zip(self.time_s.tolist(), self.displacements_m.tolist(), facing, strict=True)
        for time_s, (dx, dy), looks in rows:
            yield Move(time_s, dx, dy, looks)
