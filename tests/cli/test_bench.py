import json
import os
import shutil
import subprocess
import sys

import pytest

from palms.io import read_json
from palms.sample import sample_folder
from tests.evaluation.test_experiment import without_reference

SAMPLE = sample_folder()
FEW = ("--methods", "uniform,paper", "--trials", 2, "--particles", 100)


@pytest.fixture(scope="module")
def done(palms, tmp_path_factory):
    folder = tmp_path_factory.mktemp("bench") / "r"
    result = palms("bench", SAMPLE, *FEW, "--out", folder)
    assert result.exit_code == 0, result.output
    return folder, result


def test_results_tables_and_report_are_written(done):
    folder, result = done
    assert {path.name for path in folder.iterdir()} == {
        "experiment.json", "results.json", "report.html", "table.md", "trials.jsonl",
    }  # fmt: skip
    results = read_json(folder / "results.json")
    assert [(t["method"], t["trial"]) for t in results["trials"]] == [
        ("uniform", 0), ("uniform", 1), ("paper", 0), ("paper", 1),
    ]  # fmt: skip
    assert "false_localized" in result.stdout
    assert result.stderr == ""
    assert "| paper |" in (folder / "table.md").read_text()


def test_the_command_of_the_report_gives_the_same_results(done, palms, tmp_path):
    folder, _ = done
    page = (folder / "report.html").read_text()
    command = page.partition("<p>Command:</p>")[2].partition("<code>")[2].partition("</code>")[0]
    words = command.replace(str(folder), str(tmp_path / "again")).split()
    assert palms(*words[1:]).exit_code == 0
    assert read_json(tmp_path / "again" / "results.json") == read_json(folder / "results.json")


def test_a_finished_run_says_so_and_writes_the_same(done, palms):
    folder, _ = done
    before = (folder / "results.json").read_bytes()
    result = palms("bench", SAMPLE, *FEW, "--out", folder)
    assert result.exit_code == 0
    assert result.stderr == "going on: 4 of 4 trials are done\n"
    assert (folder / "results.json").read_bytes() == before


def test_other_results_are_compared(done, palms, tmp_path):
    folder, _ = done
    shutil.copytree(folder, tmp_path / "doubled")
    given = ("--out", folder, "--compare", f"furniture={tmp_path / 'doubled'}")
    assert palms("bench", SAMPLE, *FEW, *given).exit_code == 0
    assert "What each nuisance does" in (folder / "report.html").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--methods", "paper,oogle"), ("oogle",)),
        (("--methods", ","), ("at least one",)),
        (("--compare", "furniture"), ("--compare", "NAME=DIR")),
        (("--compare", "furniture=no/such"), ("no/such", "results.json")),
    ],
)
def test_what_cannot_be_run_is_one_line(palms, palms_fails, tmp_path, arguments, words):
    line = palms_fails("bench", SAMPLE, "--out", tmp_path / "r", *arguments)
    assert all(word in line for word in words)
    assert not (tmp_path / "r").exists()


def test_a_missing_or_empty_data_set_is_one_line(palms_fails, tmp_path):
    assert "no/such" in palms_fails("bench", "no/such", "--out", tmp_path / "r")
    assert str(tmp_path) in palms_fails("bench", tmp_path, "--out", tmp_path / "r")


def test_a_walk_without_reference_is_one_line(palms_fails, tmp_path):
    data = without_reference(tmp_path / "data")
    line = palms_fails("bench", data, "--out", tmp_path / "r")
    assert "expected reference positions, got none" in line


def test_the_folder_of_another_experiment_is_one_line(done, palms_fails):
    folder, _ = done
    line = palms_fails("bench", SAMPLE, *FEW, "--out", folder, "--seed", 1)
    assert "another experiment's results (other seed)" in line


def test_a_file_in_the_way_is_one_line(palms_fails, tmp_path):
    (tmp_path / "r").write_text("")
    assert "no folder" in palms_fails("bench", SAMPLE, *FEW, "--out", tmp_path / "r")


INTERRUPTED = """
import os, signal, sys
from palms.cli import main
from palms.evaluation.journal import Journal

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background ignores it
    append = Journal.append

    def append_and_press(self, records):
        append(self, records)
        os.killpg(0, signal.SIGINT)  # as a terminal does: parent and workers alike

    Journal.append = append_and_press
    main()
"""


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("jobs", [1, 2])
def test_ctrl_c_is_calm_and_the_same_command_goes_on(palms, tmp_path, jobs, monkeypatch):
    monkeypatch.setattr("palms.evaluation.report.write_experiment_report", lambda *_: None)
    out = tmp_path / "r"
    words = ["bench", SAMPLE, "--methods", "uniform", "--trials", 30, "--particles", 200]
    alone = [str(word) for word in (*words, "--out", tmp_path / "through")]
    words = [str(word) for word in (*words, "--jobs", jobs, "--out", out)]
    stopped = subprocess.run(
        [sys.executable, "-c", INTERRUPTED, *words], start_new_session=True, text=True,
        capture_output=True, timeout=120, check=False,
    )  # fmt: skip
    assert (stopped.returncode, stopped.stdout) == (130, "")
    assert stopped.stderr == "stopped; run the same command again to go on\n"
    saved = (out / "trials.jsonl").read_bytes().count(b"\n")
    assert 0 < saved < 30
    result = palms(*words)
    assert result.exit_code == 0, result.output
    assert result.stderr == f"going on: {saved} of 30 trials are done\n"
    assert palms(*alone).exit_code == 0
    assert (tmp_path / "through" / "results.json").read_bytes() == (
        out / "results.json"
    ).read_bytes()
    seeds = [trial["seed"] for trial in json.loads((out / "results.json").read_text())["trials"]]
    assert len(set(seeds)) == 30
