import dataclasses
import multiprocessing
import pickle

import numpy as np
import pytest

from palms.belief import Stage
from palms.building import Building
from palms.errors import InputError, PalmsError
from palms.localizer import Localizer, locate, recorded, track, track_trials
from palms.odometry import Move, Odometry
from palms.raster import rasterize
from palms.scan import Scan
from palms.settings import METHODS, Settings
from tests.worlds import seen_from, two_rooms, walk

PLAN = two_rooms()
START = np.array([5.0, 3.9])
STEPS = [*[(0.5, 0.0)] * 4, *[(-0.5, 0.0)] * 7, *[(0.0, 0.6)] * 4, *[(0.6, 0.0)] * 24]
DRIFT = 0.7


def scan(drift=DRIFT):
    near = np.linalg.norm(PLAN.segments_m.mean(axis=1) - START, axis=1) < 4.5
    return seen_from(START, PLAN.segments_m[near], drift)


def same(a, b):
    return len(a) == len(b) and all(
        (x.stage, x.p_within_1m, x.radius_95_m, x.drift_rad, x.heading_rad, x.hypotheses)
        == (y.stage, y.p_within_1m, y.radius_95_m, y.drift_rad, y.heading_rad, y.hypotheses)
        and np.array_equal(x.position_m, y.position_m)
        for x, y in zip(a, b, strict=True)
    )


def test_a_walk_is_followed_to_the_truth():
    odometry = walk(STEPS, DRIFT)
    found = track(PLAN, scan(), odometry, Settings.paper(), rng=1)
    truth = START + np.cumsum(STEPS, axis=0)
    assert found.localized_at_s is not None
    assert found.oriented_at_s <= found.localized_at_s
    assert np.linalg.norm(found.position_m[-1] - truth[-1]) < 0.5
    assert found.estimates[-1].drift_rad == pytest.approx(DRIFT, abs=0.1)
    assert found.estimates[-1].heading_rad == pytest.approx(0, abs=0.1)


@pytest.mark.parametrize("method", METHODS)
def test_live_and_recorded_give_the_same_answers(method):
    settings, odometry = Settings.for_method(method).with_particles(400), walk(STEPS, DRIFT)
    recorded = track(PLAN, scan(), odometry, settings, rng=5)
    live = Localizer(PLAN, settings, rng=5)
    live.observe(scan())
    assert same([live.move(move) for move in odometry.moves()], list(recorded))
    assert same(list(track(PLAN, scan(), odometry, settings, rng=5)), list(recorded))


@pytest.mark.parametrize("method", METHODS)
def test_trials_do_not_depend_on_one_another(method):
    settings, odometry = Settings.for_method(method).with_particles(300), walk(STEPS, DRIFT)
    one = list(track_trials(rasterize(PLAN), scan(), odometry, settings, range(3, 9)))
    assert [a.seed for a in one] == [3, 4, 5, 6, 7, 8]
    for a in one:
        assert same(list(a), list(track(PLAN, scan(), odometry, settings, rng=a.seed)))
    assert not same(list(one[0]), list(one[1]))


def _trials(where, seeds=range(3, 9), settings=None, jobs=2):
    settings = settings or Settings.for_method("paper").with_particles(300)
    return track_trials(where, scan(), walk(STEPS, DRIFT), settings, seeds, jobs)


@pytest.fixture
def much(monkeypatch):
    """As if little work were much."""
    monkeypatch.setattr(recorded, "SHARE", 1)


@pytest.mark.parametrize("where", [rasterize(PLAN), Building((PLAN,))], ids=["raster", "building"])
@pytest.mark.parametrize("method", ["palms", "uniform-ori"])
def test_trials_do_not_depend_on_processes(method, where, much):
    settings = Settings.for_method(method).with_particles(300)
    seeds = [5, 3, 5, 8, 4]
    one, two = (list(_trials(where, seeds, settings, jobs)) for jobs in (1, 2))
    assert [each.seed for each in two] == seeds
    assert all(same(list(a), list(b)) for a, b in zip(one, two, strict=True))


def test_little_work_starts_no_process(monkeypatch):
    monkeypatch.setattr(recorded, "in_processes", None)
    assert len(list(_trials(rasterize(PLAN), range(8), jobs=8))) == 8
    assert list(_trials(rasterize(PLAN), (), jobs=8)) == []


def test_whoever_leaves_early_leaves_no_process(much):
    tracks = _trials(rasterize(PLAN), range(1000))
    next(tracks), next(tracks)
    working = multiprocessing.active_children()
    assert len(working) == 2
    tracks.close()
    for process in working:
        process.join(10.0)
    assert not multiprocessing.active_children()


def test_a_trials_process_that_dies_is_said(much):
    tracks = _trials(rasterize(PLAN), range(1000))
    next(tracks), next(tracks)
    multiprocessing.active_children()[0].kill()
    with pytest.raises(PalmsError, match="a worker process died; run it again"):
        list(tracks)


def test_what_was_worked_out_of_a_plan_stays_behind():
    raster, settings = rasterize(PLAN), Settings()
    before = len(pickle.dumps(raster))
    found = locate(raster, scan(), settings)
    assert raster.sights
    there = pickle.loads(pickle.dumps(raster, protocol=5))
    assert len(pickle.dumps(there)) == before
    assert not there.inside.flags.writeable
    again = locate(there, scan(), settings)
    assert np.array_equal(found.log_weight, again.log_weight)
    building = Building((PLAN,))
    before = len(pickle.dumps(building))
    assert building.atlas.raster(settings.raster)
    assert len(pickle.dumps(building)) == before


def test_other_seeds_give_other_answers_but_the_same_place():
    odometry = walk(STEPS, DRIFT)
    ends = [track(PLAN, scan(), odometry, Settings.paper(), rng=s).position_m[-1] for s in range(8)]
    assert len({tuple(end) for end in ends}) == 8
    truth = START + np.sum(STEPS, axis=0)
    off = np.linalg.norm(np.array(ends) - truth, axis=1)
    assert np.sum(off < 0.5) >= 5


def test_a_scan_taken_elsewhere_in_the_odom_frame_says_so():
    away = np.array([1.3, -0.4])  # the phone then carried back to the origin
    moved = Scan(scan(0.0).walls_m + away, position_m=away)
    start = Localizer(PLAN, Settings.paper()).observe(scan(0.0))
    shifted = Localizer(PLAN, Settings.paper()).observe(moved, np.zeros(2))
    best = shifted.hypotheses[0]
    turned = {tuple(np.round([h.x_m, h.y_m], 0)) for h in start.hypotheses}
    assert (round(best.x_m + away[0]), round(best.y_m + away[1])) in turned or best.share < 0.5


def test_without_a_scan_there_is_no_belief():
    estimate = Localizer(PLAN, Settings.paper()).move(Move(1.0, 0.5, 0.0))
    assert estimate.position_m is None
    assert estimate.stage == Stage.SEARCHING
    assert estimate.heading_rad is None
    assert estimate.p_within_2m == 0


def test_uniform_with_orientation_waits_for_its_first_moves():
    found = track(PLAN, None, walk(STEPS), Settings.uniform_ori(), rng=0)
    assert [e.position_m is None for e in found][:9] == [True] * 7 + [False] * 2


def test_time_must_not_go_back():
    localizer = Localizer(PLAN, Settings.uniform())
    localizer.move(Move(2.0, 0.5, 0.0))
    with pytest.raises(InputError, match="time from 2 s on"):
        localizer.move(Move(1.0, 0.5, 0.0))


def test_watchers_see_every_step():
    seen = []
    odometry = walk(STEPS, DRIFT)
    track(PLAN, scan(), odometry, Settings.paper(), watch=lambda *args: seen.append(args))
    assert len(seen) == len(odometry)
    estimate, belief, info = seen[-1]
    assert estimate.is_localized
    assert len(belief.particles) == 2000
    assert info.n_hit + info.n_survived == 2000


def test_a_frame_of_its_own_leaves_the_drift_open():
    own = dataclasses.replace(walk(STEPS, 2.0), frame="own", source="inertial")
    first = track(PLAN, scan(), own, Settings.paper(), rng=0).estimates[0]
    assert first.stage == Stage.SEARCHING
    assert first.p_within_2m < 0.9


def test_the_scan_alone_gives_candidates_with_the_truth_among_the_best():
    found = locate(PLAN, scan(), Settings.paper())
    best = found.position_m[np.argsort(-found.score)][:5]
    assert np.linalg.norm(best - START, axis=1).min() < 0.15


def test_a_walk_of_two_samples_is_a_walk():
    two = Odometry([0.5, 1.0], [[0.1, 0], [0.2, 0]])
    assert len(track(PLAN, scan(), two, Settings.paper())) == 2
