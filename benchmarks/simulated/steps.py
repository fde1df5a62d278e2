"""Doing what a study says; what is there already is not done again."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from benchmarks.simulated.studies import Dataset, Run, Study
from palms.errors import InputError
from palms.evaluation.experiment import as_results
from palms.evaluation.journal import Journal
from palms.evaluation.workers import run_experiment
from palms.io import read_json, write_json

Rows = list[dict[str, Any]]


def simulate(dataset: Dataset, work: Path, jobs: int) -> None:
    """Make a data set, whole or not at all; one that is there is taken as it is."""
    if (work / dataset.name).exists():
        return
    part = f"{dataset.name}.{os.getpid()}.part"
    words = [*dataset.words()[:-1], part, "--jobs", str(jobs)]
    palms(words, work)
    (work / part).rename(work / dataset.name)


def bench(study: Study, work: Path, jobs: int) -> None:
    """Simulate, and run `palms bench` with its report for each run of a study."""
    simulate(study.dataset, work, jobs)
    for run in study.runs:
        palms([*run.words(study.dataset.name), "--jobs", str(jobs)], work)


def bench_only(study: Study, work: Path, jobs: int) -> None:
    """Simulate and run, without reports."""
    simulate(study.dataset, work, jobs)
    for run in study.runs:
        experiment = run.experiment(work / study.dataset.name)
        journal = Journal(work / run.out, experiment.to_json(experiment.cases()))
        run_experiment(experiment, journal, jobs)
        ordered = journal.ordered(experiment)
        write_json(work / run.out / "results.json", as_results(experiment, ordered))


def palms(words: list[str], work: Path) -> None:
    """Run a command of this environment in the folder; its words go to standard error."""
    print("$", *words, file=sys.stderr, flush=True)
    done = subprocess.run(
        [sys.executable, "-m", *words], cwd=work, stdout=subprocess.DEVNULL, check=False
    )
    if done.returncode:
        raise SystemExit(done.returncode)


def read(study: Study, work: Path) -> dict[str, Any]:
    """Return the results of a study as one, after a look whether they are of it."""
    found = [_read_run(run, study.dataset, work) for run in study.runs]
    sources = {(each["versions"]["source"], each["machine"]["Processor"]) for each in found}
    if len(sources) > 1:
        raise InputError(
            f"results in {work}", expected="runs of one source and machine",
            got=f"{len(sources)} of them", fix="remove the older ones",
        )  # fmt: skip
    return {**found[0], "trials": [trial for each in found for trial in each["trials"]]}


def _read_run(run: Run, dataset: Dataset, work: Path) -> dict[str, Any]:
    path = work / run.out / "results.json"
    content: dict[str, Any] = read_json(path)
    made = run.experiment(work / dataset.name)
    said = content["experiment"]
    wanted = as_results(made, ())["experiment"]
    other = [name for name in wanted if said.get(name) != wanted[name]]
    if other:
        raise InputError(
            str(path), expected="the results of this study", got=f"other {', '.join(other)}",
            fix="remove the folder",
        )  # fmt: skip
    return content
