"""The mall benchmark on its data, and its figures on a walk made up; skipped without the data."""

import json
import math
import os
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from palms import Settings
from palms.evaluation.answers import Answers
from palms.geometry import rotate

ROOT = Path(__file__).resolve().parents[2]
DATA = Path(os.environ.get("PALMS_DATA") or ROOT / ".." / "shared" / "data")
MALL = DATA / "mall"

needs_data = pytest.mark.skipif(
    not MALL.is_dir(), reason=f"the mall's floors are not in {MALL} (set PALMS_DATA)"
)


@pytest.fixture(scope="module")
def bench():
    sys.path.insert(0, str(ROOT))
    try:
        from benchmarks.mall import cases, run, table, walks

        yield {"cases": cases, "run": run, "table": table, "walks": walks}
    finally:
        sys.path.remove(str(ROOT))


@pytest.fixture
def corner(bench):
    """10 m east, 10 m north in the map; the heading's frame is turned by 0.3 rad from it."""
    way = np.concatenate([np.tile([1.0, 0.0], (10, 1)), np.tile([0.0, 1.0], (10, 1))])
    return bench["walks"].Walk(
        "F2", "a", np.arange(1.0, 21.0), rotate(way, -0.3),
        np.array([0.0, 10.0, 19.5]), np.array([[5.0, 5.0], [15.0, 5.0], [15.0, 14.5]]),
    )  # fmt: skip


def test_the_frame_of_a_walk_comes_from_its_first_legs(corner):
    assert corner.drift_rad == pytest.approx(0.3)
    bent = corner.step_m.copy()
    bent[10:] = rotate(bent[10:], 0.5)
    far = replace(corner, waypoint_m=5.0 + 2 * (corner.waypoint_m - 5.0), step_m=2 * bent)
    assert far.drift_rad == pytest.approx(0.3)  # the first leg alone is 20 m


def test_the_reference_joins_the_waypoints_in_time(corner):
    reference = corner.reference_m
    np.testing.assert_allclose(reference[[0, 9, 10]], [[6, 5], [15, 5], [15, 6]])
    assert np.isnan(reference[19]).all()
    assert not np.isnan(reference[:19]).any()


def test_errors_at_waypoints_count_while_localized(bench, corner):
    t_s = corner.step_s
    stage = ["searching"] * 15 + ["localized"] * 5
    answers = Answers(t_s, np.tile([15.0, 11.5], (20, 1)), stage)
    assert bench["cases"].waypoint_errors(answers, corner) == [None, pytest.approx(3.0)]


def test_figures_at_waypoints_pool_the_waypoints(bench):
    trials = [
        {"scene": "mall", "walk": walk, "waypoint_error_m": errors}
        for walk, errors in (("a", [None, 1.0, 1.5]), ("b", [4.0]))
    ]
    localized, near = bench["table"].waypoint_shares(trials)
    assert (localized.value, near.value) == (0.75, pytest.approx(2 / 3))
    assert (near.n, near.units) == (3, 2)
    assert bench["table"].waypoint_median(trials).value == 1.5


@needs_data
def test_walks_that_cross_walls_are_as_many_as_is_known(bench):
    recorded, cases = bench["walks"].read_walks(), bench["cases"]
    assert [len(recorded[floor]) for floor in bench["walks"].FLOORS] == [21, 34, 32]
    case = cases.load_case("F2", 0)  # the scans of the others have no part in it
    assert sum(replace(case, walk=walk).crosses for walk in recorded["F2"]) == 10


@needs_data
def test_a_case_shares_its_frame_or_not(bench):
    shared, own = (bench["cases"].load_case("F4", 1, frame) for frame in ("scan", "own"))
    assert (shared.odometry.frame, own.odometry.frame) == ("scan", "own")
    np.testing.assert_array_equal(shared.odometry.position_m, own.odometry.position_m)
    assert len(shared.scan.walls_m) >= 3
    ends = rotate(shared.scan.walls_m, shared.walk.drift_rad) + shared.walk.waypoint_m[0]
    middle = ends.mean(axis=1)
    from palms.geometry import distance_to_segments

    off = [distance_to_segments(m, shared.raster.plan.segments_m).min() for m in middle]
    assert np.median(off) < 0.3


@needs_data
def test_a_trial_and_its_table(bench):
    def follow():
        case = bench["cases"].load_case("F2", 3)
        return list(bench["cases"].run_trials(case, "paper", [0, 1]))

    rows = follow()
    assert rows == follow()
    assert json.loads(json.dumps(rows, allow_nan=False)) == rows
    for row in rows:
        assert all(math.isfinite(v) for v in row.values() if isinstance(v, float))
        assert 30 < row["length_m"] < 140
        assert row["waypoint_error_m"]
    assert "| paper | 1 |" in bench["table"].markdown(rows, "one walk")


@needs_data
def test_methods_without_a_scan_run_in_one_frame_only(bench):
    plan = bench["run"].Plan(("paper", "uniform"), ("F2",), seeds=1, walks=1)
    assert [task[2:4] for task in plan.tasks()] == [
        ("scan", "paper"), ("scan", "uniform"), ("own", "paper"),
    ]  # fmt: skip
    assert bench["run"].as_json(plan)["settings"]["benchmark"] == "mall"


@needs_data
def test_results_do_not_depend_on_the_number_of_processes(bench):
    plan = bench["run"].Plan(("paper", "uniform"), ("F4",), ("scan",), seeds=1, walks=2)
    assert list(bench["run"].run(plan, 1)) == list(bench["run"].run(plan, 2))


@needs_data
def test_a_scan_that_sees_no_wall_is_a_walk_that_never_declares(bench):
    cases = bench["cases"]
    blind = replace(cases.load_case("F3", 0), scan=None)
    (row,) = cases.run_trials(blind, "paper", [0])
    assert (row["declared"], row["scan_walls"], row["useful"]) == (False, 0, 0.0)
    assert Settings.for_method("paper").start.source == "scan"
