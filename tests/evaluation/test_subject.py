"""Several levels, further scans and hints of a data set, as methods are told and judged."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from palms.errors import InputError
from palms.evaluation.experiment import Batch, Experiment, run_batch
from palms.evaluation.simulation import (
    CaseSettings,
    Count,
    generate_levels,
    make_site,
    simulate_site,
    write_simulated,
)
from palms.evaluation.subject import Subject
from palms.evaluation.worst import rerun, rerun_command
from palms.io import Event, open_dataset, read_events, write_events
from palms.io.happenings import happenings_of
from palms.odometry import Odometry
from palms.scan import Scan
from palms.settings import Settings


@pytest.fixture(scope="module")
def tower(tmp_path_factory):
    """A data set of a building of two levels, with a second scan and a hint."""
    folder = tmp_path_factory.mktemp("tower")
    site = make_site(generate_levels("office", 3, 2), seed=3)
    settings = CaseSettings(length_m=60.0, second_scan_m=20.0, hint="place", hint_m=10.0)
    (case,) = simulate_site(site, Count(1, 1), settings)
    write_simulated(folder, site, case, picture=False)
    return folder


@pytest.fixture
def case(tower):
    return open_dataset(tower).cases[0]


def test_a_case_has_all_levels_and_what_happened(case):
    building = case.building()
    assert building.names == tuple(plan.level for plan in building.levels) == ("1", "2")
    assert building.levels[0].name == case.scene
    assert building.stairs
    told = case.happenings(case.walk().odometry("arkit"), building)
    first, hint, second, level = (each.what for each in told)
    assert first.position_m.tolist() == [0, 0]
    assert (hint.probability, hint.level, hint.radius_m) == (0.8, "1", 5.0)
    assert np.linalg.norm(second.position_m) > 5
    assert (level.level, level.probability, level.place_m) == ("2", 0.99, None)
    assert [each.time_s for each in told] == sorted(each.time_s for each in told)


def test_the_jump_is_for_the_judge_alone(tower, tmp_path):
    shutil.copytree(tower, tmp_path / "d")
    (case,) = open_dataset(tmp_path / "d").cases
    events = [*case.events(), Event(5.0, "jump", shift_m=(20.0, 0.0))]
    before = case.happenings(case.walk().odometry("arkit"), case.building())
    write_events(events, case.events_path)
    after = case.happenings(case.walk().odometry("arkit"), case.building())
    assert len(after) == len(before)


def test_a_stated_probability_counts_and_is_kept(tmp_path):
    told = [Event(1.0, "hint", room="Hall", probability=0.6), Event(2.0, "level", level="2")]
    write_events(told, tmp_path / "events.json")
    events = read_events(tmp_path / "events.json")
    assert events == tuple(told)
    walk, building = Odometry([1, 2], [[1, 0], [2, 0]]), generate_levels("office", 7, 1)
    (only,) = happenings_of([], events, walk, building)  # one level is never left
    hint = only.what
    assert (hint.room, hint.probability) == ("Hall", 0.6)


def test_later_scans_count_where_they_share_session_and_clock():
    walk = Odometry([1, 2, 3], [[1, 0], [2, 0], [3, 0]])
    wall, one = [[[2, -2], [2, 2]]], generate_levels("office", 7, 1)
    first = Scan(wall, time_s=9.0, session="7")
    later = Scan(wall, (1.0, 0.0), time_s=2.0, session="7")
    scans = [first, later, replace(later, session="8"), replace(later, time_s=0.0)]
    told = happenings_of(scans, [], walk, one)
    assert [each.what is scan for each, scan in zip(told, scans, strict=False)] == [True, True]
    own = replace(walk, position_m=walk.position_m @ [[0, 5], [-5, 0]], frame="own")
    _, second = happenings_of(scans, [], own, one)
    moved = second.what
    assert (second.time_s, moved.position_m.tolist()) == (
        2.0,
        [0.0, 10.0],
    )  # where that odometry was
    np.testing.assert_allclose(moved.relative_m, later.relative_m)


def test_our_methods_are_told_all_and_the_papers_the_first_scan(tower):
    experiment = Experiment(tower, ("palms", "paper"), trials=1, particles=2000)
    (case,) = experiment.cases()
    subject = experiment.subject(case)
    ours, paper = (
        next(subject.tracks(experiment.settings(method), [1])) for method in ("palms", "paper")
    )
    assert {each.level for each in ours} <= {"1", "2"}
    assert {each.level for each in paper} == {None}
    bare = replace(subject, building=None, told=(), reference_level=None)
    (same,) = bare.tracks(experiment.settings("paper"), [1])
    np.testing.assert_array_equal(same.position_m, paper.position_m)
    (alone,) = replace(subject, told=()).tracks(experiment.settings("palms"), [1])
    assert not np.array_equal(alone.position_m, ours.position_m)


def test_answers_are_judged_on_their_level(tower):
    experiment = Experiment(tower, ("palms", "paper"), trials=1, particles=2000)
    (case,) = experiment.cases()
    subject = experiment.subject(case)
    paper = next(subject.tracks(experiment.settings("paper"), [1]))
    off = subject.answers(paper).off_m(subject.reference_m, subject.reference_level)
    above = np.array(subject.reference_level) == "2"
    assert 0 < above.sum() < len(above)
    assert np.isinf(off[above]).all()
    assert np.isfinite(off[~above]).all()
    for method in experiment.methods:
        records = run_batch(subject, Batch(case.scene, case.name, method, (0,)), experiment)
        json.dumps(records, allow_nan=False)
        assert records[0]["right_place"] <= 1


def test_a_perfect_answer_is_right_on_every_level(tower):
    experiment = Experiment(tower, ("palms",), trials=1, particles=2000)
    subject = experiment.subject(experiment.cases()[0])
    track = next(subject.tracks(Settings().with_particles(500), [1]))
    truth = [
        replace(each, position_m=place, level=level, stage="localized")
        for each, place, level in zip(
            track, subject.building.atlas.folded(subject.reference_m),
            subject.reference_level, strict=True,
        )
    ]  # fmt: skip
    answers = subject.answers(replace(track, estimates=tuple(truth)))
    off = answers.off_m(subject.reference_m, subject.reference_level)
    assert off == pytest.approx(0.0, abs=1e-9)


def test_the_digest_of_the_data_covers_levels_and_events(tower, tmp_path):
    def digest(change):
        folder = tmp_path / change.replace("*", "")
        shutil.copytree(tower, folder)
        for path in folder.rglob(change):
            path.write_text(path.read_text() + " ")
        experiment = Experiment(folder, ("paper",))
        return experiment.to_json(experiment.cases())["data_sha256"]

    found = [digest(each) for each in ("nothing", "events.json", "*level-2.csv", "*-2.rooms*")]
    assert len(set(found)) == 4


def test_the_worst_cases_run_again_as_they_were(tower):
    experiment = Experiment(tower, ("palms",), trials=1, particles=2000)
    (case,) = experiment.cases()
    subject = Subject.of(case)
    (record,) = run_batch(subject, Batch(case.scene, case.name, "palms", (0,)), experiment)
    track = rerun(experiment, subject, record)
    off = subject.answers(track).off_m(subject.reference_m, subject.reference_level)
    final = record["final_error_m"]
    assert off[-1] == (np.inf if final is None else pytest.approx(final))
    assert rerun_command(experiment, case, record).startswith("palms bench ")
    assert "palms track" in rerun_command(experiment, case, record | {"method": "paper"})


def test_a_truth_of_unknown_levels_is_refused(tower, tmp_path):
    shutil.copytree(tower, tmp_path / "d")
    (case,) = open_dataset(tmp_path / "d").cases
    truth = case.folder / "truth.csv"
    truth.write_text(truth.read_text().replace(",2\n", ",7\n"))
    with pytest.raises(InputError, match="expected some of 1, 2, got '7'"):
        Subject.of(case)
    with pytest.raises(InputError, match="expected some of 1, 2"):  # before the work
        Experiment(tmp_path / "d", ("paper",)).cases()
    truth.unlink()
    with pytest.raises(InputError, match=r"truth\.csv with the level"):
        Subject.of(case)


def test_a_hint_of_a_level_that_nobody_knows_is_refused(tower, tmp_path):
    shutil.copytree(tower, tmp_path / "d")
    (case,) = open_dataset(tmp_path / "d").cases
    write_events([Event(1.0, "level", level="9")], case.events_path)
    experiment = Experiment(tmp_path / "d", ("palms",), trials=1, particles=200)
    with pytest.raises(InputError, match=r"one of the building's \(1, 2\)"):
        list(experiment.subject(case).tracks(Settings().with_particles(200), [0]))


def test_a_scene_of_its_own_is_no_level_of_another(tower, tmp_path):
    shutil.copytree(tower, tmp_path / "d")
    scene = open_dataset(tmp_path / "d").cases[0].scene
    trajectories = tmp_path / "d" / "trajectories"
    shutil.copytree(trajectories / scene, trajectories / f"{scene}-level-2")
    assert all(not case.above_paths for case in open_dataset(tmp_path / "d").cases)
