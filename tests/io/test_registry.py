from __future__ import annotations

import importlib.metadata
import sys
import tomllib
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from palms.errors import InputError, PalmsWarning
from palms.floorplan import FloorPlan
from palms.io import registry
from palms.io.registry import (
    BUILT_IN,
    FLOORPLANS,
    ODOMETRY,
    SCANS,
    choose_format,
    formats,
    read_floorplan,
    read_scan,
    read_walk,
)
from palms.odometry import Odometry

GROUPS = (FLOORPLANS, SCANS, ODOMETRY)
PLAN = FloorPlan([[[0, 0], [8, 0]]], name="from a plug-in")


def plugin(**changes) -> SimpleNamespace:
    parts = {
        "name": "mine",
        "description": "of mine",
        "suffixes": (".mine",),
        "recognizes": lambda path: path.read_bytes().startswith(b"MINE"),
        "read": lambda path, scale=1.0: PLAN,
        "write": None,
        "extra": None,
    }
    return SimpleNamespace(**(parts | changes))


@pytest.fixture
def install(monkeypatch):
    """Make entry points of other packages; forget them afterwards."""
    module = ModuleType("palms_plugin_for_tests")
    monkeypatch.setitem(sys.modules, module.__name__, module)

    def install_readers(**readers: object) -> None:
        entries = []
        for name, reader in readers.items():
            setattr(module, name, reader)
            value = f"{module.__name__}:{name}" if reader is not None else "no.such.module:x"
            entries.append(importlib.metadata.EntryPoint(name, value, FLOORPLANS))
        monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: entries)
        formats.cache_clear()

    yield install_readers
    formats.cache_clear()


def test_pyproject_names_what_is_built_in():
    project = Path(__file__).parents[2] / "pyproject.toml"
    declared = tomllib.loads(project.read_text())["project"]["entry-points"]
    assert {g: sorted(declared[g].values()) for g in GROUPS} == {
        g: sorted(BUILT_IN[g]) for g in GROUPS
    }


@pytest.mark.parametrize("group", GROUPS)
def test_built_in_readers_need_no_metadata(install, group):
    install()
    assert len(formats(group)) == len(BUILT_IN[group])
    for reader in formats(group):
        assert all(suffix.startswith(".") for suffix in reader.suffixes)
        assert reader.description


def test_a_plugin_reads_its_files(install, put):
    install(mine=plugin())
    assert read_floorplan(put("a.csv", "MINE")).name == "from a plug-in"
    assert read_floorplan(put("a.csv", "0,0,8,0\n")).name == "a"
    assert read_floorplan(put("b.csv", "0,0,8,0\n"), format="mine", scale=2.0) is PLAN


def test_a_broken_plugin_is_named_and_left_out(install, put):
    install(gone=None, half=object(), mine=plugin())
    with pytest.warns(PalmsWarning) as caught:
        found = formats(FLOORPLANS)
    assert [reader.name for reader in found][-1] == "mine"
    messages = sorted(str(warning.message) for warning in caught)
    assert "plug-in gone" in messages[0]
    assert "plug-in half" in messages[1]
    assert "recognizes" in messages[1]
    assert read_floorplan(put("a.csv", "0,0,8,0\n")).name == "a"


def test_a_plugin_that_fails_to_look_is_named(install, put):
    install(mine=plugin(recognizes=lambda path: path.no_such_thing))
    with pytest.warns(PalmsWarning, match="format mine could not look"):
        assert read_floorplan(put("a.csv", "0,0,8,0\n")).name == "a"


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
        ("a.doc", b"\xff\xfeh\x00i\x00", "text in UTF-16"),
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


def test_choose_format(put):
    assert choose_format(FLOORPLANS, put("a.csv", "0,0,8,0\n")).name == "csv"
