from __future__ import annotations

import sys

import numpy as np
import pytest

from palms.errors import InputError
from palms.floorplan import SegmentClass
from palms.io import FLOORPLANS, choose_format, read_any, read_levels
from palms.io.plan_ifc import read_plan_ifc
from tests.io.floors import load_tool

pytest.importorskip("ifcopenshell")
TOOL = load_tool("plan_model")
THICK = 200.0  # millimetres, as all lengths below


class House:
    """A model in millimetres with walls 200 thick, in the making."""

    def __init__(self, prefix=".MILLI.", north=None, site=("$", "$")):
        model = self.model = TOOL.IfcModel()
        north = "$" if north is None else model.add("IFCDIRECTION", north)
        axes = model.add("IFCAXIS2PLACEMENT3D", model.point(0, 0, 0), "$", "$")
        self.context = model.add(
            "IFCGEOMETRICREPRESENTATIONCONTEXT", "$", "'Model'", "3", "1.E-5", axes, north
        )
        unit = model.add("IFCSIUNIT", "*", ".LENGTHUNIT.", prefix, ".METRE.")
        units = model.add("IFCUNITASSIGNMENT", f"({unit})")
        self.project = model.add("IFCPROJECT", model.identity(), "$", "'p'", "$", "$", "$", "$",
                                 f"({self.context})", units)  # fmt: skip
        at = model.placement(0, 0, 0)
        self.site = model.product("IFCSITE", "s", at, "$", "$", ".ELEMENT.", *site, "$", "$", "$")
        self.building = model.product("IFCBUILDING", "House", at, "$", "$", ".ELEMENT.", "$", "$",
                                      "$")  # fmt: skip
        self.storeys = {}

    def storey(self, name, z):
        self.storeys[name] = (z, [], [])
        return self

    def body(self, length, width, height):
        return self.model.body(self.model.rectangle(length, width), self.context, height)

    def put(self, kind, storey, at, size, *more, z=0.0, height=3000.0):
        """Put a box of a kind at the middle of its footprint; return its reference."""
        base, standing, _ = self.storeys[storey]
        placed = self.model.placement(*at, base + z)
        part = self.model.product(kind, "", placed, self.body(*size, height), *(more or ("$", "$")))
        standing.append(part)
        return part

    def hole(self, wall, storey, at, size, filling=None, *, z=0.0, height=2100.0):
        model = self.model
        placed = model.placement(*at, self.storeys[storey][0] + z)
        shape = self.body(*size, height)
        opening = model.product("IFCOPENINGELEMENT", "", placed, shape, "$", "$")
        model.add("IFCRELVOIDSELEMENT", model.identity(), "$", "$", "$", wall, opening)
        if filling:
            inner = (size[0], 60.0) if size[0] > size[1] else (60.0, size[1])
            part = self.put(filling, storey, at, inner, "$", "$", "$", "$", "$", "$", z=z,
                            height=height)  # fmt: skip
            model.add("IFCRELFILLSELEMENT", model.identity(), "$", "$", "$", opening, part)

    def room(self, storey, name, long_name, at, size):
        model = self.model
        placed = model.placement(*at, self.storeys[storey][0])
        long_name = f"'{long_name}'" if long_name else "$"
        self.storeys[storey][2].append(
            model.product("IFCSPACE", name, placed, self.body(*size, 2500.0), long_name,
                          ".ELEMENT.", "$", "$")
        )  # fmt: skip

    def box(self, storey, height=3000.0):
        """Four walls around 8 x 5 m, measured along their middles; return the lower one."""
        low = self.put("IFCWALL", storey, (4000, 0), (8200, THICK), "$", "$", height=height)
        self.put("IFCWALL", storey, (4000, 5000), (8200, THICK), height=height)
        for x in (0, 8000):
            self.put("IFCWALL", storey, (x, 2500), (THICK, 4800), height=height)
        return low

    def text(self):
        model = self.model
        TOOL._relate(model, "IFCRELAGGREGATES", self.project, [self.site])
        TOOL._relate(model, "IFCRELAGGREGATES", self.site, [self.building])
        found = []
        for name, (z, standing, rooms) in self.storeys.items():
            placed = model.placement(0, 0, z)
            storey = model.product("IFCBUILDINGSTOREY", name, placed, "$", "$", ".ELEMENT.",
                                   TOOL._real(z))  # fmt: skip
            found.append(storey)
            if standing:
                model.add("IFCRELCONTAINEDINSPATIALSTRUCTURE", model.identity(), "$", "$", "$",
                          f"({','.join(standing)})", storey)  # fmt: skip
            if rooms:
                TOOL._relate(model, "IFCRELAGGREGATES", storey, rooms)
        if found:
            TOOL._relate(model, "IFCRELAGGREGATES", self.building, found)
        return model.text()


def rows(plan, kind):
    return sorted(np.sort(each, axis=0).round(2).ravel().tolist() for each in plan.of_class(kind))


def test_walls_have_two_faces_and_doors_lie_in_their_middle(put):
    house = House().storey("Ground", 0.0)
    low = house.box("Ground")
    house.hole(low, "Ground", (3000, 0), (900, 400), "IFCDOOR")
    house.hole(low, "Ground", (6000, 0), (1200, 400), "IFCWINDOW", z=900.0, height=1200.0)
    house.hole(low, "Ground", (1500, 0), (600, 400), "IFCWINDOW", z=2200.0, height=500.0)  # above
    house.room("Ground", "12", "Office", (4000, 2500), (7800, 4800))
    plan = read_plan_ifc(put("a.ifc", house.text()))
    assert (plan.name, plan.level) == ("House", "Ground")
    assert plan.size_m == pytest.approx([8.2, 5.2])
    assert rows(plan, SegmentClass.DOOR) == [[2.55, 0, 3.45, 0]]
    assert rows(plan, SegmentClass.GLASS) == [[5.4, 0, 6.6, 0]]
    walls = rows(plan, SegmentClass.WALL)
    for face in ([0.1, 0.1, 2.55, 0.1], [-0.1, -0.1, 2.55, -0.1], [3.45, 0.1, 5.4, 0.1],
                 [2.55, -0.1, 2.55, 0.1], [0.1, 0.1, 0.1, 4.9]):  # fmt: skip
        assert face in walls
    assert plan.room_at([4, 2]) == "Office 12"


def test_an_opening_that_nothing_fills(put):
    house = House().storey("Ground", 0.0)
    low = house.box("Ground")
    house.hole(low, "Ground", (3000, 0), (1500, 900))  # deeper than the wall
    house.hole(low, "Ground", (6000, 0), (800, 400), z=1000.0)  # a hatch
    plan = read_plan_ifc(put("a.ifc", house.text()))
    assert rows(plan, SegmentClass.OPENING) == [[2.25, 0, 3.75, 0]]
    assert not len(plan.of_class(SegmentClass.DOOR))


def test_columns_and_curtain_walls(put):
    house = House().storey("Ground", 0.0)
    house.box("Ground")
    house.put("IFCCOLUMN", "Ground", (4000, 2500), (400, 400), "$", "$")
    house.put("IFCPLATE", "Ground", (6000, 2500), (2000, 20), "$", "$")
    house.put("IFCFURNITURE", "Ground", (2000, 2500), (900, 600), "$", "$")
    house.put("IFCWALL", "Ground", (2000, 4000), (900, 100), "$", "$", height=800.0)  # a low one
    path = put("a.ifc", house.text())
    plan = read_plan_ifc(path)
    assert [3.8, 2.3, 4.2, 2.3] in rows(plan, SegmentClass.WALL)
    assert [5, 2.51, 7, 2.51] in rows(plan, SegmentClass.GLASS)
    inner = [row for row in rows(plan, SegmentClass.WALL) if row[0] > 0.2 and row[2] < 3]
    assert inner == []
    low = read_plan_ifc(path, height=0.5)
    assert [1.55, 4.05, 2.45, 4.05] in rows(low, SegmentClass.WALL)


def test_storeys_are_listed_and_chosen(put, says):
    house = House().storey("Roof", 6000.0).storey("First floor", 3000.0).storey("Cellar", -2800.0)
    house.storey("Ground", 0.0)
    house.box("Ground")
    house.box("Cellar", 2700.0)
    house.put("IFCWALL", "First floor", (4000, 0), (8200, THICK), "$", "$")
    path = put("a.ifc", house.text())
    with pytest.raises(InputError) as caught:
        read_plan_ifc(path)
    says(caught.value, "Cellar (number -1, at -2.80 m", "Ground (number 0", "First floor (number 1",
         "3 storeys with walls", "level=")  # fmt: skip
    for level in ("First floor", "1"):
        plan = read_any(FLOORPLANS, path, None, [f"level={level}"])
        assert (plan.level, plan.size_m.tolist()) == ("First floor", pytest.approx([8.2, 0.2]))
    assert read_plan_ifc(path, level="-1").level == "Cellar"
    with pytest.raises(InputError) as caught:
        read_plan_ifc(path, level="9")
    says(caught.value, "'9'")
    with pytest.raises(InputError, match="at least one wall"):
        read_plan_ifc(path, level="Roof")


def test_all_storeys_with_walls_are_a_building(put):
    house = House().storey("Roof", 6000.0).storey("First floor", 3000.0).storey("Cellar", -2800.0)
    house.storey("Ground", 0.0)
    house.box("Ground")
    house.box("Cellar", 2700.0)
    house.put("IFCWALL", "First floor", (4000, 0), (8200, THICK), "$", "$")
    levels = read_levels(put("a.ifc", house.text()))
    assert [(each.name, each.ordinal) for each in levels] == [
        ("Cellar", -1.0), ("Ground", 0.0), ("First floor", 1.0)
    ]  # fmt: skip
    assert levels[1].plan.size_m == pytest.approx([8.2, 5.2])
    assert levels[2].plan.size_m == pytest.approx([8.2, 0.2])


def test_a_wall_from_below_reaches_up(put):
    house = House().storey("Ground", 0.0).storey("Upper", 3000.0)
    house.box("Ground", height=6000.0)
    house.put("IFCWALL", "Upper", (4000, 2500), (7800, 100), "$", "$")
    plan = read_plan_ifc(put("a.ifc", house.text()), level="Upper")
    assert plan.size_m == pytest.approx([8.2, 5.2])
    assert [0.1, 2.55, 7.9, 2.55] in rows(plan, SegmentClass.WALL)


def test_metres_and_where_on_earth(put):
    small = House("$", site=("(48,8,30,500000)", "(11,34,3,0)")).storey("Ground", 0.0)
    small.put("IFCWALL", "Ground", (4, 0), (8, 0.2), "$", "$", height=3.0)
    plan = read_plan_ifc(put("a.ifc", small.text()))
    assert plan.size_m == pytest.approx([8, 0.2])
    assert plan.origin.lon_deg == pytest.approx(11.5675)
    assert plan.origin.lat_deg == pytest.approx(48 + 8 / 60 + 30.5 / 3600)


def test_a_unit_that_is_wrong_is_refused_with_the_factor(put, says):
    house = House("$").storey("Ground", 0.0)  # millimetres that say they are metres
    house.hole(house.box("Ground"), "Ground", (3000, 0), (900, 400), "IFCDOOR")
    path = put("a.ifc", house.text())
    with pytest.raises(InputError) as caught:
        read_plan_ifc(path)
    says(caught.value, "multiply by 0.001", "scale=")
    plan = read_any(FLOORPLANS, path, None, ["scale=0.001"])
    assert plan.size_m == pytest.approx([8.2, 5.2], abs=0.01)
    assert rows(plan, SegmentClass.DOOR) == [[2.55, 0, 3.45, 0]]


def test_a_model_that_is_turned_against_north(put):
    house = House(north="(1.,0.)", site=("(48,0,0)", "(-11,-30,0)")).storey("Ground", 0.0)
    house.box("Ground")
    path = put("a.ifc", house.text())
    plain = read_plan_ifc(path)
    assert plain.size_m == pytest.approx([8.2, 5.2])
    assert plain.origin is None
    plan = read_plan_ifc(path, frame="earth")
    assert plan.size_m == pytest.approx([5.2, 8.2])
    assert plan.origin.lon_deg == pytest.approx(-11.5)


def test_what_is_no_model_is_refused(put, says):
    head = "ISO-10303-21;HEADER;FILE_SCHEMA(('IFC4'));ENDSEC;DATA;"
    tail = "ENDSEC;END-ISO-10303-21;"
    wall = "#1=IFCBUILDINGSTOREY($,$,$,$,$,#1,$,$,.ELEMENT.,#1);"
    for text in (head + tail, head, head + wall + tail, head + "#1=IFCWALL(" + tail,
                 head.replace("IFC4", "IFC99") + tail, head + "#1=NOTHING();" + tail):  # fmt: skip
        with pytest.raises(InputError) as caught:
            read_plan_ifc(put("a.ifc", text))
        says(caught.value, "a.ifc")


def test_a_file_is_known_by_its_content(put):
    house = House().storey("Ground", 0.0)
    house.box("Ground")
    assert choose_format(FLOORPLANS, put("a.dxf", house.text())).name == "ifc"


def test_without_ifcopenshell_the_extra_is_named(put, says, monkeypatch):
    monkeypatch.setitem(sys.modules, "ifcopenshell", None)
    house = House().storey("Ground", 0.0)
    with pytest.raises(InputError) as caught:
        read_any(FLOORPLANS, put("a.ifc", house.text()))
    says(caught.value, "palms-localization[ifc]", "ifcopenshell")


def test_height_is_checked(put):
    with pytest.raises(InputError, match=r"a number from 0\.1 to 3"):
        read_plan_ifc(put("a.ifc", ""), height=20.0)


DAMAGES = {
    "a reference to nothing": lambda t: t.replace("#2,", "#99999,"),
    "a number gone": lambda t: t.replace("8200.", ""),
    "a letter for a number": lambda t: t.replace("3000.", "x"),
    "a huge number": lambda t: t.replace("8200.", "1.E300"),
    "a loop of placements": lambda t: t.replace("IFCLOCALPLACEMENT($", "IFCLOCALPLACEMENT(#8"),
    "half of the lines": lambda t: "\n".join(t.split("\n")[:9] + t.split("\n")[20:]),
    "lines twice": lambda t: t.replace("DATA;\n", "DATA;\n" + t.split("DATA;\n")[1][:3000]),
    "bytes that are no text": lambda t: t.replace("IFCWALL(", "IFCWALL(\x00\x01"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_models_give_a_plan_or_one_line(put, damage):
    house = House().storey("Ground", 0.0)
    house.hole(house.box("Ground"), "Ground", (3000, 0), (900, 400), "IFCDOOR")
    good = house.text()
    text = DAMAGES[damage](good)
    assert text != good
    path = put("a.ifc", text)
    try:
        found = str(len(read_plan_ifc(path).segments_m))
    except InputError as error:
        found = str(error)
        assert "a.ifc" in found
    assert found not in ("", "0")
    assert "\n" not in found
