"""One walk in all formats: the files of tools/make_walk_files.py give the same track."""

from __future__ import annotations

import gzip
import shutil
import sys
import warnings
import zipfile
from pathlib import Path

import numpy as np
import pytest

from palms.geometry import rotate
from palms.io import ODOMETRY, choose_format, read_tracking, read_walk
from palms.sample import sample_folder

ROOT = Path(__file__).resolve().parents[2]
DATA = Path(__file__).parent / "data" / "walks"
POSES = (
    "tum-z.tum", "tum-y.txt", "arkit-3x4-ns.txt", "arkit-3x4-columns.txt", "arkit-4x4-columns.csv",
    "arkit-transform.json", "arcore-ns.csv", "arcore-ms.jsonl", "stray-odometry.csv",
)  # fmt: skip
FORMATS = {
    **dict.fromkeys(POSES, "poses"), "tum-z.tum": "tum", "tum-y.txt": "tum", "steps.csv": "steps",
    "ronin.npy": "ronin", "android.txt": "android", "sensor-logger-ios.zip": "sensor-logger",
    "sensor-logger-android.zip": "sensor-logger",
}  # fmt: skip
TURN_RAD = 0.7


@pytest.fixture(scope="module")
def truth():
    return read_tracking(sample_folder() / "trajectories" / "sample" / "walk-1").odometry()


def read(name: str, **options):
    """The only odometry of a file; warnings are failures."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        walk = read_walk(DATA / name, **options)
    (source,) = walk.sources
    return walk.odometry(source)


def test_each_file_has_its_format():
    assert {file.name for file in DATA.iterdir()} == set(FORMATS)
    for name, kind in FORMATS.items():
        assert choose_format(ODOMETRY, DATA / name).name == kind


@pytest.mark.parametrize("name", POSES)
def test_pose_formats_give_the_same_track(name, truth):
    walk = read(name)
    count = len(walk)
    assert count == 80
    np.testing.assert_allclose(walk.time_s, truth.time_s[:count], atol=1e-3)
    np.testing.assert_allclose(walk.position_m, truth.position_m[:count], atol=0.01)
    assert walk.start_m.tolist() == [0.0, 0.0]
    assert (walk.frame, walk.source) == ("scan", "vio")
    moves = np.diff(truth.position_m[: count + 1], axis=0)[:-1]
    np.testing.assert_allclose(
        np.cos(walk.facing_rad[:-1] - np.arctan2(moves[:, 1], moves[:, 0])), 1, atol=1e-3
    )


def test_poses_on_the_data_set_s_ground_are_a_quarter_turn_off(truth):
    walk = read("arkit-3x4-ns.txt", ground="-z,-x")
    np.testing.assert_allclose(
        walk.position_m, rotate(truth.position_m[:80], -np.pi / 2), atol=0.01
    )
    usual = read("arkit-3x4-ns.txt")
    turn = walk.facing_rad - usual.facing_rad
    np.testing.assert_allclose(np.sin(turn), -1, atol=1e-9)


def test_ronin_gives_the_track_in_its_own_frame(truth):
    walk = read("ronin.npy", rate_hz=50, every_s=0)
    assert (walk.frame, walk.source) == ("own", "inertial")
    at = np.searchsorted(walk.time_s, truth.time_s[:79] - 1e-9)
    expected = rotate(truth.position_m[:79], TURN_RAD)
    assert np.abs(walk.position_m[at] - expected).max() < 0.04  # samples lie 2 cm apart
    recorded = read_walk(DATA / "ronin.npy", rate_hz="50")
    np.testing.assert_allclose(recorded.start_m, [0.0, 0.0], atol=1e-6)
    assert recorded.has_reference.all()


def test_steps_give_the_track_in_their_own_frame(truth):
    walk = read("steps.csv")
    expected = rotate(truth.position_m[1:51] - truth.position_m[0], TURN_RAD)
    np.testing.assert_allclose(walk.position_m, expected, atol=0.01)
    assert (walk.frame, walk.source) == ("own", "inertial")


def fitted_error_m(walk, truth) -> tuple[float, float]:
    """Largest distance of the walk's steps from the true ones, rotation fitted; and the length.

    The recording begins two seconds before the first sample of the truth.
    """
    time = truth.time_s[:51] - truth.time_s[0] + 2.0
    true = truth.position_m[:51] - truth.position_m[0]
    path = np.concatenate([[[0.0, 0.0]], walk.position_m])
    when = np.concatenate([[0.0], walk.time_s])
    found = np.column_stack([np.interp(time, when, path[:, k]) for k in (0, 1)])
    cross = (found[:, 0] * true[:, 1] - found[:, 1] * true[:, 0]).sum()
    turned = rotate(found, float(np.arctan2(cross, (found * true).sum())))
    length = np.linalg.norm(np.diff(true, axis=0), axis=1).sum()
    return float(np.linalg.norm(turned - true, axis=1).max()), float(length)


@pytest.mark.parametrize("name", ["sensor-logger-android.zip", "sensor-logger-ios.zip"])
@pytest.mark.parametrize("heading", ["gyro", "attitude"])
def test_sensors_give_the_track_by_dead_reckoning(name, heading, truth):
    walk = read(name, heading=heading)
    assert (walk.frame, walk.source, walk.facing_rad) == ("own", "inertial", None)
    off, length = fitted_error_m(walk, truth)
    assert off < 0.04 * length
    assert 49 <= len(walk) <= 52


@pytest.mark.filterwarnings("ignore:.*cannot be read and are left out")
def test_an_android_log_gives_the_track_and_its_reference(truth):
    recorded = read_walk(DATA / "android.txt")
    off, length = fitted_error_m(recorded.odometry("ronin"), truth)
    assert off < 0.04 * length
    np.testing.assert_allclose(recorded.start_m, truth.position_m[0] + [100, 50], atol=1e-3)
    (known,) = np.nonzero(recorded.has_reference)
    assert len(known) == 5
    np.testing.assert_allclose(
        recorded.reference_m[known], truth.position_m[10:51:10] + [100, 50], atol=1e-3
    )
    assert recorded.building_id == "Sample 2"


def test_an_unpacked_recording_is_the_same(tmp_path):
    with zipfile.ZipFile(DATA / "sensor-logger-ios.zip") as archive:
        archive.extractall(tmp_path / "recording")
    np.testing.assert_array_equal(
        read(tmp_path / "recording").position_m, read("sensor-logger-ios.zip").position_m
    )


@pytest.mark.parametrize("name", ["tum-z.tum", "arkit-3x4-ns.txt", "arcore-ns.csv", "steps.csv"])
def test_packed_by_gzip_it_is_the_same(name, tmp_path):
    packed = tmp_path / f"{name}.gz"
    packed.write_bytes(gzip.compress((DATA / name).read_bytes()))
    np.testing.assert_array_equal(read(packed).position_m, read(name).position_m)


def test_the_files_are_those_of_the_tool(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT))
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    import make_walk_files

    make_walk_files.write(tmp_path)
    sys.modules.pop("make_walk_files")
    text = [name for name in FORMATS if not name.startswith(("android", "sensor", "ronin"))]
    for name in text:  # the others hold rounded sines, which machines round in their own way
        assert (tmp_path / name).read_text() == (DATA / name).read_text(), name
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(FORMATS)
    shutil.rmtree(tmp_path)
