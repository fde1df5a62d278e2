from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palms.belief import (
    Belief,
    Estimate,
    Stage,
    gathered_m,
    hypotheses,
    settle,
    summarize,
    whole_m,
)
from palms.odometry import Move
from palms.particles import Particles
from palms.randomness import as_key
from palms.settings import AnswerSettings, ConvergenceSettings, Settings

KEY, STILL = as_key(0), Move(1.0, 0.0, 0.0)
PAPER = ConvergenceSettings()


def cloud(places, sizes, labels, spread=0.1, seed=0):
    rng = np.random.default_rng(seed)
    position = np.concatenate(
        [rng.normal(p, spread, (n, 2)) for p, n in zip(places, sizes, strict=True)]
    )
    n = len(position)
    return Particles(position, np.zeros(n), np.ones(n), np.repeat(labels, sizes), np.full(n, 1 / n))


def test_nobody_agrees_the_search_goes_on_with_the_mean_of_all():
    particles = cloud([[0, 0], [10, 0]], [500, 500], [0, 1])
    belief = settle(Belief(particles), particles, STILL, PAPER, KEY)
    assert belief.stage == Stage.SEARCHING
    assert belief.answer_m == pytest.approx([5, 0], abs=0.05)


def test_one_label_dominates_but_in_three_places():
    particles = cloud([[0, 0], [10, 0], [20, 0]], [450, 300, 250], [2, 2, 1])
    agreed = cloud([[0, 0], [10, 0], [20, 0], [5, 9]], [300, 300, 300, 100], [2, 2, 2, 1])
    assert settle(Belief(particles), particles, STILL, PAPER, KEY).stage == Stage.SEARCHING
    belief = settle(Belief(particles), agreed, STILL, PAPER, KEY)
    assert belief.stage == Stage.ORIENTED
    assert belief.label == 2
    assert belief.answer_m == pytest.approx([10, 0], abs=0.05)  # the dominant label's mean


def test_half_of_the_dominant_label_in_one_cluster_localizes_at_once():
    particles = cloud([[0, 0], [10, 0]], [900, 100], [1, 0])
    belief = settle(Belief(particles), particles, STILL, PAPER, KEY)
    assert belief.stage == Stage.LOCALIZED  # t1 = t2
    assert belief.answer_m == pytest.approx([0, 0], abs=0.02)
    assert belief.answering.sum() == 900


def test_between_clusterings_the_mode_moves_along_and_its_neighbours_answer():
    particles = cloud([[0, 0], [10, 0]], [900, 100], [1, 0])
    belief = settle(Belief(particles), particles, STILL, PAPER, KEY)
    for step in range(19):
        moved = cloud([[0.5 * (step + 1), 0], [10, 0]], [900, 100], [1, 0])
        belief = settle(belief, moved, Move(step + 2.0, 0.5, 0.0), PAPER, KEY)
        assert belief.age == step + 1
        assert belief.mode_m == pytest.approx([0.5 * (step + 1), 0], abs=0.05)
        assert belief.answer_m == pytest.approx([0.5 * (step + 1), 0], abs=0.05)
    again = settle(belief, moved, STILL, PAPER, KEY)
    assert again.age == 0  # clustered anew at the 20th step


def test_t2_is_final_in_the_paper():
    particles = cloud([[0, 0]], [100], [1])
    belief = settle(Belief(particles), particles, STILL, PAPER, KEY)
    scattered = cloud([[0, 0], [20, 0], [0, 20]], [40, 30, 30], [0, 1, 2])
    for _ in range(50):
        belief = settle(belief, scattered, STILL, PAPER, KEY)
    assert belief.stage == Stage.LOCALIZED


def test_the_authors_withdraw_t2_when_the_label_changes_and_thin_after_t1():
    authors = Settings.authors().convergence
    particles = cloud([[0, 0], [1, 0]], [900, 100], [1, 3])
    belief = settle(Belief(particles), particles, STILL, authors, KEY)
    assert belief.stage == Stage.LOCALIZED
    assert len(belief.particles) == 250
    changed = cloud([[0, 0], [15, 0], [0, 15]], [100, 90, 60], [2, 2, 1])
    assert settle(belief, changed, STILL, authors, KEY).label == 2


def test_uniform_judges_by_dispersion():
    uniform = Settings.uniform().convergence
    wide = cloud([[0, 0]], [500], [0], spread=2.5)
    narrow = cloud([[0, 0]], [500], [0], spread=0.4)
    assert settle(Belief(wide), wide, STILL, uniform, KEY).stage == Stage.SEARCHING
    assert settle(Belief(wide), narrow, STILL, uniform, KEY).stage == Stage.LOCALIZED


def test_a_summary_says_how_sure_it_is():
    particles = cloud([[0, 0], [30, 0]], [700, 300], [0, 1], spread=0.2)
    belief = settle(Belief(particles), particles, STILL, ConvergenceSettings(label_share=0.6), KEY)
    estimate = summarize(belief, 4.0, np.pi / 2)
    assert estimate.is_localized
    assert estimate.p_within_1m == pytest.approx(0.7, abs=0.01)
    assert estimate.p_within_2m == pytest.approx(0.7, abs=0.01)
    assert estimate.radius_68_m < 1.0
    assert estimate.radius_95_m == pytest.approx(30, abs=1)
    assert estimate.heading_rad == pytest.approx(np.pi / 2)
    assert [round(h.share, 1) for h in estimate.hypotheses] == [0.7, 0.3]
    assert estimate.hypotheses[0].x_m == pytest.approx(0, abs=0.1)


@pytest.mark.parametrize("n", [7, 999, 2000, 2001])
def test_probabilities_do_not_exceed_one(n):
    particles = cloud([[0, 0]], [n], [0])
    estimate = summarize(Belief(particles), 0.0, None)
    assert estimate.p_within_1m <= estimate.p_within_2m <= 1.0


def test_no_belief_is_a_normal_value():
    nothing = Estimate(3.0)
    assert not nothing.is_localized
    assert nothing.position_m is None
    assert nothing.p_within_1m == 0


def test_hypotheses_turn_with_the_drift():
    n = 100
    particles = Particles(
        np.zeros((n, 2)), np.full(n, 2 * np.pi + 0.5), np.ones(n), np.zeros(n), np.full(n, 1 / n)
    )
    assert hypotheses(Belief(particles))[0].drift_rad == pytest.approx(0.5)


@given(st.lists(st.floats(0.0, 60.0), min_size=2, max_size=2), st.floats(0.5, 1.0))
def test_stated_radii_keep_their_order_and_never_grow(radii_m, local_spread):
    near, far = sorted(radii_m)
    stated = [gathered_m(each, local_spread) for each in (near, far)]
    assert stated[0] <= stated[1] + 1e-12
    assert local_spread * near <= stated[0] + 1e-12
    assert stated[0] <= near
    assert gathered_m(far + 4.0, local_spread) == far + 4.0
    assert [whole_m(each, local_spread) for each in stated] == pytest.approx([near, far])


def test_only_what_is_local_is_drawn_in():
    particles = Particles(
        [[0.0, 0.0], [1.5, 0.0], [-1.5, 0.0], [30.0, 0.0]], np.zeros(4), np.ones(4),
        np.zeros(4), [0.4, 0.25, 0.25, 0.1],
    )  # fmt: skip
    belief = Belief(particles, answering=np.array([True, True, True, False]))
    whole, drawn_in = (
        summarize(belief, 0.0, None, AnswerSettings(local_spread=spread)) for spread in (1.0, 0.6)
    )
    assert (whole.p_within_1m, drawn_in.p_within_1m) == pytest.approx((0.4, 0.9))
    assert whole.p_within_2m == drawn_in.p_within_2m == pytest.approx(0.9)
    assert (whole.radius_68_m, drawn_in.radius_68_m) == pytest.approx((1.5, 0.9))
    assert whole.radius_95_m == drawn_in.radius_95_m == pytest.approx(30.0)
    core = summarize(belief, 0.0, None, AnswerSettings(local_spread=0.6, core_spread=0.5))
    assert replace(core, radius_68_m=drawn_in.radius_68_m) == drawn_in
    assert core.radius_68_m == pytest.approx(0.75)
