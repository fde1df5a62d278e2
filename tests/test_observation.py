import dataclasses

import numpy as np
import pytest

from palms.floorplan import FloorPlan, SegmentClass
from palms.geometry import rotate, wrap_angle
from palms.observation import log_likelihood, scan_points, search
from palms.orientation import likely_drifts
from palms.raster import rasterize
from palms.scan import Scan
from palms.settings import ObservationSettings
from tests.worlds import closed, seen_from, two_rooms

PLAN = two_rooms()
RASTER = rasterize(PLAN)
POINT = np.array([5.0, 3.9])
NEAR = PLAN.segments_m[np.linalg.norm(PLAN.segments_m.mean(axis=1) - POINT, axis=1) < 4.5]
OURS = ObservationSettings()


def best(found):
    at = int(found.score.argmax())
    return found.position_m[at], found.drift_rad[at]


@pytest.mark.parametrize("drift", [0.0, 0.7, -2.3, np.pi])
def test_the_best_cell_is_the_place_of_the_scan(drift):
    position, found = best(search(seen_from(POINT, NEAR, drift), RASTER))
    assert np.linalg.norm(position - POINT) < 0.25
    assert wrap_angle(found - drift) == pytest.approx(0, abs=OURS.drift_step_rad)


def test_shares_sum_to_one():
    found = search(seen_from(POINT, NEAR, 0.35), RASTER)
    assert np.exp(found.log_weight).sum() == pytest.approx(1)


def test_any_angle_of_the_plan_is_found():
    """A hexagon with a stub: no two of its walls meet at a right angle."""
    corners = [[4 * np.cos(a), 3 * np.sin(a) + 0.2 * a] for a in np.arange(6) * np.pi / 3]
    walls = np.concatenate([closed(corners), [[[1.0, 0.5], [2.0, 1.7]]]])
    plan = FloorPlan(walls)
    scan = seen_from([-0.5, 0.3], walls, 1.234)
    position, drift = best(search(scan, rasterize(plan)))
    assert np.linalg.norm(position - [-0.5, 0.3]) < 0.3
    assert wrap_angle(drift - 1.234) == pytest.approx(0, abs=OURS.drift_step_rad)


def test_turning_plan_and_scan_together_turns_the_answer():
    scan, angle = seen_from(POINT, NEAR, 0.2), 0.5
    turned = rasterize(FloorPlan(rotate(PLAN.segments_m, angle)))
    position, drift = best(search(scan, turned))
    assert np.linalg.norm(position - rotate(POINT, angle)) < 0.3
    assert wrap_angle(drift - 0.2 - angle) == pytest.approx(0, abs=OURS.drift_step_rad)


def test_the_search_agrees_with_judging_each_pose():
    """Where walls err by the metre and not as wholes, and none is missing: the rough model."""
    scan = seen_from(POINT, NEAR, 0.35)
    settings = dataclasses.replace(
        OURS, cell_size_m=0.1, wall_sd_m=OURS.search_sd_m, unexplained_share=OURS.search_share,
        empty_nats_per_m=OURS.search_empty_nats_per_m, missing_share=1e-9, unplanned_share=1e-9,
        offset_sd_m=1e-3, far_offset_share=0.0,
    )  # fmt: skip
    found, points = search(scan, RASTER, settings), scan_points(scan, settings)
    some = np.random.default_rng(0).choice(len(found), 5000)
    position, drift = found.position_m[some], found.drift_rad[some]
    one = log_likelihood(points, RASTER, position, drift, settings)
    assert np.corrcoef(one, found.score[some])[0, 1] > 0.98


def said_of(walls, settings=OURS, at=POINT):
    """What the scan at POINT says of `at` in a plan of other walls."""
    points = scan_points(seen_from(POINT, NEAR, 0.0), settings)
    place = np.asarray(at, float)[None]
    return float(log_likelihood(points, rasterize(FloorPlan(walls)), place, [0.0], settings)[0])


def test_a_wall_drawn_off_is_one_error_however_long_it_is():
    """Twice as long a wall, off by as much, loses no more for being off."""
    losses = []
    for length in (2.0, 4.0):
        seen = scan_points(Scan([[[2.0, -length / 2], [2.0, length / 2]]]))
        here, off = (
            log_likelihood(
                seen, rasterize(FloorPlan([[[x, -5.0], [x, 5.0]], [[-4, -5], [-4, 5]]])),
                np.zeros((1, 2)), np.zeros(1),
            )[0]
            for x in (2.0, 2.25)
        )  # fmt: skip
        losses.append(here - off)
    assert 0.5 < losses[0] < 5.0
    assert losses[1] == pytest.approx(losses[0], abs=1.0)


def test_a_wall_that_does_not_stand_costs_no_more_than_its_share():
    across = [[[4.2, 3.6], [5.8, 3.6]]]
    lost = said_of(PLAN.segments_m) - said_of(np.concatenate([PLAN.segments_m, across]))
    assert 1.0 < lost <= -np.log(OURS.missing_share) + 1e-6
    rarer = dataclasses.replace(OURS, missing_share=1e-3)
    more = said_of(PLAN.segments_m, rarer) - said_of(
        np.concatenate([PLAN.segments_m, across]), rarer
    )
    assert more > lost + 1.0


def test_a_seen_wall_that_the_plan_lacks_costs_nothing():
    alone = scan_points(Scan([[[2.0, -1.0], [2.0, 1.0]]]))
    nowhere = log_likelihood(alone, RASTER, np.array([[-50.0, -50.0]]), np.zeros(1))
    assert nowhere[0] == pytest.approx(0.0, abs=1e-9)


def test_points_say_the_same_however_dense_they_are():
    scan = seen_from(POINT, NEAR, 0.0)
    rng = np.random.default_rng(1)
    position = POINT + rng.normal(0, 0.3, (300, 2))
    drift = rng.normal(0, 0.05, 300)
    said = [
        log_likelihood(scan_points(scan, s), RASTER, position, drift, s)
        for s in (OURS, dataclasses.replace(OURS, spacing_m=0.05))
    ]
    assert np.abs(said[0] - said[1]).mean() < 0.04 * np.abs(said[0]).mean()


def test_a_wall_in_proven_empty_space_speaks_against_a_place():
    scan = seen_from(POINT, NEAR, 0.0)
    across = FloorPlan(np.concatenate([PLAN.segments_m, [[[4.2, 3.6], [5.8, 3.6]]]]))
    points, here, straight = scan_points(scan), POINT[None], np.zeros(1)
    without = log_likelihood(points, RASTER, here, straight)
    assert log_likelihood(points, rasterize(across), here, straight) < without - 1


def test_doors_may_be_open_or_shut():
    hall = closed([[0, 0], [6, 0], [6, 4], [0, 4]])
    seen = seen_from([3.0, 2.0], hall)
    door = [[[2.0, 1.0], [4.0, 1.0]]]  # between the phone and a wall that it saw
    says = {}
    for kind in (SegmentClass.WALL, SegmentClass.DOOR):
        classes = [SegmentClass.WALL] * 4 + [kind]
        raster = rasterize(FloorPlan(np.concatenate([hall, door]), classes))
        says[kind] = log_likelihood(scan_points(seen), raster, [[3.0, 2.0]], [0.0])[0]
    assert says[SegmentClass.DOOR] > says[SegmentClass.WALL] + 2


def test_only_what_was_looked_at_counts_as_empty():
    wall = [[[2.0, -2.0], [2.0, 2.0]]]
    everywhere = scan_points(Scan(wall))
    assert (everywhere.empty_m[:, 0] > 0.0).mean() > 0.95
    ahead = np.full(360, np.nan)
    ahead[:10] = 5.0
    known = scan_points(Scan(wall, coverage_m=np.where(np.arange(360) < 180, 1.0, np.nan)))
    assert np.linalg.norm(known.empty_m[known.empty_m[:, 1] > 0.2], axis=1).max() < 1.0


def test_likely_drifts_leave_out_what_no_wall_allows():
    drifts = likely_drifts(
        seen_from(POINT, NEAR, 0.3).walls_m, PLAN.segments_m, OURS.drift_step_rad, OURS.drift_share
    )
    off = np.abs(wrap_angle(4 * (drifts - 0.3))) / 4
    assert len(drifts) < 40
    assert off.max() < np.radians(16)
    assert off.min() < OURS.drift_step_rad / 2 + 1e-9


def test_large_buildings_are_searched_with_larger_cells():
    small = dataclasses.replace(OURS, max_cells=2000)
    found = search(seen_from(POINT, NEAR, 0.0), RASTER, small)
    assert found.grid.size <= 2000
    assert np.linalg.norm(best(found)[0] - POINT) < found.grid.cell_size_m
