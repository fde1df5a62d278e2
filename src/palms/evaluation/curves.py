"""What the report draws, computed from arrays and records alone.

A record is one trial as `experiment.run_batch` makes it: names, metrics, and under ``series``
what was said about every two metres walked.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.evaluation.bootstrap import Reliability, reliability
from palms.evaluation.metrics import WRONG_M
from palms.evaluation.tables import units_of
from palms.geometry import FloatArray

__all__ = [
    "ErrorCdf",
    "Shares",
    "Sweep",
    "Verdict",
    "declare_by_threshold",
    "error_cdf",
    "localized_shares",
    "pooled_errors",
    "sampled_reliability",
    "threshold_sweep",
    "worst_trials",
]

Records = Sequence[Mapping[str, Any]]

SPACING_M = 2.0  # ours: of the marks at which shares are counted; that of the series
THRESHOLDS = tuple(np.round(np.concatenate([np.linspace(0.05, 0.95, 19), [0.97, 0.99]]), 2))
WORST = 10  # issue "Measure": the report shows the worst ten cases


@dataclass(frozen=True, slots=True)
class ErrorCdf:
    """How large a share of all errors is at most so large.

    Parameters
    ----------
    error_m : (N,)
        Increasing; what is finite of the errors.
    share : (N,)
        Share of all errors, missing answers among them, that are at most `error_m`.

    Examples
    --------
    >>> error_cdf([0.5, 1.5]).at(1.0)
    0.5
    """

    error_m: FloatArray
    share: FloatArray

    def at(self, limit_m: float) -> float:
        """Return the share of errors of at most `limit_m`."""
        n = int(np.searchsorted(self.error_m, limit_m, side="right"))
        return float(self.share[n - 1]) if n else 0.0


def error_cdf(error_m: npt.ArrayLike, weight: npt.ArrayLike | None = None) -> ErrorCdf:
    """Return the distribution of errors.

    Parameters
    ----------
    error_m : array_like (N,)
        NaN where there was no answer: no error is large enough for that, so the curve ends
        below 1.
    weight : array_like (N,), optional
        Such as the metres walked with each error; all the same when left out.

    Raises
    ------
    InputError
        When there are not as many weights as errors.

    Examples
    --------
    >>> cdf = error_cdf([3.0, 0.2, np.nan, 0.8])
    >>> cdf.error_m.tolist(), cdf.share.tolist()
    ([0.2, 0.8, 3.0], [0.25, 0.5, 0.75])
    """
    error = np.asarray(error_m, dtype=np.float64).ravel()
    each = np.ones(len(error)) if weight is None else np.asarray(weight, dtype=np.float64).ravel()
    if len(each) != len(error):
        raise InputError("error_cdf", expected=f"{len(error)} weights", got=str(len(each)))
    order = np.argsort(error, kind="stable")
    order = order[~np.isnan(error[order])]
    total = each.sum()
    share = np.cumsum(each[order]) / total if total > 0 else np.zeros(len(order))
    return ErrorCdf(error[order], share)


@dataclass(frozen=True, slots=True)
class _Series:
    """What was said along one trial, about every two metres."""

    walked_m: FloatArray
    error_m: FloatArray
    localized: npt.NDArray[np.bool_]
    p2: FloatArray

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> _Series:
        found = record["series"]
        number = {k: np.array(found[k], dtype=np.float64) for k in ("walked_m", "error_m", "p2")}
        return cls(
            number["walked_m"], number["error_m"], np.array(found["localized"], dtype=np.bool_),
            number["p2"],
        )  # fmt: skip

    @property
    def move_m(self) -> FloatArray:
        return np.diff(self.walked_m, prepend=0.0)


def pooled_errors(records: Records, localized_only: bool = True) -> tuple[FloatArray, FloatArray]:
    """Return errors (N,) of all trials and the metres (N,) walked with each.

    Parameters
    ----------
    records : sequence of mapping
    localized_only : bool
        Those while localized; else those of the whole walks.

    Examples
    --------
    >>> series = {"walked_m": [2.0, 4.0], "error_m": [9.0, 0.5], "localized": [0, 1],
    ...           "p2": [0.1, 0.9]}
    >>> [values.tolist() for values in pooled_errors([{"series": series}])]
    [[0.5], [2.0]]
    """
    errors, moves = [np.zeros(0)], [np.zeros(0)]
    for each in map(_Series.of, records):
        chosen = each.localized if localized_only else np.ones(len(each.localized), dtype=np.bool_)
        errors.append(each.error_m[chosen])
        moves.append(each.move_m[chosen])
    return np.concatenate(errors), np.concatenate(moves)


@dataclass(frozen=True, slots=True)
class Shares:
    """How many trials are localized, and rightly, after so many metres.

    Parameters
    ----------
    walked_m : (M,)
    localized : (M,)
        Share of the trials whose stage is localized there.
    right : (M,)
        Of these, within 2 m of the reference; as a share of all trials.
    """

    walked_m: FloatArray
    localized: FloatArray
    right: FloatArray


def localized_shares(records: Records, spacing_m: float = SPACING_M) -> Shares:
    """Return the share of trials localized, and rightly so, against metres walked.

    A trial whose walk is over counts on as it ended, so that shares are always of all trials.

    Parameters
    ----------
    records : sequence of mapping
        At least one.
    spacing_m : float
        Between the marks.

    Examples
    --------
    >>> series = {"walked_m": [2.0, 4.0], "error_m": [9.0, 0.5], "localized": [0, 1],
    ...           "p2": [0.1, 0.9]}
    >>> localized_shares([{"series": series}]).right.tolist()
    [0.0, 0.0, 1.0]
    """
    all_series = [_Series.of(record) for record in records]
    longest = max((float(s.walked_m[-1]) for s in all_series), default=0.0)
    marks = np.arange(0.0, longest + spacing_m / 2, spacing_m)
    localized, right = np.zeros(len(marks)), np.zeros(len(marks))
    for series in all_series:
        at = np.searchsorted(series.walked_m, marks + spacing_m / 2, side="right") - 1
        is_localized = (at >= 0) & series.localized[at]
        localized += is_localized
        right += is_localized & (series.error_m[at] <= WRONG_M)
    n = max(1, len(all_series))
    return Shares(marks, localized / n, right / n)


@dataclass(frozen=True, slots=True)
class Verdict:
    """What comes of declaring by a threshold: the headline's pair.

    Parameters
    ----------
    false_localized : float
        Share of the metres walked while declared on which the answer is off by more than
        2 m; NaN when it never declares.
    right_after_m : float
        Metres to the first right declaration; NaN when there is none.
    """

    false_localized: float
    right_after_m: float


def declare_by_threshold(
    walked_m: npt.ArrayLike, error_m: npt.ArrayLike, p_within_2m: npt.ArrayLike, threshold: float
) -> Verdict:
    """Say what would come of calling a trial localized whenever `p_within_2m` is high.

    Parameters
    ----------
    walked_m : array_like (N,)
        Metres walked up to each answer.
    error_m : array_like (N,)
        How far each answer is off; NaN where there is none.
    p_within_2m : array_like (N,)
        How sure each answer is.
    threshold : float
        From this probability on it declares.

    Examples
    --------
    >>> declare_by_threshold([2, 4, 6, 8], [9, 9, 0.5, 0.5], [0.2, 0.6, 0.7, 0.9], 0.5)
    Verdict(false_localized=0.333..., right_after_m=nan)
    >>> declare_by_threshold([2, 4, 6, 8], [9, 9, 0.5, 0.5], [0.2, 0.6, 0.7, 0.9], 0.65)
    Verdict(false_localized=0.0, right_after_m=6.0)
    """
    walked, error, p2 = (
        np.asarray(each, dtype=np.float64) for each in (walked_m, error_m, p_within_2m)
    )
    false, right = _verdicts(walked, error, p2, np.array([threshold]))
    return Verdict(float(false[0]), float(right[0]))


def _verdicts(
    walked_m: FloatArray, error_m: FloatArray, p_within_2m: FloatArray, threshold: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the headline's pair of one trial for each threshold (H,)."""
    declared = p_within_2m >= threshold[:, None]
    near, move = error_m <= WRONG_M, np.diff(walked_m, prepend=0.0)
    metres = np.where(declared, move, 0.0).sum(axis=1)
    false = np.full(len(threshold), np.nan)
    np.divide(np.where(declared & ~near, move, 0.0).sum(axis=1), metres, out=false,
              where=metres > 0)  # fmt: skip
    right = np.pad(declared & near, ((0, 0), (0, 1)), constant_values=True)
    right[:, 1:-1] &= ~declared[:, :-1]
    return false, np.append(walked_m, np.nan)[right.argmax(axis=1)]


@dataclass(frozen=True, slots=True)
class Sweep:
    """The headline's pair for each of many thresholds.

    Parameters
    ----------
    threshold : (H,)
    false_localized : (H,)
        Mean over the trials that declare at all; NaN where none does.
    right_after_m : (H,)
        Mean over all trials, those without a right declaration at the walk's full length.
    """

    threshold: FloatArray
    false_localized: FloatArray
    right_after_m: FloatArray


def threshold_sweep(records: Records, thresholds: Sequence[float] = THRESHOLDS) -> Sweep:
    """Return what each threshold on `p_within_2m` would have led to.

    Parameters
    ----------
    records : sequence of mapping
    thresholds : sequence of float

    Examples
    --------
    >>> series = {"walked_m": [2.0, 4.0], "error_m": [9.0, 0.5], "localized": [0, 1],
    ...           "p2": [0.1, 0.9]}
    >>> sweep = threshold_sweep([{"length_m": 5.0, "series": series}], [0.05, 0.5])
    >>> sweep.false_localized.tolist(), sweep.right_after_m.tolist()
    ([0.5, 0.0], [5.0, 4.0])
    """
    length = np.array([record["length_m"] for record in records], dtype=np.float64)
    threshold = np.array(thresholds, dtype=np.float64)
    false, right = np.empty((2, len(records), len(threshold)))
    for k, each in enumerate(map(_Series.of, records)):
        false[k], right[k] = _verdicts(each.walked_m, each.error_m, each.p2, threshold)
    defined = ~np.isnan(false)
    shares, metres = np.full((2, len(threshold)), np.nan)
    np.divide(np.where(defined, false, 0.0).sum(axis=0), defined.sum(axis=0), out=shares,
              where=defined.any(axis=0))  # fmt: skip
    if len(records):
        metres = np.where(np.isnan(right), length[:, None], right).mean(axis=0)
    return Sweep(threshold, shares, metres)


def sampled_reliability(records: Records) -> Reliability | None:
    """Return whether `p_within_1m` comes true, from one random step of each trial.

    None when no record has one.

    Examples
    --------
    >>> record = {"scene": "E2", "walk": "w1", "sampled_p_within_1m": 0.95,
    ...           "sampled_within_1m": True}
    >>> sampled_reliability([record]).brier.value
    0.0025
    """
    known = [r for r in records if r.get("sampled_p_within_1m") is not None]
    if not known:
        return None
    return reliability(
        [r["sampled_p_within_1m"] for r in known],
        [r["sampled_within_1m"] for r in known],
        units_of(known),
    )


def worst_trials(records: Records, n: int = WORST) -> list[Mapping[str, Any]]:
    """Return the worst trials, each of another walk as long as there are walks left.

    First those with the longest stretch of wrong answers while localized, then those that
    are the least useful.

    Examples
    --------
    >>> trial = {"scene": "E2", "walk": "w1", "useful": 0.5}
    >>> bad = [{**trial, "seed": seed, "longest_false_m": 10.0 * seed} for seed in range(3)]
    >>> [t["seed"] for t in worst_trials([*bad, {**bad[0], "walk": "w2"}], 3)]
    [2, 0, 1]
    """
    ranked = sorted(records, key=lambda r: (-r["longest_false_m"], r["useful"] or 0.0))
    seen: dict[tuple[str, str], int] = {}
    place = []
    for record in ranked:
        walk = (record["scene"], record["walk"])
        place.append(seen.setdefault(walk, 0))
        seen[walk] += 1
    order = sorted(range(len(ranked)), key=lambda i: place[i])
    return [ranked[i] for i in order[:n]]
