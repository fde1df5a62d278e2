from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from palms.errors import FormatError, InputError, OutputError, PalmsWarning
from palms.floorplan import FloorPlan
from palms.io import read_scan
from palms.io.dataset import check_same_session, open_dataset
from palms.io.dataset_output import write_case, write_plan
from palms.io.label import Label
from palms.io.walk import RecordedWalk
from palms.odometry import Odometry
from palms.scan import Scan

DEPTH = Path(__file__).parent / "data" / "scans" / "depth"
PLAN = FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]], name="E2")
SCAN = Scan([[[2, -2.5], [2, 0.5]]])


def walk(session: tuple[str, ...] = ()) -> RecordedWalk:
    x = np.arange(1.0, 5.0)
    odometry = Odometry(x, np.column_stack([x, 0 * x]), session=session)
    return RecordedWalk(arkit=odometry, session=session)


@pytest.fixture
def root(tmp_path):
    folder = tmp_path / "set"
    write_plan(folder, PLAN)
    later = Scan([[[4, -1], [4, 3]]], position_m=(3, 0), time_s=3.0, session="17")
    first = Scan(SCAN.walls_m, session="17")
    write_case(folder, "E2", "w1", walk(("17",)), [first, later], [Label((1, 2), 0.5), None])
    write_case(folder, "E2", "w2", walk(), [SCAN])
    return folder


def test_what_was_written_is_found(root):
    found = open_dataset(root)
    assert [case.title for case in found.cases] == ["E2/w1", "E2/w2"]
    assert found.scenes == ("E2",)
    first, second = found.cases
    assert first.plan().name == "E2"
    assert first.walk().session == ("17",)
    assert [scan.time_s for scan in first.scans()] == [0, 3]
    assert first.scan().session == "17"
    assert first.label().position_m.tolist() == [1, 2]
    assert first.label(1) is None
    assert second.label() is None
    for scan in first.scans():
        check_same_session(scan, first.walk())
    assert second.scan().session == "1"  # the folder's name


def test_the_layout_is_the_data_sets(root):
    files = sorted(
        os.path.relpath(os.path.join(at, name), root)
        for at, _, names in os.walk(root)
        for name in names
    )
    assert files == [
        "maps/E2.csv",
        "trajectories/E2/w1/Session_17/detectedPlanes.json",
        "trajectories/E2/w1/Session_17/label.txt",
        "trajectories/E2/w1/Session_17_scan2/detectedPlanes.json",
        "trajectories/E2/w1/Session_17_scan2/scan.json",
        "trajectories/E2/w1/w1.json",
        "trajectories/E2/w2/Session_1/detectedPlanes.json",
        "trajectories/E2/w2/w2.json",
    ]


def test_scans_are_in_order_of_time_not_of_name(tmp_path):
    write_plan(tmp_path, PLAN)
    late = Scan(SCAN.walls_m, time_s=9.0, session="1")
    early = Scan(SCAN.walls_m, time_s=2.0, session="2")
    write_case(tmp_path, "E2", "w", walk(), [late, early])
    assert [scan.time_s for scan in open_dataset(tmp_path).cases[0].scans()] == [2, 9]


def test_unknown_files_are_left_alone(root):
    (root / "README.md").write_text("hello")
    (root / "maps" / "photo.png").write_bytes(b"\x89PNG")
    (root / "trajectories" / "notes.txt").write_text("hello")
    (root / "trajectories" / ".DS_Store").write_bytes(b"\x00")
    (root / "trajectories" / "E2" / "notes.txt").write_text("hello")
    (root / "trajectories" / "E2" / "empty").mkdir()
    (root / "trajectories" / "E2" / "w1" / "events.json").write_text("[]")
    (root / "trajectories" / "E2" / "w1" / "Session_other").mkdir()
    assert len(open_dataset(root)) == 2


def test_reading_is_lazy(root):
    (root / "maps" / "E2.csv").write_text("rubbish")
    case = open_dataset(root).cases[0]
    with pytest.raises(FormatError):
        case.plan()


def test_a_walk_without_scan(root, says):
    shutil.rmtree(root / "trajectories" / "E2" / "w2" / "Session_1")
    case = open_dataset(root).cases[1]
    assert case.scans() == ()
    assert case.label() is None
    with pytest.raises(InputError) as caught:
        case.scan()
    says(caught.value, "Session_")


def test_sessions_with_depth_alone_are_scans(root):
    session = root / "trajectories" / "E2" / "w2" / "Session_1"
    (session / "detectedPlanes.json").unlink()
    shutil.copytree(DEPTH, session, dirs_exist_ok=True)
    later = session.with_name("Session_2")
    shutil.copytree(DEPTH, later)
    (later / "scan.json").write_text('{"t_s": 3.5, "position_m": [0.25, 0]}')
    case = open_dataset(root).cases[1]
    assert [path.name for path in case.scan_paths] == ["Session_1", "Session_2"]
    first, second = case.scans()
    np.testing.assert_array_equal(first.walls_m, read_scan(DEPTH).walls_m)
    np.testing.assert_array_equal(case.scan().walls_m, first.walls_m)
    assert first.coverage_m is not None
    assert (first.session, first.time_s, second.session, second.time_s) == ("1", 0, "2", 3.5)
    assert second.position_m.tolist() == [0.25, 0]
    assert first.position_m.tolist() != [0.25, 0]


def test_scans_without_walk_are_named(root):
    (root / "trajectories" / "E2" / "w2" / "w2.json").unlink()
    with pytest.warns(PalmsWarning, match="w2: scans without a walk"):
        assert len(open_dataset(root)) == 1


@pytest.mark.parametrize("name", ["maps", "trajectories"])
def test_a_missing_folder_is_named(root, says, name):
    shutil.rmtree(root / name)
    with pytest.raises(InputError) as caught:
        open_dataset(root)
    says(caught.value, f"no {name}")


def test_no_folder(tmp_path, says):
    (tmp_path / "file").write_text("a")
    for path in (tmp_path / "none", tmp_path / "file"):
        with pytest.raises(InputError) as caught:
            open_dataset(path)
        says(caught.value, "no folder there")


def test_scene_without_plan(root, says):
    (root / "maps" / "E2.csv").rename(root / "maps" / "E3.csv")
    with pytest.raises(InputError) as caught:
        open_dataset(root)
    says(caught.value, "E2.csv", "got E3")


def test_plan_with_a_second_suffix(root):
    (root / "maps" / "E2.csv").rename(root / "maps" / "E2.geojson.csv")
    assert open_dataset(root).cases[0].plan().name == "E2"


def test_no_walks(root, says):
    shutil.rmtree(root / "trajectories" / "E2")
    with pytest.raises(InputError) as caught:
        open_dataset(root)
    says(caught.value, "no walk")


def test_a_case_is_not_overwritten(root, says):
    with pytest.raises(OutputError) as caught:
        write_case(root, "E2", "w1", walk(), [SCAN])
    says(caught.value, "w1")


def test_a_case_that_fails_leaves_nothing(tmp_path):
    shifted = RecordedWalk.of(Odometry([1, 2], [[5, 5], [6, 5]], start_m=[4, 5]))
    with pytest.raises(InputError):
        write_case(tmp_path, "E2", "w", shifted, [SCAN])
    assert os.listdir(tmp_path / "trajectories" / "E2") == []


@pytest.mark.parametrize("name", ["", ".", "..", "a/b", "../x", "a\x00b"])
def test_names_that_are_no_folders(tmp_path, says, name):
    with pytest.raises(InputError) as caught:
        write_case(tmp_path, "E2", name, walk(), [SCAN])
    says(caught.value)
    with pytest.raises(InputError):
        write_plan(tmp_path, FloorPlan(PLAN.segments_m, name=name))


def test_unwritable(unwritable, says):
    with pytest.raises(OutputError) as caught:
        write_plan(unwritable, PLAN)
    says(caught.value)
    with pytest.raises(OutputError) as caught:
        write_case(unwritable, "E2", "w", walk(), [SCAN])
    says(caught.value)


def test_same_session(says):
    scan = Scan(SCAN.walls_m, session="Session_17")
    check_same_session(scan, walk(("17",)))
    check_same_session(scan, walk(("Session_17", "x")))
    check_same_session(scan, walk())
    check_same_session(SCAN, walk(("18",)))
    with pytest.raises(InputError) as caught:
        check_same_session(scan, walk(("18",)).odometry())
    says(caught.value, "17", "18")


def test_a_frame_of_its_own_is_no_excuse(says):
    """The walk starts where the scan was taken, whatever its frame."""
    odometry = Odometry([1, 2], [[1, 0], [2, 0]], frame="own", source="inertial", session=("18",))
    with pytest.raises(InputError) as caught:
        check_same_session(Scan(SCAN.walls_m, session="17"), odometry)
    says(caught.value)
