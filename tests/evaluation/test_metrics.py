"""Every metric on tiny cases whose figures can be worked out by hand."""

import json
import math

import numpy as np
import pytest

from palms import Estimate, FloorPlan, InputError, Stage, Track, rasterize
from palms.evaluation.metrics import Answers, TrialMetrics, sample_step, trial_metrics

S, O, L, X = "searching", "oriented", "localized", "lost"  # noqa: E741
NAN = math.nan


def case(stages, errors, lengths=None, *, known=None, **stated):
    """Walk along x with steps of 1 m; answers are off by `errors` in y."""
    n = len(stages)
    lengths = [1.0] * n if lengths is None else lengths
    x = np.cumsum(lengths)
    reference = np.stack([x, np.zeros(n)], axis=1)
    answers = Answers(
        np.arange(1.0, n + 1), np.stack([x, np.asarray(errors, float)], axis=1), stages, **stated
    )
    if known is not None:
        reference[~np.asarray(known, bool)] = NAN
    moves = np.stack([lengths, np.zeros(n)], axis=1)
    return answers, reference, moves


def metrics(*args, **kwargs):
    return trial_metrics(*case(*args, **kwargs))


def test_declaration_is_the_first_localized_step():
    m = metrics([S, O, L, L], [9, 9, 1.5, 0])
    assert m.declared
    assert not m.wrong
    assert (m.declared_after_s, m.declared_after_m, m.right_after_m) == (3.0, 3.0, 3.0)


@pytest.mark.parametrize(("error", "wrong"), [(2.0, False), (2.01, True)])
def test_wrong_is_off_by_more_than_two_metres_at_that_moment(error, wrong):
    m = metrics([S, L, L], [0, error, 0])
    assert m.wrong is wrong
    assert m.right_after_m == (None if wrong else 2.0)  # never entered again


def test_a_second_declaration_may_be_right():
    m = metrics([L, X, L, L], [5, 5, 0.5, 0])
    assert m.wrong
    assert m.declared_after_m == 1.0
    assert m.right_after_m == 3.0


def test_false_localized_is_a_share_of_localized_metres():
    m = metrics([S, L, L, L], [9, 0, 3, 0], lengths=[5, 1, 2, 1])
    assert m.false_localized == 0.5
    assert m.useful == 2 / 9
    assert m.longest_false_m == 2.0


def test_longest_false_stretch_ends_with_a_good_step_and_when_lost():
    m = metrics([L, L, L, X, L, L, L], [3, 3, 0, 3, 3, 3, 3], lengths=[1, 1, 1, 1, 1, 1, 0.5])
    assert m.longest_false_m == 2.5
    m = metrics([L, L, X, L], [3, 3, 3, 3])
    assert m.longest_false_m == 2.0


def test_localized_steps_only_count_after():
    m = metrics([L, L, X, S], [0, 2, 50, 50])
    assert m.rmse_after_m == pytest.approx(math.sqrt(2))
    assert m.within_1m_after == 0.5
    assert m.final_error_m == 50.0


def test_the_papers_columns_count_all_later_steps():
    m = metrics([S, L, X, L], [7, 1, 1, 2])
    assert (m.paper_time_s, m.paper_distance_m) == (2.0, 2.0)
    assert m.paper_rmse_m == pytest.approx(math.sqrt(2))
    assert m.paper_within_1m == pytest.approx(2 / 3)


def test_useful_is_within_one_metre_inclusive():
    assert metrics([L, L], [1.0, 1.001]).useful == 0.5


def test_coverage_over_localized_steps():
    m = metrics([S, L, L], [9, 1, 2], radius_68_m=[1, 1.0, 1], radius_95_m=[1, 2, 2])
    assert (m.coverage_68, m.coverage_95) == (0.5, 1.0)


def test_the_radius_is_the_median_while_localized():
    assert metrics([S, L, L, L], [9, 1, 2, 2], radius_95_m=[9, 1, 5, 2]).radius_95_m == 2.0


def test_an_alarm_is_false_when_the_answer_was_right():
    m = metrics([X, X, L, X, S, X], [1, 1, 0, 2, 0, 2.1])
    assert m.false_alarms == 2  # the first, and the one after localized; the last is right


def test_right_place_needs_no_wall_between():
    raster = rasterize(FloorPlan([[[-5, 1], [20, 1]], [[-5, -5], [20, -5]]]))
    m = trial_metrics(*case([L, L, L, S], [0.5, 2, -3, 0]), raster)
    assert m.right_place == 0.5  # of four metres: the wall at y = 1 cuts off one, one is searched
    assert metrics([L], [0]).right_place is None


def test_never_declared():
    m = metrics([S, O, X], [0, 0, 4])
    assert not m.declared
    assert not m.wrong
    undefined = (
        "declared_after_s", "declared_after_m", "right_after_m", "false_localized",
        "rmse_after_m", "within_1m_after", "coverage_68", "coverage_95", "radius_95_m",
        "paper_time_s", "paper_distance_m", "paper_rmse_m", "paper_within_1m",
    )  # fmt: skip
    assert all(getattr(m, name) is None for name in undefined)
    assert (m.useful, m.longest_false_m, m.final_error_m) == (0.0, 0.0, 4.0)
    assert (m.duration_s, m.length_m) == (3.0, 3.0)


def test_steps_without_a_reference_are_left_out_but_walked():
    m = metrics([L, S, L, L], [0, 0, 3, 0], lengths=[4, 1, 1, 1], known=[0, 1, 1, 1])
    assert (m.declared_after_m, m.wrong) == (6.0, True)
    assert m.false_localized == 0.5
    assert m.useful == pytest.approx(1 / 3)
    assert m.length_m == 7.0


def test_a_gap_in_the_reference_does_not_break_a_false_stretch():
    m = metrics([L, L, L], [3, 0, 3], known=[1, 0, 1])
    assert m.longest_false_m == 2.0


def test_no_reference_at_all():
    m = metrics([L, L], [0, 0], known=[0, 0])
    assert not m.declared
    assert (m.useful, m.final_error_m, m.false_localized) == (None, None, None)


def test_no_steps_at_all():
    m = trial_metrics(Answers([], np.empty((0, 2)), ()), np.empty((0, 2)), np.empty((0, 2)))
    assert (m.declared, m.useful, m.length_m, m.duration_s) == (False, None, 0.0, 0.0)


def test_no_answer_while_localized_is_false():
    m = metrics([S, L, L], [0, NAN, 0])
    assert m.wrong
    assert m.false_localized == 0.5
    assert m.rmse_after_m == 0.0


def test_no_answer_at_the_end():
    assert metrics([S, S], [0, NAN]).final_error_m is None


def test_standing_still_earns_nothing():
    m = metrics([L, L], [0, 9], lengths=[1, 0])
    assert (m.useful, m.false_localized, m.longest_false_m) == (1.0, 0.0, 0.0)
    assert metrics([S, L], [0, 0], lengths=[1, 0]).false_localized is None


def test_json_holds_every_metric_and_no_nan():
    content = metrics([S, L, L], [NAN, NAN, 3]).to_json()
    assert set(content) == set(TrialMetrics.__dataclass_fields__)
    assert not any(isinstance(v, float) and math.isnan(v) for v in content.values())
    assert all(v is None or type(v) in (bool, int, float) for v in content.values())


def test_answers_of_a_track():
    steps = (Estimate(0.5), Estimate(1.0, Stage.LOCALIZED, np.array([1.0, 2.0]), p_within_1m=0.5,
                                     radius_68_m=1.0, radius_95_m=2.0))  # fmt: skip
    answers = Answers.of(Track(0, steps))
    assert np.isnan(answers.position_m[0]).all()
    assert answers.position_m[1].tolist() == [1.0, 2.0]
    assert answers.localized.tolist() == [False, True]
    assert np.isnan(answers.radius_68_m[0])
    assert answers.radius_95_m[1] == 2.0


def test_answers_of_json_are_those_of_the_track():
    answers = Answers.from_json({
        "t_s": [0.5, 1.0], "x_m": [None, 1.0], "y_m": [None, 2.0], "stage": [S, L],
        "p_within_1m": [0, 0.5], "radius_68_m": [None, 1.0], "radius_95_m": [None, 2.0],
        "drift_rad": [None, 0.0],
    })  # fmt: skip
    assert np.isnan(answers.position_m[0]).all()
    assert answers.stage == (Stage.SEARCHING, Stage.LOCALIZED)


@pytest.mark.parametrize("wrong", ["reference", "moves"])
def test_lengths_must_agree(wrong):
    answers, reference, moves = case([S, L], [0, 0])
    shorter = {"reference": (reference[:1], moves), "moves": (reference, moves[:1])}[wrong]
    with pytest.raises(InputError, match=wrong):
        trial_metrics(answers, *shorter)
    with pytest.raises(InputError, match="stage"):
        Answers([1.0, 2.0], reference, [S])


def test_sampled_step_has_a_reference():
    answers, reference, _ = case(
        [S] * 4, [0, 0, 0, 5], known=[0, 0, 0, 1], p_within_1m=[1, 1, 1, 0.25]
    )
    drawn = {sample_step(answers, reference, np.random.default_rng(k)) for k in range(5)}
    assert drawn == {(0.25, False)}
    assert sample_step(answers, np.full((4, 2), NAN), np.random.default_rng(0)) is None


def test_an_answer_on_another_level_is_wrong_however_near():
    answers = Answers([1.0, 2.0, 3.0], np.zeros((3, 2)), [L, L, L], level=["1", "2", "2"])
    moves = [[1, 0]] * 3
    m = trial_metrics(answers, np.zeros((3, 2)), moves, reference_level=["1", "1", "2"])
    assert (m.wrong, m.right_after_m) == (False, 1.0)
    assert m.false_localized == pytest.approx(1 / 3)
    assert m.useful == pytest.approx(2 / 3)
    assert m.longest_false_m == 1.0
    assert (m.rmse_after_m, m.within_1m_after) == (0.0, pytest.approx(2 / 3))
    json.dumps(m.to_json(), allow_nan=False)
    last = trial_metrics(answers, np.zeros((3, 2)), moves, reference_level=["1", "2", "1"])
    assert last.final_error_m is None
    for level, near in (("2", True), ("1", False)):
        found = sample_step(
            Answers([1.0], [[0, 0]], [L], [0.5], level=["2"]), [[0, 0]],
            np.random.default_rng(0), [level],
        )  # fmt: skip
        assert found == (0.5, near)


def test_levels_in_a_track_file_are_read():
    steps = {
        "t_s": [1.0], "x_m": [0.0], "y_m": [0.0], "stage": ["localized"], "p_within_1m": [1.0],
        "radius_68_m": [0.1], "radius_95_m": [0.2], "level": ["G"], "p_level": [0.9],
        "heading_rad": [None], "words": ["anything"],
    }  # fmt: skip
    assert Answers.from_json(steps).level == ("G",)
    assert Answers.from_json({k: v for k, v in steps.items() if k != "level"}).level == (None,)
