"""FloorPlan, Scan, Odometry, Settings, keys: checked at the door."""

import dataclasses
import math

import numpy as np
import pytest

from palms.errors import InputError, PalmsWarning, SettingsError
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.odometry import Move, Odometry
from palms.randomness import as_key
from palms.scan import Scan
from palms.settings import METHODS, MotionSettings, Settings
from tests.worlds import L_ROOM, closed


def test_a_plan_without_classes_is_all_wall():
    plan = FloorPlan(L_ROOM)
    assert set(plan.classes) == {SegmentClass.WALL}
    assert len(plan.blocking_m) == len(L_ROOM)


@pytest.mark.parametrize(
    ("segments", "words"),
    [
        (np.empty((0, 2, 2)), "at least one wall"),
        ([[[0, 0], [0, 0]]], "at least one wall with a length"),
        (L_ROOM * 1000, "millimetres"),
        (L_ROOM * 1e9, "at most 5000 m wide"),
        (L_ROOM * 1e-3, "at least 1 m wide"),
        (np.full((1, 2, 2), np.nan), "finite"),
    ],
)
def test_impossible_plans_are_refused_and_say_their_size(segments, words):
    with pytest.raises(InputError, match=words):
        FloorPlan(segments, name="annex")


def test_a_plan_in_millimetres_says_how_large_it_seems():
    with pytest.raises(InputError, match=r"got 7000 x 5000.*multiply by 0.001"):
        FloorPlan(L_ROOM * 1000)


def test_a_plan_of_doors_only_has_no_wall():
    with pytest.raises(InputError, match="at least one wall"):
        FloorPlan(L_ROOM, classes=np.full(6, SegmentClass.DOOR))


def test_classes_must_be_as_many_as_segments_and_known():
    with pytest.raises(InputError, match="6 classes"):
        FloorPlan(L_ROOM, classes=[0, 1])
    with pytest.raises(InputError, match="classes 0 to 3"):
        FloorPlan(L_ROOM, classes=[0, 1, 2, 3, 4, 0])


def test_the_smallest_room_that_holds_a_point_names_it():
    hall = Room("Hall", [[0, 0], [9, 0], [9, 9], [0, 9]])
    booth = Room("Booth", [[1, 1], [2, 1], [2, 2], [1, 2]])
    plan = FloorPlan(L_ROOM, rooms=(hall, booth))
    assert plan.room_at([1.5, 1.5]) == "Booth"
    assert plan.room_at([5.0, 5.0]) == "Hall"
    assert plan.room_at([50.0, 5.0]) is None


def test_a_room_needs_three_corners():
    with pytest.raises(InputError, match="at least 3 points"):
        Room("Line", [[0, 0], [1, 1]])


def test_values_cannot_be_changed():
    plan, scan = FloorPlan(L_ROOM), Scan(L_ROOM)
    walk = Odometry([1, 2], [[0, 0], [1, 0]])
    for value, field in ((plan, "segments_m"), (scan, "walls_m"), (walk, "position_m")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(value, field, None)
        with pytest.raises(ValueError, match="read-only"):
            getattr(value, field)[0] = 0


def test_a_wall_longer_than_any_is_refused():
    with pytest.raises(InputError, match="at most 100 m, got one of 2000 m"):
        Scan([[[2, -1000], [2, 1000]]])


def test_scans_without_walls_or_beyond_their_range_are_refused():
    with pytest.raises(InputError, match="at least one vertical wall"):
        Scan(np.empty((0, 2, 2)))
    with pytest.raises(InputError, match=r"within 10 m .* nearest at 100 m"):
        Scan([[[100, 0], [100, 5]]])
    with pytest.warns(PalmsWarning, match="1 of 2 walls lie beyond"):
        assert len(Scan([[[100, 0], [100, 5]], [[2, 0], [2, 1]]]).walls_m) == 1


def test_scans_are_seen_from_their_position():
    scan = Scan([[[3, 1], [3, 2]]], position_m=(1, 1))
    assert scan.relative_m.tolist() == [[[2, 0], [2, 1]]]


def test_coverage_may_be_unknown_but_not_negative():
    assert np.isnan(Scan(L_ROOM, coverage_m=[1.0, np.nan]).coverage_m).tolist() == [False, True]
    with pytest.raises(InputError, match="coverage"):
        Scan(L_ROOM, coverage_m=[-1.0])


@pytest.mark.parametrize(
    ("time", "position", "words"),
    [
        ([1.0], [[0, 0]], "at least 2 samples"),
        ([1.0, 2.0, 3.0], [[0, 0], [1, 1]], "3 positions"),
        ([1.0, 0.5], [[0, 0], [1, 1]], r"times that increase, got 0\.5 s at sample 1, after 1 s"),
        ([-1.0, 0.5], [[0, 0], [1, 1]], "times that increase"),
        ([1.0, 2.0], [[0, 0], [900, 1]], "metres and seconds, got 900 m/s"),
        (
            [1, 2, 3, 4],
            [[0, 0], [1, 0], [2, 0], [9000, 0]],
            "at most 1000 m, got 8998 m at sample 3",
        ),
        ([1.0, np.nan], [[0, 0], [1, 1]], "finite"),
    ],
)
def test_impossible_walks_are_refused(time, position, words):
    with pytest.raises(InputError, match=words):
        Odometry(time, position)


def test_the_first_move_runs_from_the_origin():
    walk = Odometry([12.5, 13.0], [[0.5, 0.0], [0.5, 1.0]], facing_rad=[0.1, 0.2])
    assert list(walk.moves()) == [Move(12.5, 0.5, 0.0, 0.1), Move(13.0, 0.0, 1.0, 0.2)]
    assert walk.walked_m.tolist() == [0.5, 1.5]


def test_every_method_has_its_preset():
    for name in METHODS:
        assert Settings.for_method(name).method == name
    with pytest.raises(SettingsError, match="one of palms, paper, authors"):
        Settings.for_method("magic")


def test_the_papers_numbers():
    paper = Settings.paper()
    assert paper.start.n_particles == 2000
    assert paper.candidates.quantile == 0.99
    assert paper.template.empty_weight == 1
    assert (paper.convergence.label_share, paper.convergence.cluster_share) == (0.8, 0.5)
    assert paper.convergence.recluster_steps == 20
    assert paper.motion.hit_weight == 0


def test_settings_out_of_range_are_refused():
    with pytest.raises(SettingsError, match=r"motion.step_m: expected above 0 m, got 0"):
        MotionSettings(step_m=0)
    with pytest.raises(SettingsError, match=r"n_particles"):
        Settings().with_particles(0)


@pytest.mark.parametrize("rng", [-1, 1.5, "0", None, True])
def test_what_is_no_seed_is_refused(rng):
    with pytest.raises(SettingsError, match="rng"):
        as_key(rng)


def test_keys_come_from_seeds_generators_and_keys():
    assert as_key(5) == as_key(np.int64(5)) == as_key(as_key(5))
    assert as_key(np.random.default_rng(1)) == as_key(np.random.default_rng(1))
    assert 0 <= as_key(3).uniform() < 1


def test_no_setting_is_nan():
    for method in METHODS:
        for group in dataclasses.asdict(Settings.for_method(method)).values():
            for value in group.values() if isinstance(group, dict) else ():
                assert not (isinstance(value, float) and math.isnan(value))


def test_closed_polygons_close():
    assert closed([[0, 0], [1, 0], [0, 1]])[-1].tolist() == [[0, 1], [0, 0]]
