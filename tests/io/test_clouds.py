"""Point clouds and depth folders: how they are written, and what is refused."""

import io
import json
import shutil
import sys
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest

from palms.errors import InputError, PalmsWarning
from palms.extraction import ExtractionSettings
from palms.geometry import lengths
from palms.io import point_clouds, read_scan
from palms.io.depth_folder import read_frames
from palms.io.depth_images import pixel_size
from palms.io.ply import read_ply_points

DATA = Path(__file__).parent / "data" / "scans"
POINTS = np.load(DATA / "cloud.npz")["xyz_mm"] / 1000
WALLS = read_scan(DATA / "cloud.npz").walls_m


def ply(points, kind="binary_little_endian", before="", extra=(), number="float"):
    order = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": ""}[kind]
    names = ["x", "y", "z", *extra]
    head = f"ply\nformat {kind} 1.0\n{before}element vertex {len(points)}\n"
    head += "".join(f"property {number} {name}\n" for name in names) + "end_header\n"
    full = np.column_stack([points, *(np.arange(len(points)) % 7 for _ in extra)])
    if not order:
        return (
            head.encode()
            + "".join(" ".join(f"{v:.4f}" for v in row) + "\n" for row in full).encode()
        )
    return head.encode() + full.astype(order + {"float": "f4", "double": "f8"}[number]).tobytes()


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("number", ["float", "double"])
def test_ply_in_every_order(kind, number, put):
    path = put("a.ply", ply(POINTS[:500], kind, extra=("nx", "red"), number=number))
    np.testing.assert_allclose(read_ply_points(path), POINTS[:500], atol=1e-4)


def test_ply_with_other_things_before_the_vertices(put):
    before = "element camera 2\nproperty float f\nproperty uchar id\n"
    good = ply(POINTS[:50], before=before)
    start = good.index(b"end_header\n") + len(b"end_header\n")
    path = put("a.ply", good[:start] + b"0123456789" + good[start:])
    np.testing.assert_allclose(read_ply_points(path), POINTS[:50], atol=1e-6)
    text = ply(POINTS[:50], "ascii", before=before)
    start = text.index(b"end_header\n") + len(b"end_header\n")
    path = put("b.ply", text[:start] + b"1.5 2\n2.5 3\n" + text[start:])
    np.testing.assert_allclose(read_ply_points(path), POINTS[:50], atol=1e-4)


def test_ply_of_windows(put):
    text = ply(POINTS[:50], "ascii").replace(b"\n", b"\r\n")
    np.testing.assert_allclose(read_ply_points(put("a.ply", text)), POINTS[:50], atol=1e-4)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "an empty file"),
        (b"ply\nformat ascii 1.0\n", "no header"),
        (ply(POINTS[:9]).replace(b"vertex 9", b"vertex 9000000000000"), "room for 9"),
        (ply(POINTS[:9], "ascii").replace(b"vertex 9", b"vertex 9" + b"0" * 22), "room for"),
        (ply(POINTS[:9])[:-5], "room for 8"),
        (ply(POINTS[:9], "ascii")[:-40], "header says"),
        (ply(POINTS[:0]), "no vertex"),
        (ply(POINTS[:9]).replace(b"float y", b"float w"), "properties 'x w z'"),
        (ply(POINTS[:9]).replace(b"float y", b"float x"), "properties 'x x z'"),
        (ply(POINTS[:9]).replace(b"float y", b"quad y"), "PLY 1.0"),
        (ply(POINTS[:9]).replace(b"float y", b"list uchar int y"), "before lists|properties"),
        (ply(POINTS[:9], "ascii").replace(b"end_header\n", b"end_header\nx y z\n"), "PLY file"),
        (ply(np.full((9, 3), np.nan)), "points"),
        (ply(POINTS[:9] * 1e6), "1000 m"),
    ],
)  # fmt: skip
def test_ply_that_cannot_be(content, words, put, says):
    with pytest.raises(InputError, match=words) as caught:
        read_scan(put("a.ply", content), format="ply")
    says(caught.value, "a.ply")


def test_large_clouds_are_thinned(put, monkeypatch):
    monkeypatch.setattr(point_clouds, "MAX_POINTS", 5000)
    few = read_ply_points(put("a.ply", ply(POINTS)))
    np.testing.assert_allclose(few, POINTS[::4], atol=1e-6)
    text = read_ply_points(put("b.ply", ply(POINTS, "ascii")))
    np.testing.assert_allclose(text, POINTS[::4], atol=1e-4)
    assert len(read_scan(DATA / "cloud.npz", position=(0, 0)).walls_m) > 4


def saved(**arrays):
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


@pytest.mark.parametrize(
    "arrays",
    [
        {"xyz_mm": np.round(POINTS * 1000).astype(np.int32)},
        {"points": POINTS.astype(np.float32), "colours": np.zeros((len(POINTS), 3), np.uint8)},
        {"xyz_cm": np.asfortranarray(POINTS * 100)},
        {"arr_0": np.column_stack([POINTS, POINTS])},
    ],
)
def test_npz_in_several_ways(arrays, put):
    scan = read_scan(put("a.npz", saved(**arrays)))
    np.testing.assert_allclose(scan.walls_m, WALLS, atol=0.005)


def test_npy_alone_and_its_unit(tmp_path):
    np.save(tmp_path / "room_mm.npy", POINTS * 1000)
    np.save(tmp_path / "room.npy", POINTS * 1000)
    np.testing.assert_allclose(read_scan(tmp_path / "room_mm.npy").walls_m, WALLS, atol=0.005)
    with pytest.raises(InputError, match="1000 m across"):
        read_scan(tmp_path / "room.npy")
    again = read_scan(tmp_path / "room.npy", unit="mm")
    np.testing.assert_allclose(again.walls_m, WALLS, atol=0.005)


def header_only(shape, dtype="<f8"):
    """An npz whose array claims a shape and has no content."""
    stream, archive = io.BytesIO(), io.BytesIO()
    np.lib.format.write_array_header_1_0(
        stream, {"descr": dtype, "fortran_order": False, "shape": shape}
    )
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("xyz.npy", stream.getvalue())
    return archive.getvalue()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"PK\x03\x04 and no more xyz.npy", "npz file that can be read"),
        (header_only((10**12, 3)), "at most 2 GB"),
        (header_only((1000, 3)), "1000 points, as its header says"),
        (header_only((1000, 3), "|O"), "points|shape"),
        (header_only((1, 200_000_000)), r"\(P, 3\)"),
        (saved(a=np.zeros(5)), r"\(P, 3\)"),
        (saved(a=np.zeros((5, 3), complex)), r"\(P, 3\)"),
        (saved(xyz=np.array([[None, 1, 2]], object)), r"\(P, 3\)"),
        (saved(xyz=np.zeros((0, 3))), "points"),
        (saved(xyz=np.full((10, 3), np.nan)), "points"),
    ],
)  # fmt: skip
def test_npz_that_cannot_be(content, words, put, says):
    with pytest.raises(InputError, match=words) as caught:
        read_scan(put("a.npz", content), format="npz-cloud")
    says(caught.value, "a.npz")


def test_a_zip_bomb_stays_small(put):
    bomb = saved(xyz=np.zeros((20_000_000, 3), np.float32))
    assert len(bomb) < 1_000_000
    path = put("a.npz", bomb)
    tracemalloc.start()
    with pytest.raises(InputError):
        read_scan(path, format="npz-cloud")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e9


@pytest.mark.parametrize(
    ("name", "package", "extra"), [("cloud.laz", "laspy", "las"), ("cloud.e57", "pye57", "e57")]
)
def test_a_missing_extra_is_named(name, package, extra, monkeypatch, says):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError) as caught:
        read_scan(DATA / name)
    says(caught.value, package, f"palms-localization[{extra}]")


def test_laz_without_its_decompressor_names_the_extra(monkeypatch, says):
    import laspy

    monkeypatch.setattr(laspy.LazBackend, "detect_available", tuple)
    with pytest.raises(InputError) as caught:
        read_scan(DATA / "cloud.laz")
    says(caught.value, "lazrs", "palms-localization[las]")


def las(**fields):
    """The tests' LAZ file with numbers of its header changed: offset, format, value."""
    import struct

    content = bytearray((DATA / "cloud.laz").read_bytes())
    for offset, kind, value in fields.values():
        struct.pack_into(kind, content, offset, value)
    return bytes(content)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (las(points=(107, "<I", 4_000_000_000)), "4000000000 points|that fits|LAS or LAZ"),
        (las(records=(100, "<I", 4_000_000_000)), "records before its points"),
        (las(start=(96, "<I", 4_000_000_000)), "records before its points"),
        (las()[:100], "cut off"),
        (las()[:3000], "chunks"),
    ],
)
def test_las_that_claims_too_much(content, words, put, says):
    with pytest.raises(InputError, match=words) as caught:
        read_scan(put("a.laz", content), format="las")
    says(caught.value, "a.laz")


def test_which_way_is_up(put, says):
    for up, order in {"x": [1, 2, 0], "y": [0, 1, 2], "z": [0, 2, 1]}.items():
        turned = POINTS[:, order] * ([1, -1, 1] if up == "z" else 1)
        path = put(f"{up}.npz", saved(xyz=turned))
        found = len(read_scan(path).walls_m)
        assert found == len(WALLS)
        assert len(read_scan(path, up=up).walls_m) == found
    ball = np.random.default_rng(0).normal(size=(5000, 3))
    with pytest.raises(InputError, match="which way is up") as caught:
        read_scan(put("ball.npz", saved(xyz=ball)))
    says(caught.value, "up=y")


@pytest.mark.parametrize("up", ["x", "-x", "y", "-y", "z", "-z"])
def test_no_axis_mirrors(up):
    assert np.linalg.det(np.array(point_clouds.UP_AXES[up], float)) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"up": "w"}, "option up"),
        ({"position": "here"}, "option position"),
        ({"position": (1, 2, 3)}, "option position"),
        ({"floor": "low"}, "option floor"),
        ({"unit": "ft"}, "option unit"),
    ],
)
def test_options_that_cannot_be(options, words):
    with pytest.raises(InputError, match=words):
        read_scan(DATA / "cloud.npz", **options)


def test_position_and_floor_are_taken():
    scan = read_scan(DATA / "cloud.npz", position="0.5,-1", floor="-1.4")
    assert scan.position_m.tolist() == [0.5, -1.0]
    assert len(scan.walls_m) == len(WALLS)


# ---------------------------------------------------------------- depth folders


@pytest.fixture
def depth(tmp_path):
    return shutil.copytree(DATA / "depth", tmp_path / "Session_12")


def change(path, edit):
    path.write_text(json.dumps(edit(json.loads(path.read_text()))))


def test_what_counts_as_a_wall_is_heeded(depth):
    every = lengths(read_scan(depth).walls_m)
    long = lengths(read_scan(depth, settings=ExtractionSettings(min_length_m=2.5)).walls_m)
    assert every.min() < 2.5 <= long.min()


def test_the_folder_names_the_session(depth):
    assert read_scan(depth).session == "12"


def test_matrices_by_columns_are_read_too(depth):
    for path in (depth / "poses").iterdir():
        change(path, lambda pose: {"data": np.array(pose["data"]).T.tolist()})
    for path in (depth / "intrinsics").iterdir():
        change(path, lambda lens: {"data": np.array(lens["data"]).T.tolist()})
    np.testing.assert_allclose(read_scan(depth).walls_m, read_scan(DATA / "depth").walls_m)


def test_intrinsics_are_scaled_from_the_image_to_the_depth():
    lens = np.array([[1440.0, 0, 958.0], [0, 1440, 716], [0, 0, 1]])
    focal, centre = pixel_size(lens, (192, 256))
    np.testing.assert_allclose(focal, 192.0)
    np.testing.assert_allclose(centre, [958.5 / 7.5 - 0.5, 716.5 / 7.5 - 0.5])
    own, _ = pixel_size(np.array([[200.0, 0, 127.5], [0, 200, 95.5], [0, 0, 1]]), (192, 256))
    np.testing.assert_allclose(own, 200.0)
    for wrong in (np.eye(3), np.zeros((3, 3)), lens * -1):
        with pytest.raises(InputError, match="camera intrinsics"):
            pixel_size(wrong, (192, 256))


def test_images_without_a_pose_are_left_out_with_a_word(depth):
    (depth / "poses" / "cameraPose_3.json").unlink()
    with pytest.warns(PalmsWarning, match="1 of 30 depth images"):
        assert len(read_frames(depth)) == 29
    shutil.rmtree(depth / "poses")
    (depth / "poses").mkdir()
    with pytest.raises(InputError, match="none matching"):
        read_scan(depth)


def test_few_of_very_many_images_are_read(depth):
    assert len(read_frames(depth, 10)) == 10


@pytest.mark.parametrize(
    ("file", "edit", "words"),
    [
        (
            "depths/depth_0.json",
            lambda d: [row[:9] for row in d[:-1]] + [[1.0]],
            "numbers of shape",
        ),
        ("depths/depth_0.json", lambda d: 7, "in rows"),
        ("depths/depth_0.json", lambda d: [[-1.0, 1.0], [1.0, 1.0]], "metres"),
        ("depths/depth_0.json", lambda d: [[]], "depth image|shape"),
        ("poses/cameraPose_0.json", lambda d: {"data": [[1]]}, "4x4"),
        ("poses/cameraPose_0.json", lambda d: {"data": [[2, 0, 0, 0]] * 4}, "rotation"),
        ("intrinsics/cameraIntrinsics_0.json", lambda d: {"data": [1, 2]}, "shape"),
    ],
)
def test_depth_that_cannot_be(depth, file, edit, words, says):
    change(depth / file, edit)
    with pytest.raises(InputError, match=words) as caught:
        read_scan(depth)
    says(caught.value, file.partition("_")[0].rpartition("/")[2])


# ---------------------------------------------------------------- Stray Scanner


@pytest.fixture
def stray(tmp_path):
    return shutil.copytree(DATA / "stray", tmp_path / "stray")


def test_stray_columns_may_be_more_and_depth_older(stray):
    path = stray / "odometry.csv"
    rows = [line.split(", ") for line in path.read_text().splitlines()]
    path.write_text(
        "\n".join(", ".join([*row[:2], str(i), *row[2:], "1"]) for i, row in enumerate(rows))
        .replace("frame, 0, x", "frame, fx, x")
        .replace("qw, 1", "qw, fy")
    )
    from PIL import Image

    for image in (stray / "depth").iterdir():
        np.save(image.with_suffix(".npy"), np.array(Image.open(image)))
        image.unlink()
    np.testing.assert_allclose(read_scan(stray).walls_m, read_scan(DATA / "stray").walls_m)


def test_stray_pixels_without_confidence_are_left_out(stray):
    from PIL import Image

    for image in (stray / "confidence").iterdir():
        Image.fromarray(np.zeros((48, 64), np.uint8)).save(image)
    with pytest.raises(InputError, match="depth images"):
        read_scan(stray)


@pytest.mark.parametrize(
    ("file", "content", "words"),
    [
        ("odometry.csv", "a, b\n1, 2\n", "columns frame"),
        (
            "odometry.csv",
            "timestamp, frame, x, y, z, qx, qy, qz, qw\n0, 000000, 1, 2, x\n",
            "line 2",
        ),
        ("camera_matrix.csv", "1, 2\n3, 4\n", "shape"),
        ("depth/000000.png", "no image", "a PNG image"),
        ("confidence/000000.png", b"\x89PNG\r\n\x1a\n", "a PNG image"),
    ],
)
def test_stray_that_cannot_be(stray, file, content, words, says):
    (stray / file).write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError, match=words) as caught:
        read_scan(stray)
    says(caught.value, Path(file).name)
