from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.errors import FormatError, InputError, OutputError, PalmsWarning
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.io.plan_csv import FORMAT, plan_name, read_plan_csv, rooms_path, write_plan_csv

SQUARE = [[[0, 0], [8, 0]], [[8, 0], [8, 5]], [[8, 5], [0, 5]], [[0, 5], [0, 0]]]


@pytest.mark.parametrize(
    "text",
    [
        "0,0,8,0\n8,0,8,5\n",
        "x1,y1,x2,y2\n0,0,8,0\n8,0,8,5",
        "\ufeff0,0,8,0\r\n8,0,8,5\r\n",
        "\n\n0, 0, 8, 0\n\n  \n 8 ,0,\t8,5  \n\n",
        "0,0,8,0,\n8,0,8,5,,,\n",
        "x1,y1,x2,y2 (m, local; doors cut, or not)\n0,0,8,0\n8,0,8,5\n",
        '"x1","y1","x2","y2"\r"0","0","8","0"\r"8","0","8","5"\r',
        "0;0;8;0\n8;0;8,0;5,0\n",
        "0\t0\t8\t0\n8\t0\t8\t5\n",
        ",a,b\n0,0,8,0,wall\n8,0,8,5,WALL\n",
    ],
)
def test_ways_to_write_the_same_plan(put, text):
    plan = read_plan_csv(put("hall.csv", text))
    assert plan.segments_m.tolist() == [[[0, 0], [8, 0]], [[8, 0], [8, 5]]]
    assert not plan.classes.any()
    assert plan.name == "hall"


def test_classes(put):
    rows = "".join(f"{i},0,{i},5,{c}\n" for i, c in enumerate(["wall", "Door", "opening", "glass"]))
    assert read_plan_csv(put("a.csv", rows)).classes.tolist() == [0, 1, 2, 3]


def test_unknown_classes_are_walls_and_reported_once(put):
    path = put("a.csv", "0,0,8,0,fence\n8,0,8,5,hedge\n8,5,0,5,fence\n0,5,0,0,door\n")
    with pytest.warns(PalmsWarning) as caught:
        plan = read_plan_csv(path)
    assert len(caught) == 1
    assert "'fence', 'hedge' in 3 rows" in str(caught[0].message)
    assert plan.classes.tolist() == [0, 0, 0, 1]


def test_segments_without_length_are_left_out_with_a_count(put):
    with pytest.warns(PalmsWarning, match="1 of 3 segments"):
        plan = read_plan_csv(put("a.csv", "0,0,8,0\n9,9,9,9\n8,0,8,5\n"))
    assert len(plan.segments_m) == 2


@pytest.mark.parametrize(
    ("row", "got"),
    [
        ("1,2,3", "3 cells"),
        ("1,2,3,4,5,6", "6 cells"),
        ("1,2,x,4", "'x'"),
        ("1,,3,4", "''"),
        ("1,2,nan,4", "'nan'"),
        ("1,2,inf,4", "'inf'"),
        ("1,2,3,1e400", "'1e400'"),
        ("1 2 3 4", "'1 2 3 4'"),
    ],
)
def test_a_bad_row_is_named(put, says, row, got):
    with pytest.raises(FormatError) as caught:
        read_plan_csv(put("a.csv", f"x1,y1,x2,y2\n0,0,8,0\n{row}\n"))
    says(caught.value, "a.csv line 3", got)


@pytest.mark.parametrize(
    ("content", "got"),
    [
        ("", "an empty file"),
        ("x1,y1,x2,y2\n", "no row with numbers"),
        ('{"type": "FeatureCollection"}', "JSON"),
        ('{\n "type": 1,\n "b": 2}', "JSON"),
        ("<svg>\n<g>\n</svg>", "XML"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "a PNG image"),
    ],
)
def test_wrong_format(put, says, content, got):
    with pytest.raises(FormatError) as caught:
        read_plan_csv(put("a.csv", content))
    says(caught.value, "a.csv", got)


@pytest.mark.parametrize(
    ("content", "hint"),
    [
        ("0,0,80000,0\n0,0,0,30000\n", "millimetres"),
        ("0,0,1e300,0\n0,0,-1e300,1e308\n", "metres"),
        ("0,0,0.01,0\n", "convert it to metres"),
        ("0,0,8,0,door\n", "at least one wall"),
    ],
)
def test_absurd_plans(put, says, content, hint):
    with pytest.raises(FormatError) as caught:
        read_plan_csv(put("a.csv", content))
    says(caught.value, "a.csv", hint)


def test_only_segments_without_length(put, says):
    with pytest.warns(PalmsWarning), pytest.raises(FormatError) as caught:
        read_plan_csv(put("a.csv", "1,1,1,1\n"))
    says(caught.value, "at least one wall")


def test_folder_and_missing(tmp_path, says):
    for path in (tmp_path, tmp_path / "none.csv"):
        with pytest.raises(InputError) as caught:
            read_plan_csv(path)
        says(caught.value)


@pytest.mark.parametrize(
    ("name", "expected"),
    [("a.csv", "a"), ("a.geojson.csv", "a"), ("F2.5.csv", "F2.5"), (".csv", ".csv")],
)
def test_plan_names(name, expected):
    assert plan_name(name) == expected


def test_rooms_beside_the_plan(tmp_path):
    rooms = (
        Room("Hall", [[0, 0], [4, 0], [4, 5], [0, 5]]),
        Room("Büro 2", [[4, 0], [8, 0], [8, 5]]),
    )
    outline = [[0, 0], [8, 0], [8, 5], [0, 5]]
    plan = FloorPlan(SQUARE, rooms=rooms, outline_m=outline, level="2")
    write_plan_csv(plan, tmp_path / "a.csv")
    again = read_plan_csv(tmp_path / "a.csv")
    assert [room.name for room in again.rooms] == ["Hall", "Büro 2"]
    assert again.rooms[1].polygon_m.tolist() == rooms[1].polygon_m.tolist()
    assert again.outline_m.tolist() == outline
    assert again.level == "2"
    assert again.room_at([1, 1]) == "Hall"


def test_stale_rooms_are_removed(tmp_path):
    path = tmp_path / "a.csv"
    write_plan_csv(FloorPlan(SQUARE, rooms=(Room("Hall", [[0, 0], [4, 0], [4, 5]]),)), path)
    write_plan_csv(FloorPlan(SQUARE), path)
    assert not rooms_path(path).exists()
    assert read_plan_csv(path).rooms == ()


@pytest.mark.parametrize(
    "rooms",
    [
        "",
        "[]",
        '{"features": 1}',
        '{"features": [1]}',
        '{"features": [{"properties": {"name": "a"}, "geometry": {"type": "Polygon"}}]}',
        '{"features": [{"properties": {"name": "a"}, '
        '"geometry": {"type": "Polygon", "coordinates": [[[0, 0], [1, 1]]]}}]}',
        '{"features": [{"properties": {"name": "a"}, '
        '"geometry": {"type": "Polygon", "coordinates": [[[0, 0], [1, NaN], [2, 2]]]}}]}',
    ],
)
def test_bad_rooms(put, says, rooms):
    path = put("a.csv", "0,0,8,0\n")
    put("a.rooms.geojson", rooms)
    with pytest.raises(FormatError) as caught:
        read_plan_csv(path)
    says(caught.value, "a.rooms.geojson")


def test_other_features_are_ignored(put):
    path = put("a.csv", "0,0,8,0\n")
    point = {"geometry": {"type": "Point", "coordinates": [0, 0]}, "properties": None}
    put("a.rooms.geojson", {"features": [point, {"geometry": None}]})
    assert read_plan_csv(path).rooms == ()


def test_unwritable(unwritable, says):
    with pytest.raises(OutputError) as caught:
        write_plan_csv(FloorPlan(SQUARE), unwritable / "a.csv")
    says(caught.value)


coordinate = st.floats(-2000, 2000, allow_nan=False)
segment = st.tuples(coordinate, coordinate, coordinate, coordinate)


@settings(derandomize=True, deadline=None, max_examples=60)
@given(st.lists(st.tuples(segment, st.sampled_from(SegmentClass)), max_size=20))
def test_round_trip_is_exact(tmp_path_factory, drawn):
    rows = [[[0, 0], [8, 0]], *[[s[:2], s[2:]] for s, _ in drawn if s[:2] != s[2:]]]
    classes = [0, *[c for s, c in drawn if s[:2] != s[2:]]]
    plan = FloorPlan(rows, classes)
    path = tmp_path_factory.mktemp("plan") / "a.csv"
    write_plan_csv(plan, path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        again = read_plan_csv(path)
    assert np.array_equal(again.segments_m, plan.segments_m)
    assert np.array_equal(again.classes, plan.classes)


@pytest.mark.parametrize(
    ("content", "fits"),
    [
        ("x1,y1,x2,y2\n1,2,3,4\n", True),
        ("1,2,3,4", True),
        ("1;2;3;4\n", True),
        ('{"a": 1}', False),
        ("[[[0, 1], [2, 3]]]", False),
        (b"\x89PNG\x00", False),
        ("", False),
        ("some text\nand more\n", False),
    ],
)
def test_recognizes(put, content, fits):
    assert FORMAT.recognizes(put("a.any", content)) is fits
