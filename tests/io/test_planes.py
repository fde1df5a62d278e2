from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.errors import FormatError, InputError, OutputError, PalmsWarning
from palms.geometry import rotate
from palms.io.planes import FORMAT, read_scan_json, scan_time_s, session_of, write_scan_json
from palms.scan import Scan

WALL = [[[2.0, -2.5], [2.0, 0.5]]]


def test_the_example_of_the_contract(put, plane):
    scan = read_scan_json(put("detectedPlanes.json", [plane]))
    assert scan.walls_m.tolist() == WALL
    assert scan.position_m.tolist() == [0, 0]
    assert scan.session is None


def test_older_form(put, plane):
    older = {
        "anchorTransform": plane["anchorTransform"],
        "planeCenter": [0, 0, 0],
        "planeExtent": [3, 2.4, 0],
        "detectedTime": 1,
        "updatedTime": 2,
    }
    assert read_scan_json(put("a.json", [older])).walls_m.tolist() == WALL


def test_plain_segments(put):
    assert read_scan_json(put("a.json", WALL)).walls_m.tolist() == WALL


def test_center_and_rotation_in_the_anchor_frame(put, plane):
    """A wall along the anchor's -z after a quarter turn, its centre shifted along x."""
    plane["centers"] = [[0.5, 1, 0]]
    plane["extents"] = [[3, 2.4, np.pi / 2]]
    # anchor at (1, 0, -2): centre (1.5, 1, -2); Ry(90 deg) takes x to -z
    walls = read_scan_json(put("a.json", [plane])).walls_m
    np.testing.assert_allclose(walls, [[[3.5, -1.5], [0.5, -1.5]]], atol=1e-12)


def test_anchor_rotation_as_nested_rows(put, plane):
    """Rows: the anchor's x axis is the first column, here (0, 0, -1): straight ahead."""
    plane["anchorTransform"] = [[0, 0, 1, 1], [0, 1, 0, 0], [-1, 0, 0, -2], [0, 0, 0, 1]]
    walls = read_scan_json(put("a.json", [plane])).walls_m
    np.testing.assert_allclose(walls, [[[3.5, -1], [0.5, -1]]], atol=1e-12)


def test_only_vertical_planes_are_walls_and_others_are_not_checked(put, plane):
    floor = {"planeAlignment": 0, "centers": []}
    assert len(read_scan_json(put("a.json", [floor, plane])).walls_m) == 1


def test_no_vertical_plane(put, says, plane):
    plane["planeAlignment"] = 0
    with pytest.raises(FormatError) as caught:
        read_scan_json(put("a.json", [plane, plane]))
    says(caught.value, "a.json", "2 planes, none vertical", "scan again")


@pytest.mark.parametrize("folder", ["Session_17", "Session_17/"])
def test_folder_of_a_session(put, tmp_path, plane, folder):
    put("Session_17/detectedPlanes.json", [plane])
    assert read_scan_json(f"{tmp_path}/{folder}").session == "17"


def test_session_of_the_working_folder(put, plane, monkeypatch):
    path = put("Session_17/detectedPlanes.json", [plane])
    monkeypatch.chdir(path.parent)
    assert read_scan_json("detectedPlanes.json").session == "17"
    assert session_of("Session_") is None


def test_folder_without_planes(tmp_path, says):
    with pytest.raises(InputError) as caught:
        read_scan_json(tmp_path)
    says(caught.value, "detectedPlanes.json")


def test_time_and_position_beside_it(put, plane):
    path = put("Session_1/detectedPlanes.json", [plane])
    put("Session_1/scan.json", {"t_s": 31.5, "position_m": [1, -2], "other": 1})
    scan = read_scan_json(path.parent)
    assert (scan.time_s, scan.position_m.tolist()) == (31.5, [1, -2])
    assert scan_time_s(path.parent) == 31.5


def test_scan_json_of_others_is_left_alone(put):
    """Outside of a session's folder a file called scan.json may be anything, even a scan."""
    put("scan.json", WALL)
    assert len(read_scan_json(put("walls.json", WALL)).walls_m) == 1
    assert len(read_scan_json(put("Session_1/scan.json", WALL)).walls_m) == 1


@pytest.mark.parametrize(
    "content",
    [
        [],
        "",
        '{"t_s": "soon"}',
        '{"t_s": NaN}',
        '{"t_s": [1]}',
        '{"position_m": [1]}',
        '{"position_m": {"x": 1}}',
        '{"coverage_m": 3}',
        '{"coverage_m": [1e400]}',
        '{"coverage_m": [-1]}',
    ],
)
def test_bad_scan_json(put, says, plane, content):
    path = put("Session_1/detectedPlanes.json", [plane])
    put("Session_1/scan.json", content)
    with pytest.raises(FormatError) as caught:
        read_scan_json(path)
    says(caught.value, "Session_1")


@pytest.mark.parametrize(
    ("key", "value", "where"),
    [
        ("anchorTransform", None, "anchorTransform"),
        ("anchorTransform", [[1, 0, 0, 1]] * 3, "anchorTransform"),
        ("anchorTransform", [1] * 16, "anchorTransform"),
        ("centers", [], "centers"),
        ("centers", [[0, 0]], "centers"),
        ("centers", [["a", 0, 0]], "centers[0][0]"),
        ("centers", [[0, 0, 0], [0, 0, 1e999]], "centers[1][2]"),
        ("extents", "wide", "extents"),
        ("extents", [[-1, 2, 0]], "width"),
        ("planeAlignment", "up", "planeAlignment"),
        ("planeAlignment", None, "planeAlignment"),
    ],
)
def test_a_bad_field_is_named(put, says, plane, key, value, where):
    bad = {**plane, key: value}
    text = json.dumps([plane, bad])
    with pytest.raises(FormatError) as caught:
        read_scan_json(put("a.json", text))
    says(caught.value, "a.json plane 1", where)


@pytest.mark.parametrize("key", ["anchorTransform", "centers", "extents"])
def test_a_missing_field_is_named(put, says, plane, key):
    del plane[key]
    with pytest.raises(FormatError) as caught:
        read_scan_json(put("a.json", [plane]))
    says(caught.value, "plane 0", key, "got nothing")


def test_transposed_transform(put, says, plane):
    plane["anchorTransform"] = np.transpose(plane["anchorTransform"]).tolist()
    with pytest.raises(FormatError) as caught:
        read_scan_json(put("a.json", [plane]))
    says(caught.value, "plane 0", "transpose it")


@pytest.mark.parametrize("factor", [0, 2, -1, 1e200])
def test_transform_that_is_not_rigid(put, says, plane, factor):
    matrix = np.array(plane["anchorTransform"], dtype=float)
    matrix[:3, :3] *= factor
    with pytest.raises(FormatError) as caught:
        read_scan_json(put("a.json", [{**plane, "anchorTransform": matrix.tolist()}]))
    says(caught.value, "no rotation")


@pytest.mark.parametrize(
    "content",
    [
        "",
        "[",
        "[]",
        "{}",
        "3",
        "null",
        "x1,y1,x2,y2\n1,2,3,4",
        b"\x89PNG\x00",
        "[1]",
        "[null, {}]",
        "[[[0, 1], [2]]]",
        "[[[0, 1], [2, NaN]]]",
        "[[[0, 1], [2, 1e400]]]",
        "[[0, 1, 2, 3]]",
        "[[[2, 0], [2, 0]]]",
        "[[[2000, 0], [2000, 3000]]]",
        "[[[1e200, 0], [1e300, 1e308]]]",
    ],
)
def test_wrong_content(put, says, content):
    with pytest.raises(FormatError) as caught:
        read_scan_json(put("a.json", content))
    says(caught.value, "a.json")


def test_far_walls_are_left_out_with_a_word(put):
    with pytest.warns(PalmsWarning, match="1 of 2 walls"):
        scan = read_scan_json(put("a.json", [*WALL, [[50, 0], [50, 5]]]))
    assert len(scan.walls_m) == 1


def same(a: Scan, b: Scan) -> None:
    np.testing.assert_allclose(a.walls_m, b.walls_m, rtol=0, atol=1e-9)
    assert np.array_equal(a.position_m, b.position_m)
    assert (a.time_s, a.session) == (b.time_s, b.session)
    assert (a.coverage_m is None) == (b.coverage_m is None)
    if a.coverage_m is not None:
        assert np.array_equal(a.coverage_m, b.coverage_m, equal_nan=True)


angle = st.floats(-np.pi, np.pi)
a_wall = st.tuples(st.floats(0.1, 5), angle, angle, st.floats(0.2, 8))
a_coverage = st.lists(st.one_of(st.just(np.nan), st.floats(0, 20)), min_size=1, max_size=8)


@st.composite
def scans(draw) -> Scan:
    position = draw(st.tuples(st.floats(-100, 100), st.floats(-100, 100)))
    walls = [
        np.array(position) + rotate([r, 0], at) + np.outer([0, 1], rotate([width, 0], along))
        for r, at, along, width in draw(st.lists(a_wall, min_size=1, max_size=8))
    ]
    coverage = draw(st.one_of(st.none(), a_coverage))
    time_s = draw(st.sampled_from([0.0, 3.25]))
    return Scan(walls, position, coverage, time_s, draw(st.sampled_from([None, "7", "17", "x_y"])))


@settings(derandomize=True, deadline=None, max_examples=60)
@given(
    scans(),
    st.sampled_from(["Session_7", "Session_7/walls.json", "any.json", "Session_7/scan.json"]),
)
def test_round_trip(tmp_path_factory, scan, name):
    folder = tmp_path_factory.mktemp("scan")
    (folder / "Session_7").mkdir()
    write_scan_json(scan, folder / name)
    named = replace(scan, session="7") if scan.session is None and "7" in name else scan
    same(read_scan_json(folder / name), named)  # a scan that names none goes by its folder


def test_stale_scan_json_is_removed(tmp_path):
    write_scan_json(Scan(WALL, time_s=3.0), tmp_path / "Session_1")
    write_scan_json(Scan(WALL, session="1"), tmp_path / "Session_1")
    assert os.listdir(tmp_path / "Session_1") == ["detectedPlanes.json"]
    assert read_scan_json(tmp_path / "Session_1").time_s == 0


def test_unwritable(unwritable, says):
    for name in ("a.json", "Session_1"):
        with pytest.raises(OutputError) as caught:
            write_scan_json(Scan(WALL), unwritable / name)
        says(caught.value)


def test_recognizes(put, tmp_path, plane):
    assert FORMAT.recognizes(put("Session_1/detectedPlanes.json", [plane]))
    assert FORMAT.recognizes(tmp_path / "Session_1")
    assert FORMAT.recognizes(put("a", WALL))
    assert not FORMAT.recognizes(put("b", {"anchorTransform": 1}))
    assert not FORMAT.recognizes(put("c", "1,2,3,4"))
    assert not FORMAT.recognizes(tmp_path / "none")


def test_importing_is_light():
    code = (
        "import sys, palms.io; "
        "print({'pydantic', 'matplotlib', 'typer', 'rich', 'shapely'} & set(sys.modules))"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "set()"
