"""Metrics of one trial.

What they mean is the contract of the project: shares of metres walked, so that standing
still earns nothing; steps without a reference are left out of everything; a walk that never
converges is counted, never dropped. The headline is a pair: `false_localized`, and
`right_after_m`, the metres to a right declaration. In a building of several levels an answer
on another level than the truth's is infinitely far off.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.belief import Stage
from palms.errors import InputError
from palms.geometry import FloatArray, as_readonly
from palms.localizer import Track
from palms.raster import PlanRaster

__all__ = ["Answers", "TrialMetrics", "sample_step", "trial_metrics"]

WRONG_M = 2.0  # ours: off by more than this is wrong
NEAR_M = 1.0  # paper IV-C: within this is useful


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
        reference = _checked(reference_m, "reference", len(self.t_s))
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


@dataclass(frozen=True, slots=True)
class TrialMetrics:
    """The metrics of one trial; None where a figure is not defined.

    A step counts with the metres of the move that led to it.

    Attributes
    ----------
    declared : bool
        Whether the stage localized was reached.
    wrong : bool
        Whether the answer was off by more than 2 m at that moment.
    declared_after_s, declared_after_m : float or None
        Time and walked distance then; None when never.
    right_after_m : float or None
        Walked distance at the first entry into localized within 2 m of the reference.
    false_localized : float or None
        Share of the metres walked while localized on which the answer is off by more than
        2 m; None when there are none.
    longest_false_m : float
        The longest stretch of it without a break.
    rmse_after_m, within_1m_after : float or None
        Over the localized steps; RMSEs over those on the right level.
    useful : float or None
        Share of all metres on which the stage is localized and the answer within 1 m.
    right_place : float or None
        Share of all metres on which it is localized and no wall lies between answer and
        reference; None without a plan.
    final_error_m : float or None
        Error of the last answer; None on the wrong level.
    coverage_68, coverage_95 : float or None
        Share of the localized steps within the stated radius.
    radius_95_m : float or None
        Median of it over the localized steps.
    false_alarms : int
        Times that it said to be lost while its answer was within 2 m.
    paper_time_s, paper_distance_m, paper_rmse_m, paper_within_1m : float or None
        The paper's columns: time and distance at t2, and RMSE and share within 1 m over
        all steps from then on, whatever the stage.
    duration_s, length_m : float
        Of the whole walk.

    Examples
    --------
    >>> answers = Answers([1.0, 2.0], [[0, 0], [3, 0]], ["searching", "localized"])
    >>> trial_metrics(answers, [[1, 0], [3, 0]], [[1, 0], [2, 0]]).declared_after_m
    3.0
    """

    declared: bool
    wrong: bool
    declared_after_s: float | None
    declared_after_m: float | None
    right_after_m: float | None
    false_localized: float | None
    longest_false_m: float
    rmse_after_m: float | None
    within_1m_after: float | None
    useful: float | None
    right_place: float | None
    final_error_m: float | None
    coverage_68: float | None
    coverage_95: float | None
    radius_95_m: float | None
    false_alarms: int
    paper_time_s: float | None
    paper_distance_m: float | None
    paper_rmse_m: float | None
    paper_within_1m: float | None
    duration_s: float
    length_m: float

    def to_json(self) -> dict[str, float | bool | None]:
        """Return the metrics by name; no NaN in them."""
        return asdict(self)


@dataclass(frozen=True, slots=True)
class _Steps:
    """The steps of a trial that have a reference."""

    t_s: FloatArray
    walked_m: FloatArray
    move_m: FloatArray
    error_m: FloatArray
    localized: npt.NDArray[np.bool_]


def trial_metrics(
    answers: Answers,
    reference_m: npt.ArrayLike,
    moves_m: npt.ArrayLike,
    raster: PlanRaster | None = None,
    reference_level: Sequence[str | None] | None = None,
) -> TrialMetrics:
    """Compare the answers of one trial with reference positions.

    Parameters
    ----------
    answers : Answers
        T of them.
    reference_m : array_like (T, 2)
        Where the phone was, map frame; NaN where nobody knows. Such steps are left out of
        everything but the distance walked.
    moves_m : array_like (T, 2)
        The odometry's moves, the first from (0, 0).
    raster : PlanRaster, optional
        The plan, for `right_place`; with several levels that of their atlas, on which
        answers and reference are then given.
    reference_level : sequence (T,), optional
        The level that the phone was on, in a building of several.

    Raises
    ------
    InputError
        When lengths differ.

    Examples
    --------
    >>> answers = Answers([1.0, 2.0], [[1, 0], [9, 0]], ["localized", "localized"])
    >>> metrics = trial_metrics(answers, [[1, 0], [2, 0]], [[1, 0], [1, 0]])
    >>> metrics.false_localized, metrics.useful, metrics.final_error_m, metrics.wrong
    (0.5, 0.5, 7.0, False)
    """
    reference = _checked(reference_m, "reference", len(answers.t_s))
    moves = _checked(moves_m, "moves", len(answers.t_s))
    length = np.linalg.norm(moves, axis=1)
    known = ~np.isnan(reference).any(axis=1)
    off = answers.off_m(reference, reference_level)[known]
    steps = _Steps(
        answers.t_s[known], np.cumsum(length)[known], length[known], off, answers.localized[known]
    )
    place = None
    if raster is not None:
        clear = np.isfinite(off)
        clear[clear] = ~raster.blocked(
            answers.position_m[known][clear], reference[known][clear]
        )  # fmt: skip
        place = _ratio(length[known][steps.localized & clear].sum(), length[known].sum())
    return TrialMetrics(
        **_declaration(steps),
        **_while_localized(steps),
        right_place=place,
        final_error_m=_number(off[-1]) if len(off) else None,
        coverage_68=_share(off <= answers.radius_68_m[known], steps.localized),
        coverage_95=_share(off <= answers.radius_95_m[known], steps.localized),
        radius_95_m=_median(answers.radius_95_m[known][steps.localized]),
        false_alarms=int((_entered(answers.lost[known]) & (off <= WRONG_M)).sum()),
        duration_s=float(answers.t_s[-1]) if len(answers.t_s) else 0.0,
        length_m=float(length.sum()),
    )


def _checked(values: npt.ArrayLike, what: str, n: int) -> FloatArray:
    array = np.asarray(values, dtype=np.float64).reshape(-1, 2)
    if len(array) != n:
        raise InputError(
            f"metrics: {what}", expected=f"{n} rows, one for each answer", got=str(len(array))
        )
    return array


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _ratio(part: float, whole: float) -> float | None:
    return float(part / whole) if whole > 0 else None


def _share(holds: npt.NDArray[np.bool_], among: npt.NDArray[np.bool_]) -> float | None:
    return float(holds[among].mean()) if among.any() else None


def _median(values: FloatArray) -> float | None:
    stated = values[~np.isnan(values)]
    return float(np.median(stated)) if len(stated) else None


def _entered(stage: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    entered: npt.NDArray[np.bool_] = stage & ~np.concatenate([[False], stage[:-1]])
    return entered


def _rmse(error_m: FloatArray) -> float | None:
    """Of the answers on the right level; no number is fair to the others."""
    known = error_m[np.isfinite(error_m)]
    return float(np.sqrt((known**2).mean())) if len(known) else None


def _declaration(steps: _Steps) -> dict[str, Any]:
    """When it declared, whether rightly, and the paper's columns from then on."""
    names = ("time_s", "distance_m", "rmse_m", "within_1m")
    if not steps.localized.any():
        return {
            "declared": False, "wrong": False, "declared_after_s": None, "declared_after_m": None,
            "right_after_m": None, **{f"paper_{name}": None for name in names},
        }  # fmt: skip
    at = int(steps.localized.argmax())
    near = steps.error_m <= WRONG_M
    right = np.flatnonzero(_entered(steps.localized) & near)
    later = np.arange(len(near)) >= at
    t_s, walked = float(steps.t_s[at]), float(steps.walked_m[at])
    return {
        "declared": True,
        "wrong": not near[at],
        "declared_after_s": t_s,
        "declared_after_m": walked,
        "right_after_m": float(steps.walked_m[right[0]]) if len(right) else None,
        "paper_time_s": t_s,
        "paper_distance_m": walked,
        "paper_rmse_m": _rmse(steps.error_m[at:]),
        "paper_within_1m": _share(steps.error_m <= NEAR_M, later),
    }


def _while_localized(steps: _Steps) -> dict[str, Any]:
    """How good the answers are while it says that it knows."""
    localized, move = steps.localized, steps.move_m
    false = localized & ~(steps.error_m <= WRONG_M)  # no answer while localized is false, too
    near = localized & (steps.error_m <= NEAR_M)
    return {
        "false_localized": _ratio(move[false].sum(), move[localized].sum()),
        "longest_false_m": _longest(false, move),
        "rmse_after_m": _rmse(steps.error_m[localized]),
        "within_1m_after": _share(near, localized),
        "useful": _ratio(move[near].sum(), move.sum()),
    }


def _longest(mask: npt.NDArray[np.bool_], move_m: FloatArray) -> float:
    """Metres of the longest run of steps for which `mask` holds."""
    run = np.cumsum(~mask)[mask]
    return float(np.bincount(run, move_m[mask]).max()) if len(run) else 0.0


def sample_step(
    answers: Answers,
    reference_m: npt.ArrayLike,
    rng: np.random.Generator,
    reference_level: Sequence[str | None] | None = None,
) -> tuple[float, bool] | None:
    """Draw one step that has a reference: its `p_within_1m`, and whether it was so.

    One for each walk and trial, since the steps of a walk are not independent; for
    `bootstrap.reliability`. None when no step has a reference.

    Examples
    --------
    >>> answers = Answers([1.0], [[0, 0]], ["searching"], [0.25])
    >>> sample_step(answers, [[0.5, 0.0]], np.random.default_rng(0))
    (0.25, True)
    """
    reference = _checked(reference_m, "reference", len(answers.t_s))
    known = np.flatnonzero(~np.isnan(reference).any(axis=1))
    if not len(known):
        return None
    at = int(rng.choice(known))
    off = answers.off_m(reference, reference_level)[at]
    return float(answers.p_within_1m[at]), bool(off <= NEAR_M)
