"""Commands in a building of several levels, and hints of where it starts."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from palms.evaluation.answers import Answers
from palms.io import Truth, write_json, write_plan_csv, write_scan_json, write_truth
from tests.test_building import DRIFT, GROUND, START, STEPS, UPPER, scan_on
from tests.worlds import walk


@pytest.fixture(scope="module")
def house(tmp_path_factory):
    """Two levels as files of each kind, a scan and a walk on the upper one."""
    folder = tmp_path_factory.mktemp("house")
    write_plan_csv(GROUND, folder / "house.csv")
    write_plan_csv(UPPER, folder / "upper.csv")
    features = []
    for plan in (GROUND, UPPER):
        for segment in plan.segments_m.tolist():
            features.append(_feature("LineString", segment, plan.level, type="wall"))
        for room in plan.rooms:
            ring = [[*room.polygon_m.tolist(), room.polygon_m[0].tolist()]]
            features.append(_feature("Polygon", ring, plan.level, type="room", name=room.name))
    write_json(folder / "house.geojson", {"type": "FeatureCollection", "features": features})
    start = np.array([20 - START[0], START[1]])
    steps = [(-x, y) for x, y in STEPS]
    session = folder / "Session_7"
    write_scan_json(replace(scan_on(UPPER, start), session="7"), session)
    moves, truth = walk(steps, DRIFT), start + np.cumsum(steps, axis=0)
    recorded = folder / "w"
    recorded.mkdir()
    content = {
        "ARKit_raw_2D": (-moves.position_m).tolist(),
        "time_intervals": np.diff(moves.time_s, prepend=0).tolist(), "session_id": 7,
    }  # fmt: skip
    write_json(recorded / "w.json", content)
    n = len(truth)
    write_truth(Truth(moves.time_s, truth, np.zeros(n), ["1"] * n), recorded / "truth.csv")
    return SimpleNamespace(
        plan=folder / "house.csv", upper=folder / "upper.csv", both=folder / "house.geojson",
        scan=session, walk=recorded, start=start, end=truth[-1],
    )  # fmt: skip


def _feature(kind, coordinates, level, **properties):
    geometry = {"type": kind, "coordinates": coordinates}
    return {
        "type": "Feature", "geometry": geometry, "properties": {"level": level, **properties}
    }  # fmt: skip


def found(palms, *arguments):
    result = palms(*arguments, "--json", "-")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


@pytest.mark.parametrize("given", ["above", "all"])
def test_places_are_in_map_metres_with_their_level_and_room(palms, house, given):
    plans = [house.plan, "--above", house.upper] if given == "above" else [house.both]
    more = ["--all-levels"] if given == "all" else []
    best, *others = found(palms, "locate", *plans, house.scan, *more, "--top", 50)["candidates"]
    assert best["level"] == "1"
    assert np.hypot(best["x_m"] - house.start[0], best["y_m"] - house.start[1]) < 0.5
    assert {each["level"] for each in others} <= {"0", "1"}
    for each in (best, *others):
        assert -0.5 <= each["x_m"] <= 20.5
        assert -0.5 <= each["y_m"] <= 12.5
        plan = GROUND if each["level"] == "0" else UPPER
        assert each["room"] == plan.room_at((each["x_m"], each["y_m"]))


def test_the_table_of_places_names_levels_where_there_are_several(palms, house):
    told = palms("locate", house.plan, house.scan, "--above", house.upper, "--top", 2).stdout
    head, first, *_ = told.splitlines()
    assert head.split()[:2] == ["level", "place"]
    assert first.split()[:2] == ["1", "1"]
    assert "level" not in palms("locate", house.plan, house.scan, "--top", 2).stdout


def test_a_track_names_level_and_probability(palms, house, tmp_path):
    arguments = ["track", house.plan, house.scan, house.walk, "--above", house.upper]
    particles = ["--particles", 6000]
    document = found(palms, *arguments, *particles)
    steps = document["trials"][0]["steps"]
    assert len(steps["level"]) == len(steps["p_level"]) == len(steps["t_s"])
    assert steps["level"][-1] == "1"
    assert steps["p_level"][-1] > 0.9
    assert steps["x_m"][-1] == pytest.approx(house.end[0], abs=1)
    assert Answers.from_json(steps).level == tuple(steps["level"])
    out = tmp_path / "out"
    told = palms(*arguments, *particles, "--out", out)
    assert told.exit_code == 0, told.output
    assert "level 1 (" in told.stdout
    assert "The truth was 0." in told.stdout
    report = (out / "report.html").read_text()
    assert "levels 0, 1" in report
    assert "level 1" in report
    assert (out / "track.png").read_bytes().startswith(b"\x89PNG")
    alone = found(palms, "track", house.plan, house.scan, house.walk, *particles)
    assert "level" not in alone["trials"][0]["steps"]


def test_an_answer_on_another_level_is_said_to_be_there(palms, house):
    wrong = ["--level", 0, "--hint-probability", 0.999999]
    plans = [house.upper, "--above", house.plan]  # upside down: what it is called counts
    told = palms("track", *plans, house.scan, house.walk, *wrong, "--particles", 300).stdout
    assert ("The truth was on another level" in told) == ("level 0 (" in told.splitlines()[-2])


def test_a_hint_raises_the_places_that_it_names(palms, house):
    def share(level, *hint):
        places = found(palms, "locate", *plans, house.scan, "--top", 10_000, *hint)["candidates"]
        return sum(each["p"] for each in places if each["level"] == level)

    plans, (x, y) = [house.plan, "--above", house.upper], house.start
    without, right = share("1"), share("1", "--level", 1)
    assert right > without
    assert share("1", "--near", f"{x},{y},3", "--level", 1) > right
    wrong = "--level", 0, "--hint-probability", 0.8
    assert share("0", *wrong) > share("0")
    assert share("1", *wrong) > 0.5  # soft: a scan that fits outweighs it


def test_a_track_with_a_hint_is_surer_at_once(palms, house):
    arguments = ["track", house.plan, house.scan, house.walk, "--above", house.upper]
    x, y = house.start
    hint = ["--near", f"{x},{y},2", "--level", "1"]
    plain, told = (
        found(palms, *arguments, "--particles", 6000, *more)["trials"][0]["steps"]
        for more in ([], hint)
    )
    assert told["p_within_2m"][0] > plain["p_within_2m"][0]
    assert told["p_level"][0] > plain["p_level"][0]


@pytest.mark.parametrize("command", ["locate", "track"])
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--near", "3"], "--near: expected X,Y or X,Y,RADIUS in metres, got '3'"),
        (["--near", "3,four"], "--near: expected X,Y"),
        (["--near", "3,4,0"], "radius: expected above 0 m"),
        (["--near", "300,400"], "a place in the building"),
        (["--near", "nan,4"], "place"),
        (["--level", "7"], "one of the building's (0, 1), got '7'"),
        (["--room", "Room 9"], "one of the plan's rooms (Hall, Office 11, Stairs A), got 'Room 9'"),
        (["--room", "Hall", "--level", "1"], "a place in the building"),
        (["--room", "Hall", "--hint-probability", "1"], "probability: expected between 0 and 1"),
        (["--level", "0", "--method", "paper"], "a method that takes hints"),
        (["--all-levels"], "either that or --all-levels"),
        (["--above", "PLAN"], "levels with names of their own"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(palms, house, command, words, said):
    words = [str(house.plan) if word == "PLAN" else word for word in words]
    files = [house.plan, house.scan, *([house.walk] if command == "track" else [])]
    result = palms(command, *files, "--above", house.upper, *words)
    assert result.exit_code == 1
    (line,) = result.stderr.splitlines()
    assert line.startswith("palms: error: ")
    assert said in line


def test_a_plan_of_another_frame_is_refused(palms, house, tmp_path):
    beside = replace(UPPER, segments_m=UPPER.segments_m + 500.0, rooms=())
    write_plan_csv(beside, tmp_path / "beside.csv")
    result = palms("locate", house.plan, house.scan, "--above", tmp_path / "beside.csv")
    assert result.exit_code == 1
    assert "a plan above the lowest one, in its frame" in result.stderr


def test_a_plan_without_a_level_is_called_by_its_file(palms, house, tmp_path):
    for name, source in (("cellar.csv", house.plan), ("house-level-7.csv", house.upper)):
        shutil.copy(source, tmp_path / name)  # without the rooms, which say the level
    plans = tmp_path / "cellar.csv", house.scan, "--above", tmp_path / "house-level-7.csv"
    places = found(palms, "locate", *plans, "--top", 50)["candidates"]
    assert places[0]["level"] == "7"
    assert {each["level"] for each in places} <= {"cellar", "7"}
