from __future__ import annotations

import gzip
import json

import numpy as np
import pytest

from palms.errors import FormatError, InputError, PalmsWarning
from palms.floorplan import SegmentClass
from palms.io import read_building, read_levels
from palms.io.plan_geojson import read_plan_geojson


def feature(kind, coordinates, **properties):
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features, **more):
    return {"type": "FeatureCollection", "features": list(features), **more}


HALL = feature("LineString", [[0, 0], [8, 0], [8, 5], [0, 5], [0, 0]], type="wall")
AREA = [[[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]]


def test_degrees_are_told_from_metres_by_their_extent(put):
    line = [[30.38, 60.007], [30.381, 60.007]]
    plan = read_plan_geojson(put("a.geojson", feature("LineString", line)))
    assert plan.size_m[0] == pytest.approx(55.8, abs=0.1)
    assert plan.origin.to_lonlat(plan.segments_m[0]) == pytest.approx(np.array(line), abs=1e-9)
    local = read_plan_geojson(put("b.geojson", HALL))
    assert local.size_m.tolist() == [8, 5]
    assert local.origin is None


def test_the_same_origin_for_all_levels_of_a_building(put):
    line = feature("LineString", [[30.38, 60.007], [30.381, 60.007]])
    plan = read_plan_geojson(put("a.geojson", line), origin=(30.38, 60.007))
    assert plan.segments_m[0, 0] == pytest.approx([0, 0], abs=1e-6)


def test_a_door_is_cut_out_of_the_wall(put):
    door = feature("LineString", [[3, 0.1], [4, 0.1]], type="door")
    plan = read_plan_geojson(put("a.geojson", collection(HALL, door)))
    assert plan.of_class(SegmentClass.DOOR).tolist() == [[[3, 0.1], [4, 0.1]]]
    assert [[0, 0], [3, 0]] in plan.of_class(SegmentClass.WALL).tolist()
    assert len(plan.of_class(SegmentClass.WALL)) == 5


def test_thin_areas_of_doors_and_windows_become_their_middle_line(put):
    ring = [[[3, -0.1], [4, -0.1], [4, 0.1], [3, 0.1], [3, -0.1]]]
    pane = [[[8.1, 3], [8.1, 4], [7.9, 4], [7.9, 3], [8.1, 3]]]
    door, window = feature("Polygon", ring, type="door"), feature("Polygon", pane, type="window")
    plan = read_plan_geojson(put("a.geojson", collection(HALL, door, window)))
    assert plan.of_class(SegmentClass.DOOR).tolist() == [[[3, 0], [4, 0]]]
    assert plan.of_class(SegmentClass.GLASS).tolist() == [[[8, 3], [8, 4]]]


def test_areas_are_walls_where_the_file_names_none(put):
    shop = feature("Polygon", AREA, name="Shop")
    plan = read_plan_geojson(put("a.geojson", collection(shop)))
    assert len(plan.segments_m) == 4
    assert plan.room_at([2, 2]) == "Shop"
    named = read_plan_geojson(
        put("b.geojson", collection(HALL, feature("Polygon", AREA, name="x")))
    )
    assert len(named.segments_m) == 4
    assert named.room_at([2, 2]) == "x"


def test_words_and_properties_of_ones_own(put):
    line = feature("LineString", [[0, 0], [8, 0]], capa="Muro")
    glass = feature("LineString", [[8, 0], [8, 5]], capa="vidrio")
    area = feature("Polygon", AREA, rotulo="Sala")
    path = put("a.geojson", collection(line, glass, area))
    plan = read_plan_geojson(
        path, class_property="capa", classes="vidrio:glass", name_property="rotulo"
    )
    assert plan.classes.tolist() == [SegmentClass.WALL, SegmentClass.GLASS]
    assert plan.room_at([1, 1]) == "Sala"
    with pytest.raises(InputError, match="word:class"):
        read_plan_geojson(path, classes="vidrio=glass")


def test_lines_of_unknown_class_are_left_out_with_a_word(put):
    cable = feature("LineString", [[1, 1], [2, 2]], type="cable")
    with pytest.warns(PalmsWarning, match="1 lines of class 'cable'"):
        plan = read_plan_geojson(put("a.geojson", collection(HALL, cable)))
    assert len(plan.segments_m) == 4


def test_levels_are_chosen_and_listed(put, says):
    low = feature("LineString", [[0, 0], [8, 0]], level="1")
    high = feature("LineString", [[0, 0], [9, 0]], level="2")
    path = put("a.geojson", collection(low, high))
    with pytest.raises(InputError) as caught:
        read_plan_geojson(path)
    says(caught.value, "levels 1, 2")
    plan = read_plan_geojson(path, level="2")
    assert (plan.size_m[0], plan.level) == (9, "2")
    with pytest.raises(InputError, match="one of 1, 2"):
        read_plan_geojson(path, level="7")


def test_the_ground_floor_is_a_level_like_others(put):
    """0 is no missing level: its walls are not on the others."""
    ground = feature("LineString", [[0, 0], [8, 0]], level=0)
    above = feature("LineString", [[0, 5], [9, 5]], level=1.0)
    everywhere = feature("LineString", [[0, 0], [0, 5]])
    both = feature("LineString", [[8, 0], [8, 5]], level="0;1")
    path = put("a.geojson", collection(above, ground, everywhere, both))
    levels = read_levels(path)
    assert [(each.name, each.ordinal, each.plan.level) for each in levels] == [
        ("0", 0, "0"), ("1", 1, "1"),
    ]  # fmt: skip
    for each, own in zip(levels, ([[0, 0], [8, 0]], [[0, 5], [9, 5]]), strict=True):
        expected = [own, [[0, 0], [0, 5]], [[8, 0], [8, 5]]]
        assert sorted(each.plan.segments_m.tolist()) == sorted(expected)
        alone = read_plan_geojson(path, level=each.name)
        np.testing.assert_array_equal(each.plan.segments_m, alone.segments_m)


@pytest.mark.parametrize(
    ("names", "ordinals"),
    [
        (["-1", "0.5", "12"], [-1, 0.5, 12]),
        (["Ground", "First"], [0, 1]),
        (["0", "roof"], [0, 1]),
        (["nan", "1e9"], [0, 1]),
    ],
)
def test_levels_are_in_order_of_their_numbers_else_of_the_file(put, names, ordinals):
    line = [[30.38, 60.007], [30.3801, 60.007]]
    listed = [
        feature("LineString", [[x, y + k * 1e-4] for x, y in line], level=name)
        for k, name in enumerate(names)
    ]
    levels = read_levels(put("a.geojson", collection(*listed)))
    assert [(each.name, each.ordinal) for each in levels] == list(zip(names, ordinals, strict=True))
    assert len({each.plan.origin for each in levels}) == 1
    northing = [each.plan.segments_m[0, 0, 1] for each in levels]
    assert np.diff(northing) == pytest.approx(11.1, abs=0.1)


def test_gzip_and_its_bomb(put, says, monkeypatch):
    packed = gzip.compress(json.dumps(HALL).encode())
    assert read_plan_geojson(put("a.geojson.gz", packed)).size_m.tolist() == [8, 5]
    monkeypatch.setattr("palms.io.packed.MAX_BYTES", 1_000_000)
    bomb = gzip.compress(b" " * 50_000_000)
    with pytest.raises(FormatError) as caught:
        read_plan_geojson(put("bomb.geojson.gz", bomb))
    says(caught.value, "more")


@pytest.mark.parametrize(
    "content",
    [
        collection(),
        {"type": "FeatureCollection", "features": 3},
        collection(3),
        collection(feature("Polygon", [[1, 2], [3, 4]])),
        collection(feature("LineString", [[0, 0], [float("nan"), 1]])),
        collection(feature("LineString", [[0, 0], ["a", 1]])),
        collection(feature("LineString", [[0, 0], [10**400, 1]])),
        collection(feature("Curve", [[0, 0]])),
        collection(feature("Point", [0, 0])),
        {"type": "GeometryCollection", "geometries": None},
        collection(feature("LineString", [[0, 0], [1e9, 1]])),
    ],
)
def test_wrong_content_is_refused_in_one_line(put, says, content):
    with pytest.raises(InputError) as caught:
        read_plan_geojson(put("a.geojson", content))
    says(caught.value, "a.geojson")


def test_stairs_are_known_by_their_class_whatever_they_are_called(put):
    square = [[[0, 0], [2, 0], [2, 3], [0, 3], [0, 0]]]
    beside = [[[5, 0], [7, 0], [7, 3], [5, 3], [5, 0]]]

    def level(name, *areas):
        lines = feature("LineString", [[0, 0], [20, 0]], indoor="wall", level=name)
        return [lines, *areas]

    shaft = feature("Polygon", square, indoor="room", room="stairs", level="0;1", ref="T1")
    lift = feature("Polygon", beside, indoor="elevator", level="0")
    office = feature("Polygon", beside, indoor="room", name="Office", level="1")
    path = put("a.geojson", collection(shaft, *level("0", lift), *level("1", office)))
    building = read_building(path)
    assert building.names == ("0", "1")
    assert [(each.name, each.position_m.tolist()) for each in building.stairs] == [
        ("stairs", [1.0, 1.5])
    ]
    assert [len(each.stairs) for each in read_levels(path)] == [2, 1]  # the lift leads nowhere


def test_one_level_is_a_building_of_one(put):
    building = read_building(put("a.geojson", HALL))
    assert len(building.levels) == 1
    assert building.stairs == ()
