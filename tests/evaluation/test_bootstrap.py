"""Intervals over walks."""

import math

import numpy as np
import pytest

from palms import InputError
from palms.evaluation.bootstrap import (
    Interval,
    aggregate,
    bootstrap_difference,
    bootstrap_interval,
    reliability,
)
from palms.evaluation.metrics import Answers, trial_metrics


def test_trials_of_one_walk_do_not_narrow_the_interval():
    walks = [0.0, 1.0, 0.3, 0.6, 0.9]
    once = bootstrap_interval(walks, range(5))
    often = bootstrap_interval(np.repeat(walks, 50), np.repeat(range(5), 50).tolist())
    assert often.value == pytest.approx(once.value)
    assert (often.low, often.high) == pytest.approx((once.low, once.high))
    assert (often.n, often.units) == (250, 5)


def test_interval_of_a_mean_is_about_two_standard_errors():
    values = np.random.default_rng(1).normal(size=400)
    interval = bootstrap_interval(values, range(400))
    standard_error = values.std() / 20
    assert interval.low == pytest.approx(values.mean() - 1.96 * standard_error, abs=0.02)
    assert interval.high == pytest.approx(values.mean() + 1.96 * standard_error, abs=0.02)


@pytest.mark.parametrize(
    ("values", "median"), [([3, 1, 2], 2.0), ([4, 1, 2, 3], 2.5), ([7], 7.0), ([1, 1, 9, 9], 5.0)]
)
def test_median_is_the_usual_one(values, median):
    assert bootstrap_interval(values, range(len(values)), "median").value == median


def test_undefined_values_are_left_out_but_their_walks_are_drawn():
    interval = bootstrap_interval([1.0, math.nan, 3.0], ["a", "b", "c"])
    assert (interval.value, interval.n, interval.units) == (2.0, 2, 3)


def test_nothing_defined():
    interval = bootstrap_interval([math.nan, math.nan], ["a", "b"], "median")
    assert math.isnan(interval.value)
    assert interval.n == 0
    assert f"{interval:.2f}" == "-"


def test_one_walk_tells_nothing_about_others():
    interval = bootstrap_interval([1.0, 2.0], ["a", "a"])
    assert interval.value == 1.5
    assert math.isnan(interval.low)
    assert f"{interval:.1f}" == "1.5"


def test_no_values():
    assert bootstrap_interval([], []).n == 0


def test_same_seed_same_interval():
    args = ([0.1, 0.5, 0.2, 0.9], ["a", "b", "c", "d"], "median")
    assert bootstrap_interval(*args) == bootstrap_interval(*args)


def test_units_must_be_as_many():
    with pytest.raises(InputError, match="unit"):
        bootstrap_interval([1.0], ["a", "b"])


def trial(stages, error):
    n = len(stages)
    moves = np.tile([1.0, 0.0], (n, 1))
    position = np.cumsum(moves, axis=0)
    answers = Answers(np.arange(1.0, n + 1), position + np.array([0.0, error]), stages)
    return trial_metrics(answers, position, moves).to_json()


def test_walks_that_never_converge_are_counted():
    never = trial(["searching"] * 4, 0.0)
    right = trial(["searching", "localized", "localized", "localized"], 0.0)
    wrong = trial(["localized"] * 4, 5.0)
    figures = aggregate([never, right, wrong, never], ["a", "b", "c", "d"])
    assert figures["declared"].value == 0.5
    assert figures["wrong"].value == 0.25
    assert figures["wrong_of_declared"].value == 0.5
    assert figures["declared_after_m"].value == 1.5
    assert figures["declared_after_m"].n == 2
    assert figures["declared_after_m_full"].value == pytest.approx((4 + 2 + 1 + 4) / 4)
    assert figures["declared_after_s_full"].value == pytest.approx((4 + 2 + 1 + 4) / 4)
    assert figures["right_after_m_full"].value == pytest.approx((4 + 2 + 4 + 4) / 4)
    assert figures["declared_after_m_full_median"].value == 3.0
    assert figures["useful"].value == pytest.approx(0.75 / 4)
    assert figures["false_localized"].value == 0.5
    assert figures["false_localized"].n == 2


def test_reliability_of_a_perfect_and_of_a_boastful_filter():
    units = list(range(100))
    true = np.arange(100) < 70
    honest = reliability(np.full(100, 0.7), true, units)
    boastful = reliability(np.full(100, 0.99), true, units)
    assert honest.came_true[6].n + honest.came_true[7].n == 100
    assert honest.brier.value == pytest.approx(0.21)
    assert honest.brier.value < boastful.brier.value
    assert honest.log_score.value > boastful.log_score.value
    assert boastful.came_true[9].value == pytest.approx(0.7)
    assert math.isnan(boastful.came_true[0].value)
    assert np.nanmax(boastful.stated) == pytest.approx(0.99)


def test_log_score_stays_finite():
    assert np.isfinite(reliability([0.0, 1.0], [True, False], ["a", "b"]).log_score.value)


def test_interval_formats_all_three():
    assert f"{Interval(1.0, 0.5, 1.5, 3, 3):.1f}" == "1.0 [0.5, 1.5]"


def test_a_difference_keeps_pairs_together():
    rng = np.random.default_rng(1)
    easy = rng.uniform(0, 1, 40)
    units = [f"b{k}" for k in range(40)]
    change = bootstrap_difference(easy, easy + 0.1 + rng.normal(0, 0.02, 40), units, units)
    assert change.value == pytest.approx(0.1, abs=0.01)
    assert 0.08 < change.low < 0.1 < change.high < 0.12
    alone = bootstrap_interval(easy, units)
    assert change.high - change.low < 0.2 * (alone.high - alone.low)


def test_a_difference_of_means_counts_what_is_defined():
    change = bootstrap_difference([0.0, np.nan, 1.0], [1.0, 3.0], ["a", "a", "b"], ["b", "a"])
    assert (change.value, change.n, change.units) == (1.5, 4, 2)
    none = bootstrap_difference([np.nan], [1.0], ["a"], ["a"])
    assert np.isnan(none.value)
    one = bootstrap_difference([1.0], [2.0], ["a"], ["a"])
    assert one.value == 1.0
    assert np.isnan(one.low)


@pytest.mark.parametrize(("n", "doubt"), [(3, 0.708), (20, 0.168)])
def test_a_bin_in_which_all_came_true_is_not_beyond_doubt(n, doubt):
    """Exact: binomial tables give [0, 0.168] for none of 20."""
    units = [f"w{k}" for k in range(n) for _ in range(2)]
    found = reliability([0.95] * 2 * n, [True] * 2 * n, units).came_true[-1]
    assert (found.value, found.high) == (1.0, 1.0)
    assert found.low == pytest.approx(1 - doubt, abs=1e-3)
    none = reliability([0.05] * 2 * n, [False] * 2 * n, units).came_true[0]
    assert (none.low, none.high) == (0.0, pytest.approx(doubt, abs=1e-3))
