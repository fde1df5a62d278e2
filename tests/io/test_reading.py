from __future__ import annotations

import pytest

from palms.errors import InputError
from palms.io import read_floorplan, read_scan, read_walk, registry
from palms.odometry import Odometry
from tests.io.plugins import PLAN, plugin


def test_a_plugin_reads_its_files(install, put):
    install(mine=plugin())
    assert read_floorplan(put("a.csv", "MINE")).name == "from a plug-in"
    assert read_floorplan(put("a.csv", "0,0,8,0\n")).name == "a"
    assert read_floorplan(put("b.csv", "0,0,8,0\n"), format="mine", scale=2.0) is PLAN


def test_a_missing_extra_is_named(install, put, says):
    def read(path):
        raise ModuleNotFoundError("No module named 'ezdxf'", name="ezdxf")

    install(mine=plugin(read=read, extra="dxf"))
    with pytest.raises(InputError) as caught:
        read_floorplan(put("a.mine", "MINE"))
    says(caught.value, "ezdxf", "palms-localization[dxf]")


def test_a_walk_reader_may_return_odometry(monkeypatch, put):
    walk = Odometry([1, 2], [[1, 0], [2, 0]], source="inertial", frame="own")
    reader = plugin(read=lambda path: walk)
    monkeypatch.setattr(registry, "formats", lambda group: (reader,))
    assert read_walk(put("a.mine", "MINE")).odometry("ronin") is walk


def test_content_counts_before_suffix(put, plane, walk_content):
    assert read_floorplan(put("plan.txt", "0,0,8,0\n")).name == "plan"
    assert len(read_scan(put("scan.txt", [plane])).walls_m) == 1
    assert len(read_walk(put("walk.txt", walk_content))) == 9


@pytest.mark.parametrize("read", [read_floorplan, read_scan, read_walk])
def test_nothing_there(read, tmp_path, says):
    for path in (tmp_path / "none.csv", "a\x00b"):
        with pytest.raises(InputError) as caught:
            read(path)
        says(caught.value, "nothing there")


@pytest.mark.parametrize(
    "file",
    [
        ("a.doc", "hello", "text"),
        ("a.doc", b"\xff\xfeh\x00", "text in UTF-16"),
        ("a", "", "empty"),
    ],
)
@pytest.mark.parametrize(
    ("read", "known"),
    [
        (read_floorplan, "csv (.csv)"),
        (read_scan, "planes (.json)"),
        (read_walk, "tracking (.json)"),
    ],
)
def test_no_format_fits(read, known, put, says, file):
    name, content, got = file
    with pytest.raises(InputError) as caught:
        read(put(name, content))
    says(caught.value, name, known, got)


@pytest.mark.parametrize("read", [read_floorplan, read_scan, read_walk])
def test_a_folder_that_is_no_input(read, tmp_path, says):
    with pytest.raises(InputError) as caught:
        read(tmp_path)
    says(caught.value, "a folder")


def test_the_suffix_decides_whose_complaint_is_heard(put, says):
    with pytest.raises(InputError) as caught:
        read_floorplan(put("a.csv", "x1,y1\n1,2\n"))
    says(caught.value, "line 2")
    with pytest.raises(InputError) as caught:
        read_scan(put("a.json", "[]"))
    says(caught.value, "an empty list")


def test_unknown_format_and_options(put, says):
    path = put("a.csv", "0,0,8,0\n")
    with pytest.raises(InputError) as caught:
        read_floorplan(path, format="dwg")
    says(caught.value, "csv", "'dwg'")
    with pytest.raises(InputError, match="options for format csv"):
        read_floorplan(path, layer="walls")
