from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.errors import InputError
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geometry import lengths
from palms.repair import close_gaps, crop, find_problems, free_space, merge, snap

SQUARE = [[[0, 0], [8, 0]], [[8, 0], [8, 6]], [[8, 6], [0, 6]], [[0, 6], [0, 0]]]
DIVIDED = [*SQUARE, [[4, 0], [4, 6]]]


def words(plan):
    return " | ".join(find_problems(plan))


def test_a_good_plan_has_no_problem():
    plan = FloorPlan(
        [*SQUARE, [[4, 0], [4, 2]], [[4, 2], [4, 3]], [[4, 3], [4, 6]]], [0, 0, 0, 0, 0, 1, 0]
    )
    assert find_problems(plan) == []
    assert free_space(plan).area_m2 == pytest.approx(48, rel=0.1)


def test_what_cannot_be_reached_is_measured():
    plan = FloorPlan(DIVIDED)
    space = free_space(plan)
    assert space.pockets == 1
    assert space.unreachable_m2 == pytest.approx(24, rel=0.1)
    assert "no doors" in words(plan)
    assert "no way leads to" in words(plan)


def test_overlaps_gaps_and_units_are_seen():
    assert "overlap along 8.0 m" in words(FloorPlan([*SQUARE, SQUARE[0]]))
    gap = [SQUARE[0], [[8, 0.2], [8, 6]], *SQUARE[2:]]
    assert "1 gap of up to 0.20 m" in words(FloorPlan(gap))
    assert "check the unit" in words(FloorPlan(np.array(SQUARE) * 200.0))


def test_snap_joins_ends_and_says_so():
    plan, text = snap(FloorPlan([[[0, 0], [8, 0]], [[8, 0.02], [8, 6]]]), 0.05)
    assert plan.segments_m[0, 1].tolist() == plan.segments_m[1, 0].tolist() == [8, 0.01]
    assert text == "snap: 2 ends moved by up to 0.010 m"


def test_merge_keeps_classes_apart_and_gaps_open():
    segments = [[[0, 0], [3, 0]], [[2, 0.01], [5, 0]], [[6, 0], [8, 0]], [[2, 0], [4, 0]]]
    plan, text = merge(FloorPlan(segments, [0, 0, 0, 1]))
    walls = plan.of_class(SegmentClass.WALL)
    assert np.sort(lengths(walls)) == pytest.approx([2, 5], abs=1e-3)
    assert len(plan.of_class(SegmentClass.DOOR)) == 1
    assert text == "merge: 4 segments became 3"


def test_gaps_are_closed_between_loose_ends_only():
    walls = [[[0, 0], [3, 0]], [[3.4, 0], [8, 0]], [[3, 0], [3, 4]]]
    assert len(close_gaps(FloorPlan(walls), 0.5)[0].segments_m) == 3  # 3, 0 is a corner
    plan, text = close_gaps(FloorPlan(walls[:2]), 0.5)
    assert plan.segments_m[-1].tolist() in ([[3, 0], [3.4, 0]], [[3.4, 0], [3, 0]])
    assert text == "close-gaps: 1 closed, 0.40 m of wall added"
    doors = FloorPlan([*walls[:2], [[3, 0], [3.4, 0]]], [0, 0, 1])
    assert len(close_gaps(doors, 0.5)[0].segments_m) == 3


def test_crop_keeps_what_lies_inside():
    rooms = (Room("left", [[0, 0], [4, 0], [4, 6]]), Room("right", [[4, 0], [8, 0], [8, 6]]))
    plan, text = crop(FloorPlan(DIVIDED, rooms=rooms), (0, -1, 5, 7))
    assert plan.bounds_m[1].tolist() == [5, 6]
    assert [room.name for room in plan.rooms] == ["left"]
    assert text == "crop: 1 of 5 segments left out"
    with pytest.raises(InputError, match="walls in it"):
        crop(plan, (20, 20, 30, 30))


@pytest.mark.parametrize("repair", [snap, close_gaps])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_distances_are_checked(repair, value):
    with pytest.raises(InputError, match="metres above 0"):
        repair(FloorPlan(SQUARE), value)


@settings(derandomize=True, deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1), st.integers(1, 30))
def test_merging_covers_the_same_ground_and_is_done_once(seed, count):
    rng = np.random.default_rng(seed)
    x = np.sort(rng.uniform(0, 40, (count, 2)), axis=1)
    y = rng.integers(0, 3, count).astype(float)
    segments = np.stack([np.column_stack([x[:, 0], y]), np.column_stack([x[:, 1], y])], axis=1)
    plan, _ = merge(FloorPlan(np.concatenate([segments, [[[0, 9], [5, 9]]]])))
    for level in range(3):
        for at in rng.uniform(0, 40, 20):
            before = ((y == level) & (x[:, 0] <= at) & (at <= x[:, 1])).any()
            on = plan.segments_m[np.abs(plan.segments_m[:, 0, 1] - level) < 0.1][..., 0]
            after = ((on.min(axis=1) <= at) & (at <= on.max(axis=1))).any()
            near = (np.abs(x[y == level] - at) < 0.03).any()
            assert before == after or near
    assert len(merge(plan)[0].segments_m) == len(plan.segments_m)
