"""Every format of scans, on files of one place: the same walls; and the ways they are written."""

import importlib.util
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from palms.errors import InputError, PalmsWarning
from palms.geometry import lengths
from palms.io import SCANS, choose_format, formats, read_scan, write_scan_json
from palms.scan import Scan

DATA = Path(__file__).parent / "data" / "scans"
TRUE_WALLS = np.array(json.loads((DATA / "walls.json").read_text()))
PLANES = {
    "planes.json": "planes",
    "arkit-planes.json": "arkit-planes",
    "roomplan.json": "roomplan",
    "webxr-planes.json": "webxr-planes",
    "arcore-planes.json": "arcore-planes",
}
POINTS = {
    "cloud.ply": "ply",
    "cloud-ascii.ply": "ply",
    "cloud.npz": "npz-cloud",
    "cloud.laz": "las",
    "cloud.e57": "e57",
    "depth": "depth-folder",
    "stray": "stray-scanner",
}
FILES = PLANES | POINTS


def farthest_end(wall, walls):
    """How far the ends of the best fitting wall are from those of one."""
    both = np.stack([walls, walls[:, ::-1]])
    return np.linalg.norm(both - wall, axis=-1).max(axis=-1).min()


def content(name):
    return json.loads((DATA / name).read_text())


def reader(name):
    return choose_format(SCANS, DATA / name).name


@pytest.mark.parametrize("name", FILES)
def test_each_file_is_known_for_what_it_is(name):
    assert reader(name) == FILES[name]


@pytest.mark.parametrize("name", FILES)
def test_content_counts_and_not_the_name(name, tmp_path):
    if (DATA / name).is_file():
        shutil.copy(DATA / name, tmp_path / "file.bin")
        assert choose_format(SCANS, tmp_path / "file.bin").name == FILES[name]


def test_every_format_has_its_file():
    assert {each.name for each in formats(SCANS)} >= set(FILES.values())
    built_in = {each.name for each in formats(SCANS) if each.read.__module__.startswith("palms.")}
    assert built_in == set(FILES.values())


@pytest.mark.parametrize("name", FILES)
def test_all_formats_give_the_same_walls(name):
    scan = read_scan(DATA / name)
    within = 0.01 if name in PLANES else 0.03
    for wall in TRUE_WALLS:
        assert farthest_end(wall, scan.walls_m) < within
    assert len(scan.walls_m) == len(TRUE_WALLS)
    assert scan.position_m.tolist() == [0.0, 0.0]


@pytest.mark.parametrize("name", ["depth", "stray"])
def test_depth_says_what_is_empty(name):
    scan = read_scan(DATA / name)
    assert scan.coverage_m.shape == (360,)
    assert np.isfinite(scan.coverage_m).all()
    area = (scan.coverage_m**2).sum() * np.pi / 360
    assert 50 < area < 60


def test_the_script_makes_these_files(tmp_path):
    script = Path(__file__).parents[2] / "tools" / "make_scan_files.py"
    spec = importlib.util.spec_from_file_location("make_scan_files", script)
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    files = made.make_scan_files(tmp_path / "scans")
    names = {str(file.relative_to(tmp_path / "scans")) for file in files}
    assert names == {str(f.relative_to(DATA)) for f in DATA.rglob("*") if f.is_file()}
    for name in FILES:
        ours, theirs = read_scan(tmp_path / "scans" / name), read_scan(DATA / name)
        np.testing.assert_allclose(ours.walls_m, theirs.walls_m, atol=1e-3)


@pytest.mark.parametrize("name", FILES)
def test_a_scan_is_converted_to_planes_and_back(name, tmp_path):
    scan = read_scan(DATA / name)
    write_scan_json(scan, tmp_path / "Session_1")
    again = read_scan(tmp_path / "Session_1")
    np.testing.assert_allclose(again.walls_m, scan.walls_m, atol=1e-9)
    assert (again.coverage_m is None) == (scan.coverage_m is None)


def test_depth_beside_planes_tells_what_is_empty(tmp_path):
    session = tmp_path / "Session_5"
    shutil.copytree(DATA / "depth", session)
    write_scan_json(Scan(TRUE_WALLS), session)
    scan = read_scan(session)
    assert reader_of(session) == "planes"
    np.testing.assert_allclose(scan.walls_m, TRUE_WALLS, atol=1e-9)
    np.testing.assert_allclose(scan.coverage_m, read_scan(DATA / "depth").coverage_m)
    (session / "scan.json").write_text('{"coverage_m": [1.0, 2.0]}')
    assert read_scan(session).coverage_m.tolist() == [1.0, 2.0]


def reader_of(path):
    return choose_format(SCANS, path).name


def test_damaged_depth_beside_planes_is_left_out_with_a_word(tmp_path):
    session = tmp_path / "Session_5"
    shutil.copytree(DATA / "depth", session)
    write_scan_json(Scan(TRUE_WALLS), session)
    (session / "depths" / "depth_0.json").write_text("[[1, 2], [3")
    with pytest.warns(PalmsWarning, match="depth images are left out"):
        assert read_scan(session).coverage_m is None


# ---------------------------------------------------------------- ARKit


def by_rows(flat):
    return np.array(flat).reshape(4, 4).T.tolist()


def by_columns(flat):
    return np.array(flat).reshape(4, 4).tolist()


@pytest.mark.parametrize(
    "write",
    [by_rows, by_columns, lambda flat: {"columns": by_columns(flat)},
     lambda flat: np.array(by_rows(flat)).ravel().tolist()],
    ids=["nested rows", "nested columns", "columns by name", "flat rows"],
)  # fmt: skip
def test_arkit_matrices_in_every_writing(write, put):
    planes = [
        plane | {"transform": write(plane["transform"])} for plane in content("arkit-planes.json")
    ]
    scan = read_scan(put("a.json", planes))
    for wall in TRUE_WALLS:
        assert farthest_end(wall, scan.walls_m) < 0.001


def test_arkit_of_older_ios_and_other_apps(put):
    planes = []
    for plane in content("arkit-planes.json"):
        extent = plane.pop("planeExtent")
        if extent["rotationOnYAxis"] == 0.0 and plane["classification"] == "wall":
            planes.append(
                plane | {"extent": {"x": extent["width"], "y": 0, "z": extent["height"]},
                         "center": {"x": 0, "y": 0, "z": 0}, "alignment": 1,
                         "classification": {"wall": {}}}
            )  # fmt: skip
    planes[1]["extent"] = [planes[1]["extent"]["x"], 0.0, planes[1]["extent"]["z"]]
    planes[2]["extent"] = [planes[2]["extent"]["x"], planes[2]["extent"]["z"]]
    scan = read_scan(put("a.json", {"anchors": planes}), format="arkit-planes")
    assert len(scan.walls_m) == len(planes)
    for wall in scan.walls_m:
        assert farthest_end(wall, TRUE_WALLS) < 0.001


def test_arkit_outlines_stand_in_for_extents(put):
    plane = content("arkit-planes.json")[1]
    extent = plane.pop("planeExtent")
    x, z = extent["width"] / 2, extent["height"] / 2
    corners = [[x, 0, z], [x, 0, -z], [-x, 0, -z], [-x, 0, z]]
    scan = read_scan(
        put("a.json", [plane | {"geometry": {"boundaryVertices": corners}}]), format="arkit-planes"
    )
    assert farthest_end(TRUE_WALLS[1], scan.walls_m) < 0.001


def test_arkit_centers_are_in_the_anchors_frame(put):
    plane = content("arkit-planes.json")[2]  # x along the wall, not turned
    scan = read_scan(put("a.json", [plane | {"center": [0.5, 0.0, 0.3]}]))
    wall = TRUE_WALLS[2]
    along = (wall[1] - wall[0]) / np.linalg.norm(wall[1] - wall[0])
    assert farthest_end(wall + 0.5 * along, scan.walls_m) < 0.001


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"transform": [1, 2, 3]}, "a 4x4 matrix"),
        ({"transform": [2.0] * 16}, "a rotation and a translation"),
        ({"planeExtent": {"width": -1, "height": 2}}, "0 m or more"),
        ({"planeExtent": {"width": "wide", "height": 2}}, "a finite number"),
        ({"center": [0, 0]}, "3 numbers"),
        ({"classification": "table"}, "none"),
        ({"alignment": "horizontal"}, "none"),
    ],
)
def test_arkit_planes_that_cannot_be(change, words, put, says):
    plane = content("arkit-planes.json")[0] | change
    with pytest.raises(InputError, match=words) as caught:
        read_scan(put("a.json", [plane]), format="arkit-planes")
    says(caught.value, "a.json")


# ---------------------------------------------------------------- RoomPlan


IDENTITY = np.eye(4).ravel().tolist()


def measured(value, symbol):
    """An angle as Swift encodes it."""
    return {"value": value, "unit": {"symbol": symbol}}


def arc(start, end):
    return {"radius": 3.0, "startAngle": start, "endAngle": end, "center": [0, 0]}


def test_roomplan_keeps_doors_when_asked(put):
    cut, whole = read_scan(DATA / "roomplan.json"), read_scan(DATA / "roomplan.json", doors="keep")
    room = content("roomplan.json")
    missing = sum(door["dimensions"][0] for door in room["doors"])
    assert lengths(whole.walls_m).sum() - lengths(cut.walls_m).sum() == pytest.approx(missing)
    assert missing > 0.7


def test_roomplan_doors_without_a_parent_find_their_wall(put):
    room = content("roomplan.json")
    for door in room["doors"] + room["openings"]:
        door["parentIdentifier"] = None
    np.testing.assert_allclose(
        read_scan(put("a.json", room)).walls_m, read_scan(DATA / "roomplan.json").walls_m, atol=1e-9
    )


def test_roomplan_confidence(put):
    room = content("roomplan.json")
    room["walls"][0]["confidence"] = {"low": {}}
    room["walls"][1]["confidence"] = "medium"
    path = put("a.json", room)
    count = [len(read_scan(path, confidence=word).walls_m) for word in ("low", "medium", "high")]
    assert count[0] == len(TRUE_WALLS)
    assert count[0] > count[1] > count[2] > 0
    with pytest.raises(InputError, match="option confidence"):
        read_scan(path, confidence="some")


@pytest.mark.parametrize(
    ("start", "end"),
    [(0.0, np.pi / 2), (measured(0, "°"), measured(90, "°")), (0, 90),
     (measured(0, "rad"), measured(np.pi / 2, "rad"))],
    ids=["radians", "degrees", "plain degrees", "measurements"],
)  # fmt: skip
def test_roomplan_curved_walls_become_chords(start, end, put):
    wall = content("roomplan.json")["walls"][0]
    wall |= {"transform": IDENTITY, "curve": arc(start, end)}
    scan = read_scan(put("a.json", {"walls": [wall]}), position=(0, 0))
    assert len(scan.walls_m) == 9
    np.testing.assert_allclose(np.linalg.norm(scan.walls_m, axis=-1), 3.0, atol=1e-9)
    assert lengths(scan.walls_m).sum() == pytest.approx(3 * np.pi / 2, rel=0.01)


def test_roomplan_doors_cut_curved_walls(put):
    wall = content("roomplan.json")["walls"][0]
    wall |= {"transform": IDENTITY, "identifier": "round", "curve": arc(0, np.pi)}
    at = IDENTITY[:12] + [0, 0, 3, 1]
    door = wall | {"transform": at, "curve": None, "dimensions": [1.0, 2, 0], "identifier": "door",
                   "parentIdentifier": "round", "category": {"door": {}}}  # fmt: skip
    scan = read_scan(put("a.json", {"walls": [wall], "doors": [door]}), position=(0, 0))
    assert lengths(scan.walls_m).sum() == pytest.approx(3 * np.pi - 1.0, rel=0.01)
    assert np.linalg.norm(scan.walls_m - [0, -3], axis=-1).min() == pytest.approx(0.5, abs=0.03)


def test_roomplan_structures_of_several_rooms(put):
    room = content("roomplan.json")
    first = room | {"walls": room["walls"][:2], "doors": [], "openings": []}
    second = room | {"walls": room["walls"][2:]}
    scan = read_scan(
        put("a.json", {"rooms": [first, second], "identifier": "home"}), format="roomplan"
    )
    assert len(scan.walls_m) >= len(room["walls"])


@pytest.mark.parametrize(
    ("room", "words"),
    [
        ([], "a RoomPlan room"),
        ({"walls": []}, "at least one wall"),
        ({"walls": [3]}, "a surface"),
        ({"walls": [{"transform": [1] * 16, "dimensions": [1, 2, 0]}]}, "a rotation"),
        ({"rooms": [{"story": 0}]}, "a RoomPlan room"),
    ],
)
def test_roomplan_that_cannot_be(room, words, put, says):
    with pytest.raises(InputError, match=words) as caught:
        read_scan(put("a.json", room), format="roomplan")
    says(caught.value, "a.json")


# ---------------------------------------------------------------- WebXR, ARCore


def test_webxr_matrices_and_lists(put):
    planes = []
    for plane in content("webxr-planes.json")["planes"]:
        pose, polygon = plane.pop("pose"), plane["polygon"]
        planes.append(
            plane | {"transform": matrix_of(pose["position"], pose["orientation"]),
                     "polygon": [[p["x"], p["y"], p["z"]] for p in polygon]}
        )  # fmt: skip
    scan = read_scan(put("a.json", planes))
    for wall in TRUE_WALLS:
        assert farthest_end(wall, scan.walls_m) < 0.001


def matrix_of(position, orientation):
    from scipy.spatial.transform import Rotation

    matrix = np.eye(4)
    matrix[:3, :3] = Rotation.from_quat([orientation[key] for key in "xyzw"]).as_matrix()
    matrix[:3, 3] = [position[key] for key in "xyz"]
    return matrix.T.ravel().tolist()


def test_the_viewers_place_is_the_observation_point(put):
    planes = content("webxr-planes.json") | {"viewer": {"position": {"x": 0.5, "y": 1.4, "z": -1}}}
    assert read_scan(put("a.json", planes)).position_m.tolist() == [0.5, 1.0]
    arcore = content("arcore-planes.json") | {"camera": [0.5, 1.4, -1]}
    assert read_scan(put("b.json", arcore)).position_m.tolist() == [0.5, 1.0]


def test_webxr_upright_by_pose_whatever_it_is_called(put):
    planes = content("webxr-planes.json")["planes"]
    for plane in planes:
        plane["semanticLabel"] = None
        del plane["orientation"]
    lying = planes[0] | {"pose": {"position": {"x": 0, "y": 0, "z": 0},
                                  "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}}  # fmt: skip
    scan = read_scan(put("a.json", [*planes[:-1], lying]), format="webxr-planes")
    assert len(scan.walls_m) == len(TRUE_WALLS)


def test_arcore_numbers_and_raw_poses(put):
    planes = content("arcore-planes.json")["planes"]
    for plane in planes:
        pose = plane["centerPose"]
        plane |= {
            "type": 2,
            "trackingState": 0,
            "centerPose": [*pose["rotation"], *pose["translation"]],
        }
    scan = read_scan(put("a.json", planes))
    assert len(scan.walls_m) == len(TRUE_WALLS)
    for wall in TRUE_WALLS:
        assert farthest_end(wall, scan.walls_m) < 0.001


@pytest.mark.parametrize(
    "change",
    [{"type": "HORIZONTAL_UPWARD_FACING"}, {"type": 0}, {"trackingState": "STOPPED"},
     {"subsumedBy": 3}],
)  # fmt: skip
def test_arcore_planes_that_do_not_count(change, put):
    plane = content("arcore-planes.json")["planes"][0] | change
    with pytest.raises(InputError, match="at least one upright plane"):
        read_scan(put("a.json", [plane]))


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("webxr-planes", {"polygon": [3, 4]}, "3 numbers"),
        ("webxr-planes", {"polygon": None}, "points x, y, z"),
        ("webxr-planes", {"pose": {"position": {"x": 1}}}, "finite number"),
        ("webxr-planes", {"pose": None}, "4x4"),
        ("arcore-planes", {"centerPose": [0, 0, 0, 0, 1, 2, 3]}, "unit"),
        ("arcore-planes", {"extentX": -2}, "0 m or more"),
        ("arcore-planes", {"polygon": ["a", "b"]}, "finite number"),
    ],
)  # fmt: skip
def test_planes_that_cannot_be(name, change, words, put, says):
    plane = content(f"{name}.json")["planes"][0] | change
    with pytest.raises(InputError, match=words) as caught:
        read_scan(put("a.json", [plane]), format=name)
    says(caught.value, "a.json")
