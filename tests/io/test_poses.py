from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from palms.errors import FormatError, InputError, PalmsWarning
from palms.io import read_walk
from palms.io.pose_log import seconds
from palms.io.poses import read_poses
from palms.io.tum import read_tum, write_walk_tum
from palms.io.walk import RecordedWalk
from palms.odometry import Odometry

STRAIGHT = "".join(f"{0.5 * k} 0 1.4 {-0.6 * k:.2f} 0 0 0 1\n" for k in range(9))


@pytest.mark.parametrize(
    ("per_second", "hz"), [(1, 60), (1, 1), (1e3, 30), (1e3, 1), (1e6, 60), (1e9, 200), (1e9, 1)]
)
def test_units_of_time_are_found(per_second, hz):
    true = 5000 + np.arange(20) / hz
    found = seconds(true * per_second, "log.txt")
    np.testing.assert_allclose(found, true - 5000, atol=1e-5)


def test_a_unit_that_is_named_counts(put):
    slow = "".join(f"{2000 * k} 0 0 {-k} 0 0 0 1\n" for k in range(5))
    assert read_poses(put("a.txt", slow), time_unit="ms").time_s.tolist() == [2.0, 4.0, 6.0, 8.0]
    named = "time_ms,x,y,z\n" + "".join(f"{2000 * k},0,0,{-k}\n" for k in range(5))
    assert read_poses(put("a.csv", named)).time_s[-1] == 8.0


def test_poses_are_thinned_to_about_a_step(put):
    rows = "".join(f"{k / 60:.4f} 0 1.4 {-k / 60:.4f} 0 0 0 1\n" for k in range(601))
    path = put("a.txt", rows)
    time = read_poses(path).time_s
    assert np.diff(time[:-1]).min() >= 0.4 - 1e-4
    assert time[-1] == 10.0
    assert len(read_poses(path, every_s=0)) == 600
    assert len(read_poses(path, every_s="1")) == 10


@pytest.mark.parametrize("pitch_deg", [0, -60, 60])
def test_the_phone_faces_along_minus_z(put, pitch_deg):
    turn = Rotation.from_euler("YX", [30, pitch_deg], degrees=True).as_quat()
    cells = " ".join(f"{v:.8f}" for v in turn)
    rows = "".join(f"{k} {k} 0 0 {cells}\n" for k in range(5))
    facing = read_poses(put("a.txt", rows)).odometry().facing_rad
    np.testing.assert_allclose(facing, np.radians(90 + 30), atol=1e-6)


def test_looking_down_keeps_the_facing_before(put):
    down = Rotation.from_euler("x", -90, degrees=True).as_quat()
    turns = [[0, 0, 0, 1], [0, 0, 0, 1], down, down]
    rows = "".join(f"{k} {k} 0 0 {' '.join(map(str, q))}\n" for k, q in enumerate(turns))
    facing = read_poses(put("a.txt", rows)).odometry().facing_rad
    np.testing.assert_allclose(facing, np.pi / 2)
    rows = "".join(f"{k} {k} 0 0 {' '.join(map(str, down))}\n" for k in range(4))
    assert read_poses(put("a.txt", rows)).odometry().facing_rad is None


def test_a_log_that_begins_elsewhere_begins_there(put):
    far = "".join(f"{k} {k + 30} 0 -40 0 0 0 1\n" for k in range(4))
    with pytest.warns(PalmsWarning, match=r"begins 50.0 m from the origin"):
        walk = read_poses(put("a.txt", far)).odometry()
    assert walk.start_m.tolist() == [30.0, 40.0]
    assert walk.walked_m.tolist() == [1.0, 2.0, 3.0]
    own = read_poses(put("a.txt", far), frame="own").odometry()
    assert (own.frame, own.start_m.tolist(), own.position_m[-1].tolist()) == ("own", [0, 0], [3, 0])


def test_rotations_that_are_none_are_said(put):
    rows = STRAIGHT.replace(" 0 0 0 1\n", " 0 0 0 7\n")
    with pytest.warns(PalmsWarning, match="its rotations are none"):
        assert read_poses(put("a.txt", rows)).odometry().facing_rad is None


def test_objects_without_a_pose_are_left_out(put):
    objects = [{"timestamp": k, "position": [k, 0, 0]} for k in range(6)]
    objects[2] = {"timestamp": 2, "position": None}
    with pytest.warns(PalmsWarning, match="1 of 6 objects have no pose"):
        walk = read_poses(put("a.json", objects))
    assert walk.time_s.tolist() == [1, 3, 4, 5]
    with pytest.raises(FormatError, match="4 of 6 objects without"):
        read_poses(put("a.json", objects[:2] + [{}] * 4))


def test_columns_of_words_are_left_alone(put):
    rows = "".join(f"{k},normal,{k},0,0,not mapped yet\n" for k in range(4))
    walk = read_poses(put("a.csv", f"time,state,x,y,z,mapping\n{rows}"))
    assert walk.odometry().position_m.tolist() == [[1, 0], [2, 0], [3, 0]]
    words = rows.replace("2,normal,2", "2,normal,lost")
    with pytest.raises(FormatError, match="line 4"):
        read_poses(put("a.csv", f"time,state,x,y,z,mapping\n{words}"))
    with pytest.raises(FormatError, match="the columns time, x, z"):
        read_poses(put("a.csv", "time,state,x,y,z\n0,a,1,b,2\n1,a,2,b,3\n"))


def test_a_comment_may_name_the_columns(put):
    turn = Rotation.from_euler("y", 40, degrees=True).as_quat()
    rows = "".join(f"{k} {turn[3]} 0 {turn[1]} 0 {k} 1.4 0\n" for k in range(4))
    walk = read_poses(put("a.txt", f"# made\n# timestamp qw qx qy qz tx ty tz\n{rows}"))
    np.testing.assert_allclose(walk.odometry().position_m, [[1, 0], [2, 0], [3, 0]])
    np.testing.assert_allclose(walk.odometry().facing_rad, np.radians(130))


def test_long_documents_on_one_line_are_read(put):
    frames = [{"t": k / 10, "p": [0.1 * k, 0, 0], "note": "x" * 100} for k in range(2000)]
    assert len(read_poses(put("a.json", frames))) == 500
    lines = "\n".join(json.dumps(frame) for frame in frames)
    assert len(read_poses(put("a.jsonl", lines))) == 500


def test_matrices_as_nested_rows_and_columns_agree(put):
    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_euler("y", 40, degrees=True).as_matrix()
    found = []
    for turned in (False, True):
        frames = []
        for k in range(4):
            matrix[:3, 3] = [k, 1, -2 * k]
            frames.append({"time": k, "pose": (matrix.T if turned else matrix).tolist()})
        found.append(read_poses(put("a.json", frames)).odometry())
    np.testing.assert_allclose(found[0].position_m, [[1, 2], [2, 4], [3, 6]])
    np.testing.assert_allclose(found[1].position_m, found[0].position_m)
    np.testing.assert_allclose(found[1].facing_rad, found[0].facing_rad)


BAD = {
    "no time": ("x,y,z\n1,2,3\n2,3,4\n3,4,5\n", "columns x, y, z"),
    "five columns": ("0 1 2 3 4\n1 1 2 3 4\n2 1 2 3 4\n", "5 numbers"),
    "a word": (STRAIGHT + "9 0 0 0 0 0 zero 1\n", "line 10"),
    "not finite": (STRAIGHT + "9 0 0 nan 0 0 0 1\n", "line 10"),
    "a short row": (STRAIGHT + "9 0 0\n", "line 10"),
    "back in time": (STRAIGHT + "1 0 0 0 0 0 0 1\n", "1 after 4 in pose 10"),
    "one time": ("1 0 0 0 0 0 0 1\n" * 5, "one time"),
    "two poses": ("0 0 0 0 0 0 0 1\n1 0 0 1 0 0 0 1\n", "three poses or more"),
    "no rotation": ("".join(f"{k} {' '.join('3' * 12)}\n" for k in range(4)), "holds no rotation"),
    "mirrored": ("".join(f"{k} 1 0 0 {k} 0 1 0 0 0 0 -1 0\n" for k in range(4)), "no rotation"),
    "millimetres": ("".join(f"{k} {900 * k} 0 0 0 0 0 1\n" for k in range(4)), "m/s"),
    "comments only": ("# t x y z\n", "no row with numbers"),
    "a header too long": ("t,x,y,z,qx\n0,1,2,3\n1,2,3,4\n", "5 numbers in each line"),
}


@pytest.mark.parametrize(("content", "part"), BAD.values(), ids=BAD)
def test_what_is_wrong_is_said(put, says, content, part):
    path = put("a.txt", content)
    with pytest.raises(FormatError) as caught:
        read_poses(path)
    says(caught.value, str(path), part)


@pytest.mark.parametrize(
    ("content", "part"),
    [
        ("[]", "expected poses"), ('{"poses": 3}', "expected poses"), ("[1, 2]", "2 of 2 objects"),
        ('[{"a": "b"}]', "1 of 1 objects"), ('{"t": 1}\n{"t": \n', "line"),
        ('{"t":1,"x":2}\n{"t":2,"x":3}\n', "columns t, x"),
        ('[{"t": 1, "x": 1e999, "y": 0, "z": 0}]', "columns t, y, z"),
        ('[{"time": {"a": 1}}]', "columns"), ("[" * 3000, "JSON"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_json_is_said(put, says, content, part):
    with pytest.raises(FormatError) as caught:
        read_poses(put("a.json", content))
    says(caught.value, "a.json", part)


def test_what_is_too_much_is_refused(put, monkeypatch, says):
    monkeypatch.setattr("palms.io.pose_table.MAX_ROWS", 5)
    monkeypatch.setattr("palms.io.pose_table.MAX_JSON_BYTES", 50)
    for name, content in (("a.txt", STRAIGHT), ("a.json", [{"t": k, "x": 0} for k in range(9)])):
        with pytest.raises(InputError) as caught:
            read_poses(put(name, content))
        says(caught.value, name, "more")


@pytest.mark.parametrize(
    "options",
    [
        {"ground": "x,z"},
        {"frame": "map"},
        {"time_unit": "h"},
        {"every_s": "often"},
        {"every_s": -1},
    ],
)
def test_options_out_of_range_are_refused(put, says, options):
    with pytest.raises(InputError) as caught:
        read_poses(put("a.txt", STRAIGHT), **options)
    says(caught.value, f"option {next(iter(options))}")


AXES = {
    "z": np.eye(3),
    "y": np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "-y": np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]]),
}


@pytest.mark.parametrize("up", AXES)
def test_tum_with_any_axis_up(put, up):
    level = np.array([[0, 0, 1.4], [1, 0, 1.42], [2, 0, 1.38], [2, 1, 1.4], [2, 3, 1.41]])
    rows = [f"{t} {' '.join(map(str, p))} 0 0 0 1" for t, p in enumerate(level @ AXES[up])]
    path = put("a.tum", "\n".join(rows))
    expected = level[1:, :2]
    np.testing.assert_allclose(read_tum(path, up=up).odometry().position_m, expected, atol=1e-9)
    if up != "-y":  # which of y and -y is up cannot be told
        np.testing.assert_allclose(read_tum(path).odometry().position_m, expected, atol=1e-9)


def test_an_axis_that_cannot_be_told_is_said(put):
    rows = "".join(f"{t} {t} 0 0 0 0 0 1\n" for t in range(5))
    assert len(read_tum(put("a.tum", rows))) == 4  # level both ways
    slanted = "".join(f"{t} 0 {t} {t} 0 0 0 1\n" for t in range(5))
    with pytest.warns(PalmsWarning, match="taken as upright"):
        read_tum(put("a.tum", slanted))


def test_tum_round_trip(tmp_path):
    rng = np.random.default_rng(3)
    place = np.cumsum(rng.normal(0, 0.4, (40, 2)), axis=0)
    time = np.cumsum(rng.uniform(0.1, 0.9, 40))
    walks = (
        Odometry(time, place, facing_rad=rng.uniform(-3, 3, 40)),
        Odometry(time, place, start_m=(0.3, 0.1)),
        Odometry(time, place, frame="own", source="inertial"),
    )
    for odometry in walks:
        write_walk_tum(RecordedWalk.of(odometry), tmp_path / "a.tum")
        recorded = read_walk(tmp_path / "a.tum")
        again = recorded.odometry(recorded.sources[0])
        np.testing.assert_allclose(again.time_s, odometry.time_s, atol=1e-6)
        np.testing.assert_allclose(again.position_m, odometry.position_m, atol=1e-4)
        np.testing.assert_allclose(again.start_m, odometry.start_m, atol=1e-4)
        assert (again.frame, again.source) == (odometry.frame, odometry.source)
        assert (again.facing_rad is None) == (odometry.facing_rad is None)
        if odometry.facing_rad is not None:
            np.testing.assert_allclose(again.facing_rad, odometry.facing_rad, atol=1e-6)


def test_looking_where_one_goes_is_found_in_tum(put):
    rows = "".join(f"{t} {t} 0 0 0 0 0 1\n" for t in range(5))  # x ahead, going along x
    np.testing.assert_allclose(read_tum(put("a.tum", rows)).odometry().facing_rad, 0.0)
    aside = "".join(f"{t} 0 {t} 0 0 0 0 1\n" for t in range(5))
    assert read_tum(put("a.tum", aside), up="z").odometry().facing_rad is None


def test_messages_name_the_file_even_when_it_is_packed(tmp_path):
    path = Path(tmp_path) / "a.txt.gz"
    path.write_bytes(b"\x1f\x8b\x08\x00cut off")
    with pytest.raises(FormatError, match=r"a\.txt\.gz: expected"):
        read_poses(path)
    (tmp_path / "list.json").write_text(json.dumps({"frames": []}))
    with pytest.raises(FormatError, match=r"list\.json"):
        read_poses(tmp_path / "list.json")
