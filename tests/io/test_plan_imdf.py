from __future__ import annotations

import gzip
import json
import shutil
import zipfile

import numpy as np
import pytest

from palms.errors import FormatError, InputError, PalmsWarning
from palms.floorplan import SegmentClass
from palms.io import (
    FLOORPLANS,
    choose_format,
    read_building,
    read_floorplan,
    read_levels,
)
from palms.io.plan_imdf import read_plan_imdf
from tests.io.floors import DATA

M = 1 / 111_320  # degrees of a metre at the equator


def area(x0, y0, x1, y1):
    ring = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]]
    return {"type": "Polygon", "coordinates": [[[M * x, M * y] for x, y in ring]]}


def line(x0, y0, x1, y1):
    return {"type": "LineString", "coordinates": [[M * x0, M * y0], [M * x1, M * y1]]}


def item(identity, geometry, **properties):
    return {"type": "Feature", "id": identity, "geometry": geometry, "properties": properties}


def level(name, ordinal, building):
    names = {"en": f"Level {name}", "fr": f"Niveau {name}"}
    return item(f"id-{building}-{ordinal}", area(0, 0, 12, 8), name=names, ordinal=ordinal,
                short_name={"en": name}, building_ids=[building])  # fmt: skip


def venue(**changes):
    """Two walkways side by side, a room above them with a door, on one level of one building."""
    on = {"level_id": "id-b-0"}
    files = {
        "level": [level("G", 0, "b")],
        "building": [item("b", None, name={"en": "Museum", "fr": "Musée"})],
        "unit": [
            item("w1", area(0, 0, 6, 3), category="walkway", name=None, **on),
            item("w2", area(6, 0, 12, 3), category="lobby", name={"en": "Lobby"}, **on),
            item("r", area(0, 3, 12, 8), category="room", name=None, **on),
        ],
        "opening": [
            item(
                "o", line(2, 3.05, 3, 3.05), category="automobile", door={"type": "swinging"}, **on
            )
        ],
        "anchor": [item("a", {"type": "Point", "coordinates": [0, 0]}, unit_id="r")],
        "occupant": [item("c", None, anchor_id="a", name={"en": "Cafe"})],
    }
    return files | changes


@pytest.fixture
def put_venue(tmp_path):
    def put(files, packed=False):
        folder = tmp_path / "venue"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        for name, features in files.items():
            text = json.dumps({"type": "FeatureCollection", "features": features}).encode()
            if packed:
                (folder / f"{name}.geojson.gz").write_bytes(gzip.compress(text))
            else:
                (folder / f"{name}.geojson").write_bytes(text)
        return folder

    return put


@pytest.mark.parametrize("packed", [False, True])
def test_a_folder_without_a_manifest(put_venue, packed):
    folder = put_venue(venue(), packed)
    assert choose_format(FLOORPLANS, folder).name == "imdf"
    plan = read_plan_imdf(folder)
    assert (plan.name, plan.level) == ("Museum", "Level G")
    assert plan.size_m == pytest.approx([12, 8], rel=0.01)


def test_edges_that_walkways_share_are_no_walls_and_others_are_walls_once(put_venue):
    plan = read_plan_imdf(put_venue(venue()), origin=(0.0, 0.0))
    walls = plan.of_class(SegmentClass.WALL)
    middles = walls.mean(axis=1)
    assert not ((abs(middles - [6, 1.5]) < 0.5).all(axis=1)).any()
    total = sum(float(abs(b - a).sum()) for a, b in walls)
    assert total == pytest.approx(2 * (12 + 8) + 12 - 1, rel=0.01)
    assert len(plan.of_class(SegmentClass.DOOR)) == 1


def test_an_opening_counts_whatever_its_category(put_venue):
    files = venue()
    files["opening"][0]["properties"]["category"] = "emergencyexit"
    assert len(read_plan_imdf(put_venue(files)).of_class(SegmentClass.DOOR)) == 1


def test_rooms_are_named_by_unit_or_occupant(put_venue):
    plan = read_plan_imdf(put_venue(venue()), origin=(0.0, 0.0))
    assert plan.room_at([6, 6]) == "Cafe"
    assert plan.room_at([9, 1]) == "Lobby"
    assert plan.room_at([3, 1]) is None


def test_fixtures_are_solid_unless_told_otherwise(put_venue):
    files = venue(fixture=[item("f", area(5, 5, 6, 6), level_id="id-b-0", category="furniture")])
    folder = put_venue(files)
    without = len(read_plan_imdf(folder, fixtures=False).segments_m)
    assert len(read_plan_imdf(folder).segments_m) == without + 4


@pytest.mark.parametrize("named", ["0", "G", "Level G", "Niveau G", "id-b-0"])
def test_a_level_by_name_ordinal_or_id(put_venue, named):
    folder = put_venue(venue(level=[level("G", 0, "b"), level("1", 3, "b")]))
    assert read_plan_imdf(folder, level=named, language="fr").level == "Niveau G"


def test_several_levels_are_listed(put_venue, says):
    folder = put_venue(venue(level=[level("G", 0, "b"), level("1", 3, "b")]))
    for wanted in (None, "7"):
        with pytest.raises(InputError) as caught:
            read_plan_imdf(folder, level=wanted)
        says(caught.value, "Level G (ordinal 0, Museum", "Level 1 (ordinal 3", "level=NAME")


def test_levels_of_the_same_name_are_told_by_their_building(put_venue):
    files = venue(level=[level("G", 0, "b"), level("G", 0, "c")])
    files["building"].append(item("c", None, name={"en": "Annex"}))
    folder = put_venue(files)
    with pytest.raises(InputError, match="Annex"):
        read_plan_imdf(folder, level="G")
    assert read_plan_imdf(folder, level="G", building="Musée").name == "Museum"


def tower(*levels):
    """A venue with the same units on several levels, whose ids begin with that of the level."""
    plain = venue()
    copies = {"unit": [], "opening": []}
    for each in levels:
        for kind, listed in copies.items():
            for found in plain[kind]:
                own = found["properties"] | {"level_id": each["id"]}
                listed.append(found | {"id": f"{each['id']}-{found['id']}", "properties": own})
    return plain | copies | {"level": list(levels)}


def test_all_levels_of_a_venue_lie_in_one_frame_from_the_lowest_up(put_venue):
    above = level("1", 1, "b")
    above["geometry"] = area(0, 0, 60, 40)  # the frame's origin is the middle of all levels
    folder = put_venue(tower(above, level("B", -1, "b"), level("G", 0, "b")))
    levels = read_levels(folder, language="fr")
    assert [(each.name, each.ordinal) for each in levels] == [
        ("Niveau B", -1), ("Niveau G", 0), ("Niveau 1", 1),
    ]  # fmt: skip
    assert len({each.plan.origin for each in levels}) == 1
    for each in levels:
        alone = read_plan_imdf(folder, level=each.name, language="fr")
        np.testing.assert_array_equal(each.plan.segments_m, alone.segments_m)
        assert each.plan.level == each.name
        np.testing.assert_allclose(each.plan.segments_m, levels[0].plan.segments_m, atol=1e-6)


def test_levels_of_one_building_of_a_venue(put_venue, says):
    files = tower(level("G", 0, "b"), level("G", 0, "c"), level("1", 1, "c"))
    files["building"].append(item("c", None, name={"en": "Annex"}))
    folder = put_venue(files)
    assert len(read_levels(folder)) == 3
    annex = read_levels(folder, building="Annex")
    assert [(each.name, each.plan.name) for each in annex] == [
        ("Level G", "Annex"), ("Level 1", "Annex"),
    ]  # fmt: skip
    with pytest.raises(InputError) as caught:
        read_levels(folder, building="Tower")
    says(caught.value, "building='Tower'", "Annex")


def test_a_level_without_walls_is_left_out_with_a_word(put_venue):
    files = tower(level("G", 0, "b"))
    roof = level("R", 1, "b")
    folder = put_venue(files | {"level": [*files["level"], roof]})
    with pytest.warns(PalmsWarning, match="level Level R is left out"):
        assert [each.name for each in read_levels(folder)] == ["Level G"]
    with pytest.raises(FormatError):
        read_levels(put_venue(files | {"level": [roof]}))


def test_the_level_of_a_file_of_one_level_is_its_building():
    for name in ("floor.dxf", "floor.imdf.zip", "floor.geojson"):
        (only,) = read_levels(DATA / name)
        plan = read_floorplan(DATA / name)
        np.testing.assert_array_equal(only.plan.segments_m, plan.segments_m)
        assert (only.name, only.plan.level) == (plan.level or "", plan.level)


@pytest.mark.parametrize("missing", ["level", "unit"])
def test_what_is_missing_is_named(put_venue, says, missing):
    files = venue()
    del files[missing]
    with pytest.raises(FormatError) as caught:
        read_plan_imdf(put_venue(files))
    says(caught.value, f"no {missing}.geojson")


def test_a_zip_bomb_is_not_unpacked(tmp_path, says, monkeypatch):
    monkeypatch.setattr("palms.io.archives.MAX_BYTES", 1_000_000)
    path = tmp_path / "bomb.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("level.geojson", b" " * 50_000_000)
        archive.writestr("unit.geojson", b"{}")
    with pytest.raises(FormatError) as caught:
        read_plan_imdf(path)
    says(caught.value, "more unpacked")


def test_too_many_files_in_an_archive(tmp_path, says, monkeypatch):
    monkeypatch.setattr("palms.io.archives.MAX_MEMBERS", 3)
    with pytest.raises(FormatError) as caught:
        read_plan_imdf(DATA / "floor.imdf.zip")
    says(caught.value, "at most 3 files")


@pytest.mark.parametrize("name", ["../../level.geojson", "/etc/level.geojson", "a\\..\\..\\x.json"])
def test_names_that_lead_out_of_the_archive(tmp_path, says, name):
    path = tmp_path / "evil.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(name, b"{}")
    with pytest.raises(FormatError) as caught:
        read_plan_imdf(path)
    says(caught.value, "names inside the archive")
    assert sorted(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    "changes",
    [
        {"level": [item("x", None, name=None, ordinal="first")]},
        {"level": [item("id-b-0", area(0, 0, 1, 1), name=3, building_ids=7)]},
        {"unit": [item("u", area(0, 0, 1, 1), category=5, level_id="id-b-0", name=[1])]},
        {"unit": [item("u", None, level_id="id-b-0")]},
        {"opening": [item("o", line(0, 0, 1, 1), level_id="id-b-0", door="x")]},
        {"level": []},
    ],
)
def test_odd_values_give_a_plan_or_one_line(put_venue, changes):
    try:
        text = str(len(read_plan_imdf(put_venue(venue(**changes))).segments_m))
    except InputError as error:
        text = str(error)
    assert text != "0"
    assert "\n" not in text


def test_stairs_are_units_of_such_a_category_on_two_levels(put_venue, says):
    files = tower(level("G", 0, "b"), level("1", 1, "b"))
    for each in files["level"]:
        on = {"level_id": each["id"], "name": None}
        files["unit"].append(item(f"{each['id']}-e", area(0, 3, 2, 5), category="elevator", **on))
    last = files["level"][1]["id"]
    files["unit"].append(
        item("s", area(8, 4, 9, 5), category="stairs", name={"en": "Stairs"}, level_id=last)
    )
    building = read_building(put_venue(files))
    assert building.names == ("Level G", "Level 1")
    (lift,) = building.stairs  # stairs that the other level does not have lead nowhere
    assert lift.name == "elevator"
    low, high = (corner(lift.polygon_m, axis=0) for corner in (np.min, np.max))
    assert (high - low) == pytest.approx([2, 2], abs=0.02)


def test_a_building_of_two_levels_of_one_name_asks_for_the_building(put_venue, says):
    folder = put_venue(tower(level("G", 0, "b"), level("G", 0, "c")))
    with pytest.raises(InputError) as caught:
        read_building(folder)
    says(caught.value, "several levels called 'Level G'", "building=NAME")
