"""Damaged copies of good scans of every format: a clear error or a valid scan, and nothing else."""

import functools
import shutil
from pathlib import Path

import pytest
from hypothesis import given, settings

from palms.errors import PalmsError
from palms.io import SCANS, formats, read_scan
from palms.scan import Scan
from tests.io.damage import damaged, damages, outcome

DATA = Path(__file__).parent / "data" / "scans"
FAST = {
    "arkit-planes.json": "arkit-planes",
    "roomplan.json": "roomplan",
    "webxr-planes.json": "webxr-planes",
    "arcore-planes.json": "arcore-planes",
}
SLOW = {
    "cloud.ply": "ply",
    "cloud-ascii.ply": "ply",
    "cloud.npz": "npz-cloud",
    "cloud.laz": "las",
    "cloud.e57": "e57",
    "depth/depths/depth_0.json": "depth-folder",
    "depth/poses/cameraPose_0.json": "depth-folder",
    "depth/intrinsics/cameraIntrinsics_0.json": "depth-folder",
    "stray/odometry.csv": "stray-scanner",
    "stray/camera_matrix.csv": "stray-scanner",
    "stray/depth/000000.png": "stray-scanner",
    "stray/confidence/000000.png": "stray-scanner",
}
FOLDERS = ("depth", "stray")


def check_read(path, format):
    outcome(functools.partial(read_scan, path, format=format), Scan, path)


def damaged_copy(folder, name, damages):
    """Lay a damaged copy of a file into a folder; return what is to be read."""
    top = name.partition("/")[0]
    if top in FOLDERS:
        small = shutil.copytree(DATA / top, folder / top, dirs_exist_ok=True)
        for file in (*small.rglob("*_[1-9]*.json"), *small.rglob("0000[0-2][1-9].png")):
            if int("".join(c for c in file.stem if c.isdigit())) % 6:
                file.unlink()
    (folder / name).write_bytes(damaged((DATA / name).read_bytes(), damages))
    return folder / top


@pytest.mark.parametrize("name", FAST)
@settings(derandomize=True, deadline=None, max_examples=150)
@given(damages=damages)
def test_damaged_planes(tmp_path_factory, name, damages):
    folder = tmp_path_factory.getbasetemp() / "damaged-planes"
    folder.mkdir(exist_ok=True)
    check_read(damaged_copy(folder, name, damages), FAST[name])


@pytest.mark.parametrize("name", SLOW)
@settings(derandomize=True, deadline=None, max_examples=15)
@given(damages=damages)
def test_damaged_points_and_depth(tmp_path_factory, name, damages):
    folder = tmp_path_factory.getbasetemp() / f"damaged-{name.replace('/', '-')}"
    folder.mkdir(exist_ok=True)
    check_read(damaged_copy(folder, name, damages), SLOW[name])


NAMES = sorted(
    reader.name for reader in formats(SCANS) if reader.read.__module__.startswith("palms")
)


@pytest.mark.parametrize("format", NAMES)
@pytest.mark.parametrize("content", [b"", b"\x00" * 300, b"hello\n", b"[]", b"{}", b"[" * 100_000])
def test_what_is_of_no_format_is_refused_by_each(format, content, put):
    path = put("file.json", content)
    with pytest.raises(PalmsError) as caught:
        read_scan(path, format=format)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("format", NAMES)
@pytest.mark.parametrize(
    "other", ["planes.json", "roomplan.json", "cloud.ply", "cloud.npz", "depth"]
)
def test_files_of_another_format_are_refused_by_each(format, other):
    names = {"planes.json": "planes", "roomplan.json": "roomplan", "cloud.ply": "ply",
             "cloud.npz": "npz-cloud", "depth": "depth-folder"}  # fmt: skip
    if names[other] == format or (other == "planes.json" and format == "arkit-planes"):
        return
    with pytest.raises(PalmsError) as caught:
        read_scan(DATA / other, format=format)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("format", NAMES)
def test_nothing_there_and_an_empty_folder(format, tmp_path):
    for path in (tmp_path / "none", tmp_path):
        with pytest.raises(PalmsError) as caught:
            read_scan(path, format=format)
        assert str(path) in str(caught.value)
