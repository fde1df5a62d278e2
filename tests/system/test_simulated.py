"""The studies on simulated buildings, from end to end on small ones."""

import contextlib
import json
import math
import re
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from palms.cli.app import app
from palms.errors import InputError

ROOT = Path(__file__).resolve().parents[2]
SMALL = "--building office --buildings 2 --starts 2 --walks 1 --seed 1 --length 25 --no-pictures"


@pytest.fixture(scope="module")
def bench():
    sys.path.insert(0, str(ROOT))
    try:
        from benchmarks.simulated import events, nuisances, steps, studies, tables

        yield {
            "nuisances": nuisances, "steps": steps, "studies": studies, "tables": tables,
            "events": events,
        }  # fmt: skip
    finally:
        sys.path.remove(str(ROOT))


@pytest.fixture(scope="module")
def study(bench):
    """Two small buildings, one of them angled; two runs."""
    studies = bench["studies"]
    return studies.Study(
        studies.Dataset("small", SMALL),
        (
            studies.Run("results", ("uniform", "paper"), 2, 100),
            studies.Run("results-oracle", ("oracle",), 1, 200),
        ),
    )


@pytest.fixture(scope="module")
def work(bench, study, tmp_path_factory):
    """Where its commands ran, in this process."""
    folder = tmp_path_factory.mktemp("study")

    def palms(words, where):
        with contextlib.chdir(where):
            result = CliRunner().invoke(app, words[1:])
        assert result.exit_code == 0, result.output

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bench["steps"], "palms", palms)
        bench["steps"].bench(study, folder, 1)
    return folder


@pytest.fixture(scope="module")
def results(bench, study, work):
    return bench["steps"].read(study, work)


def test_the_table_of_the_paper_has_all_runs_and_the_commands(bench, study, results):
    text = bench["tables"].paper_table(study, results)
    assert "```sh\npalms simulate --building office --buildings 2" in text
    assert "palms bench small --methods uniform,paper --trials 2 --particles 100 --out" in text
    assert "2 buildings, one walk each, 2 trials of each method but 1 of oracle" in text
    assert f"source {results['versions']['source']}" in text
    assert re.findall(r"^\| (\S+) \| 2 \|", text, re.MULTILINE) == 2 * [
        "uniform",
        "paper",
        "oracle",
    ]


def test_a_command_runs_in_the_folder_and_its_failure_ends_the_study(bench, tmp_path, capfd):
    with pytest.raises(SystemExit):
        bench["steps"].palms(["palms", "bench", "no-such-data", "--out", "r"], tmp_path)
    said = capfd.readouterr()
    assert said.out == ""
    assert said.err.startswith("$ palms bench no-such-data --out r\npalms: error: no-such-data")


def test_the_table_of_buildings_has_those_without_right_angles_alone(bench, study, results):
    text = bench["tables"].buildings_table(study, results)
    assert "### Those without right angles alone: 1 of 2" in text
    angled = text.partition("alone")[2]
    assert angled.count("| uniform | 1 |") == 2


def test_doubling_is_measured_over_the_same_walks(bench, study, results):
    uniform = [t for t in results["trials"] if t["method"] == "uniform"]
    better = [{**t, "useful": t["useful"] + 0.25} for t in uniform]
    runs = (replace(study.runs[0], particles=n) for n in (100, 200))
    two = replace(study, runs=tuple(runs))
    text = bench["tables"].doubling_table(two, {**results, "trials": [*uniform, *better]})
    assert re.search(r"^\| 200 \| .* \| \+0.2500 \[\+0.2500, \+0.2500\] \|$", text, re.MULTILINE)


def test_what_is_done_is_not_done_again(bench, study, work, monkeypatch):
    called = []
    monkeypatch.setattr(bench["steps"], "palms", lambda words, _: called.append(words))
    bench["steps"].simulate(study.dataset, work, 1)
    assert not called
    monkeypatch.setattr("palms.evaluation.workers.run_batch", None)
    before = (work / "results" / "results.json").read_bytes()
    bench["steps"].bench_only(study, work, 1)
    assert (work / "results" / "results.json").read_bytes() == before


def test_results_of_another_study_or_source_are_refused(bench, study, work, tmp_path):
    other = tmp_path / "other"
    shutil.copytree(work, other)
    path = other / "results-oracle" / "results.json"
    content = json.loads(path.read_text())
    content["versions"]["source"] = "0"
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match="expected runs of one source and machine"):
        bench["steps"].read(study, other)
    content["experiment"]["trials"] = 7
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match="expected the results of this study, got other trials"):
        bench["steps"].read(study, other)


def test_nuisances_have_a_figure_and_a_table(bench, tmp_path):
    plan = bench["studies"].Nuisances(SMALL, ("uniform", "paper"), 1, ("spurious_count",))
    assert list(bench["nuisances"].run(plan, tmp_path, 1)) == ["plain", "spurious_count"]
    text = bench["nuisances"].write(plan, tmp_path, tmp_path)
    assert (tmp_path / "nuisances.png").stat().st_size > 1000
    assert "| doubled | uniform: false_localized | uniform: useful | paper: false_localized" in text
    (row,) = re.findall(r"^\| `spurious_count` \|.*$", text, re.MULTILINE)
    assert row.count("|") == 6


def test_every_nuisance_that_a_walk_here_has_is_doubled(bench):
    names = bench["studies"].Nuisances().names
    assert {"thickness_m", "vio_scale_sd", "furniture_per_m"} <= set(names)
    assert not any(name.startswith("inertial") for name in names)


@pytest.fixture(scope="module")
def happenings(bench):
    """Small studies of what happens on the way."""
    return bench["studies"].Happenings(2, 1, particles=300)


def test_what_happens_is_asked_of_the_same_buildings_and_walks(bench, happenings):
    plain = happenings.study("plain").dataset.words()
    for name in happenings.names:
        words = happenings.study(name).dataset.words()
        added = [word for word in words if word not in plain]
        assert bool(added) == (name not in ("plain", "inertial")), name
        assert [word for word in plain[:-1] if word in words] == plain[:-1]
    assert "--walk-source ronin" in " ".join(happenings.study("inertial").commands()[1])


def test_found_again_wants_three_marks_in_a_row_soon_after_the_jump(bench):
    found_again = bench["events"].found_again
    walked = [58.0, 60.0, 80.5, *[82.0 + 2 * k for k in range(20)]]

    def trial(begins, near=0.3):
        right = [begins <= k < begins + 3 for k in range(len(walked))]
        error = [near if each else 9.0 for each in right]
        return {"series": {"walked_m": walked, "error_m": error, "localized": [1] * len(walked)}}

    assert found_again(trial(3)) == 1
    assert found_again(trial(17)) == 1  # begins 29.5 m after the jump
    assert found_again(trial(18)) == 0
    assert found_again(trial(3, near=1.1)) == 0
    assert math.isnan(found_again({"series": {"walked_m": [1.0, 3.0]}}))


def test_right_by_so_many_metres(bench):
    soon = bench["events"].right_by(25.0)
    assert [soon({"right_after_m": each}) for each in (None, 25.0, 25.1)] == [0, 1, 0]
