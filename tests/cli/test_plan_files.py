"""A command on a file of each format of floor plans ends in the right plan."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from palms.cli.app import app
from palms.floorplan import SegmentClass
from palms.geometry import lengths
from palms.io import FLOORPLANS, choose_format, formats
from tests.io.floors import DATA, FILES, RASTER, sample


@pytest.mark.parametrize("name", FILES)
def test_plan_info_tells_the_size_and_the_walls(name):
    options = [word for text in FILES[name] for word in ("--option", text)]
    done = CliRunner().invoke(app, ["plan", "info", str(DATA / name), *options, "--json", "-"])
    assert done.exit_code == 0, done.output
    facts, truth = json.loads(done.stdout), sample()
    assert facts["size_m"] == pytest.approx(truth.size_m.tolist(), abs=0.1)
    found = facts["segments"]
    length_m = found["wall"]["length_m"] + found["glass"]["length_m"]
    faces = 2 if name == "floor.ifc" else 1
    assert length_m / faces == pytest.approx(lengths(truth.blocking_m).sum(), rel=0.02)
    if name not in RASTER:
        doors = found["door"]["count"] + found["opening"]["count"]
        wanted = truth.of_class(SegmentClass.DOOR, SegmentClass.OPENING)
        assert doors == len(wanted)
    assert facts["free_area_m2"] == pytest.approx(2966, rel=0.03)


def test_each_format_has_a_file():
    read = {choose_format(FLOORPLANS, DATA / name).name for name in FILES}
    assert {reader.name for reader in formats(FLOORPLANS)} - {"csv"} == read
