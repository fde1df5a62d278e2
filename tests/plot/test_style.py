import itertools

import matplotlib as mpl
import numpy as np
import pytest

from palms.belief import Stage
from palms.plot.output import image_bytes
from palms.plot.style import (
    ANSWER,
    ANY_DRIFT,
    GROUPS,
    INK,
    INTRUDER,
    STAGE_LINES,
    TRUTH,
    add_scale_bar,
    draw_particles,
    frame_map,
    groups_of,
    lightness,
    new_figure,
    styled,
)


def test_groups_stay_apart_in_grey():
    for a, b in itertools.combinations(GROUPS, 2):
        assert abs(lightness(a.colour) - lightness(b.colour)) > 10, (a, b)


@pytest.mark.parametrize("colour", [*(group.colour for group in GROUPS), ANSWER, TRUTH, INK])
def test_colours_stand_out_from_paper(colour):
    assert lightness(colour) < 80


def test_answer_and_truth_stay_apart_in_grey():
    assert lightness(TRUTH) - lightness(ANSWER) > 18
    assert lightness(INTRUDER) > lightness(INK) + 30


def test_nothing_is_said_by_colour_alone():
    assert len({group.marker for group in GROUPS}) == len(GROUPS)
    assert len({str(STAGE_LINES[stage]) for stage in Stage}) == len(Stage)


# Red-green blindness as Viénot, Brettel and Mollon (1999) simulate it, on linear RGB.
DEUTAN = np.array([[0.29275, 0.70725, 0], [0.29275, 0.70725, 0], [-0.02234, 0.02234, 1]])


def seen_by_deutan(colour):
    srgb = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    linear = np.clip(DEUTAN @ srgb**2.2, 0, 1)
    return linear ** (1 / 2.2)


def test_groups_stay_apart_for_the_red_green_blind():
    for a, b in itertools.combinations([*(g.colour for g in GROUPS), ANSWER], 2):
        assert np.linalg.norm(seen_by_deutan(a) - seen_by_deutan(b)) > 0.15, (a, b)


@pytest.mark.parametrize(("width", "words"), [(3.0, "0.5 m"), (30.0, "5 m"), (700.0, "100 m")])
def test_the_scale_bar_is_round_and_true(width, words):
    axes = new_figure(4, 3).add_subplot()
    frame_map(axes, (0, 0), (width, width / 2))
    (bar,) = [line for line in axes.lines if line.get_gid() == "scale-bar"]
    assert words in [text.get_text() for text in axes.texts]
    assert np.ptp(bar.get_xdata()) == pytest.approx(float(words.split()[0]))


def test_a_map_has_one_scale_both_ways_and_no_ticks():
    axes = new_figure(4, 3).add_subplot()
    frame_map(axes, (0, 0), (10, 5))
    assert axes.get_aspect() == 1.0
    assert not len(axes.get_xticks())
    assert not len(axes.get_yticks())


def test_the_scale_bar_lies_below_the_map():
    axes = new_figure(4, 3).add_subplot()
    frame_map(axes, (0, 0), (10, 5))
    bar = axes.lines[0]
    assert max(bar.get_ydata()) < 0
    add_scale_bar(axes)  # again, on the same axes: no error
    assert len(axes.lines) == 2


def test_groups_of_many_drifts_are_quarters_of_the_circle():
    drift = np.radians([0, 44, 46, 134, 136, 180, -136, -134, -46, -44])
    assert groups_of(np.arange(10), drift, by_label=False).tolist() == [
        0, 0, 1, 1, 2, 2, 2, 3, 3, 0
    ]  # fmt: skip
    assert groups_of(np.array([0, 1, 2, 3]), np.zeros(4), by_label=True).tolist() == [0, 1, 2, 3]


def test_rare_groups_lie_on_top():
    axes = new_figure(4, 3).add_subplot()
    group = np.array([0] * 5 + [1] * 2 + [2], np.int8)
    lines = draw_particles(axes, np.zeros((8, 2)), group)
    assert lines[2].get_zorder() > lines[1].get_zorder() > lines[0].get_zorder()
    assert [len(line.get_xdata()) for line in lines] == [5, 2, 1, 0, 0]
    assert lines[4].get_color() == ANY_DRIFT.colour


def test_the_users_own_style_changes_nothing():
    def draw():
        figure = new_figure(2, 2)
        figure.add_subplot().set_title("A title")
        return image_bytes(figure, dpi=50)

    plain = styled(draw)()
    with mpl.rc_context({"font.size": 20, "axes.titlesize": 30, "figure.facecolor": "red"}):
        assert styled(draw)() == plain
