"""A small experiment on the packaged sample, run once."""

from __future__ import annotations

import pytest

from palms.evaluation.experiment import Experiment
from palms.evaluation.journal import Journal
from palms.evaluation.workers import run_experiment
from palms.io import write_json
from palms.sample import sample_folder

METHODS = ("uniform", "paper")


def small(trials=20, **changes):
    return Experiment(sample_folder(), METHODS, **{"trials": trials, "particles": 150} | changes)


def run_into(folder, experiment, **how):
    """Run an experiment into a folder; the bytes of its results.json."""
    from palms.evaluation.experiment import as_results

    journal = Journal(folder, experiment.to_json(experiment.cases()))
    run_experiment(experiment, journal, **how)
    write_json(folder / "results.json", as_results(experiment, journal.ordered(experiment)))
    return (folder / "results.json").read_bytes()


@pytest.fixture(scope="session")
def experiment():
    return small()


@pytest.fixture(scope="session")
def finished(experiment, tmp_path_factory):
    """The folder of an experiment that ran through in one process."""
    folder = tmp_path_factory.mktemp("finished")
    run_into(folder, experiment)
    return folder


@pytest.fixture(scope="session")
def expected(finished):
    return (finished / "results.json").read_bytes()


@pytest.fixture(scope="session")
def records(experiment, finished):
    journal = Journal(finished, experiment.to_json(experiment.cases()))
    return journal.ordered(experiment)


@pytest.fixture(scope="session")
def palms():
    """Run the command in this process: result with exit_code, stdout and stderr."""
    from typer.testing import CliRunner

    from palms.cli.app import app

    runner = CliRunner()
    return lambda *arguments: runner.invoke(app, [str(each) for each in arguments])
