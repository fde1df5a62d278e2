"""Figures of a method's trials, alone and against another method's on the same walks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from palms.evaluation.bootstrap import (
    Interval,
    Reliability,
    aggregate,
    bootstrap_interval,
    reliability,
)
from palms.evaluation.tables import by_method, units_of

Trial = Mapping[str, Any]
Trials = Sequence[Trial]

MANY = 1_000  # issue: walks in a bin whose reliability counts by itself


def of(trials: Trials, method: str = "palms") -> Trials:
    """Return the trials of a method."""
    return by_method(trials)[method]


def figure(trials: Trials, name: str) -> Interval:
    """Return one figure with its interval, as the tables have it."""
    return aggregate(trials, units_of(trials), {name})[name]


def mean(trials: Trials, name: str) -> float:
    """Return the mean of a metric, over the trials that have one."""
    known = [value for value in (_number(t.get(name)) for t in trials) if not math.isnan(value)]
    return float(np.mean(known)) if known else math.nan


def ratio(trials: Trials, name: str, other: str = "oracle") -> float:
    """Return the mean of a metric over another method's; NaN where that is 0.

    Examples
    --------
    >>> trials = [{"method": "palms", "useful": 0.5}, {"method": "oracle", "useful": 0.8}]
    >>> ratio(trials, "useful")
    0.625
    """
    theirs = mean(of(trials, other), name)
    return mean(of(trials), name) / theirs if theirs else math.nan


def metres_ratio(trials: Trials, other: str = "oracle") -> float:
    """Return the metres to a right declaration over another method's, where both have one.

    Examples
    --------
    >>> after_m = {("palms", "a"): 20.0, ("oracle", "a"): 10.0, ("oracle", "b"): 5.0}
    >>> metres_ratio([
    ...     {"method": method, "scene": "office", "walk": walk, "right_after_m": after}
    ...     for (method, walk), after in after_m.items()
    ... ])
    2.0
    """
    ours, theirs = (_by_walk(of(trials, method), "right_after_m") for method in ("palms", other))
    both = [key for key in ours if key in theirs]
    return sum(ours[key] for key in both) / sum(theirs[key] for key in both)


def _by_walk(trials: Trials, name: str) -> dict[tuple[object, ...], float]:
    return {
        (t["scene"], t["walk"], t.get("trial")): float(t[name])
        for t in trials
        if t[name] is not None
    }


def reliability_of(trials: Trials) -> Reliability:
    """Return the reliability of `p_within_1m`, one random step of each trial."""
    known = [t for t in trials if t["sampled_p_within_1m"] is not None]
    stated = [t["sampled_p_within_1m"] for t in known]
    return reliability(stated, [t["sampled_within_1m"] for t in known], units_of(known))


def off_by(found: Reliability) -> list[str]:
    """Return the bins that miss: neither within 0.03 nor, with few walks, in the interval."""
    missed = []
    for stated, came_true in zip(found.stated, found.came_true, strict=True):
        if math.isnan(stated) or abs(stated - came_true.value) <= 0.03:
            continue
        if came_true.n >= MANY or not came_true.low <= stated <= came_true.high:
            missed.append(f"{stated:.2f}: {came_true:.2f}")
    return missed


def alarms_per_km(trials: Trials) -> Interval:
    """Return how often it says to be lost while it is right, in 1,000 m."""
    rate = [1000 * t["false_alarms"] / t["length_m"] for t in trials]
    return bootstrap_interval(rate, units_of(trials))


def _number(value: float | bool | None) -> float:
    return math.nan if value is None else float(value)
