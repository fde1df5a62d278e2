import numpy as np
import pytest

from palms.errors import InputError
from palms.evaluation.curves import (
    declare_by_threshold,
    error_cdf,
    localized_shares,
    pooled_errors,
    sampled_reliability,
    threshold_sweep,
    worst_trials,
)


def record(error, localized, p2=None, **names):
    n = len(error)
    series = {
        "walked_m": [2.0 * (i + 1) for i in range(n)], "error_m": error, "localized": localized,
        "p2": p2 or [0.5] * n,
    }  # fmt: skip
    return {"scene": "E2", "walk": "w1", "length_m": 2.0 * n, "series": series} | names


def test_the_cdf_ends_below_one_where_answers_are_missing():
    cdf = error_cdf([1.0, np.nan, 3.0, np.nan])
    assert cdf.share[-1] == 0.5
    assert [cdf.at(limit) for limit in (0.5, 1.0, 2.0, 99.0)] == [0.0, 0.25, 0.25, 0.5]


def test_the_cdf_weighs_metres():
    assert error_cdf([1.0, 5.0], [9.0, 1.0]).at(1.0) == 0.9
    assert len(error_cdf([]).share) == 0
    with pytest.raises(InputError, match="2 weights"):
        error_cdf([1.0, 5.0], [9.0])


def test_errors_are_pooled_with_their_metres():
    one = record([None, 9.0, 0.5], [0, 0, 1])
    error, metres = pooled_errors([one, one])
    assert error.tolist() == [0.5, 0.5]
    assert metres.tolist() == [2.0, 2.0]
    assert np.isnan(pooled_errors([one], localized_only=False)[0]).sum() == 1


def test_shares_are_of_all_trials_and_end_as_the_walks_did():
    short, long = record([0.5], [1]), record([9.0, 9.0, 9.0], [0, 1, 1])
    shares = localized_shares([short, long])
    assert shares.walked_m.tolist() == [0.0, 2.0, 4.0, 6.0]
    assert shares.localized.tolist() == [0.0, 0.5, 1.0, 1.0]
    assert shares.right.tolist() == [0.0, 0.5, 0.5, 0.5]


def test_a_threshold_declares_as_the_metrics_count():
    walked, error, p = [2, 4, 6, 8], [9, 9, 1, 1], [0.1, 0.6, 0.2, 0.9]
    assert declare_by_threshold(walked, error, p, 0.5).right_after_m == 8.0
    assert declare_by_threshold(walked, error, p, 0.5).false_localized == 0.5
    never = declare_by_threshold(walked, error, p, 0.95)
    assert np.isnan([never.false_localized, never.right_after_m]).all()


def test_a_sweep_counts_walks_without_a_right_declaration_in_full():
    trials = [record([9.0, 0.5], [0, 1], [0.1, 0.9]), record([9.0] * 4, [0] * 4, [0.1] * 4)]
    sweep = threshold_sweep(trials, [0.5, 0.95])
    assert sweep.right_after_m.tolist() == [(4.0 + 8.0) / 2, (4.0 + 8.0) / 2]
    assert sweep.false_localized[0] == 0.0
    assert np.isnan(sweep.false_localized[1])


def test_reliability_takes_one_step_a_trial():
    trials = [
        {"scene": "E2", "walk": f"w{i}", "sampled_p_within_1m": p, "sampled_within_1m": p == 0.9}
        for i, p in enumerate([0.1, 0.9, None, 0.9])
    ]
    found = sampled_reliability(trials[:2] + trials[3:])
    assert [interval.n for interval in found.came_true] == [0, 1, 0, 0, 0, 0, 0, 0, 0, 2]
    assert sampled_reliability([trials[2]]) is None


def test_the_worst_are_of_different_walks_first():
    trials = [
        {"scene": "E2", "walk": w, "useful": u, "longest_false_m": m}
        for w, m, u in [("a", 5.0, 0.1), ("a", 9.0, 0.1), ("b", 0.0, 0.9), ("c", 0.0, None)]
    ]
    assert [trials.index(t) for t in worst_trials(trials, 4)] == [1, 3, 2, 0]


def test_real_records_fit(records):
    sweep = threshold_sweep(records)
    assert np.all((sweep.right_after_m > 0) & (sweep.right_after_m <= records[0]["length_m"]))
    shares = localized_shares(records)
    assert np.all(shares.right <= shares.localized)
