"""What must hold of matching for any plan, scan and frame."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.floorplan import FloorPlan
from palms.geometry import rotate, wrap_angle
from palms.heatmap import find_candidates, match, scan_drifts
from palms.raster import rasterize
from palms.scan import Scan
from palms.settings import Settings
from tests.worlds import closed, two_rooms

CELL = 0.1
POINT = np.array([5.03, 3.87])
quick = settings(derandomize=True, deadline=None, max_examples=40)


def near(plan, point=POINT):
    return plan.segments_m[np.linalg.norm(plan.segments_m.mean(axis=1) - point, axis=1) < 4.5]


@st.composite
def rooms(draw):
    """A room seen whole from within: a star-shaped polygon of 4 to 9 walls, and the point."""
    n = draw(st.integers(4, 9))
    seed = draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    step = rng.uniform(0.7, 1.3, n)
    angle = np.cumsum(step) / step.sum() * 2 * np.pi
    radius = rng.uniform(1.5, 4.5, n)
    corners = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return closed(corners + rng.uniform(-30, 30, 2)), rng.uniform(-np.pi, np.pi), seed


@quick
@given(rooms())
def test_a_noiseless_scan_peaks_within_half_a_cell_diagonal_of_the_truth(room):
    walls, drift, seed = room
    centre = walls[:, 0].mean(axis=0)
    rng = np.random.default_rng(seed)
    point = centre + rng.uniform(-0.3, 0.3, 2)
    scan = Scan(rotate(walls - point, -drift))
    maps = match(scan, rasterize(FloorPlan(walls)), [drift])
    peak = maps.grid.position_of(maps.best_cell(0))
    assert np.linalg.norm(peak - point) <= CELL * np.sqrt(0.5) + 1e-9


@quick
@given(st.integers(-200, 200), st.integers(-200, 200))
def test_shifting_the_plan_shifts_the_heatmaps(columns, rows):
    plan = two_rooms()
    by = np.array([columns, rows]) * CELL
    scan = Scan(near(plan) - POINT)
    here = match(scan, rasterize(plan), [0.3])
    there = match(scan, rasterize(FloorPlan(plan.segments_m + by)), [0.3])
    assert there.grid.origin_m - by == pytest.approx(here.grid.origin_m)
    assert there.scores(0) == pytest.approx(here.scores(0), abs=2e-3)


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_turning_the_plan_turns_the_heatmap(quarters):
    plan, turn = two_rooms(), quarters * np.pi / 2
    scan = Scan(near(plan) - POINT)
    turned = FloorPlan(rotate(plan.segments_m, turn))
    here = match(scan, rasterize(plan), [0.0]).scores(0)
    there = match(scan, rasterize(turned), [turn]).scores(0)
    assert np.rot90(here, -quarters) == pytest.approx(there, abs=5e-3)  # rows grow upwards


@quick
@given(st.floats(-np.pi, np.pi))
def test_turning_the_plan_by_any_angle_turns_its_peak_and_its_drifts(turn):
    plan = two_rooms()
    scan = Scan(near(plan) - POINT)
    straight = match(scan, rasterize(plan), [0.0])
    peak_there = straight.grid.position_of(straight.best_cell(0))
    raster = rasterize(FloorPlan(rotate(plan.segments_m, turn)))
    drifts = scan_drifts(scan, raster)
    k = int(np.abs(wrap_angle(drifts - turn)).argmin())
    assert wrap_angle(drifts[k] - turn) == pytest.approx(0, abs=1e-6)
    maps = match(scan, raster, drifts)
    peak = maps.grid.position_of(maps.best_cell(k))
    assert np.linalg.norm(peak - rotate(peak_there, turn)) <= 2 * CELL * np.sqrt(0.5)
    assert maps.scores(k).max() == max(m.max() for m in maps)


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_turning_the_scan_by_a_quarter_permutes_the_labels(quarters):
    plan = two_rooms()
    raster = rasterize(plan)
    scan = Scan(rotate(near(plan) - POINT, 0.2))
    turned = Scan(rotate(scan.walls_m, quarters * np.pi / 2))
    here = match(scan, raster, scan_drifts(scan, raster))
    there = match(turned, raster, scan_drifts(turned, raster))
    for k in range(4):
        drift = wrap_angle(here.drifts_rad[k] - quarters * np.pi / 2)
        other = int(np.abs(wrap_angle(there.drifts_rad - drift)).argmin())
        assert there.scores(other) == pytest.approx(here.scores(k), abs=1e-3)


@quick
@given(st.floats(-50, 50), st.floats(-50, 50))
def test_moving_the_scans_frame_changes_nothing(x, y):
    plan, by = two_rooms(), np.array([x, y])
    raster = rasterize(plan)
    scan = Scan(near(plan) - POINT)
    moved = Scan(scan.walls_m + by, position_m=by)
    here = match(scan, raster, scan_drifts(scan, raster))
    there = match(moved, raster, scan_drifts(moved, raster))
    assert there.drifts_rad == pytest.approx(here.drifts_rad, abs=1e-9)
    assert there.scores(2) == pytest.approx(here.scores(2), abs=1e-3)


def test_many_drifts_need_no_more_memory_than_a_few():
    """Candidates of 72 drifts are found while one map is alive at a time."""
    plan = two_rooms()
    raster = rasterize(plan)
    drifts = np.arange(72) * 2 * np.pi / 72
    maps = match(Scan(near(plan) - POINT), raster, drifts)
    alive = []

    class Counted(type(maps)):
        def scores(self, k):
            scores = super().scores(k)
            alive.append(scores.nbytes)
            return scores

    counted = Counted(maps.raster, maps.scan, maps.drifts_rad, maps.settings)
    found = find_candidates(counted)
    assert len(alive) == 72
    assert len(found) == pytest.approx(0.01 * 72 * raster.grid.size, rel=0.01)
    everything = np.stack(list(maps))
    assert found.score.min() == np.sort(everything.ravel())[-len(found)]


def test_settings_are_not_shared_between_methods():
    paper = Settings.paper()
    assert dataclasses.replace(paper, method="mine") != paper
    assert Settings.paper() == paper
