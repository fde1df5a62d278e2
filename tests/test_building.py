"""Several levels: laid out side by side, decided by scan, walk and hints."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from palms.building import Building, Stairs
from palms.errors import InputError
from palms.floorplan import FloorPlan, Room
from palms.hints import Hint
from palms.levels import climbed, level_shares
from palms.localizer import Happening, Localizer, locate, track, track_trials
from palms.odometry import Move
from palms.particles import Particles
from palms.randomness import as_key
from palms.raster import rasterize
from palms.settings import LevelSettings, Settings
from tests.worlds import seen_from, two_rooms, walk

STAIRS = Room("Stairs A", [[9.0, 7.5], [11.0, 7.5], [11.0, 11.5], [9.0, 11.5]])
GROUND = replace(two_rooms(), level="0", rooms=(STAIRS, Room("Hall", [[0, 0], [7, 0], [7, 4]])))
UPPER = replace(  # the same walls, mirrored
    GROUND, segments_m=GROUND.segments_m * [-1, 1] + [20, 0], level="1",
    rooms=(STAIRS, Room("Office 11", [[0, 0], [7, 0], [7, 4]])),
)  # fmt: skip
HOUSE = Building((GROUND, UPPER))
OURS = Settings().with_particles(6000)
START, DRIFT = np.array([5.0, 3.9]), 0.7
STEPS = [*[(0.5, 0.0)] * 4, *[(-0.5, 0.0)] * 7, *[(0.0, 0.6)] * 4, *[(0.6, 0.0)] * 20]


def scan_on(plan, point=START):
    near = np.linalg.norm(plan.segments_m.mean(axis=1) - point, axis=1) < 4.5
    return seen_from(point, plan.segments_m[near], DRIFT)


def test_rooms_called_stairs_join_levels_where_they_lie_above_each_other():
    assert [stairs.name for stairs in HOUSE.stairs] == ["Stairs A"]
    apart = replace(UPPER, rooms=(Room("Stairs B", [[0, 0], [1, 0], [1, 1]]),))
    assert Building((GROUND, apart)).stairs == ()
    assert Building((GROUND, apart), (Stairs("Lift", STAIRS.polygon_m),)).stairs[0].name == "Lift"


@pytest.mark.parametrize(
    "levels", [(), (GROUND, GROUND), (GROUND, replace(UPPER, level=None))], ids=str
)
def test_levels_need_names_of_their_own(levels):
    with pytest.raises(InputError, match="level"):
        Building(levels)


def test_a_level_that_is_not_there_is_named():
    with pytest.raises(InputError, match=r"one of the building's \(0, 1\), got '2'"):
        HOUSE.level("2")


@pytest.mark.parametrize("n", [1, 2, 3, 7])
def test_places_go_to_their_sheet_and_back(n):
    building = Building([replace(GROUND, level=str(k)) for k in range(n)])
    atlas, rng = building.atlas, np.random.default_rng(n)
    place = rng.uniform([-1, -1], [21, 13], (500, 2))
    level = rng.integers(0, n, 500)
    on_sheet = place + atlas.shift_m[level]
    assert (atlas.level_of(on_sheet) == level).all()
    assert atlas.folded(on_sheet) == pytest.approx(place)
    other = rng.integers(0, n, 500)
    moved = atlas.on_level(on_sheet, other)
    assert (atlas.level_of(moved) == other).all()
    assert atlas.folded(moved) == pytest.approx(place)
    assert len(atlas.plan.segments_m) == n * len(GROUND.segments_m)


def test_sheets_lie_farther_apart_than_scans_see():
    low = [HOUSE.atlas.shift_m[k] + plan.bounds_m[0] for k, plan in enumerate(HOUSE.levels)]
    high = [HOUSE.atlas.shift_m[k] + plan.bounds_m[1] for k, plan in enumerate(HOUSE.levels)]
    assert max((low[1] - high[0]).max(), (low[0] - high[1]).max()) > 20


@pytest.mark.parametrize("n", [2, 3, 7])
def test_what_lies_between_sheets_is_not_inside(n):
    building = Building([replace(GROUND, level=str(k)) for k in range(n)])
    raster, one = building.atlas.raster(OURS.raster), rasterize(GROUND)
    cells = raster.grid.position_of(np.argwhere(raster.inside))
    level = building.atlas.level_of(cells)
    assert np.bincount(level) == pytest.approx([one.inside.sum()] * n, rel=0.02)
    low, high = GROUND.bounds_m
    folded = building.atlas.folded(cells)
    assert (folded > low - 0.4).all()
    assert (folded < high + 0.4).all()


def test_the_outline_of_a_level_is_that_of_its_sheet():
    corner = [[0, 0], [8, 0], [8, 12], [0, 12]]
    part = replace(UPPER, outline_m=corner)
    raster = Building((GROUND, part)).atlas.raster(OURS.raster)
    whole = Building((GROUND, UPPER)).atlas.raster(OURS.raster)
    assert raster.inside.sum() / whole.inside.sum() == pytest.approx((20 + 8) / 40, rel=0.05)


def test_one_level_is_as_if_there_were_no_building():
    alone = Building((GROUND,))
    steps = walk(STEPS, DRIFT)
    one = track(GROUND, scan_on(GROUND), steps, OURS)
    two = track(alone, scan_on(GROUND), steps, OURS)
    assert np.array_equal(one.position_m, two.position_m)
    assert two.estimates[-1].level is None


@pytest.mark.parametrize("plan", HOUSE.levels, ids=lambda plan: plan.level)
def test_a_scan_and_a_walk_decide_the_level(plan):
    mirrored = plan is UPPER
    start = np.array([20 - START[0], START[1]]) if mirrored else START
    steps = [(-x, y) for x, y in STEPS] if mirrored else STEPS
    found = track(HOUSE, scan_on(plan, start), walk(steps, DRIFT), OURS, rng=1)
    last = found.estimates[-1]
    truth = start + np.sum(steps, axis=0)
    assert last.is_localized
    assert last.level == plan.level
    assert last.p_level > 0.95
    assert np.linalg.norm(last.position_m - truth) < 1.0
    assert {h.level for h in last.hypotheses} <= set(HOUSE.names)


def test_only_those_on_stairs_climb_and_as_fast_as_it_is_said():
    n, atlas = 20_000, HOUSE.atlas
    place = np.random.default_rng(0).uniform([0, 0], [20, 12], (n, 2))
    crowd = Particles(place, np.zeros(n), np.ones(n), np.zeros(n), np.full(n, 1 / n))
    settings = LevelSettings(climb_per_s=0.2, reach_m=0.0)
    after = climbed(crowd, atlas, 2.0, settings, as_key(3))
    went = atlas.level_of(after.position_m) == 1
    there = atlas.on_stairs(place)
    assert not went[~there].any()
    assert went[there].mean() == pytest.approx(1 - np.exp(-0.4), abs=0.04)
    assert atlas.folded(after.position_m) == pytest.approx(place)
    assert climbed(crowd, atlas, 0.0, settings, as_key(3)) is crowd


def test_climbing_does_not_depend_on_how_often_it_is_asked():
    n, atlas = 20_000, Building([replace(GROUND, level=str(k)) for k in range(2)]).atlas
    place = np.random.default_rng(0).uniform([9.5, 8], [11.5, 11], (n, 2))
    crowd = Particles(place, np.zeros(n), np.ones(n), np.zeros(n), np.full(n, 1 / n))
    once = climbed(crowd, atlas, 1.0, LevelSettings(), as_key(0))
    often = crowd
    for k in range(10):
        often = climbed(often, atlas, 0.1, LevelSettings(), as_key(k + 1))
    assert level_shares(once, atlas)[1] == pytest.approx(level_shares(often, atlas)[1], abs=0.02)


def test_somebody_who_takes_the_stairs_is_followed():
    """Into the stairs on the ground floor, out of them on the upper one, and along it."""
    localizer = Localizer(HOUSE, OURS, rng=2)
    localizer.observe(scan_on(GROUND))
    to_stairs = [*STEPS[:15], *[(0.6, 0.0)] * 10, *[(0.0, 0.6)] * 5]
    moves = list(walk(to_stairs, DRIFT).moves())
    for move in moves:
        localizer.move(move)
    assert localizer.estimate.level == "0"
    before = level_shares(localizer.belief.particles, HOUSE.atlas)[1]
    assert 0.02 < before < 0.8
    estimate = localizer.hint(Hint(level="1", probability=0.95))
    assert estimate.level == "1"
    assert level_shares(localizer.belief.particles, HOUSE.atlas)[1] > 0.8


def test_who_was_told_the_level_does_not_climb_again_before_leaving_the_stairs():
    localizer = Localizer(HOUSE, OURS, rng=2)
    localizer.observe(scan_on(GROUND))
    to_stairs = [*STEPS[:15], *[(0.6, 0.0)] * 10, *[(0.0, 0.6)] * 5]
    for move in walk(to_stairs, DRIFT).moves():
        localizer.move(move)
    told = localizer.hint(Hint(level="1", probability=0.99))
    for k in range(20):  # waiting on the landing
        waiting = localizer.move(Move(told.time_s + k + 1.0, 0.0, 0.0))
    assert waiting.level == "1"
    assert waiting.p_level == pytest.approx(told.p_level, abs=0.02)


def test_hints_of_levels_rooms_and_places():
    scan = scan_on(GROUND, np.array([16.0, 9.5]))
    for hint, level in [
        (Hint(level="1", probability=0.99), "1"),
        (Hint(place_m=(16.0, 9.5), radius_m=3.0, level="0", probability=0.99), "0"),
    ]:
        localizer = Localizer(HOUSE, OURS, rng=3)
        localizer.hint(hint)
        assert localizer.observe(scan).level == level
    with pytest.raises(InputError, match="one of the building's"):
        Localizer(HOUSE, OURS).hint(Hint(level="9"))
    with pytest.raises(InputError, match="the plan's level"):
        Localizer(GROUND, OURS).hint(Hint(level="9"))
    with pytest.raises(InputError, match="a place, a room or a level"):
        Hint()


def test_what_happens_on_the_way_counts_after_the_move_that_ends_then():
    steps = walk(STEPS, DRIFT)
    first, at = scan_on(GROUND), steps.position_m[11]
    later = scan_on(GROUND, START + np.sum(STEPS[:12], axis=0))
    later = replace(later, walls_m=later.walls_m + at, position_m=at)
    told = [Happening(-1.0, first), Happening(float(steps.time_s[11]), later)]
    one = track(HOUSE, told, steps, OURS, rng=1)
    two = track(HOUSE, first, steps, OURS, rng=1)
    same = [a.p_within_1m == b.p_within_1m for a, b in zip(one, two, strict=True)]
    assert all(same[:11])
    assert not same[11]
    assert one.estimates[11].p_within_1m > two.estimates[11].p_within_1m
    (three,) = track_trials(HOUSE, told, steps, OURS, [1])
    assert np.array_equal(one.position_m, three.position_m)


def test_the_papers_method_takes_the_first_scan_alone():
    steps = walk(STEPS, DRIFT)
    told = [Happening(-1.0, scan_on(GROUND)), Happening(3.0, scan_on(GROUND, START + 1))]
    paper = Settings.paper().with_particles(500)
    one, two = (track(GROUND, scan, steps, paper) for scan in (told, told[0].what))
    assert np.array_equal(one.position_m, two.position_m)


def test_what_a_scan_says_of_a_building_lies_on_its_atlas():
    point = np.array([20 - START[0], START[1]])
    found = locate(HOUSE, scan_on(UPPER, point))
    off = np.linalg.norm(found.position_m - HOUSE.atlas.shift_m[1] - point, axis=1)
    assert np.exp(found.log_weight)[off < 0.5].sum() > 0.5


def test_a_plan_without_a_level_has_no_hint_of_one():
    with pytest.raises(InputError, match="it has no name"):
        Localizer(FloorPlan(GROUND.segments_m), OURS).hint(Hint(level="1"))


@pytest.mark.parametrize("within_m", [0.0, 0.3, 1.3])
def test_who_is_on_stairs_is_told_to_the_millimetre(within_m):
    stairs = (
        Stairs("round", [[5 + np.cos(a), 4 + np.sin(a)] for a in np.arange(0, 6.2, 0.2)]),
        Stairs("at the border", [[19, 0], [22, 0], [22, 3], [19, 2]]),
        Stairs("nowhere near", [[9e6, 0], [9e6 + 1, 0], [9e6, 3]]),
    )
    plans = tuple(replace(two_rooms(), level=name) for name in "123")
    atlas = Building(plans, stairs).atlas
    rng = np.random.default_rng(0)
    here = rng.uniform([-4, -4], [26, 16], (6000, 2))
    level = rng.integers(0, 3, len(here))
    areas = shapely.union_all([shapely.Polygon(each.polygon_m) for each in stairs])
    on_atlas = here + atlas.shift_m[level]
    x, y = atlas.folded(on_atlas).T
    slow = shapely.contains_xy(areas.buffer(within_m), x, y)
    assert (atlas.on_stairs(on_atlas, within_m) == slow).all()
    assert 0.005 < slow.mean() < 0.2


def test_stairs_without_area_are_no_stairs():
    line = Stairs("a line", [[1, 1], [2, 2], [3, 3]])
    plans = tuple(replace(two_rooms(), level=name) for name in "12")
    assert not Building(plans, (line,)).atlas.on_stairs(np.array([[1.5, 1.5], [9.0, 9.0]])).any()


def test_far_from_all_sheets_there_is_a_level_all_the_same():
    plans = tuple(replace(two_rooms(), level=name) for name in "1234")
    far = 1e5 * np.array([[-1.0, -1], [-1, 1], [1, -1], [1, 1]])
    assert Building(plans).atlas.level_of(far).tolist() == [0, 3, 0, 3]
