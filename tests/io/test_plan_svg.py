from __future__ import annotations

import math

import numpy as np
import pytest

from palms.errors import FormatError, InputError, PalmsWarning
from palms.floorplan import SegmentClass
from palms.io import FLOORPLANS, choose_format, read_any
from palms.io.plan_svg import read_plan_svg
from palms.io.svg_paths import parse_path, parse_transform

SHELL = "<g id='walls'><rect x='0' y='0' width='800' height='500'/></g>"


@pytest.fixture
def svg(put):
    """Write a drawing of 800 x 500 units with some content; return its path."""

    def make(inside, head="viewBox='0 0 800 500'", name="a.svg"):
        return put(name, f"<svg xmlns='http://www.w3.org/2000/svg' {head}>{inside}</svg>")

    return make


def rows(plan, kind):
    return sorted(np.sort(each, axis=0).round(3).ravel().tolist() for each in plan.of_class(kind))


def test_the_lower_left_corner_is_the_origin_and_y_points_up(svg):
    plan = read_plan_svg(svg(SHELL + "<g id='wall2'><line x1='0' y1='100' x2='300' y2='100'/></g>"),
                         scale=0.01)  # fmt: skip
    assert plan.size_m.tolist() == [8, 5]
    assert [0, 4, 3, 4] in rows(plan, SegmentClass.WALL)


def test_every_shape_and_transform(svg):
    shapes = (
        "<g id='walls' transform='translate(100 0) scale(2)'>"
        "<polyline points='0,0 50,0 50,50'/><polygon points='0 200 50 200 50 240'/>"
        "<circle cx='200' cy='100' r='50'/><ellipse cx='200' cy='100' rx='20' ry='10'/>"
        "<path d='M0 100h10v10zm20 0l10 10'/><g transform='rotate(90)'>"
        "<line x1='10' y1='-10' x2='40' y2='-10'/></g></g>"
    )
    walls = rows(read_plan_svg(svg(shapes), scale=0.01), SegmentClass.WALL)
    for wall in ([1, 5, 2, 5], [2, 4, 2, 5], [1, 0.2, 2, 1], [1.0, 2.8, 1.2, 3.0],
                 [1.4, 2.8, 1.6, 3.0], [1.2, 4.2, 1.2, 4.8]):  # fmt: skip
        assert wall in walls
    points = np.array(walls).reshape(-1, 2)
    assert (np.abs(np.hypot(*(points - [5, 3]).T) - 1) < 0.002).sum() > 60


@pytest.mark.parametrize("where", ["id='Tueren'", "class='x door-leaf'", "inkscape:label='Doors'",
                                   "data-name='DOOR 1'"])  # fmt: skip
def test_names_may_be_ids_classes_and_labels_and_the_inner_one_counts(svg, where):
    inside = f"<g id='walls'><path d='M0 500H800'/><path {where} d='M300 500H400'/></g>"
    plan = read_plan_svg(svg(SHELL + inside), scale=0.01)
    assert rows(plan, SegmentClass.DOOR) == [[3, 0, 4, 0]]
    assert [0, 0, 3, 0] in rows(plan, SegmentClass.WALL)


def test_the_name_of_the_whole_drawing_says_nothing(svg):
    path = svg(SHELL + "<path d='M0 0L9 9'/>", "id='floor-with-doors' viewBox='0 0 800 500'")
    assert not len(read_plan_svg(path, scale=0.01).of_class(SegmentClass.DOOR))


def test_a_leaf_with_its_swing_becomes_the_door_shut(svg):
    door = "<g id='doors'><g><path d='M300 500V400'/><path d='M300 400A100 100 0 0 1 400 500'/></g>"
    plan = read_plan_svg(svg(SHELL + door + "</g>"), scale=0.01)
    assert rows(plan, SegmentClass.DOOR) == [[3, 0, 4, 0]]
    curve = "<g id='doors'><path d='M300 500V400C355.23 400 400 444.77 400 500'/></g>"
    (found,) = rows(read_plan_svg(svg(SHELL + curve), scale=0.01), SegmentClass.DOOR)
    assert found == pytest.approx([3, 0, 4, 0], abs=0.005)


def test_thin_areas_of_doors_and_glass_become_their_middle_line(svg):
    inside = ("<rect id='door-7' x='300' y='490' width='100' height='20'/>"
              "<rect id='window' x='790' y='100' width='20' height='200'/>")  # fmt: skip
    plan = read_plan_svg(svg(SHELL + inside), scale=0.01)
    assert rows(plan, SegmentClass.DOOR) == [[3, 0, 4, 0]]
    assert rows(plan, SegmentClass.GLASS) == [[8, 2, 8, 4]]


def test_rooms_are_named_by_title_label_text_or_id(svg):
    def room(x, head, inside=""):
        box = f"{x},10 {x + 90},10 {x + 90},90 {x},90"
        return f"<polygon points='{box}' {head}>{inside}</polygon>"

    inside = (
        "<g id='rooms'>" + room(0, "id='r1'", "<title>Lab\n 7</title>")
        + room(100, "data-name='12'") + room(200, "id='polygon8'") + room(300, "id='Big_hall'")
        + room(400, "id='g2'") + "</g>"
        "<text x='250' y='50'><tspan>Tea </tspan><tspan>kitchen</tspan></text>"
        "<text transform='translate(330 50)'>Foyer</text>"
    )  # fmt: skip
    plan = read_plan_svg(svg(SHELL + inside), scale=0.01)
    names = [plan.room_at([x / 100, 4.5]) for x in (50, 150, 250, 350, 450)]
    assert names == ["Lab 7", "12", "Tea kitchen", "Foyer", None]
    plain = read_plan_svg(svg(SHELL + inside.replace("Foyer", "")), scale=0.01)
    assert plain.room_at([3.5, 4.5]) == "Big hall"
    assert len(plan.of_class(SegmentClass.WALL)) == 4


def test_the_outlines_of_rooms_are_walls_where_no_name_says_wall(svg):
    inside = (
        "<g id='rooms'><rect id='A1' x='0' y='0' width='400' height='300'/></g><path d='M0 0L9 9'/>"
    )
    plan = read_plan_svg(svg(inside), scale=0.01)
    assert plan.size_m.tolist() == [4, 3]
    assert plan.room_at([1, 3]) == "A1"


def test_without_any_name_all_that_is_drawn_heavily_is_a_wall(svg):
    inside = (
        "<style>.g1{stroke:#000;stroke-width:6} .g2{display:none}</style>"
        "<rect width='800' height='500' fill='#fff'/>"
        "<path class='g1' fill='none' d='M0 0H800V500H400M300 500H0V0'/>"
        "<path class='g1' fill='none' d='M300 500V400' style='stroke-width:6px'/>"
        "<path class='g1' fill='none' stroke-width='1' d='M300 400A100 100 0 0 1 400 500'/>"
        "<path stroke='#333' style='stroke-width:1' d='M0 250H800'/>"
        "<path class='g2' stroke='black' d='M0 50H800'/>"
        "<g visibility='hidden'><path stroke='black' d='M0 60H800'/></g>"
        "<rect x='600' y='100' width='50' height='50'/>"
        "<path d='M10 10c5 5 10 5 10 20z'/><path fill='none' d='M0 0L800 500'/>"
    )
    plan = read_plan_svg(svg(inside), scale=0.01)
    assert rows(plan, SegmentClass.DOOR) == [[3, 0, 4, 0]]
    assert rows(plan, SegmentClass.WALL) == sorted([
        [0, 5, 8, 5], [8, 0, 8, 5], [4, 0, 8, 0], [0, 0, 3, 0], [0, 0, 0, 5],
        [6, 4, 6.5, 4], [6.5, 3.5, 6.5, 4], [6, 3.5, 6.5, 3.5], [6, 3.5, 6, 4],
    ])  # fmt: skip
    thin = rows(read_plan_svg(svg(inside), scale=0.01, min_stroke=0.5), SegmentClass.WALL)
    assert [0, 2.5, 8, 2.5] in thin


def test_use_repeats_a_symbol(svg):
    inside = (
        "<defs><g id='leaf'><path d='M0 0H100'/></g></defs>"
        "<symbol id='s'><path d='M0 0V9'/></symbol>"
        "<g id='doors'><use href='#leaf' x='100' y='500'/>"
        "<use xlink:href='#leaf' transform='translate(500 500)'/><use href='#gone'/></g>"
    )
    plan = read_plan_svg(svg(SHELL + inside, "xmlns:xlink='x' viewBox='0 0 800 500'"), scale=0.01)
    assert rows(plan, SegmentClass.DOOR) == [[1, 0, 2, 0], [5, 0, 6, 0]]


def test_scale_by_points_and_distance(svg, says):
    path = svg(SHELL)
    plan = read_plan_svg(path, points=(0, 0, 800, 0), distance=16)
    assert plan.size_m.tolist() == [16, 10]
    with pytest.raises(InputError) as caught:
        read_plan_svg(path)
    says(caught.value, "a drawing of 800 x 500 units", "scale=METRES per unit", "points=")
    with pytest.raises(InputError) as caught:
        read_plan_svg(path, points=(1, 1, 1, 1), distance=3)
    says(caught.value, "two points apart")


@pytest.mark.parametrize("width", ["80mm", "8cm", "3.1496062992in"])
def test_a_ratio_is_of_the_paper(svg, says, width):
    path = svg(SHELL, f"width='{width}' height='50mm' viewBox='0 0 800 500'")
    assert read_plan_svg(path, ratio=100).size_m == pytest.approx([8, 5])
    with pytest.raises(InputError) as caught:
        read_plan_svg(svg(SHELL, name="b.svg"), ratio=100)
    says(caught.value, "its width in mm", "scale=METRES")
    with pytest.raises(InputError, match="above 0"):
        read_plan_svg(path, ratio=-1)


@pytest.mark.parametrize(
    ("head", "low"),
    [
        ("width='900' height='600'", (0, 1)),
        ("viewBox='-100 -50 1000 600'", (1, 0.5)),
        ("width='100%'", (0, 0)),
    ],
)
def test_where_the_corner_is(svg, head, low):
    plan = read_plan_svg(svg(SHELL, head), scale=0.01)
    assert plan.bounds_m[0] == pytest.approx(low)


def test_patterns_of_ones_own(svg, says):
    path = svg("<g id='Fassade'><path d='M0 0H800V500'/></g><g id='Moebel'><path d='M1 1h9'/></g>")
    plan = read_plan_svg(path, scale=0.01, walls="fassade")
    assert plan.size_m.tolist() == [8, 5]
    with pytest.raises(InputError, match="regular expression"):
        read_plan_svg(path, scale=0.01, walls="(")


def test_what_is_left_out_is_said(svg):
    inside = SHELL + "".join(f"<g id='desk'><path d='M{i} 0v9'/></g>" for i in range(5))
    with pytest.warns(PalmsWarning, match="5 lines on layers 'desk'"):
        read_plan_svg(svg(inside), scale=0.01)


def test_an_absurd_scale_is_refused_with_the_factor(svg, says):
    with pytest.raises(FormatError) as caught:
        read_plan_svg(svg(SHELL), scale=10.0)
    says(caught.value, "multiply by", "scale=")


@pytest.mark.parametrize(
    "inside",
    [
        "",
        "<path d='M'/>",
        "<path d='M0 0L1'/>",
        "<path d='5 5'/>",
        "<path d='M0 0 X 5'/>",
        "<path d='M0 0A5 5 0 2 0 5 5'/>",
        "<path d='M0 0L1e99 5'/>",
        "<path stroke='black' d='M0 0L1e999 5'/>",
        "<g transform='matrix(1 2)'><path d='M0 0L9 9'/></g>",
        "<g transform='scale(1e99) scale(1e99)'><path d='M0 0L9 9'/></g>",
        "<rect width='-5' height='9'/>",
        "<circle r='nan'/>",
        "<polygon points='1 2 3'/>",
        "<g display='none'><path d='M0 0L9 9'/></g>",
        "<g>" * 150 + "<path d='M0'/>" + "</g>" * 150,
    ],
)
def test_damaged_drawings_are_refused_in_one_line(svg, says, inside):
    with pytest.raises(InputError) as caught:
        read_any(FLOORPLANS, svg(inside), None, ["scale=0.01"])
    says(caught.value, "a.svg")


def test_a_bomb_of_uses_is_refused(svg, says, monkeypatch):
    monkeypatch.setattr("palms.io.svg_elements.MAX_SHAPES", 5000)
    layers = "<g id='b0'><path d='M0 0L9 9'/></g>" + "".join(
        f"<g id='b{k}'>" + f"<use href='#b{k - 1}'/>" * 10 + "</g>" for k in range(1, 12)
    )
    with pytest.raises(FormatError) as caught:
        read_plan_svg(svg(layers), scale=0.01)
    says(caught.value, "at most 5,000 shapes")


def test_a_use_of_itself_ends(svg):
    path = svg(SHELL + "<g id='loop'><use href='#loop'/><path d='M0 0L9 9'/></g>")
    with pytest.warns(PalmsWarning, match="17 lines on layers 'loop'"):
        assert read_plan_svg(path, scale=0.01).size_m.tolist() == [8, 5]


def test_entities_are_refused_and_a_document_type_is_not(svg, put, says):
    svg_text = svg(SHELL).read_text()
    kind = '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/svg11.dtd">'
    path = put("b.svg", f"<?xml version='1.0'?>\n{kind}\n{svg_text}")
    assert choose_format(FLOORPLANS, path).name == "svg"
    assert read_plan_svg(path, scale=0.01).size_m.tolist() == [8, 5]
    bomb = '<!DOCTYPE svg [<!ENTITY a "aa"><!ENTITY b "&a;&a;">]>'
    path = put("c.svg", f"{bomb}{svg_text}")
    assert choose_format(FLOORPLANS, path).name == "svg"
    with pytest.raises(FormatError) as caught:
        read_plan_svg(path, scale=0.01)
    says(caught.value, "entity")


@pytest.mark.parametrize(
    ("data", "end"),
    [
        ("M1 1L2 3", (2, 3)),
        ("m1 1 1 2", (2, 3)),
        ("M1,1L2-3", (2, -3)),
        ("M.5.5L1.5.5", (1.5, 0.5)),
        ("M0 0h1v1H5V6", (5, 6)),
        ("M0 0c0 1 1 1 1 0s1-1 1 0", (2, 0)),
        ("M0 0q1 1 2 0t2 0", (4, 0)),
        ("M0 0a1 1 0 012 0", (2, 0)),
        ("M0 0A1 1 0 1 0 2 0", (2, 0)),
        ("M0 0L5 0L5 5Z", (0, 0)),
        ("M0 0L5 0ZL1 1", (1, 1)),
        ("M0 0A0 5 0 0 0 3 4", (3, 4)),
        ("M0 0L1e1-1E1", (10, -10)),
    ],
)
def test_path_data_of_all_commands(data, end):
    last = parse_path(data, "a.svg")[-1][-1].points[-1]
    assert last == pytest.approx(end)


def test_smooth_curves_reflect_only_after_their_own_kind():
    ((smooth,),) = parse_path("M0 0C0 1 1 1 1 0S2 -1 2 0", "a.svg")
    assert smooth.points[24] == pytest.approx([1.5, -0.75])  # the middle of the second curve
    (pieces,) = parse_path("M0 0L1 0S2 -1 2 0", "a.svg")
    assert pieces[1].points[8] == pytest.approx([1.5, -0.375])  # its handle is where it begins


@pytest.mark.parametrize("flags", ["0 0", "0 1", "1 0", "1 1"])
def test_arcs_lie_on_their_circle_on_the_side_that_the_flags_say(flags):
    ((arc,),) = parse_path(f"M3 0A3 3 0 {flags} 0 3", "a.svg")
    large, sweep = (each == "1" for each in flags.split())
    centre = [0, 0] if large != sweep else [3, 3]
    assert np.hypot(*(arc.points - centre).T) == pytest.approx(3)
    length = np.hypot(*np.diff(arc.points, axis=0).T).sum()
    assert length == pytest.approx(3 * math.pi * (1.5 if large else 0.5), rel=1e-3)


@pytest.mark.parametrize(
    ("text", "at"),
    [
        ("translate(10)", (11, 1)),
        ("translate(10 20)", (11, 21)),
        ("scale(2)", (2, 2)),
        ("scale(2,-1)", (2, -1)),
        ("rotate(90)", (-1, 1)),
        ("rotate(90 1 0)", (0, 0)),
        ("skewX(45)", (2, 1)),
        ("skewY(45)", (1, 2)),
        ("matrix(1 2 3 4 5 6)", (9, 12)),
        ("translate(1,1),scale(3)", (4, 4)),
    ],
)
def test_transforms(text, at):
    assert (parse_transform(text, "a.svg") @ [1, 1, 1])[:2] == pytest.approx(at)
