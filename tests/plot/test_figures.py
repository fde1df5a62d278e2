import numpy as np
import pytest
from matplotlib.collections import LineCollection

from palms import Estimate, FloorPlan, InputError, OutputError, Stage, Track
from palms.heatmap import find_candidates, match
from palms.io.files import write_bytes
from palms.places import find_places
from palms.plot import (
    Story,
    candidates_figure,
    empty_space_figure,
    image_bytes,
    pipeline_figure,
    plan_figure,
    stages_figure,
    track_figure,
    write_figure,
)
from palms.plot.empty_space import length_m, right_match, walls_inside, wrong_match
from palms.plot.style import GROUPS


def titles(figure):
    return [axes.get_title(loc="left") for axes in figure.axes if axes.get_title(loc="left")]


def artists(axes, gid):
    return [artist for artist in axes.get_children() if artist.get_gid() == gid]


def labels(figure):
    legends = [*figure.legends, *(axes.get_legend() for axes in figure.axes)]
    return [text.get_text() for legend in legends if legend for text in legend.get_texts()]


def maps(figure):
    return [axes for axes in figure.axes if artists(axes, "scale-bar")]


def test_plan_has_strokes_names_and_a_scale(plan):
    figure = plan_figure(plan)
    (axes,) = figure.axes
    assert titles(figure) == ["annex, level 1, 20 × 9 m"]
    assert labels(figure) == ["wall", "glass", "door", "opening"]
    assert maps(figure) == [axes]
    assert [text.get_text() for text in artists(axes, "room-name")] == ["West hall", "Lab 7"]
    assert all(artists(axes, f"plan-{word}") for word in ("wall", "glass", "door", "opening"))


def test_names_lie_inside_their_rooms(plan):
    figure = plan_figure(plan)
    figure.canvas.draw()
    for text in artists(figure.axes[0], "room-name"):
        box = text.get_window_extent().transformed(figure.axes[0].transData.inverted())
        for corner in box.corners():
            assert plan.room_at(corner) == text.get_text()


def test_plan_without_rooms_or_height():
    assert labels(plan_figure(FloorPlan([[[0, 0], [9, 0]]]))) == ["wall"]


def test_pipeline_has_its_five_steps(story):
    figure = pipeline_figure(story.heatmaps, story.candidates, truth_m=story.scan_place_m)
    found = titles(figure)
    assert [title[0] for title in found if title[0].isdigit()] == list("12345")
    assert sum("drift" in title for title in found) == 5
    assert len(maps(figure)) == 8
    assert "true place" in labels(figure)
    framed = [axes for axes in figure.axes if artists(axes, "group")]
    assert [artists(axes, "group")[0].get_color() for axes in framed] == [g.colour for g in GROUPS]
    assert {axes.spines["left"].get_linewidth() for axes in framed} == {3.0}
    assert len(artists(figure.axes[1], "truth")) == 1


def test_pipeline_of_many_drifts_shows_the_best_of_each_quarter(raster, scan):
    heatmaps = match(scan, raster, np.radians(np.arange(0, 360, 30)))
    figure = pipeline_figure(heatmaps, find_candidates(heatmaps))
    framed = [axes for axes in figure.axes if artists(axes, "group")]
    assert len(framed) == 4
    assert "drift 30°" in framed[0].get_title(loc="left")
    assert any(label.startswith("drift around 0°") for label in labels(figure))


def test_pipeline_of_one_drift(raster, scan):
    heatmaps = match(scan, raster, [0.5])
    figure = pipeline_figure(heatmaps, find_candidates(heatmaps))
    assert len([axes for axes in figure.axes if artists(axes, "group")]) == 1


def test_pipeline_needs_a_drift(raster, scan, story):
    with pytest.raises(InputError, match="at least one drift"):
        pipeline_figure(match(scan, raster, np.zeros(0)), story.candidates)


def test_empty_space_is_empty_only_at_the_right_place(story):
    right = right_match(story.heatmaps, story.scan_place_m)
    assert np.linalg.norm(right.position_m - story.scan_place_m) <= 0.5
    assert length_m(walls_inside(story.heatmaps, right)) < 0.1
    wrong = wrong_match(story.heatmaps, right.position_m)
    assert wrong is not None
    assert length_m(walls_inside(story.heatmaps, wrong)) > 1.0
    assert np.linalg.norm(wrong.position_m - right.position_m) >= 5.0


def test_empty_space_figure_says_how_much_wall_is_inside(story):
    figure = empty_space_figure(story.heatmaps, story.scan_place_m)
    first, second, third = titles(figure)
    assert first.startswith("1  The scan, turned by")
    assert second == "2  The right place: 0.0 m of wall inside"
    assert third.startswith("3  A wrong place: ")
    (red,) = artists(figure.axes[2], "intruder")
    assert isinstance(red, LineCollection)
    assert len(red.get_segments())
    assert len(maps(figure)) == 3
    assert "2  The best match: 0.0 m of wall inside" in titles(empty_space_figure(story.heatmaps))


def test_stages_have_a_row_for_each_method_and_a_column_for_each_moment(story, blind):
    moments = ("start", "t1", "t2", "end")
    figure = stages_figure({"paper": story, "uniform": blind}, moments)
    assert len(figure.axes) == 8
    assert titles(figure) == ["start", "$t_1$: oriented", "$t_2$: localized", "end"]
    assert len(maps(figure)) == 8
    under = [axes.get_xlabel() for axes in figure.axes]
    assert under[0].startswith("t = 0.5 s, ")
    assert under[0].endswith(" m off")
    assert under[7] == "t = 1.0 s"
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert "never oriented" in words
    assert "never localized" in words
    assert {"any drift", "drift θ", "answer", "true path"} <= set(labels(figure))


def test_stages_need_a_method():
    with pytest.raises(InputError, match="at least one method"):
        stages_figure({})


def test_candidates_are_numbered(plan, story):
    places = find_places(story.candidates)[:4]
    figure = candidates_figure(plan, places, story.scan, [2.0, 1.0])
    axes = figure.axes[0]
    assert sorted(t.get_text() for t in axes.texts if t.get_text().isdigit()) == list("1234")
    assert titles(figure)[0].startswith("Where the scan may have been taken on annex\n1: ")
    assert artists(axes, "scan")
    assert "true place" in labels(figure)
    first = artists(axes, "place")[-1]
    assert (first.get_xdata()[0], first.get_ydata()[0]) == (places[0].x_m, places[0].y_m)


def test_no_candidate_at_all(plan):
    assert titles(candidates_figure(plan, []))[0].endswith("nowhere")


def test_track_shows_stages_and_how_sure(plan, story):
    figure = track_figure(plan, story.track, story.truth_m)
    axes, metres, share = figure.axes
    at = story.track.localized_at_s
    assert titles(figure) == [f"Localized after {at:.1f} s"]
    assert artists(axes, "path-localized")
    assert artists(axes, "truth")
    assert artists(axes, "localized")
    assert {"error", "radius that holds 95 %", "true path", "answer, localized"} <= set(
        labels(figure)
    )
    assert artists(metres, "at-localized")[0].get_xdata()[0] == at
    assert share.get_xlabel() == "time in s"
    assert len(maps(figure)) == 1


def test_track_that_never_was_localized(plan, blind):
    figure = track_figure(plan, blind.track)
    assert titles(figure) == ["Never localized"]
    assert "error" not in labels(figure)


def test_track_with_gaps_in_answers_and_truth(plan):
    answers = [Estimate(0.5), Estimate(1.0, Stage.LOCALIZED, np.array([1.0, 1.0]), 0, 0, 1, 1)]
    truth = np.array([[1.0, 1.0], [np.nan, np.nan]])
    image_bytes(track_figure(plan, Track(0, tuple(answers)), truth), dpi=40)


def test_truth_must_be_as_long_as_the_track(plan, story):
    with pytest.raises(InputError, match="one for each answer"):
        track_figure(plan, story.track, story.truth_m[:-1])
    with pytest.raises(InputError, match="one for each answer"):
        Story(story.raster, story.odometry, story.track, story.recorder, truth_m=[[0.0, 0.0]])


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_the_same_story_gives_the_same_bytes(plan, story, kind):
    draw = {
        "png": lambda: pipeline_figure(story.heatmaps, story.candidates),
        "svg": lambda: plan_figure(plan),
        "pdf": lambda: track_figure(plan, story.track, story.truth_m),
    }[kind]
    assert image_bytes(draw(), kind, 50) == image_bytes(draw(), kind, 50)


def test_figures_are_written_whole_or_not_at_all(tmp_path, plan):
    path = tmp_path / "plan.png"
    write_figure(path, plan_figure(plan), 40)
    before = path.read_bytes()
    assert before.startswith(b"\x89PNG")
    with pytest.raises(OutputError, match=r"no/folder/plan\.png"):
        write_figure(tmp_path / "no" / "folder" / "plan.png", plan_figure(plan), 40)
    with pytest.raises(OutputError, match=r"ends in \.png"):
        write_figure(tmp_path / "plan", plan_figure(plan), 40)
    (tmp_path / "taken").mkdir()
    with pytest.raises(OutputError):
        write_bytes(tmp_path / "taken", b"x")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["plan.png", "taken"]


def test_where_t1_and_t2_coincide_a_moment_half_way_is_shown(story, blind):
    figure = stages_figure({"a": story, "b": blind})
    assert titles(figure) == ["start", "half way", "$t_1 = t_2$: localized", "end"]
    figure = stages_figure({"b": blind})
    assert titles(figure) == ["start", "$t_1$: oriented", "$t_2$: localized", "end"]
    half = story.snapshot("half")
    assert half.time_s < story.track.localized_at_s
    assert story.snapshot("t2") is story.recorder.moment("t2")


def test_moments_may_be_chosen(story):
    figure = stages_figure({"a": story}, moments=("start", "end"))
    assert titles(figure) == ["start", "end"]
