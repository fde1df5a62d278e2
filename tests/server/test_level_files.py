"""Files of several levels, as a server takes them up."""

import gzip
import json
import os
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from palms import Stairs
from palms.errors import InputError
from palms.geodesy import Origin
from palms.server.plans import building_of, plan_text, stairs_of
from palms.server.workshop import Upload, read_level_texts
from tests.test_building import GROUND, HOUSE, UPPER

DEFAULT = Path(__file__).parents[3] / "shared" / "data"
IMDF = Path(os.environ.get("PALMS_DATA", DEFAULT)) / "imdf_spbstu"


def features():
    """The house as a GeoJSON whose features have levels; its lift has no name that says so."""
    found = []
    for plan in HOUSE.levels:
        for segment in plan.segments_m.tolist():
            line = {"type": "LineString", "coordinates": segment}
            found.append((line, {"level": plan.level}))
        for room in plan.rooms:
            ring = [*room.polygon_m.tolist(), room.polygon_m[0].tolist()]
            polygon = {"type": "Polygon", "coordinates": [ring]}
            found.append((polygon, {"level": plan.level, "name": room.name, "indoor": "area"}))
    listed = [
        {"type": "Feature", "geometry": shape, "properties": what}
        for shape, what in reversed(found)
    ]
    return json.dumps({"type": "FeatureCollection", "features": listed}).encode()


def test_all_levels_of_a_file_are_stored_from_the_lowest_up(rest):
    made = rest.post("/api/v1/buildings", files={"file": ("house.geojson", features())})
    assert made.status_code == 201, made.text
    building = made.json()
    assert [level["name"] for level in building["levels"]] == ["0", "1"]
    assert [each["name"] for each in building["stairs"]] == ["Stairs A"]
    place = f"/api/v1/buildings/{building['id']}"
    rooms = rest.get(f"{place}/rooms").json()
    assert {(room["level"], room["name"]) for room in rooms} == {
        ("0", "Stairs A"), ("0", "Hall"), ("1", "Stairs A"), ("1", "Office 11")
    }  # fmt: skip
    (office,) = [r for r in rest.get(f"{place}/rooms", params={"level": "1"}).json()
                 if r["name"] == "Office 11"]  # fmt: skip
    assert office["level"] == "1"
    assert rest.get(f"{place}/rooms", params={"level": "7"}).status_code == 404
    rest.delete(place)


def test_one_level_of_a_file_may_be_chosen(rest):
    def upload(**data):
        return rest.post("/api/v1/buildings", files={"file": ("a.geojson", features())}, data=data)

    one = upload(level="1").json()
    assert [level["name"] for level in one["levels"]] == ["1"]
    assert one["stairs"] == []
    same = upload(option="level=1").json()
    assert [level["n_segments"] for level in same["levels"]] == [len(UPPER.segments_m)]
    refused = upload(level="9")
    assert refused.status_code == 422
    assert "one of 0, 1" in refused.json()["error"]
    for each in (one, same):
        rest.delete(f"/api/v1/buildings/{each['id']}")


def test_further_levels_find_their_place(rest):
    hall = b"0,0,8,0\n8,0,8,5\n8,5,0,5\n0,5,0,0\n"

    def level(place, **data):
        return rest.post(f"{place}/levels", files={"file": ("a.csv", hall)}, data=data)

    made = rest.post("/api/v1/buildings", files={"file": ("a.csv", hall)}, data={"level": "2"})
    place = f"/api/v1/buildings/{made.json()['id']}"
    for name in ("-1", "10", "1.5"):
        found = level(place, level=name).json()
    assert [each["name"] for each in found["levels"]] == ["-1", "1.5", "2", "10"]
    assert level(place, level="M").json()["levels"][-1]["name"] == "M"
    below = level(place, level="B", below="-1").json()
    assert [each["name"] for each in below["levels"]][:2] == ["B", "-1"]
    assert level(place, level="C", below="Z").status_code == 422
    assert level(place, level="B").status_code == 422
    assert rest.get(place).json() == below
    far = b"900,0,908,0\n908,0,908,5\n"
    refused = rest.post(f"{place}/levels", files={"file": ("b.csv", far)}, data={"level": "9"})
    assert refused.status_code == 422
    assert "beside it" in refused.json()["error"]
    two = rest.post(f"{place}/levels", files={"file": ("a.geojson", features())})
    assert two.status_code == 422
    assert "one level" in two.json()["error"]
    rest.delete(place)


def test_levels_with_places_on_earth_share_the_frame_of_the_lowest():
    low = replace(GROUND, origin=Origin(11.0, 48.0))
    there = Origin(11.0001, 48.0)
    offset = low.origin.to_local([11.0001, 48.0])
    high = replace(UPPER, segments_m=UPPER.segments_m - offset, origin=there, rooms=())
    from palms.server.plans import in_frame, plan_of

    moved = plan_of(in_frame(high, (), low))
    assert moved.origin == low.origin
    assert moved.segments_m == pytest.approx(UPPER.segments_m, abs=1e-3)


def test_stairs_that_a_file_has_as_such_are_kept():
    lift = Stairs("A7", [[9.0, 8.0], [11.0, 8.0], [11.0, 10.0], [9.0, 10.0]])
    plans = [replace(plan, rooms=()) for plan in HOUSE.levels]
    levels = [(plan.level, plan_text(plan, [lift])) for plan in plans]
    assert [each.name for each in stairs_of(levels[0][1])] == ["A7"]
    (joined,) = building_of(levels).stairs
    assert joined.polygon_m.tolist() == lift.polygon_m.tolist()


@pytest.mark.skipif(not IMDF.is_dir(), reason=f"no {IMDF}; set PALMS_DATA")
def test_a_venue_of_a_real_university_is_a_building_with_stairs_and_lifts(tmp_path):
    with zipfile.ZipFile(tmp_path / "venue.zip", "w") as archive:
        for path in IMDF.glob("*.geojson.gz"):
            archive.writestr(path.stem, gzip.decompress(path.read_bytes()))
    content = (tmp_path / "venue.zip").read_bytes()
    with pytest.raises(InputError, match="building=NAME"):
        read_level_texts(Upload("venue.zip", content), "Venue", "")
    listed = json.loads((IMDF / "levels.json").read_text())
    name = listed[0]["building"]
    options = (f"building={name}", "language=en")
    levels = read_level_texts(Upload("venue.zip", content, None, options), "Venue", "")
    known = sorted((e["ordinal"], e["name"]) for e in listed if e["building"] == name)
    building = building_of(levels)
    assert building.names == tuple(level for _, level in known)
    assert len({plan.origin for plan in building.levels}) == 1
    assert {"stairs", "elevator"} <= {each.name.lower() for each in building.stairs}
