import dataclasses
import math

import numpy as np
import pytest

from palms.belief import Belief, Stage, summarize
from palms.declaration import doubted, evidence_of, judge
from palms.particles import MoveInfo, Particles
from palms.settings import DeclarationSettings

OURS = DeclarationSettings("probability")
FREE = MoveInfo(0, 100, 100.0, 0.0)


def crowd(n_here, n_there=0, drift_there=0.0, spread=0.1):
    rng = np.random.default_rng(0)
    position = np.concatenate(
        [rng.normal(0, spread, (n_here, 2)), rng.normal(0, spread, (n_there, 2)) + 20]
    )
    n = n_here + n_there
    drift = np.repeat([0.0, drift_there], [n_here, n_there])
    return Particles(position, drift, np.ones(n), np.zeros(n), np.full(n, 1 / n))


def after(particles, *, doubt=0.005, stage=Stage.SEARCHING, walked_m=0.0, info=FREE):
    return moved(Belief(particles, stage, doubt=doubt), walked_m, info)


def moved(belief, walked_m, info):
    return judge(belief, belief.particles, OURS, evidence_of(walked_m, info, OURS))


def test_it_is_localized_when_it_is_probable_and_only_then():
    assert after(crowd(1000)).stage is Stage.LOCALIZED
    assert after(crowd(960, 40)).stage is Stage.ORIENTED
    assert after(crowd(600, 400, drift_there=2.0)).stage is Stage.SEARCHING


def test_it_leaves_later_than_it_enters():
    shaky = crowd(930, 70)
    assert after(shaky).stage is Stage.ORIENTED
    assert after(shaky, stage=Stage.LOCALIZED).stage is Stage.LOCALIZED
    assert after(crowd(800, 200), stage=Stage.LOCALIZED).stage is Stage.ORIENTED


def test_the_answer_is_the_heaviest_place_and_not_the_mean():
    assert np.linalg.norm(after(crowd(600, 400)).answer_m) < 0.1


def test_walls_that_contradict_the_belief_make_it_unsure_and_then_lost():
    belief, seen = after(crowd(1000)), []
    for _ in range(4):
        hit = MoveInfo(950, 50, 100.0, math.log(0.05))
        belief = moved(belief, 0.65, hit)
        seen.append(belief.stage)
    assert seen[0] is not Stage.LOST
    assert seen[-1] is Stage.LOST
    assert summarize(belief, 1.0, None).p_within_2m < 0.5


def test_walking_where_the_belief_allows_takes_the_doubt_away():
    belief = after(crowd(1000), doubt=0.3)
    assert belief.stage is not Stage.LOCALIZED
    for _ in range(60):
        belief = moved(belief, 0.65, FREE)
    assert belief.doubt == OURS.doubt_floor
    assert belief.stage is Stage.LOCALIZED


def test_many_small_moves_into_walls_leave_an_answer():
    belief = after(crowd(1000))
    for _ in range(200):
        hit = MoveInfo(1000, 0, 100.0, math.log(0.03))
        belief = moved(belief, 0.05, hit)
        estimate = summarize(belief, 1.0, None)
    assert estimate.stage is Stage.LOST
    assert 0 < estimate.p_within_2m < 1e-3
    assert np.isfinite(estimate.radius_95_m)


def test_doubt_is_bayes_rule():
    odds = 0.2 / 0.8 * math.exp(0.7)
    assert doubted(0.2, -0.7, OURS) == pytest.approx(odds / (1 + odds))
    assert doubted(doubted(0.9, -1e6, OURS), -1e6, OURS) < 1
    assert doubted(0.0, 0.0, OURS) == OURS.doubt_floor


def test_probabilities_and_radii_count_the_doubt():
    belief = after(crowd(900, 100))
    sure, unsure = (dataclasses.replace(belief, doubt=d) for d in (0.0, 0.2))
    a, b = (summarize(belief, 0.0, None) for belief in (sure, unsure))
    assert b.p_within_2m == pytest.approx(0.8 * a.p_within_2m)
    assert b.radius_95_m > 20 > a.radius_68_m
    assert b.radius_68_m >= a.radius_68_m


def test_lost_stays_until_something_is_known_again():
    spread = crowd(500, 500, drift_there=2.0)
    assert after(spread, stage=Stage.LOST).stage is Stage.LOST
    assert after(crowd(1000), stage=Stage.LOST).stage is Stage.LOCALIZED


def test_orientation_counts_drifts_across_the_turn():
    n = 400
    drift = np.linspace(-0.2, 0.2, n) + np.pi
    particles = dataclasses.replace(crowd(n, spread=9.0), drift_rad=drift)
    assert after(particles).stage is Stage.ORIENTED
