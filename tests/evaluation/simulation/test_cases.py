import json
from dataclasses import replace

import numpy as np
import pytest
import shapely

from palms.errors import SettingsError
from palms.evaluation.simulation import (
    CaseSettings,
    Count,
    NuisanceRanges,
    Stretch,
    generate_levels,
    is_sensible,
    make_site,
    simulate_site,
    simulate_start,
    simulate_walk,
    write_simulated,
)
from palms.evaluation.simulation.settings import StartSettings
from palms.geometry import distance_to_segments, rotate
from palms.io import open_dataset
from palms.io.events import read_events

FULL = CaseSettings(
    length_m=90.0, second_scan_m=30.0, jump_m=60.0, hint="room", stops=True, rooms=True
)


@pytest.fixture(scope="module")
def site():
    return make_site(generate_levels("office", 1001, 1), 1001)


@pytest.fixture(scope="module")
def cases(site):
    return list(simulate_site(site, Count(2, 2), FULL))


@pytest.fixture(scope="module")
def tower():
    return make_site(generate_levels("office", 3, 2), 3)


def test_cases_do_not_depend_on_the_order_of_making_them(site, cases):
    first = simulate_start(site, 0, [], FULL)
    second = simulate_start(site, 1, [first], FULL)
    again = simulate_walk(site, second, 1, FULL)
    assert again.name == "start-2-walk-2"
    for a, b in ((again, cases[3]),):
        np.testing.assert_array_equal(a.recorded.arkit.position_m, b.recorded.arkit.position_m)
        np.testing.assert_array_equal(a.scans[1].walls_m, b.scans[1].walls_m)
        assert a.events == b.events
        assert a.nuisances == b.nuisances


def test_walks_of_a_start_share_its_scan_and_differ(cases):
    a, b, c, _ = cases
    np.testing.assert_array_equal(a.scans[0].walls_m, b.scans[0].walls_m)
    assert a.recorded.session == b.recorded.session != c.recorded.session
    assert np.linalg.norm(a.labels[0].position_m - c.labels[0].position_m) > 4.9
    assert a.nuisances.vio_scale_sd != b.nuisances.vio_scale_sd
    assert a.nuisances.normal_sd_m == b.nuisances.normal_sd_m != c.nuisances.normal_sd_m
    assert a.nuisances.thickness_m == c.nuisances.thickness_m


def test_users_scan_where_there_is_something_to_see(site):
    settings, starts = CaseSettings(), []
    for s in range(5):
        starts.append(simulate_start(site, s, starts, settings))
    assert all(is_sensible(start.taken.scan, StartSettings()) for start in starts)
    where = np.array([start.taken.position_m for start in starts])
    apart = np.linalg.norm(where[:, None] - where[None], axis=2) + 99 * np.eye(5)
    assert apart.min() >= 4.9


def test_both_scans_lie_on_the_walls_where_they_say(site, cases):
    world = site.stretch.apply(site.places[0].world.seen_m)
    for case in cases:
        for scan, label in zip(case.scans, case.labels, strict=True):
            ends = rotate(scan.relative_m, label.drift_rad) + label.position_m
            away = [distance_to_segments(p, world).min() for p in ends.mean(axis=1)]
            assert np.median(away) < 0.25


def test_the_second_scan_shares_the_frame_of_the_walk(cases):
    for case in cases:
        first, second = case.scans
        walk, truth = case.recorded.arkit, case.recorded.truth
        at = int(np.abs(walk.time_s - second.time_s).argmin())
        assert second.time_s == pytest.approx(walk.time_s[at], abs=1e-3)
        np.testing.assert_allclose(second.position_m, walk.position_m[at], atol=1e-3)
        np.testing.assert_allclose(case.labels[1].position_m, truth.position_m[at], atol=2e-3)
        assert walk.walked_m[at] == pytest.approx(30.0, abs=4.0)
        assert not first.time_s


def test_events_are_told_in_order(cases):
    for case in cases:
        assert [event.kind for event in case.events].count("jump") == 1
        assert {event.kind for event in case.events} == {"scan", "jump", "hint"}
        times = [event.time_s for event in case.events]
        assert times == sorted(times)


def test_hints_are_right_or_wrong(site):
    start = simulate_start(site, 0, [], CaseSettings())
    for hint in ("room", "place"):
        for right in (True, False):
            settings = CaseSettings(length_m=60.0, hint=hint, hint_is_right=right)
            case = simulate_walk(site, start, 0, settings)
            (event,) = case.events
            truth = case.recorded.truth
            here = truth.position_m[np.abs(truth.time_s - event.time_s).argmin()]
            if event.room is not None:
                assert (site.drawings[0].room_at(here) == event.room) is right
            else:
                away = np.linalg.norm(here - event.position_m)
                assert bool(away <= event.radius_m) is right
            assert event.is_right is right


def test_the_data_set_can_be_read(site, cases, tmp_path):
    for case in cases:
        write_simulated(tmp_path, site, case)
    found = open_dataset(tmp_path)
    assert [case.name for case in found.cases] == [case.name for case in cases]
    read, made = found.cases[0], cases[0]
    assert len(read.plan().rooms) == len(site.drawings[0].rooms)
    walk = read.walk()
    assert walk.sources == ("arkit", "ronin")
    np.testing.assert_allclose(walk.arkit.facing_rad, made.recorded.arkit.facing_rad)
    np.testing.assert_allclose(walk.reference_m, made.recorded.truth.position_m)
    assert len(read.scans()) == 2
    assert read.scans()[0].coverage_m.shape == (360,)
    assert read.label(1).drift_rad == pytest.approx(made.labels[1].drift_rad)
    events = read_events(read.folder / "events.json")
    assert events == made.events
    (scan,) = (event for event in events if event.kind == "scan")
    assert (read.folder / scan.session / "scan.json").is_file()
    told = json.loads((read.folder / "nuisances.json").read_text())
    assert told["nuisances"] == made.nuisances.to_json()
    assert (read.folder / "picture.png").read_bytes().startswith(b"\x89PNG")


def test_the_truth_lies_in_the_frame_of_the_drawing(site):
    start = simulate_start(site, 0, [], CaseSettings())
    settings = CaseSettings(length_m=40.0)
    plain = simulate_walk(replace(site, stretch=Stretch()), start, 0, settings)
    wide = Stretch((0.0, 0.0), [[1.1, 0.0], [0.0, 1.0]])
    wider = simulate_walk(replace(site, stretch=wide), start, 0, settings)
    np.testing.assert_allclose(
        wider.recorded.truth.position_m, plain.recorded.truth.position_m * [1.1, 1.0], atol=2e-3
    )
    np.testing.assert_array_equal(wider.recorded.arkit.position_m, plain.recorded.arkit.position_m)


def test_doubling_a_nuisance_changes_its_part_alone(site):
    settings = CaseSettings(length_m=30.0)
    ranges = NuisanceRanges().double("vio_scale_sd")
    start = simulate_start(site, 0, [], settings, ranges)
    plain, doubled = (simulate_walk(site, start, 0, settings, r) for r in (None, ranges))
    np.testing.assert_array_equal(
        plain.recorded.truth.position_m, doubled.recorded.truth.position_m
    )
    np.testing.assert_array_equal(
        plain.recorded.ronin.position_m, doubled.recorded.ronin.position_m
    )
    assert doubled.nuisances.vio_scale_sd == pytest.approx(2 * plain.nuisances.vio_scale_sd)


def test_half_a_turn_sees_half(site):
    whole, half = (
        simulate_start(site, 0, [], CaseSettings(scan_turn_rad=turn)).taken.scan
        for turn in (2 * np.pi, np.pi)
    )
    assert np.isfinite(whole.coverage_m).mean() == 1.0
    assert 0.6 < np.isfinite(half.coverage_m).mean() < 0.72


@pytest.mark.parametrize(("kind", "sources"), [("vio", ("arkit",)), ("inertial", ("ronin",))])
def test_one_odometry_alone(site, kind, sources):
    start = simulate_start(site, 0, [], CaseSettings())
    settings = CaseSettings(length_m=30.0, odometry=kind, rate_hz=5.0)
    recorded = simulate_walk(site, start, 0, settings).recorded
    assert recorded.sources == sources
    np.testing.assert_allclose(np.diff(recorded.time_s), 0.2, atol=2e-3)


def test_walks_go_up_by_stairs_or_lift(tower):
    settings = CaseSettings(length_m=120.0)
    start = simulate_start(tower, 0, [], settings)
    names = [plan.level for plan in tower.drawings]
    for w in range(3):
        case = simulate_walk(tower, start, w, settings)
        truth = case.recorded.truth
        assert list(dict.fromkeys(truth.level)) == names
        (event,) = case.events
        assert (event.kind, event.level) == ("level", names[1])
        at = truth.level.index(names[1])
        stairs = [tower.stretch.apply(s.position_m) for s in tower.building.stairs]
        away = min(np.linalg.norm(truth.position_m[at] - s) for s in stairs)
        assert away < 5.0
        moves = np.linalg.norm(np.diff(truth.position_m, axis=0), axis=1)
        assert moves.max() < 2.5
        for k, place in enumerate(tower.places):
            here = np.array(truth.level) == names[k]
            path = shapely.LineString(truth.position_m[here])
            walls = shapely.linestrings(tower.stretch.apply(place.world.blocking_m))
            assert shapely.distance(path, walls).min() > 0.15


def test_levels_are_drawn_as_plans_of_their_own(tower, tmp_path):
    (case,) = simulate_site(tower, Count(1, 1), CaseSettings(length_m=60.0))
    write_simulated(tmp_path, tower, case)
    names = sorted(path.name for path in (tmp_path / "maps").glob("*.csv"))
    assert names == [f"{drawing.name}.csv" for drawing in reversed(tower.drawings)]
    assert len(open_dataset(tmp_path)) == 1


@pytest.mark.parametrize(
    "wrong",
    [
        {"length_m": 1.0}, {"rate_hz": 0.0}, {"jump_m": 500.0}, {"scan_turn_rad": 0.0},
        {"second_scan_m": 20.0, "odometry": "inertial"},
    ],
)  # fmt: skip
def test_settings_out_of_range_are_refused(wrong):
    with pytest.raises(SettingsError, match=f"CaseSettings.{next(iter(wrong))}"):
        CaseSettings(**wrong)


def test_a_jump_may_have_a_size_and_a_hint_a_time(site):
    settings = CaseSettings(length_m=40.0, jump_m=20.0, jump_size_m=12.0, hint="place", hint_m=5.0)
    case = simulate_walk(site, simulate_start(site, 0, [], settings), 0, settings)
    hint, jump = sorted(case.events, key=lambda event: event.kind)
    assert np.hypot(*jump.shift_m) == pytest.approx(12.0, abs=0.01)
    assert jump.turn_rad == 0
    assert hint.time_s < jump.time_s
    before = case.recorded.arkit.walked_m[np.searchsorted(case.recorded.time_s, hint.time_s)]
    assert before == pytest.approx(5.0, abs=1.0)
