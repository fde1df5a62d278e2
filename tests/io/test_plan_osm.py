from __future__ import annotations

import numpy as np
import pytest

from palms.errors import FormatError, InputError
from palms.floorplan import SegmentClass
from palms.io import FLOORPLANS, choose_format, read_any, read_levels
from palms.io.osm_elements import parse_levels
from palms.io.plan_osm import read_plan_osm

M = 1 / 111_319.49  # degrees of a metre at the equator
ORIGIN = (0.0, 0.0)


class Map:
    """An OSM file in the making; coordinates in metres, nodes shared by place."""

    def __init__(self):
        self.nodes, self.tagged, self.rest = {}, {}, []

    def node(self, x, y, **tags):
        key = self.nodes.setdefault((x, y), len(self.nodes) + 1)
        self.tagged.setdefault(key, {}).update(tags)
        return key

    def way(self, points, identity=None, **tags):
        refs = "".join(f"<nd ref='{self.node(*point)}'/>" for point in points)
        identity = identity or 100 + len(self.rest)
        self.rest.append(f"<way id='{identity}'>{refs}{self.tags(tags)}</way>")
        return identity

    def ring(self, points, identity=None, **tags):
        return self.way([*points, points[0]], identity, **tags)

    def relation(self, members, **tags):
        inside = "".join(f"<member type='way' ref='{i}' role='{role}'/>" for i, role in members)
        self.rest.append(f"<relation id='7'>{inside}{self.tags(tags)}</relation>")

    @staticmethod
    def tags(tags):
        return "".join(f"<tag k='{k.replace('__', ':')}' v='{v}'/>" for k, v in tags.items())

    def text(self):
        nodes = "".join(
            f"<node id='{key}' lon='{x * M:.10f}' lat='{y * M / 0.99330562:.10f}'>"
            f"{self.tags(self.tagged[key])}</node>"
            for (x, y), key in self.nodes.items()
        )
        return f"<?xml version='1.0'?><osm version='0.6'>{nodes}{''.join(self.rest)}</osm>"


def box(x0, y0, x1, y1):
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


@pytest.fixture
def house():
    """Two rooms over a corridor within a building, on level 0; doors are nodes."""
    found = Map()
    found.ring([(0, 0), (8, 0), (8, 2), (8, 6), (0, 6), (0, 2)], 1, building="yes", name="House",
               name__fr="Maison")  # fmt: skip
    found.ring([(0, 2), (2, 2), (4, 2), (4, 6), (0, 6)], indoor="room", level="0", name="Lab")
    found.ring([(4, 2), (6, 2), (8, 2), (8, 6), (4, 6)], indoor="room", level="0", ref="12")
    found.ring([(0, 0), (8, 0), (8, 2), (4, 2), (0, 2)], indoor="corridor", level="0",
               name="Hall", name__fr="Couloir")  # fmt: skip
    found.node(2, 2, door="hinged", width="1.2 m")
    found.node(6, 2, door="yes")
    return found


def segments(plan, kind):
    return {tuple(np.sort(each, axis=0).round(2).ravel() + 0.0)
            for each in plan.of_class(kind)}  # fmt: skip


def test_rooms_are_walls_and_corridors_none(house, put):
    plan = read_plan_osm(put("a.osm", house.text()), origin=ORIGIN)
    assert plan.size_m == pytest.approx([8, 6], abs=1e-3)
    assert (plan.name, plan.level, plan.origin.lon_deg) == ("House", "0", 0.0)
    walls = segments(plan, SegmentClass.WALL)
    assert (4, 2, 4, 6) in walls
    assert (0, 0, 8, 0) in walls  # the building's
    assert segments(plan, SegmentClass.DOOR) == {(1.4, 2, 2.6, 2), (5.55, 2, 6.45, 2)}
    assert {(0, 2, 1.4, 2), (2.6, 2, 5.55, 2), (6.45, 2, 8, 2)} <= walls
    assert plan.room_at([1, 5]) == "Lab"
    assert plan.room_at([5, 5]) == "12"
    assert plan.room_at([5, 1]) == "Hall"


def test_without_the_shell_and_in_another_language(house, put):
    path = put("a.osm", house.text())
    plan = read_plan_osm(path, shell=False, language="fr", origin=ORIGIN, door_width=0.8)
    assert plan.name == "Maison"
    assert plan.room_at([5, 1]) == "Couloir"
    assert plan.bounds_m[0] == pytest.approx([0, 2], abs=1e-3)
    assert (5.6, 2, 6.4, 2) in segments(plan, SegmentClass.DOOR)


def test_the_middle_of_all_levels_is_the_origin(house, put):
    house.ring(box(0, 0, 20, 6), indoor="area", level="1")
    plan = read_plan_osm(put("a.osm", house.text()), level="0")
    assert plan.bounds_m[0] == pytest.approx([-10, -3], abs=0.02)
    assert plan.origin.to_lonlat(plan.bounds_m[0]) == pytest.approx([0, 0], abs=2e-7)


def test_levels_are_listed_and_chosen_by_number_name_ref_and_id(house, put, says):
    house.ring(box(0, 0, 8, 6), 55, indoor="level", level="1", name="First floor", level__ref="1F")
    house.ring(box(0, 2, 8, 6), indoor="room", level="1", name="Attic")
    path = put("a.osm", house.text())
    with pytest.raises(InputError) as caught:
        read_plan_osm(path)
    says(caught.value, "one of 0; 1 (First floor)", "2 levels", "level=")
    for name in ("1", "1.0", "First floor", "1F", "55"):
        plan = read_plan_osm(path, level=name, origin=ORIGIN)
        assert (plan.level, [room.name for room in plan.rooms]) == ("First floor", ["Attic"])
        assert not len(plan.of_class(SegmentClass.OPENING))
    assert read_plan_osm(path, level="0").room_at is not None
    with pytest.raises(InputError) as caught:
        read_plan_osm(path, level="7")
    says(caught.value, "one of 0; 1", "'7'")


def test_all_levels_are_a_building(house, put):
    house.ring(box(0, 0, 20, 6), indoor="level", level="1", name="First floor")
    house.ring(box(0, 0, 8, 2), indoor="room", level="1", name="Attic", repeat_on="3")
    levels = read_levels(put("a.osm", house.text()), origin=ORIGIN)
    told = [(each.name, each.ordinal) for each in levels]
    assert told == [("0", 0.0), ("First floor", 1.0), ("3", 3.0)]
    assert [room.name for room in levels[2].plan.rooms] == ["Attic"]
    assert levels[0].plan.origin == levels[1].plan.origin


@pytest.mark.parametrize(
    ("level", "repeat_on", "expected"),
    [
        ("2", "", {2}),
        ("0;2", "", {0, 2}),
        ("0-2", "", {0, 1, 2}),
        ("-2--1", "", {-2, -1}),
        ("-1-1", "", {-1, 0, 1}),
        ("0.5", "3", {0.5, 3}),
        ("", "5-7;-1", {5, 6, 7, -1}),
        ("roof", "", set()),
        ("2-0", "", {0, 1, 2}),
        ("nan;inf;1e999", "", set()),
    ],
)
def test_levels_as_people_write_them(level, repeat_on, expected):
    assert parse_levels({"level": level, "repeat_on": repeat_on}) == expected


def test_a_range_of_a_billion_levels_ends():
    assert len(parse_levels({"level": "0-1000000000"})) == 300


def test_a_door_repeated_on_another_level_is_not_on_this_one(house, put):
    house.node(6, 2, level="3")
    plan = read_plan_osm(put("a.osm", house.text()), origin=ORIGIN)
    assert segments(plan, SegmentClass.DOOR) == {(1.4, 2, 2.6, 2)}


def test_openings_windows_glass_and_entrances(house, put):
    house.node(2, 2, door="no")
    house.node(6, 2, door="yes")
    house.ring([(0, 0), (8, 0), (8, 2), (8, 4), (8, 6), (0, 6), (0, 4)], 1, building="yes")
    house.node(8, 4, window="yes", width="2")
    house.node(0, 4, entrance="main", width="150 cm")
    house.way([(2, 6), (2, 4)], indoor="wall", level="0", material="glass")
    plan = read_plan_osm(put("a.osm", house.text()), origin=ORIGIN)
    assert segments(plan, SegmentClass.OPENING) == {(1.4, 2, 2.6, 2)}
    assert segments(plan, SegmentClass.GLASS) == {(8, 3, 8, 5), (2, 4, 2, 6)}
    assert (0, 3.25, 0, 4.75) in segments(plan, SegmentClass.DOOR)
    assert {(8, 0, 8, 3), (8, 5, 8, 6), (0, 0, 0, 3.25)} <= segments(plan, SegmentClass.WALL)


def test_a_door_at_a_corner_lies_along_the_longer_side(put):
    found = Map()
    found.ring(box(0, 0, 8, 3), indoor="room", level="0")
    found.node(0, 0, door="yes", width="1")
    found.way([(20, 0), (20, 5)], indoor="wall", level="0")
    found.node(20, 5, door="yes", width="1")
    plan = read_plan_osm(put("a.osm", found.text()), origin=ORIGIN)
    assert segments(plan, SegmentClass.DOOR) == {(0, 0, 1, 0), (20, 4, 20, 5)}


@pytest.mark.parametrize(("width", "metres"), [("wide", 0.9), ("300", 0.9), ("90cm", 0.9),
                                              ("0,8", 0.8), ("4'", 1.2192)])  # fmt: skip
def test_widths_as_people_write_them(put, width, metres):
    found = Map()
    found.ring([(0, 0), (4, 0), (8, 0), (8, 3), (0, 3)], indoor="room", level="0")
    found.node(4, 0, door="yes", width=width.replace("'", "&apos;"))
    plan = read_plan_osm(put("a.osm", found.text()), origin=ORIGIN)
    (door,) = plan.of_class(SegmentClass.DOOR)
    assert np.hypot(*(door[1] - door[0])) == pytest.approx(metres, abs=1e-3)


def test_multipolygons_have_holes_and_rings_of_several_ways(put):
    found = Map()
    members = [
        (found.way([(0, 0), (9, 0), (9, 9)]), "outer"),
        (found.way([(0, 0), (0, 9), (9, 9)]), "outer"),
        (found.ring(box(3, 3, 6, 6)), "inner"),
        (found.way([(50, 50), (60, 50)]), "outer"),  # stays open
    ]
    found.relation(members, type="multipolygon", indoor="room", level="2", name="Court")
    plan = read_plan_osm(put("a.osm", found.text()), origin=ORIGIN)
    assert len(plan.segments_m) == 8
    assert plan.size_m == pytest.approx([9, 9], abs=1e-3)
    assert plan.room_at([1, 1]) == "Court"


def test_one_building_of_several(house, put, says):
    house.ring(box(100, 0, 120, 20), 2, building="yes", name="Other")
    house.ring(box(100, 0, 110, 20), indoor="room", level="0", name="Far")
    house.ring(box(300, 0, 310, 20), 3, building="yes")  # nothing mapped in it
    path = put("a.osm", house.text())
    both = read_plan_osm(path)
    assert both.size_m[0] == pytest.approx(120, abs=0.01)
    for name in ("Other", "2"):
        plan = read_plan_osm(path, building=name)
        assert plan.size_m == pytest.approx([20, 20], abs=0.01)
        assert [room.name for room in plan.rooms] == ["Far"]
    with pytest.raises(InputError) as caught:
        read_plan_osm(path, building="Third")
    says(caught.value, "House (id 1); Other (id 2); no name (id 3)", "'Third'")


def test_buildings_of_two_cities_are_refused(house, put, says):
    house.ring(box(90_000, 0, 90_020, 20), 2, building="yes", name="Other")
    house.ring(box(90_000, 0, 90_010, 20), indoor="room", level="0")
    path = put("a.osm", house.text())
    with pytest.raises(InputError) as caught:
        read_plan_osm(path)
    says(caught.value, "one building, at most 5000 m wide", "90009 x 20 m", "building=NAME")
    assert read_plan_osm(path, building="Other").size_m == pytest.approx([20, 20], abs=0.01)


def test_deleted_elements_and_missing_nodes_are_left_out(house, put):
    text = house.text().replace("<way id='101'>", "<way id='101' action='delete'>")
    text = text.replace("<nd ref='1'/>", "<nd ref='999'/>")
    plan = read_plan_osm(put("a.osm", text))
    assert "Lab" not in {room.name for room in plan.rooms}


@pytest.mark.parametrize(
    ("text", "got"),
    [
        ("<osm/>", "none"),
        ("<osm><node id='1' lon='1' lat='1'/></osm>", "none"),
        ("<osm><way id='1'><tag k='indoor' v='wall'/></way></osm>", "none"),
        ("<osm><node id='x' lon='1' lat='1'/></osm>", "'x'"),
        ("<osm><node id='1' lon='nan' lat='1'/></osm>", "nan, 1"),
        ("<osm><node id='1' lat='99'/></osm>", "None, 99"),
        ("<osm><node id='1'", "unclosed token"),
        ("<osm></way>", "mismatched tag"),
        ("<html><body/></html>", "<html>"),
        ("<osm>" + "<a>" * 500, "deeper"),
    ],
)
def test_what_is_no_plan_is_refused_in_one_line(put, says, text, got):
    with pytest.raises(FormatError) as caught:
        read_plan_osm(put("a.osm", text))
    says(caught.value, "a.osm", got)


ENTITY = '<!DOCTYPE osm [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>'


@pytest.mark.parametrize(
    "declared",
    [
        ENTITY,
        '<!DOCTYPE osm [<!ENTITY a SYSTEM "/etc/passwd">]>',
        '<!DOCTYPE osm [<!ENTITY % a "x">]>',
    ],
)
def test_entities_are_refused(put, says, declared):
    path = put("a.osm", f"<?xml version='1.0'?>{declared}<osm><a>&b;</a></osm>")
    assert choose_format(FLOORPLANS, path).name == "osm"
    with pytest.raises(FormatError) as caught:
        read_any(FLOORPLANS, path)
    says(caught.value, "entity", "save it again")


def test_too_many_elements_are_refused(house, put, says, monkeypatch):
    monkeypatch.setattr("palms.io.xml_events.MAX_ELEMENTS", 20)
    with pytest.raises(FormatError) as caught:
        read_plan_osm(put("a.osm", house.text()))
    says(caught.value, "at most 20 elements")


def test_half_a_million_members_of_a_relation_take_no_time(put):
    found = Map()
    found.ring(box(0, 0, 9, 9), 5, indoor="room", level="0")
    found.relation([(5, "outer")] * 100_000, type="multipolygon", indoor="area", level="0")
    plan = read_plan_osm(put("a.osm", found.text()), origin=ORIGIN)
    assert plan.size_m == pytest.approx([9, 9], abs=1e-3)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "iso-8859-1"])
def test_encodings(house, put, encoding):
    said = f"encoding='{encoding}'" if encoding.startswith("iso") else ""
    text = house.text().replace("Lab", "Café").replace("version='1.0'", f"version='1.0' {said}")
    path = put("a.osm", text.encode(encoding))
    assert choose_format(FLOORPLANS, path).name == "osm"
    assert "Café" in {room.name for room in read_plan_osm(path).rooms}
