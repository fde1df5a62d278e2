"""Dead reckoning on the mall's raw logs, and real pose logs; skipped without the data."""

import gzip
import os
import sys
from pathlib import Path

import numpy as np
import pytest

from palms.io import read_walk

ROOT = Path(__file__).resolve().parents[2]
DATA = Path(os.environ.get("PALMS_DATA") or ROOT / ".." / "shared" / "data")
MALL, ARKIT = DATA / "mall", DATA / "arkit_log" / "ARKit_camera_pose.txt.gz"

needs_mall = pytest.mark.skipif(
    not MALL.is_dir(), reason=f"the mall's logs are not in {MALL} (set PALMS_DATA)"
)


@pytest.fixture(scope="module")
def bench():
    sys.path.insert(0, str(ROOT))
    try:
        from benchmarks.inertial import measure, table

        yield {"measure": measure, "table": table}
    finally:
        sys.path.remove(str(ROOT))


@pytest.fixture(scope="module")
def rows(bench):
    return [row for log in bench["measure"].read_logs() for row in bench["measure"].measure(log)]


def of(rows, method, name):
    return np.array([row[name] for row in rows if row["method"] == method])


@needs_mall
def test_walks_end_where_they_should(rows):
    found = of(rows, "pendulum, gyro", "end_error")
    assert len(found) == 18
    assert np.median(found) < 0.04
    others = [row for row in rows if row["floor"] != "F2"]
    assert np.median(of(others, "pendulum, gyro", "end_error")) < 0.04
    assert found.max() < 0.15


@needs_mall
def test_the_measure_gives_the_known_figure_of_the_known_steps(rows):
    assert np.median(of(rows, "steps.csv, gyro", "end_error")) == pytest.approx(0.061, abs=0.0005)


@needs_mall
def test_steps_are_those_that_are_known(rows):
    known, both, new = (
        of(rows, "pendulum, gyro", name).sum()
        for name in ("steps_known", "steps_both", "steps_new")
    )
    assert both > 0.995 * known
    assert new < 0.015 * known


@needs_mall
def test_held_phones_raise_no_doubt(recwarn):
    for path in sorted(MALL.glob("F*/walks/*.txt.gz")):
        walk = read_walk(path)
        assert walk.has_reference.sum() >= 11
        assert walk.building_id.endswith(path.parts[-3])
    assert not recwarn.list


@needs_mall
def test_the_table_has_a_line_for_each_method(bench, rows):
    text = bench["table"].markdown(rows)
    for name in (*bench["measure"].METHODS, *bench["measure"].DETECTED):
        assert f"| {name} | 18 |" in text
    assert "Steps: of 2920" in text


def test_a_walk_is_measured_by_its_waypoints(bench):
    """10 m east, 10 m north, turned, and the last leg a tenth too long."""
    walks = __import__("benchmarks.mall.walks", fromlist=["Walk"])
    way = np.concatenate([np.tile([1.0, 0.0], (10, 1)), np.tile([0.0, 1.0], (10, 1))])
    known = walks.Walk(
        "F2", "a", np.arange(1.0, 21.0), way,
        np.array([0.0, 10.0, 20.0]), np.array([[5.0, 5.0], [15.0, 5.0], [15.0, 15.0]]),
    )  # fmt: skip
    long = np.cumsum(np.concatenate([way[:10], 1.1 * way[10:]]), axis=0)
    turned = long @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    figures = bench["measure"].against_waypoints(np.arange(1.0, 21.0), turned, known)
    assert figures["distance_m"] == 20.0
    assert figures["length_ratio"] == pytest.approx(1.05)
    assert 0.03 < figures["end_error"] < 0.05
    steps = bench["measure"].step_figures(np.arange(1.1, 22.1), known)
    assert steps == {"steps_found": 19, "steps_known": 20, "steps_both": 19, "steps_new": 0}


@pytest.mark.skipif(not ARKIT.is_file(), reason=f"no {ARKIT}; set PALMS_DATA to the public data")
def test_a_real_log_of_arkit():
    walk = read_walk(ARKIT).odometry()
    assert walk.time_s[-1] == pytest.approx(46.0, abs=0.1)
    whole = read_walk(ARKIT, every_s=0).odometry()
    lines = gzip.decompress(ARKIT.read_bytes()).decode().splitlines()[1:]
    assert len(whole) == len(lines) - 1
    table = np.array([line.split() for line in lines], dtype=float)
    np.testing.assert_allclose(whole.position_m, table[1:, [4, 12]] * [1, -1])
    looks = -table[1:, [3, 11]] * [1, -1]
    np.testing.assert_allclose(
        np.cos(whole.facing_rad - np.arctan2(looks[:, 1], looks[:, 0])), 1, atol=1e-6
    )
    assert walk.facing_rad[0] == pytest.approx(np.pi / 2, abs=0.2)  # sessions begin along -z
    assert whole.walked_m[-1] == pytest.approx(walk.walked_m[-1], rel=0.15)
