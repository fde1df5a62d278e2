"""A frame that is new: the place is kept, the drift found again, and nothing claimed wrongly."""

import math

import numpy as np
import pytest

from palms.belief import Belief
from palms.building import Building
from palms.declaration import judge
from palms.errors import InputError
from palms.evaluation.simulation import ScannerNoise, WorldNoise, make_world, take_scan
from palms.geometry import rotate
from palms.io import open_dataset, read_truth
from palms.localizer import Localizer
from palms.odometry import Move
from palms.particles import Particles
from palms.randomness import as_key
from palms.raster import rasterize
from palms.recovery import Conditions
from palms.restart import reframed, spread_m
from palms.sample import sample_folder
from palms.settings import METHODS, RestartSettings, Settings
from tests.test_building import HOUSE
from tests.test_localizer import DRIFT, PLAN, START, STEPS
from tests.test_localizer import scan as scan_at_start
from tests.worlds import seen_from, walk

OURS = Settings().with_particles(8000)
RASTER = rasterize(PLAN)
CONDITIONS = Conditions(RASTER, OURS, False)
KEY = as_key(3)


def sure(place=(10.0, 6.0), n=2000):
    """A belief that knows its place, to 0.3 m."""
    spread = 0.3 * np.random.default_rng(1).normal(size=(n, 2))
    particles = Particles(
        place + spread, np.full(n, 0.7), np.ones(n), np.zeros(n), np.full(n, 1 / n)
    )
    return judge(Belief(particles, doubt=0.01), particles, OURS.declaration)


def test_somebody_walks_straight_at_first_and_then_at_random():
    settings = RestartSettings(speed_m_s=1.2, leg_s=10.0)
    assert spread_m(0.0, settings) == 0.0
    assert spread_m(0.5, settings) == pytest.approx(1.2 * 0.5 / math.sqrt(2), rel=0.02)
    long, longer = spread_m(4000.0, settings), spread_m(16_000.0, settings)
    assert longer / long == pytest.approx(2.0, rel=0.01)
    times = np.linspace(0.1, 600, 50)
    assert (np.diff([spread_m(t, settings) for t in times]) > 0).all()


def test_the_random_walk_is_what_the_formula_says():
    """Walkers who turn anywhere, after legs of exponential length."""
    rng, settings, t_s, dt = np.random.default_rng(0), RestartSettings(), 30.0, 0.1
    place, heading = np.zeros((4000, 2)), rng.uniform(-np.pi, np.pi, 4000)
    for _ in range(int(t_s / dt)):
        turns = rng.random(4000) < dt / settings.leg_s
        heading[turns] = rng.uniform(-np.pi, np.pi, turns.sum())
        place += settings.speed_m_s * dt * np.column_stack([np.cos(heading), np.sin(heading)])
    assert place.std(axis=0) == pytest.approx([spread_m(t_s, settings)] * 2, rel=0.05)


def test_in_no_time_the_place_stays_and_the_drift_is_anything():
    before = sure()
    after, nats = reframed(before, 0.0, CONDITIONS, KEY)
    p = after.particles
    assert p.mean_m() == pytest.approx(before.particles.mean_m(), abs=0.02)
    assert p.dispersion_m() == pytest.approx(before.particles.dispersion_m(), rel=0.05)
    shares = np.histogram(np.mod(p.drift_rad, 2 * np.pi), 8, weights=p.weight)[0]
    assert shares == pytest.approx([1 / 8] * 8, abs=0.03)
    assert nats < 1.0
    assert after.doubt < 0.15
    assert after.stage == before.stage  # it still knows where it is


@pytest.mark.parametrize("away_s", [3.0, 20.0, 200.0])
def test_the_longer_away_the_wider_and_always_inside(away_s):
    before = sure()
    p = reframed(before, away_s, CONDITIONS, KEY)[0].particles
    cells = RASTER.grid.cell_of(p.position_m)
    assert RASTER.inside[tuple(cells.T)].all()
    away = np.linalg.norm(p.position_m - before.particles.mean_m(), axis=1)
    stays = p.weight[away < 1.0].sum()
    gone = 1 - math.exp(-away_s / OURS.restart.keep_s)
    assert stays > (1 - OURS.restart.walk_share) * (1 - gone) - 0.02
    soon = reframed(before, 0.3, CONDITIONS, KEY)[0].particles
    at_once = np.linalg.norm(soon.position_m - before.particles.mean_m(), axis=1)
    assert stays < soon.weight[at_once < 1.0].sum() - 0.1


def test_few_particles_for_many_places_are_a_reason_to_doubt():
    before = sure()
    few = Conditions(RASTER, OURS.with_particles(1000), False)
    many = Conditions(RASTER, OURS.with_particles(60_000), False)
    one, two = (reframed(before, 2.0, each, KEY) for each in (few, many))
    assert one[1] > two[1] > 0
    assert one[0].doubt > two[0].doubt
    assert one[0].doubt <= 0.3 < OURS.declaration.lost


def test_levels_are_kept_and_stairs_may_have_been_taken():
    atlas = HOUSE.atlas
    conditions = Conditions(atlas.raster(OURS.raster), OURS, False, atlas)
    off, on = sure((4.0, 6.0)), sure((10.0, 9.5))
    for before, most in ((off, 0.05), (on, 0.6)):
        p = reframed(before, 8.0, conditions, KEY)[0].particles
        up = p.weight[atlas.level_of(p.position_m) == 1].sum()
        assert up < most
    assert up > 0.1


def scan_of(point, drift):
    near = np.linalg.norm(PLAN.segments_m.mean(axis=1) - point, axis=1) < 4.5
    return seen_from(point, PLAN.segments_m[near], drift)


def walked(localizer, steps, drift, start_s):
    """Move by map displacements, in a frame turned by -drift."""
    for k, move in enumerate(walk(steps, drift).moves(), 1):
        localizer.move(move._replace(time_s=start_s + 0.55 * k, duration_s=None))
    return localizer.estimate


def test_a_scan_in_the_new_frame_finds_the_drift_at_once():
    localizer = Localizer(PLAN, OURS, rng=1)
    localizer.observe(scan_at_start())
    assert walked(localizer, STEPS, DRIFT, 0.0).is_localized
    here, new = START + np.sum(STEPS, axis=0), -2.1
    seen = scan_of(here, new)
    localizer.restart(2.0)
    assert localizer.estimate.heading_rad is None
    found = localizer.observe(seen)
    assert np.linalg.norm(found.position_m - here) < 0.5
    assert abs(math.remainder(found.drift_rad - new, 2 * math.pi)) < 0.1
    alone = Localizer(PLAN, OURS, rng=1).observe(seen)
    assert found.p_within_2m > alone.p_within_2m - 0.02


def test_a_place_that_was_wrong_is_outvoted_by_the_scan():
    """It was carried elsewhere meanwhile, which nobody can know: the doubt lets it come back."""
    localizer = Localizer(PLAN, OURS, rng=1)
    localizer.observe(scan_at_start())
    walked(localizer, STEPS, DRIFT, 0.0)
    localizer.restart(1.0)
    there = np.array([6.0, 1.5])
    for _ in range(3):
        found = localizer.observe(scan_of(there, 0.3))
    assert np.linalg.norm(found.position_m - there) < 0.5


def test_without_a_scan_the_walk_finds_the_drift():
    localizer = Localizer(PLAN, OURS, rng=1)
    localizer.observe(scan_at_start())
    walked(localizer, STEPS, DRIFT, 0.0)
    localizer.restart(0.0)
    back = [(-x, -y) for x, y in STEPS[::-1]]
    found = walked(localizer, back, 2.0, localizer.estimate.time_s)
    assert np.linalg.norm(found.position_m - START) < 1.0
    assert abs(math.remainder(found.drift_rad - 2.0, 2 * math.pi)) < 0.2


def test_the_same_seed_gives_the_same_belief():
    def particles():
        localizer = Localizer(PLAN, OURS, rng=4)
        localizer.observe(scan_at_start())
        localizer.restart(4.0)
        return localizer.belief.particles

    one, two = particles(), particles()
    assert np.array_equal(one.position_m, two.position_m)
    assert np.array_equal(one.drift_rad, two.drift_rad)


@pytest.mark.parametrize("method", [name for name in METHODS if name not in ("palms", "no-scan")])
def test_other_methods_begin_anew(method):
    settings = Settings.for_method(method).with_particles(300)
    one, two = Localizer(PLAN, settings, rng=5), Localizer(PLAN, settings, rng=5)
    one.observe(scan_at_start())
    walked(one, STEPS[:12], DRIFT, 0.0)
    one.restart(3.0)
    for localizer in (one, two):
        localizer.observe(scan_at_start())
    for k in range(12):
        time_s = one.estimate.time_s + 0.5 + k
        first, second = (each.move(Move(time_s, 0.3, 0.0, None)) for each in (one, two))
    assert (first.position_m is None) == (second.position_m is None)
    assert first.stage == second.stage


def test_before_there_is_a_belief_nothing_is_lost():
    localizer = Localizer(Building((PLAN,)), OURS)
    assert localizer.restart(10.0).position_m is None
    assert localizer.observe(scan_at_start()).position_m is not None
    with pytest.raises(InputError, match="0 s or more"):
        localizer.restart(-1.0)


@pytest.mark.parametrize("at", [40, 85, 115])
def test_in_the_sample_building_it_finds_itself_again_and_never_claims_a_wrong_place(at):
    (case,) = open_dataset(sample_folder()).cases
    plan, odometry, truth = (
        case.plan(),
        case.walk().odometry(),
        read_truth(case.folder / "truth.csv"),
    )
    raster, rng, new = rasterize(plan), np.random.default_rng(at), 2.5
    localizer = Localizer(raster, rng=at)
    localizer.observe(case.scan())
    moves = list(odometry.moves())
    for move in moves[:at]:
        localizer.move(move)
    assert localizer.estimate.is_localized
    localizer.restart(3.0)
    turned = new - math.remainder(truth_drift(odometry, truth), 2 * math.pi)
    world = make_world(plan, WorldNoise(), rng)
    localizer.observe(take_scan(world, truth.position_m[at - 1], new, ScannerNoise(), rng).scan)
    away_m, known_after_m, walked_m = [], None, 0.0
    for k, move in enumerate(moves[at:], at):
        dx, dy = rotate(np.array([move.dx_m, move.dy_m]), -turned)
        found = localizer.move(move._replace(time_s=move.time_s + 3.0, dx_m=dx, dy_m=dy))
        walked_m += move.length_m
        if found.is_localized:
            away_m.append(float(np.linalg.norm(found.position_m - truth.position_m[k])))
            known_after_m = known_after_m or walked_m
        if walked_m > 40 or len(away_m) > 20:
            break
    assert known_after_m < 35
    assert max(away_m) < 2.0


def truth_drift(odometry, truth):
    """The angle from the walk's frame to the map, over the whole walk."""
    ours, theirs = (each.position_m[-1] - each.position_m[0] for each in (odometry, truth))
    return math.atan2(theirs[1], theirs[0]) - math.atan2(ours[1], ours[0])
