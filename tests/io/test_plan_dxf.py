from __future__ import annotations

import sys

import numpy as np
import pytest

from palms.errors import FormatError, InputError, PalmsWarning
from palms.floorplan import SegmentClass
from palms.io import FLOORPLANS, read_any
from palms.io.plan_dxf import read_plan_dxf

ezdxf = pytest.importorskip("ezdxf")
BOX = [(0, 0), (8000, 0), (8000, 5000), (0, 5000)]


@pytest.fixture
def drawing(tmp_path):
    """A drawing in millimetres with a room; `draw` adds to it; returns its path."""

    def make(draw=None, units=4, walls=True):
        document = ezdxf.new(units=units)
        space = document.modelspace()
        if walls:
            space.add_lwpolyline(BOX, close=True, dxfattribs={"layer": "A-WALL"})
        if draw is not None:
            draw(document, space)
        document.saveas(tmp_path / "a.dxf")
        return tmp_path / "a.dxf"

    return make


def on(layer):
    return {"dxfattribs": {"layer": layer}}


def test_units_come_from_the_drawing(drawing):
    assert read_plan_dxf(drawing()).size_m == pytest.approx([8, 5])
    assert read_plan_dxf(drawing(units=1)).size_m == pytest.approx([8 * 25.4, 5 * 25.4])


def test_an_unknown_unit_is_asked_for(drawing, says):
    path = drawing(units=0)
    with pytest.raises(InputError) as caught:
        read_plan_dxf(path)
    says(caught.value, "$INSUNITS 0", "scale=0.001")
    assert read_plan_dxf(path, scale=0.001).size_m == pytest.approx([8, 5])


def test_a_unit_that_makes_it_absurd_is_refused_with_the_factor(drawing, says):
    with pytest.raises(FormatError) as caught:
        read_plan_dxf(drawing(units=6))
    says(caught.value, "multiply by 0.001", "scale=")


def test_layers_by_pattern(drawing, says):
    def draw(document, space):
        space.add_line((0, 2000), (8000, 2000), **on("Trennwand"))
        space.add_line((1, 1), (2, 2), **on("Moebel"))
        space.add_line((0, 0), (0, 5000), **on("fachada"))

    path = drawing(draw, walls=False)
    with pytest.warns(PalmsWarning, match="2 lines on layers"):
        assert len(read_plan_dxf(path).segments_m) == 1
    with pytest.warns(PalmsWarning, match="Moebel"):
        assert read_plan_dxf(path, walls="fachada").size_m.tolist() == [0, 5]
    with pytest.raises(InputError) as caught:
        read_plan_dxf(path, walls="nothing")
    says(caught.value, "fachada (1)", "walls=PATTERN")
    with pytest.raises(InputError, match="regular expression"):
        read_plan_dxf(path, walls="(")


def test_entities_of_many_kinds(drawing):
    def draw(document, space):
        space.add_arc((4000, 2500), 1000, 0, 180, **on("wall"))
        space.add_circle((4000, 2500), 500, **on("column"))
        space.add_mline([(1000, 1000), (2000, 1000)], **on("wall"))
        space.add_polyline2d([(0, 0), (1000, 1000)], **on("wall"))
        space.add_spline([(0, 0), (1, 1), (500, 900)], **on("wall"))
        space.add_ellipse((4000, 2500), (900, 0), 0.5, **on("wall"))

    plan = read_plan_dxf(drawing(draw))
    points = plan.segments_m.reshape(-1, 2)
    away = np.hypot(*(points - [4, 2.5]).T)
    assert (np.abs(away - 1) < 0.01).sum() > 10
    assert (np.abs(away - 0.5) < 0.01).sum() > 10
    assert (np.abs(points - [2, 1]).max(axis=1) < 0.6).any()


def swing_block(document):
    block = document.blocks.new("DOOR90")
    block.add_line((0, 0), (0, 900))  # the leaf, open
    block.add_arc((0, 0), 900, 0, 90)


@pytest.mark.parametrize("layer", ["A-DOOR", "0"])
def test_a_door_block_is_the_segment_that_its_leaf_fills(drawing, layer):
    def draw(document, space):
        swing_block(document)
        space.add_blockref("DOOR90", (3000, 0), **on(layer))

    plan = read_plan_dxf(drawing(draw))
    (door,) = plan.of_class(SegmentClass.DOOR)
    assert door == pytest.approx(np.array([[3, 0], [3.9, 0]]), abs=1e-6)
    walls = plan.of_class(SegmentClass.WALL)
    assert len(walls) == 5  # the door is cut out


def test_blocks_are_turned_scaled_and_nested(drawing):
    def draw(document, space):
        swing_block(document)
        outer = document.blocks.new("FLAT")
        outer.add_blockref("DOOR90", (0, 0), dxfattribs={"rotation": 90, "layer": "A-DOOR"})
        space.add_blockref("FLAT", (8000, 2000), dxfattribs={"xscale": 2, "yscale": 2})

    (door,) = read_plan_dxf(drawing(draw)).of_class(SegmentClass.DOOR)
    assert door == pytest.approx(np.array([[8, 2], [8, 3.8]]), abs=1e-6)


def test_rooms_are_named_by_the_text_in_them(drawing):
    def draw(document, space):
        space.add_lwpolyline(BOX, close=True, dxfattribs={"layer": "A-AREA"})
        space.add_text("Lab 242", **on("text")).set_placement((2000, 2000))
        space.add_text("North", **on("text")).set_placement((90_000, 2000))

    plan = read_plan_dxf(drawing(draw))
    assert plan.room_at([4, 2]) == "Lab 242"


def test_a_bomb_of_blocks_is_refused(drawing, says, monkeypatch):
    monkeypatch.setattr("palms.io.plan_dxf._MAX_ENTITIES", 5000)

    def draw(document, space):
        document.blocks.new("B0").add_line((0, 0), (1, 1), **on("wall"))
        for k in range(1, 7):
            block = document.blocks.new(f"B{k}")
            for i in range(10):
                block.add_blockref(f"B{k - 1}", (i, 0))
        space.add_blockref("B6", (0, 0))

    with pytest.raises(FormatError) as caught:
        read_plan_dxf(drawing(draw))
    says(caught.value, "at most 5,000 entities")


def test_a_dwg_is_named(put, says):
    with pytest.raises(FormatError) as caught:
        read_plan_dxf(put("a.dxf", b"AC1032" + bytes(100)))
    says(caught.value, "a DWG drawing", "save it as DXF")


def test_without_ezdxf_the_extra_is_named(drawing, says, monkeypatch):
    path = drawing()
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(InputError) as caught:
        read_any(FLOORPLANS, path)
    says(caught.value, "palms-localization[dxf]")
