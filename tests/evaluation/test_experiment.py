import json
import pickle
import shutil
from dataclasses import fields, replace

import numpy as np
import pytest

from palms import FloorPlan, Odometry, Scan
from palms.errors import InputError, PalmsError
from palms.evaluation.experiment import (
    Batch,
    Experiment,
    Subject,
    as_results,
    run_batch,
    trial_seed,
)
from palms.evaluation.journal import Journal
from palms.evaluation.metrics import TrialMetrics
from palms.io import RecordedWalk, write_case, write_plan
from palms.localizer import locate
from palms.sample import sample_folder
from tests.evaluation.conftest import run_into


def test_the_seed_of_a_trial_rests_on_seed_scene_walk_and_trial_alone():
    seeds = {
        trial_seed(*key)
        for key in [(0, "E2", "w", 1), (1, "E2", "w", 1), (0, "E3", "w", 1), (0, "E2", "v", 1),
                    (0, "E2", "w", 2), (0, "E2w", "", 1)]
    }  # fmt: skip
    assert len(seeds) == 6
    assert all(float(seed) == seed < 2**53 for seed in seeds)
    assert trial_seed(0, "E2", "w", 1) == 4925608885990744  # stored: results stay reproducible


def test_methods_share_their_seeds_and_their_sampled_step(records):
    for one, other in zip(records[:20], records[20:], strict=True):
        assert (one["trial"], one["seed"]) == (other["trial"], other["seed"])
        assert one["method"] != other["method"]


def test_a_trial_does_not_depend_on_its_batch(experiment, records):
    (case,) = experiment.cases()
    subject = Subject.of(case)
    (alone,) = run_batch(subject, Batch(case.scene, case.name, "paper", (17,)), experiment)
    assert json.loads(json.dumps(alone)) == records[20 + 17]


def test_a_scan_is_searched_for_once_for_all_batches_of_a_walk(experiment, monkeypatch):
    searched = []

    def counted(*arguments):
        searched.append(arguments)
        return locate(*arguments)

    monkeypatch.setattr("palms.evaluation.subject.locate", counted)
    (case,) = experiment.cases()
    first = pickle.dumps(Subject.of(case))
    for trial in range(3):  # as they reach a worker, each time a copy
        batch = Batch(case.scene, case.name, "paper", (trial,))
        run_batch(pickle.loads(first), batch, replace(experiment, particles=10))
        run_batch(pickle.loads(first), batch, replace(experiment, particles=20))
    assert len(searched) == 2


def test_records_have_the_metrics_the_sample_and_no_nan(records):
    names = {field.name for field in fields(TrialMetrics)}
    for record in records:
        assert names <= set(record)
        assert 0 <= record["sampled_p_within_1m"] <= 1
        assert record["sampled_within_1m"] in (True, False)
        series = record["series"]
        assert len({len(values) for values in series.values()}) == 1
        assert np.all(np.diff(series["walked_m"]) > 0)
        json.dumps(record, allow_nan=False)


def test_results_have_no_series_and_say_the_settings(experiment, records):
    results = as_results(experiment, records)
    assert results["schema"] == "palms-bench/1"
    assert all("series" not in trial for trial in results["trials"])
    assert results["settings"]["paper"]["start"]["n_particles"] == 150


def test_a_journal_goes_on_and_its_cut_last_line_is_dropped(
    experiment, finished, expected, tmp_path
):
    folder = tmp_path / "r"
    folder.mkdir()
    shutil.copy(finished / "experiment.json", folder)
    lines = (finished / "trials.jsonl").read_bytes().splitlines(keepends=True)
    (folder / "trials.jsonl").write_bytes(b"".join(lines[:13]) + lines[13][:200])
    journal = Journal(folder, experiment.to_json(experiment.cases()))
    assert len(journal.records) == 13
    assert (folder / "trials.jsonl").read_bytes() == b"".join(lines[:13])
    assert run_into(folder, experiment) == expected


def test_what_is_done_is_not_run_again(experiment, finished, expected, monkeypatch):
    monkeypatch.setattr("palms.evaluation.workers.run_batch", None)
    assert run_into(finished, experiment) == expected


def test_a_trial_that_is_there_twice_counts_once(experiment, finished, tmp_path):
    folder = tmp_path / "r"
    shutil.copytree(finished, folder)
    lines = (folder / "trials.jsonl").read_bytes()
    (folder / "trials.jsonl").write_bytes(lines + lines)
    assert len(Journal(folder, experiment.to_json(experiment.cases())).records) == 40


@pytest.mark.parametrize(
    ("change", "word"),
    [({"trials": 25}, "trials"), ({"seed": 1}, "seed"), ({"particles": 151}, "particles")],
)
def test_the_folder_of_another_experiment_is_refused(experiment, finished, change, word):
    other = replace(experiment, **change)
    with pytest.raises(InputError, match=f"another experiment's results .*{word}"):
        Journal(finished, other.to_json(other.cases()))


def test_trials_that_nobody_owns_are_refused(experiment, finished, tmp_path):
    shutil.copy(finished / "trials.jsonl", tmp_path)
    with pytest.raises(InputError, match="another experiment"):
        Journal(tmp_path, experiment.to_json(experiment.cases()))


@pytest.mark.parametrize("line", [b"nonsense\n", b'{"scene": "sample"}\n', b"[1]\n"])
def test_a_damaged_line_is_named(experiment, finished, tmp_path, line):
    folder = tmp_path / "r"
    shutil.copytree(finished, folder)
    lines = (folder / "trials.jsonl").read_bytes().splitlines(keepends=True)
    lines[2] = line
    (folder / "trials.jsonl").write_bytes(b"".join(lines))
    with pytest.raises(InputError, match=r"trials\.jsonl line 3: expected a finished trial"):
        Journal(folder, experiment.to_json(experiment.cases()))


def test_other_data_is_another_experiment(tmp_path):
    shutil.copytree(sample_folder(), tmp_path / "data")
    experiment = Experiment(tmp_path / "data", ("paper",))
    before = experiment.to_json(experiment.cases())
    plan = tmp_path / "data" / "maps" / "sample.csv"
    plan.write_text(plan.read_text() + "1,1,2,2,wall\n")
    assert experiment.to_json(experiment.cases()) != before


def test_only_some_walks_run():
    def titles(*only):
        return [case.title for case in Experiment(sample_folder(), ("paper",), only=only).cases()]

    assert titles("sample") == titles("*/walk-?") == titles("nobody", "sample/walk-1") == titles()
    with pytest.raises(InputError, match="expected one called samp or w, got sample/walk-1"):
        titles("samp", "w")


def without_reference(folder):
    room = [[[0, 0], [9, 0]], [[9, 0], [9, 6]], [[9, 6], [0, 6]], [[0, 6], [0, 0]]]
    moves = Odometry([0.5, 1.0], [[0.6, 0.0], [1.2, 0.1]], session=("42",))
    write_plan(folder, FloorPlan(room, name="hall"))
    walk = RecordedWalk(arkit=moves, start_m=[2.0, 3.0], session=("42",))
    write_case(folder, "hall", "walk-1", walk, [Scan([[[-2, -3], [-2, 3]]], session="42")], [])
    return folder


def test_a_walk_without_reference_is_refused_before_the_work(tmp_path):
    experiment = Experiment(without_reference(tmp_path), ("paper",))
    with pytest.raises(InputError, match="expected reference positions, got none"):
        experiment.cases()


def test_methods_are_checked_and_counted_once():
    with pytest.raises(PalmsError, match="no-scan, oracle, got 'oogle'"):
        Experiment(sample_folder(), ("paper", "oogle"))
    with pytest.raises(InputError, match="at least one"):
        Experiment(sample_folder(), ())
    assert Experiment(sample_folder(), ("paper", "paper")).methods == ("paper",)
