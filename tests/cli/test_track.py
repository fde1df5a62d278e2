import json
import math
import os
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

from palms import Settings
from palms.cli._inputs import Input, make_settings, read_case
from palms.cli._pictures import tell_story
from palms.cli.track import follow
from palms.io import read_walk
from tests.cli.conftest import DRIFT, STEPS, write_walk
from tests.worlds import walk

LISTS = {
    "t_s", "x_m", "y_m", "heading_rad", "drift_rad", "stage", "p_within_1m", "p_within_2m",
    "radius_68_m", "radius_95_m",
}  # fmt: skip


@pytest.fixture(scope="module")
def document(palms, world, tmp_path_factory):
    path = tmp_path_factory.mktemp("track") / "track.json"
    arguments = (world.plan, world.scan, world.walk)
    result = palms("track", *arguments, "--seed", 3, "--trials", 3, "--json", path)
    assert result.exit_code == 0, result.output
    return json.loads(path.read_text())


def is_angle(value):
    return value is None or -math.pi < value <= math.pi


def check_steps(steps, intervals):
    """The lists of a trial, as docs/reference/files.md has them."""
    assert steps.keys() == LISTS
    assert {len(values) for values in steps.values()} == {len(intervals)}
    assert steps["t_s"] == pytest.approx(np.cumsum(intervals))
    assert steps["t_s"][0] == intervals[0]
    assert set(steps["stage"]) <= {"searching", "oriented", "localized", "lost"}
    assert all(map(is_angle, steps["heading_rad"] + steps["drift_rad"]))
    for i, x in enumerate(steps["x_m"]):
        if x is None:
            others = ("y_m", "heading_rad", "drift_rad", "radius_68_m", "radius_95_m")
            assert all(steps[name][i] is None for name in others)
            assert steps["p_within_1m"][i] == steps["p_within_2m"][i] == 0
        else:
            assert all(isinstance(steps[name][i], float) for name in ("y_m", "drift_rad"))
            assert 0 <= steps["p_within_1m"][i] <= steps["p_within_2m"][i] <= 1
            assert 0 <= steps["radius_68_m"][i] <= steps["radius_95_m"][i]


def check_trial(trial, seed, intervals):
    steps = trial["steps"]
    check_steps(steps, intervals)
    assert trial.keys() == {"seed", "oriented_at_s", "localized_at_s", "steps"}
    assert trial["seed"] == seed
    entered = {
        name: next(
            (t for t, s in zip(steps["t_s"], steps["stage"], strict=True) if s in stages), None
        )
        for name, stages in (("localized", {"localized"}), ("oriented", {"oriented", "localized"}))
    }
    assert trial["localized_at_s"] == entered["localized"]
    assert trial["oriented_at_s"] == entered["oriented"]


def test_each_field_is_as_the_interface_says(document, world):
    intervals = json.loads(world.walk.read_text())["time_intervals"]
    assert document["schema"] == "palms-track/1"
    assert document["plan"] == "plan"
    assert document["method"] == "palms"
    assert document["settings"]["start"]["n_particles"] == Settings().start.n_particles
    assert document["versions"]["palms"]
    assert len(document["trials"]) == 3
    for seed, trial in enumerate(document["trials"], start=3):
        check_trial(trial, seed, intervals)


def test_heading_is_that_of_the_last_long_move(document):
    steps = document["trials"][0]["steps"]
    turned = np.subtract(steps["heading_rad"], steps["drift_rad"])
    odom = np.repeat([0.0, np.pi / 2, np.pi], [4, 5, 4]) - 0.4
    assert np.cos(turned - odom) == pytest.approx(1.0)


def test_trial_i_is_a_run_of_its_own_with_seed_s_plus_i(document, palms, world):
    for trial in document["trials"]:
        arguments = (world.plan, world.scan, world.walk)
        alone = palms("track", *arguments, "--seed", trial["seed"], "--json", "-")
        assert json.loads(alone.stdout)["trials"] == [trial]


def test_standard_output_holds_nothing_but_json(palms, world):
    result = palms("track", world.plan, world.scan, world.walk, "--json", "-")
    assert json.loads(result.stdout)["schema"] == "palms-track/1"
    assert "t the end, after 4 m (7 s)" in result.stderr


def test_words_say_when_and_where_and_how_far_off(palms, world):
    result = palms("track", world.plan, world.scan, world.walk)
    assert result.exit_code == 0
    assert "ocalized" in result.stdout
    assert "The truth was" in result.stdout
    assert result.stderr == ""


def test_a_line_for_each_trial(palms, world):
    result = palms("track", world.plan, world.scan, world.walk, "--trials", 2, "--seed", 8)
    scanned, headings, first, second, together = result.stdout.splitlines()
    assert scanned.startswith("What the scan tells: ")
    assert headings.startswith("seed  localized after")
    assert first.split()[0] == "8"
    assert second.split()[0] == "9"
    assert together.startswith("Localized in ")


def test_a_walk_with_inertial_odometry_alone_is_followed_by_it_and_a_note_says_so(palms, own_world):
    content = json.loads(own_world.walk.read_text())
    del content["ARKit_raw_2D"]
    own_world.walk.write_text(json.dumps(content))
    arguments = ("track", own_world.plan, own_world.scan, own_world.walk, "--json", "-")
    chosen = palms(*arguments, "--walk-source", "ronin")
    left_to_it = palms(*arguments)
    assert left_to_it.stdout == chosen.stdout
    assert json.loads(left_to_it.stdout)["walk_source"] == "ronin"
    told = set(left_to_it.stderr.splitlines()) - set(chosen.stderr.splitlines())
    assert len(told) == 1
    assert "no arkit odometry; it is followed by ronin" in told.pop()


def test_a_source_that_was_asked_for_and_is_not_there_is_refused(palms_fails, own_world):
    content = json.loads(own_world.walk.read_text())
    del content["ARKit_raw_2D"]
    own_world.walk.write_text(json.dumps(content))
    arguments = ("track", own_world.plan, own_world.scan, own_world.walk)
    assert "expected one of ronin" in palms_fails(*arguments, "--walk-source", "arkit")


def test_without_a_reference_nothing_is_said_of_the_truth(palms, own_world):
    content = json.loads(own_world.walk.read_text())
    del content["ARKit_PF"]
    own_world.walk.write_text(json.dumps(content))
    result = palms("track", own_world.plan, own_world.scan, own_world.walk)
    assert result.exit_code == 0
    assert "How sure" in result.stdout
    assert "truth" not in result.stdout


def test_scan_and_walk_may_be_folder_or_file(palms, world):
    results = [
        json.loads(palms("track", world.plan, scan, world.walk, "--json", "-").stdout)
        for scan in (world.scan, world.scan / "detectedPlanes.json")
    ]
    assert results[0] == results[1]


@pytest.mark.parametrize("method", ["paper", "authors", "uniform", "uniform-ori", "no-scan"])
def test_each_method_runs_with_few_particles(palms, world, method):
    arguments = (world.plan, world.scan, world.walk, "--method", method, "--particles", 200)
    result = palms("track", *arguments, "--json", "-")
    document = json.loads(result.stdout)
    assert document["method"] == method
    assert document["settings"]["start"]["n_particles"] == 200
    intervals = json.loads(world.walk.read_text())["time_intervals"]
    check_trial(document["trials"][0], 0, intervals)


def test_before_there_is_a_belief_there_are_nulls(palms, world):
    result = palms(
        "track", world.plan, world.scan, world.walk, "--method", "uniform-ori", "--json", "-"
    )
    steps = json.loads(result.stdout)["trials"][0]["steps"]
    assert steps["x_m"][0] is None
    assert steps["p_within_2m"][0] == 0
    assert steps["x_m"][-1] is not None


def test_inertial_odometry_has_a_frame_of_its_own(palms, world):
    arguments = ("track", world.plan, world.scan, world.walk, "--json", "-")
    ronin = json.loads(palms(*arguments, "--walk-source", "ronin").stdout)
    assert ronin["walk_source"] == "ronin"
    assert ronin["trials"] != json.loads(palms(*arguments).stdout)["trials"]


def test_a_file_of_before_is_replaced(palms, world, tmp_path):
    path = tmp_path / "track.json"
    path.write_text("old")
    assert palms("track", world.plan, world.scan, world.walk, "--json", path).exit_code == 0
    assert json.loads(path.read_text())["schema"] == "palms-track/1"
    assert [each.name for each in tmp_path.iterdir()] == ["track.json"]


def test_pictures_into_a_new_folder(palms, world, tmp_path):
    out = tmp_path / "a" / "b"
    result = palms("track", world.plan, world.scan, world.walk, "--out", out)
    assert result.exit_code == 0, result.output
    written = sorted(path.name for path in out.iterdir())
    assert {"report.html", "walk.gif", "track.png", "stages.png", "plan.png", "pipeline.png",
            "empty-space.png"} <= set(written)  # fmt: skip
    assert f"Report: {out / 'report.html'}" in result.stdout
    assert all(name in result.stdout for name in written)


def test_pictures_without_a_scan(palms, world, tmp_path):
    arguments = (world.plan, world.scan, world.walk, "--method", "uniform")
    result = palms("track", *arguments, "--out", tmp_path)
    assert result.exit_code == 0, result.output
    written = {path.name for path in tmp_path.iterdir()}
    assert {"report.html", "walk.gif", "track.png"} <= written
    assert "pipeline.png" not in written


def test_pictures_show_the_track_of_the_json(palms, world):
    settings = make_settings("palms")
    case = read_case(Input(world.plan), Input(world.scan), Input(world.walk), "arkit")
    (alone,) = follow(case, settings, range(4, 5))
    shown = tell_story(case, settings, 4).track
    assert np.array_equal(alone.position_m, shown.position_m)


def test_cell_size(palms, world):
    result = palms("track", world.plan, world.scan, world.walk, "--cell-size", 0.2, "--json", "-")
    assert json.loads(result.stdout)["settings"]["raster"]["cell_size_m"] == 0.2


@pytest.mark.parametrize(
    "wrong", [("--trials", 0), ("--seed", -1), ("--walk-source", "gps"), ("--speed", 1)]
)
def test_wrong_usage_is_exit_code_2(palms, world, wrong):
    result = palms("track", world.plan, world.scan, world.walk, *wrong)
    assert result.exit_code == 2
    assert "Usage" in result.stderr


def test_walk_is_read_as_the_library_reads_it(world):
    assert len(read_walk(world.walk)) == world.steps


def test_the_oracle_is_to_be_had_elsewhere(palms_fails, world):
    line = palms_fails("track", world.plan, world.scan, world.walk, "--method", "oracle")
    assert line.endswith("run it with: palms bench DATASET --methods oracle --out DIR")


def test_what_the_scan_tells_is_said_and_written(palms, world, document):
    result = palms("track", world.plan, world.scan, world.walk)
    assert "What the scan tells: " in result.output
    advice = document["advice"]
    assert set(advice) == {"n_places", "mass", "n_walls", "one_way", "unseen", "gaps"}
    assert f"{advice['n_places']} place" in result.output
    uniform = palms("track", world.plan, world.scan, world.walk, "--method", "uniform")
    assert "What the scan tells" not in uniform.output


def test_say_prints_the_sentences_with_their_times(palms, world):
    said = palms("track", world.plan, world.scan, world.walk, "--say").output
    silent = palms("track", world.plan, world.scan, world.walk).output
    lines = [line for line in said.splitlines() if line not in silent.splitlines()]
    assert lines
    assert all(line.lstrip().split()[1] == "s" for line in lines)
    times = [float(line.split()[0]) for line in lines]
    assert all(b - a >= 5 for a, b in pairwise(times))
    assert "Scan taken" in lines[0]


def test_a_jump_of_the_odometry_is_noted(palms, own_world):
    at = walk(STEPS, DRIFT).position_m.copy()
    at[6:] += (12.0, 5.0)
    write_walk(own_world.walk, ARKit_raw_2D=(-at).tolist())
    ours = palms("track", own_world.plan, own_world.scan, own_world.walk)
    assert ours.stderr == (
        "palms: note: the walk's odometry jumps by 13.2 m at 3.9 s, faster than anybody walks; "
        "that was taken for an error of the tracking\n"
    )
    theirs = palms("track", own_world.plan, own_world.scan, own_world.walk, "--method", "paper")
    assert theirs.stderr == ""


INTERRUPTED = """
import os, signal
from palms.cli import main
from palms.localizer import recorded

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background ignores it
    recorded.SHARE = 1  # however little there is to do, it is shared
    in_order = recorded.in_order

    def arrived_and_press(arriving):
        for each in in_order(arriving):
            os.killpg(0, signal.SIGINT)  # as a terminal does: parent and workers alike
            yield each

    recorded.in_order = arrived_and_press
    main()
"""


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_ctrl_c_is_calm_and_leaves_nothing(world, tmp_path):
    path = tmp_path / "track.json"
    words = ["track", world.plan, world.scan, world.walk, "--method", "paper"]
    words += ["--trials", 40, "--json", path]
    stopped = subprocess.run(
        [sys.executable, "-c", INTERRUPTED, *map(str, words)], start_new_session=True, text=True,
        capture_output=True, timeout=120, check=False,
    )  # fmt: skip
    assert (stopped.returncode, stopped.stdout, stopped.stderr) == (130, "", "")
    assert not path.exists()
