"""Answers: what a method said along a walk, whatever it comes from."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.belief import Stage
from palms.errors import InputError
from palms.geometry import FloatArray, as_readonly
from palms.localizer import Track

__all__ = ["Answers", "checked_rows"]


@dataclass(frozen=True, slots=True)
class Answers:
    """What a method said along a walk, one entry for each odometry sample.

    Parameters
    ----------
    t_s : array_like (T,)
        Time.
    position_m : array_like (T, 2)
        The best single answer, map frame; NaN where there was none.
    stage : sequence (T,)
        A `palms.Stage` each, or its name.
    p_within_1m : array_like (T,), optional
        Stated probability that the phone is that near; 0 when left out.
    radius_68_m, radius_95_m : array_like (T,), optional
        Discs around the answer that hold so much of the belief; NaN where not stated.
    level : sequence (T,), optional
        Name of the level that the answer is on; None where there is only one.

    Raises
    ------
    InputError
        When lengths differ.

    Examples
    --------
    >>> Answers([0.5, 1.0], [[1, 2], [2, 2]], ["searching", "localized"]).localized.tolist()
    [False, True]
    """

    t_s: FloatArray
    position_m: FloatArray
    stage: tuple[Stage, ...]
    p_within_1m: FloatArray = None  # type: ignore[assignment]
    radius_68_m: FloatArray = None  # type: ignore[assignment]
    radius_95_m: FloatArray = None  # type: ignore[assignment]
    level: tuple[str | None, ...] = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        n = len(self.t_s)
        object.__setattr__(self, "level", tuple(self.level or (None,) * n))
        object.__setattr__(self, "stage", tuple(Stage(stage) for stage in self.stage))
        object.__setattr__(self, "position_m", as_readonly(self.position_m).reshape(-1, 2))
        absent = {"p_within_1m": 0.0, "radius_68_m": math.nan, "radius_95_m": math.nan}
        for name in ("t_s", *absent):
            given = getattr(self, name)
            filled = np.full(n, absent[name]) if given is None else given
            object.__setattr__(self, name, as_readonly(filled))
        for field in fields(self):
            if len(getattr(self, field.name)) != n:
                raise InputError(
                    f"answers: {field.name}", expected=f"{n} entries, one for each time",
                    got=str(len(getattr(self, field.name))),
                )  # fmt: skip

    @classmethod
    def of(cls, track: Track) -> Answers:
        """Return the answers of a track."""
        steps = track.estimates
        return cls(
            np.array([e.time_s for e in steps]),
            track.position_m,
            tuple(e.stage for e in steps),
            np.array([e.p_within_1m for e in steps]),
            np.array([e.radius_68_m for e in steps], dtype=np.float64),
            np.array([e.radius_95_m for e in steps], dtype=np.float64),
            tuple(e.level for e in steps),
        )

    @classmethod
    def from_json(cls, steps: Mapping[str, Sequence[Any]]) -> Answers:
        """Return the answers of `steps` of the schema palms-track/1; null becomes NaN.

        Examples
        --------
        >>> steps = {"t_s": [1.0], "x_m": [None], "y_m": [None], "stage": ["searching"],
        ...          "p_within_1m": [0.0], "radius_68_m": [None], "radius_95_m": [None]}
        >>> Answers.from_json(steps).position_m
        array([[nan, nan]])
        """
        names = ("t_s", "x_m", "y_m", "p_within_1m", "radius_68_m", "radius_95_m")
        number = {name: np.array(steps[name], dtype=np.float64) for name in names}
        return cls(
            number["t_s"], np.stack([number["x_m"], number["y_m"]], axis=1),
            tuple(steps["stage"]), number["p_within_1m"], number["radius_68_m"],
            number["radius_95_m"], tuple(steps.get("level", ())),
        )  # fmt: skip

    def off_m(
        self, reference_m: npt.ArrayLike, reference_level: Sequence[str | None] | None = None
    ) -> FloatArray:
        """Distance (T,) to the truth; infinite on another level, NaN where either is missing.

        Parameters
        ----------
        reference_m : array_like (T, 2)
        reference_level : sequence (T,), optional
            Levels of the truth; those of the answers do not count when left out.

        Examples
        --------
        >>> answers = Answers([1, 2], [[0, 0], [0, 0]], ["localized"] * 2, level=["1", "2"])
        >>> answers.off_m([[3, 4], [3, 4]], ["1", "1"]).tolist()
        [5.0, inf]
        """
        reference = checked_rows(reference_m, "reference", len(self.t_s))
        off: FloatArray = np.linalg.norm(self.position_m - reference, axis=1)
        if reference_level is not None:
            other = [a != b for a, b in zip(self.level, reference_level, strict=True)]
            off[np.array(other, dtype=np.bool_) & ~np.isnan(off)] = np.inf
        return off

    @property
    def localized(self) -> npt.NDArray[np.bool_]:
        """Whether the stage is localized (T,)."""
        return self._is(Stage.LOCALIZED)

    @property
    def lost(self) -> npt.NDArray[np.bool_]:
        """Whether the stage is lost (T,)."""
        return self._is(Stage.LOST)

    def _is(self, stage: Stage) -> npt.NDArray[np.bool_]:
        return np.array([each is stage for each in self.stage], dtype=np.bool_)


def checked_rows(values: npt.ArrayLike, what: str, n: int) -> FloatArray:
    """Return values (n, 2), one for each answer; `what` they are is told where they are not."""
    array = np.asarray(values, dtype=np.float64).reshape(-1, 2)
    if len(array) != n:
        raise InputError(
            f"metrics: {what}", expected=f"{n} rows, one for each answer", got=str(len(array))
        )
    return array
