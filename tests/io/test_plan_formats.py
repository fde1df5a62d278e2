"""One floor in all formats: the same walls from each; and files that are no plans."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from palms.errors import FormatError, PalmsError
from palms.floorplan import SegmentClass
from palms.io import FLOORPLANS, choose_format, formats, read_any, read_floorplan, write_floorplan
from tests.io.floors import (
    DATA,
    FILES,
    RASTER,
    along,
    apart_m,
    length_m,
    load_tool,
    read_file,
    sample,
)

CELL_M = 0.05
VECTOR = [name for name in FILES if name not in RASTER]


@pytest.mark.parametrize("name", VECTOR)
def test_vector_formats_have_the_same_walls_within_a_centimetre(name):
    plan, truth = read_file(name), sample()
    assert apart_m(along(truth.blocking_m), plan.blocking_m).max() < 0.01
    assert apart_m(along(plan.blocking_m), truth.blocking_m).max() < 0.01
    assert plan.size_m == pytest.approx(truth.size_m, abs=0.01)


@pytest.mark.parametrize("name", VECTOR)
def test_vector_formats_have_the_same_doors(name):
    plan, truth = read_file(name), sample()
    for kind in (SegmentClass.DOOR, SegmentClass.OPENING):
        found, wanted = plan.of_class(kind), truth.of_class(kind)
        if name == "floor.imdf.zip":  # it has no openings without a door's material
            found = plan.of_class(SegmentClass.DOOR, SegmentClass.OPENING)
            wanted = truth.of_class(SegmentClass.DOOR, SegmentClass.OPENING)
        assert len(found) == len(wanted)
        assert apart_m(found.mean(axis=1), wanted).max() < 0.01


@pytest.mark.parametrize("name", RASTER)
def test_raster_formats_have_the_same_walls_within_a_cell(name):
    plan, truth = read_file(name), sample()
    walls = plan.blocking_m
    if RASTER[name]:
        walls = walls + truth.bounds_m[0] - RASTER[name]
    there = apart_m(along(truth.blocking_m), walls)
    spurious = apart_m(along(walls), truth.blocking_m)
    assert np.quantile(there, 0.99) < CELL_M
    assert np.quantile(spurious, 0.95) < CELL_M
    assert max(there.max(), spurious.max()) < 3 * CELL_M
    assert length_m(walls) == pytest.approx(length_m(truth.blocking_m), rel=0.01)


ON_EARTH = ["floor.geojson", "floor.imdf.zip", "floor.osm", "floor.gpkg", "floor-shapes.zip"]


@pytest.mark.parametrize("name", ON_EARTH)
def test_rooms_origin_and_level_are_there(name):
    plan, truth = read_file(name), sample()
    assert {room.name for room in plan.rooms} == {room.name for room in truth.rooms}
    assert plan.origin is not None
    assert plan.level is not None
    for room in truth.rooms:
        inside = room.polygon_m[:3].mean(axis=0)
        assert plan.room_at(inside) == truth.room_at(inside)


def test_the_files_are_what_the_tool_writes(tmp_path):
    load_tool().write_all(tmp_path)
    names = {path.name for path in DATA.iterdir()}
    assert {path.name for path in tmp_path.iterdir()} == names
    exact = ("floor.dxf", "floor-map.yaml", "floor.geojson", "floor.osm", "floor.svg", "floor.ifc")
    for name in exact:
        assert (tmp_path / name).read_bytes() == (DATA / name).read_bytes()


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_known_by_its_content_whatever_its_suffix(name, tmp_path):
    expected = choose_format(FLOORPLANS, DATA / name).name
    for suffix in (".csv", ".dat", ".png", ".dxf"):
        copy = tmp_path / f"copy{suffix}"
        shutil.copy(DATA / name, copy)
        assert choose_format(FLOORPLANS, copy).name == expected


READERS = [reader for reader in formats(FLOORPLANS) if reader.name != "csv"]
IDS = [reader.name for reader in READERS]
OTHERS = {
    "empty": b"",
    "blank": b" \n \n",
    "binary": bytes(range(256)) * 8,
    "text": b"hello, this is no plan\n" * 10,
    "html": b"<!DOCTYPE html><html><body>404</body></html>",
    "json": b'{"walls": []}',
    "deep json": b"[" * 100_000,
    "png, cut": b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR",
    "zip, cut": b"PK\x03\x04" + b"\x00" * 30,
    "gzip, cut": b"\x1f\x8b\x08" + b"\x00" * 20,
    "rows": b"0,0,1,1\n1,1,2,2\n",
}


@pytest.mark.parametrize("content", OTHERS)
@pytest.mark.parametrize("reader", READERS, ids=IDS)
def test_other_content_is_refused_in_one_line(reader, content, put, says):
    path = put(f"plan{reader.suffixes[0]}", OTHERS[content])
    options = ["scale=0.1"] if reader.name in ("image", "dxf") else []
    with pytest.raises(PalmsError) as caught:
        read_any(FLOORPLANS, path, reader.name, options)
    says(caught.value, path.name)
    if content != "rows":  # which are a plan, by content
        with pytest.raises(PalmsError):
            read_floorplan(path)


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("share", [0.0, 0.3, 0.7, 0.97])
def test_cut_off_files_are_refused_or_read(name, share, tmp_path):
    for each in DATA.iterdir():
        shutil.copy(each, tmp_path)
    victim = tmp_path / name.replace("map.yaml", "map.png")
    content = victim.read_bytes()
    victim.write_bytes(content[: int(share * len(content))])
    with pytest.raises(PalmsError) as caught:
        read_file(name, tmp_path)
    assert "\n" not in str(caught.value)
    assert victim.name in str(caught.value) or name in str(caught.value)


@pytest.mark.parametrize("reader", READERS, ids=IDS)
def test_a_folder_or_nothing_in_place_of_a_file(reader, tmp_path, says):
    for path in (tmp_path, tmp_path / "none"):
        with pytest.raises(PalmsError) as caught:
            read_any(FLOORPLANS, path, reader.name, ["scale=1"] if reader.name == "image" else [])
        says(caught.value, str(path))


@pytest.mark.parametrize(("unit", "factor"), [(0.001, "0.001"), (1000.0, "1000")])
def test_an_absurd_unit_is_refused_with_the_likely_factor(unit, factor, tmp_path, says):
    import json

    line = [[0, 0], [40 / unit, 0], [40 / unit, 30 / unit]]
    path = tmp_path / "a.geojson"
    path.write_text(json.dumps({"type": "LineString", "coordinates": line}))
    with pytest.raises(FormatError) as caught:
        read_any(FLOORPLANS, path, None, ["frame=metres"])
    says(caught.value, f"multiply by {factor}", "scale=")
    plan = read_any(FLOORPLANS, path, None, ["frame=metres", f"scale={factor}"])
    assert plan.size_m == pytest.approx([40, 30])


@pytest.mark.parametrize("suffix", [".csv", ".geojson"])
def test_what_is_written_is_read_again(suffix, tmp_path):
    plan = read_file("floor.geojson")
    write_floorplan(plan, tmp_path / f"floor{suffix}")
    again = read_any(
        FLOORPLANS, tmp_path / f"floor{suffix}", None, FILES["floor.geojson"][: suffix != ".csv"]
    )
    assert np.abs(again.segments_m - plan.segments_m).max() < 1e-3
    assert (again.classes == plan.classes).all()
    assert again.origin == plan.origin
    assert [room.name for room in again.rooms] == [room.name for room in plan.rooms]
    assert again.level == plan.level
