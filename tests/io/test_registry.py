from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from palms.errors import PalmsWarning
from palms.io import read_floorplan
from palms.io.registry import BUILT_IN, FLOORPLANS, ODOMETRY, SCANS, choose_format, formats
from tests.io.plugins import plugin

GROUPS = (FLOORPLANS, SCANS, ODOMETRY)


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


def test_choose_format(put):
    assert choose_format(FLOORPLANS, put("a.csv", "0,0,8,0\n")).name == "csv"
