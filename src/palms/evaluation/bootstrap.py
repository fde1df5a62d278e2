"""Means and medians with intervals, by bootstrap over walks.

Steps of a trial and trials of a walk are not independent: whoever resamples them gets
intervals that are too narrow. What is drawn here are whole units (walks, or buildings where
there are several), each with all of its trials.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.evaluation.metrics import TrialMetrics
from palms.geometry import FloatArray

__all__ = [
    "Interval",
    "Reliability",
    "aggregate",
    "bootstrap_difference",
    "bootstrap_interval",
    "reliability",
]

Statistic = Literal["mean", "median"]

DRAWS = 2000  # ours: moves the ends of an interval by about a hundredth of its width
LEVEL = 0.95  # of every interval that is reported
_SHARES = ("declared", "wrong", "wrong_of_declared")  # of which a median says nothing
_DERIVED = {  # figure: what it is, and the whole that it stands in or is of
    "wrong_of_declared": ("wrong", "declared"),
    "declared_after_s_full": ("declared_after_s", "duration_s"),
    "declared_after_m_full": ("declared_after_m", "length_m"),
    "right_after_m_full": ("right_after_m", "length_m"),
}
BINS = 10  # ours: reliability diagrams by tenths
LOG_FLOOR = 1e-3  # ours: a filter of 2,000 particles cannot state less; keeps log scores finite


@dataclass(frozen=True, slots=True)
class Interval:
    """A statistic with its interval.

    Parameters
    ----------
    value : float
        The statistic of all values; NaN when none is defined.
    low, high : float
        Ends of the 95 % interval; NaN with fewer than two units.
    n : int
        Values that are defined.
    units : int
        Walks (or buildings) that were resampled.

    Examples
    --------
    >>> f"{Interval(0.5, 0.25, 0.75, 8, 4):.2f}"
    '0.50 [0.25, 0.75]'
    """

    value: float
    low: float
    high: float
    n: int
    units: int

    def __format__(self, spec: str) -> str:
        if np.isnan(self.value):
            return "-"
        value, low, high = (format(v, spec) for v in (self.value, self.low, self.high))
        return value if np.isnan(self.low) else f"{value} [{low}, {high}]"


def bootstrap_interval(
    values: npt.ArrayLike,
    units: Sequence[object],
    statistic: Statistic = "mean",
    *,
    draws: int = DRAWS,
    seed: int = 0,
) -> Interval:
    """Return the mean or the median of values, with an interval over units.

    Parameters
    ----------
    values : array_like (N,)
        One for each trial; NaN where the figure is not defined. Such trials do not enter
        the statistic, but their units are drawn like the others.
    units : sequence (N,)
        The walk (or the building) of each trial. Units are drawn with replacement, each
        with all of its trials.
    statistic : {"mean", "median"}
    draws : int
        Number of bootstrap samples.
    seed : int

    Raises
    ------
    InputError
        When there are not as many units as values.

    Examples
    --------
    >>> interval = bootstrap_interval([0.0, 0.0, 1.0, 1.0], ["a", "a", "b", "b"])
    >>> interval.value, interval.low, interval.high, interval.units
    (0.5, 0.0, 1.0, 2)
    """
    value = np.asarray(values, dtype=np.float64)
    if value.ndim != 1 or len(value) != len(units):
        raise InputError(
            "bootstrap", expected=f"a unit for each of {value.size} values", got=str(len(units))
        )
    names, unit = _numbered(units)
    defined = ~np.isnan(value)
    return _interval(
        value[defined].tobytes(), unit[defined].tobytes(), names, statistic, draws, seed
    )


@lru_cache(maxsize=256)
def _interval(
    values: bytes, units: bytes, names: int, statistic: Statistic, draws: int, seed: int
) -> Interval:
    """Return an interval by content: several tables of a report have the same figures."""
    value, unit = np.frombuffer(values), np.frombuffer(units, np.int64)
    nothing = float("nan")
    if not len(value):
        return Interval(nothing, nothing, nothing, 0, names)
    of_counts = _means if statistic == "mean" else _medians
    whole = float(of_counts(value, unit, np.ones((1, names)))[0])
    if names < 2:
        return Interval(whole, nothing, nothing, len(value), names)
    counts = np.random.default_rng(seed).multinomial(names, np.full(names, 1 / names), draws)
    drawn = of_counts(value, unit, counts.astype(np.float64))
    low, high = np.nanquantile(drawn, [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return Interval(whole, float(low), float(high), len(value), names)


def bootstrap_difference(
    before: npt.ArrayLike,
    after: npt.ArrayLike,
    units_before: Sequence[object],
    units_after: Sequence[object],
    *,
    draws: int = DRAWS,
) -> Interval:
    """Return by how much a mean changes, with an interval over units that both have drawn.

    What the units have in common, such as easy and hard buildings, cancels: the interval is
    narrower than those of the two means.

    Parameters
    ----------
    before, after : array_like (N,), (M,)
        One for each trial; NaN where the figure is not defined.
    units_before, units_after : sequence (N,), (M,)
        The walk (or the building) of each trial. Drawn by name, in both alike.
    draws : int

    Examples
    --------
    >>> change = bootstrap_difference([0.1, 0.8], [0.2, 0.9], ["a", "b"], ["a", "b"])
    >>> f"{change:.2f}"
    '0.10 [0.10, 0.10]'
    """
    names, unit = _numbered([*units_before, *units_after])
    pairs = [
        (value[~np.isnan(value)], which[~np.isnan(value)])
        for value, which in (
            (np.asarray(before, dtype=np.float64), unit[: len(units_before)]),
            (np.asarray(after, dtype=np.float64), unit[len(units_before) :]),
        )
    ]
    n, nothing = sum(len(value) for value, _ in pairs), float("nan")
    if not all(len(value) for value, _ in pairs):
        return Interval(nothing, nothing, nothing, n, names)
    counts = np.random.default_rng(0).multinomial(names, np.full(names, 1 / names), draws)
    every = np.concatenate([np.ones((1, names)), counts])
    first, second = (_means(value, which, every) for value, which in pairs)
    change = second - first
    if names < 2:
        return Interval(float(change[0]), nothing, nothing, n, names)
    low, high = np.nanquantile(change[1:], [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    return Interval(float(change[0]), float(low), float(high), n, names)


def _numbered(units: Sequence[object]) -> tuple[int, npt.NDArray[np.int64]]:
    number: dict[object, int] = {}
    index = np.array([number.setdefault(unit, len(number)) for unit in units], dtype=np.int64)
    return len(number), index


def _means(value: FloatArray, unit: npt.NDArray[np.int64], counts: FloatArray) -> FloatArray:
    """Mean (B,) of the values, each counted as often as its unit was drawn; NaN for none."""
    n_units = counts.shape[1]
    total = (counts * np.bincount(unit, value, n_units)).sum(axis=1)
    n = (counts * np.bincount(unit, minlength=n_units)).sum(axis=1)
    out = np.full(len(n), np.nan)
    np.divide(total, n, out=out, where=n > 0)
    return out


def _medians(value: FloatArray, unit: npt.NDArray[np.int64], counts: FloatArray) -> FloatArray:
    """Median (B,) of the values, each counted as often as its unit was drawn; NaN for none."""
    order = np.argsort(value, kind="stable")
    value, unit = value[order], unit[order]
    counts, of_draw = np.unique(counts, axis=0, return_inverse=True)  # few units: few distinct
    out = np.full(len(counts), np.nan)
    for b, count in enumerate(counts):
        upto = np.cumsum(count[unit])
        n = upto[-1]
        if n > 0:
            middle = np.searchsorted(upto, [(n - 1) // 2, n // 2], side="right")
            out[b] = value[middle].mean()
    return out[of_draw.ravel()]


def aggregate(
    trials: Sequence[Mapping[str, Any]],
    units: Sequence[object],
    names: Collection[str] | None = None,
) -> dict[str, Interval]:
    """Return figures over trials, with 95 % intervals over units.

    Parameters
    ----------
    trials : sequence of mapping
        Metrics by name, as `TrialMetrics.to_json` has them.
    units : sequence
        The walk of each trial; its building where there are several.
    names : collection of str, optional
        The figures that are wanted; all when left out, which takes its time.

    Returns
    -------
    dict of str to Interval
        ``<metric>`` is the mean and ``<metric>_median`` the median over the trials for
        which it is defined (`Interval.n` of them); `declared` and `wrong` are shares of
        all, ``wrong_of_declared`` of those that declared. For ``declared_after_s``,
        ``declared_after_m`` and ``right_after_m`` there is also ``..._full``, the mean with
        trials that never declared (or never rightly) at the walk's full length, and
        ``..._full_median``.

    Examples
    --------
    >>> from palms.evaluation.metrics import Answers, trial_metrics
    >>> answers = Answers([1.0], [[0, 0]], ["searching"])
    >>> trial = trial_metrics(answers, [[0, 0]], [[3, 4]]).to_json()
    >>> figures = aggregate([trial, trial], ["walk 1", "walk 2"])
    >>> figures["declared"].value, figures["right_after_m_full"].value
    (0.0, 5.0)
    """
    figures = {}
    for name in (*(field.name for field in fields(TrialMetrics)), *_DERIVED):
        middle = f"{name}_median"
        mean = names is None or name in names
        median = name not in _SHARES if names is None else middle in names
        if mean or median:
            values = _column(trials, name)
        if mean:
            figures[name] = bootstrap_interval(values, units)
        if median:
            figures[middle] = bootstrap_interval(values, units, "median")
    return figures


def _column(trials: Sequence[Mapping[str, Any]], name: str) -> FloatArray:
    """Values (N,) of a figure; NaN where it is not defined."""
    if name not in _DERIVED:
        return np.array([trial.get(name) for trial in trials], dtype=np.float64)
    of, whole = (_column(trials, each) for each in _DERIVED[name])
    if name == "wrong_of_declared":
        return np.where(whole == 1, of, np.nan)
    return np.where(np.isnan(of), whole, of)


@dataclass(frozen=True, slots=True)
class Reliability:
    """Whether stated probabilities come true as often as they say.

    Parameters
    ----------
    stated : (B,)
        Mean stated probability in each bin; NaN in an empty one.
    came_true : tuple of Interval
        Share that came true in each bin. Where all did or none, where a bootstrap knows no
        doubt, the interval is the exact one of a binomial share, each unit counted once.
    brier : Interval
        Mean squared difference of probability and outcome; 0 is best.
    log_score : Interval
        Mean log of the probability given to what happened; 0 is best. Probabilities are
        kept 0.001 away from 0 and 1.

    Examples
    --------
    >>> reliability([0.05, 0.95], [False, True], ["a", "b"]).brier.value
    0.0025
    """

    stated: FloatArray
    came_true: tuple[Interval, ...]
    brier: Interval
    log_score: Interval


def reliability(
    stated: npt.ArrayLike, came_true: npt.ArrayLike, units: Sequence[object], bins: int = BINS
) -> Reliability:
    """Compare stated probabilities with what happened.

    Parameters
    ----------
    stated : array_like (N,)
        Probabilities, one for each trial (one random step: see `metrics.sample_step`).
    came_true : array_like (N,)
        Whether it was so.
    units : sequence (N,)
        The walk (or the building) of each trial.
    bins : int
        Bins of equal width over [0, 1].

    Examples
    --------
    >>> result = reliability([0.9, 0.9, 0.1], [True, False, False], ["a", "b", "c"], bins=2)
    >>> [interval.value for interval in result.came_true]
    [0.0, 0.5]
    """
    p = np.asarray(stated, dtype=np.float64)
    true = np.asarray(came_true, dtype=np.float64)
    member = np.minimum((p * bins).astype(np.int64), bins - 1)
    mean = np.full(bins, np.nan)
    shares = []
    for b in range(bins):
        inside = member == b
        if inside.any():
            mean[b] = p[inside].mean()
        shares.append(_share(np.where(inside, true, np.nan), units))
    kept = np.clip(p, LOG_FLOOR, 1 - LOG_FLOOR)
    logs = np.where(true > 0, np.log(kept), np.log1p(-kept))
    brier = bootstrap_interval((p - true) ** 2, units)
    return Reliability(mean, tuple(shares), brier, bootstrap_interval(logs, units))


def _share(outcome: FloatArray, units: Sequence[object]) -> Interval:
    found = bootstrap_interval(outcome, units)
    if found.value not in (0.0, 1.0) or found.units < 2:
        return found
    seen = len({unit for unit, each in zip(units, outcome, strict=True) if not np.isnan(each)})
    doubt = 1.0 - ((1.0 - LEVEL) / 2) ** (1.0 / seen)
    low, high = (0.0, doubt) if found.value == 0.0 else (1.0 - doubt, 1.0)
    return replace(found, low=low, high=high)
