"""Metrics of one trial.

What they mean is the contract of the project: shares of metres walked, so that standing
still earns nothing; steps without a reference are left out of everything; a walk that never
converges is counted, never dropped. The headline is a pair: `false_localized`, and
`right_after_m`, the metres to a right declaration. In a building of several levels an answer
on another level than the truth's is infinitely far off.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.evaluation.answers import Answers, checked_rows
from palms.geometry import FloatArray
from palms.raster import PlanRaster

__all__ = ["Answers", "TrialMetrics", "sample_step", "trial_metrics"]

WRONG_M = 2.0  # ours: off by more than this is wrong
NEAR_M = 1.0  # paper IV-C: within this is useful


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
    reference = checked_rows(reference_m, "reference", len(answers.t_s))
    moves = checked_rows(moves_m, "moves", len(answers.t_s))
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
    reference = checked_rows(reference_m, "reference", len(answers.t_s))
    known = np.flatnonzero(~np.isnan(reference).any(axis=1))
    if not len(known):
        return None
    at = int(rng.choice(known))
    off = answers.off_m(reference, reference_level)[at]
    return float(answers.p_within_1m[at]), bool(off <= NEAR_M)
