"""palms bench: the paper's experiment on any data set."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palms.cli._errors import INTERRUPTED, interrupts
from palms.cli._options import Source

if TYPE_CHECKING:
    from palms.evaluation.experiment import Experiment
    from palms.evaluation.journal import Journal
    from palms.evaluation.sensitivity import Trials
    from palms.io import Case

EXAMPLE = "Example: palms bench data --methods paper,uniform --trials 10 --out results"


def bench(
    dataset: Annotated[
        Path, typer.Argument(metavar="DATASET", help="Folder with maps/ and trajectories/.")
    ],
    *,
    out: Annotated[
        Path,
        typer.Option(metavar="DIR", help="Results; a run that was stopped goes on from them."),
    ],
    methods: Annotated[
        str,
        typer.Option(
            metavar="NAMES", help="Methods, separated by commas; oracle on simulated data alone."
        ),
    ] = "uniform,uniform-ori,paper,palms",
    trials: Annotated[
        int, typer.Option(metavar="N", min=1, help="Trials for each method and walk.")
    ] = 100,
    jobs: Annotated[int, typer.Option(metavar="N", min=1, help="Processes.")] = 1,
    cluster: Annotated[
        str | None, typer.Option(metavar="URL", help="Address of a dask scheduler instead.")
    ] = None,
    seed: Annotated[int, typer.Option(metavar="S", min=0, help="Of the whole experiment.")] = 0,
    particles: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="The methods' own when left out.")
    ] = None,
    walk_source: Annotated[
        Source, typer.Option(help="Which odometry of the walks.")
    ] = Source.ARKIT,
    only: Annotated[
        list[str] | None,
        typer.Option(
            metavar="WALK",
            help="Only walks so called: SCENE or SCENE/WALK, with * and ?. Repeatable.",
        ),
    ] = None,
    compare: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=DIR",
            help="Results with a nuisance changed; the report says what that does. Repeatable.",
        ),
    ] = None,
) -> None:
    """Run methods over all walks of a data set, many trials each; write results and a report."""
    from palms.cli._outputs import check_folder
    from palms.evaluation.experiment import Experiment
    from palms.evaluation.journal import Journal

    names = tuple(name.strip() for name in methods.split(",") if name.strip())
    experiment = Experiment(
        dataset, names, trials, seed, particles, walk_source.value, tuple(only or ())
    )
    changed = _changed(compare or ())
    cases = experiment.cases()
    check_folder(out)
    journal = Journal(out, experiment.to_json(cases))
    try:
        with interrupts():
            _run(experiment, journal, len(cases), jobs, cluster)
            _write(experiment, journal, cases, changed)
    except KeyboardInterrupt:
        typer.echo("stopped; run the same command again to go on", err=True)
        raise typer.Exit(INTERRUPTED) from None


def _changed(compare: list[str] | tuple[str, ...]) -> dict[str, Trials]:
    from palms.errors import InputError
    from palms.evaluation.sensitivity import read_trials

    changed: dict[str, Trials] = {}
    for given in compare:
        name, equals, folder = given.partition("=")
        if not (name and equals and folder):
            raise InputError("--compare", expected="NAME=DIR", got=given)
        changed[name] = read_trials(Path(folder))
    return changed


def _run(
    experiment: Experiment, journal: Journal, walks: int, jobs: int, cluster: str | None
) -> None:
    import sys

    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    from palms.evaluation.workers import run_experiment

    total = walks * len(experiment.methods) * experiment.trials
    done = len(journal.records)
    if done:
        typer.echo(f"going on: {done:,} of {total:,} trials are done", err=True)
    console = Console(stderr=True, quiet=not sys.stderr.isatty())
    columns = ("trials", BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console) as progress:
        bar = progress.add_task("trials", total=total, completed=done)
        run_experiment(
            experiment, journal, jobs, cluster, lambda n: progress.update(bar, advance=n)
        )


def _write(
    experiment: Experiment, journal: Journal, cases: tuple[Case, ...], changed: dict[str, Trials]
) -> None:
    from palms.evaluation.experiment import as_results
    from palms.evaluation.report import Findings, write_experiment_report
    from palms.evaluation.sensitivity import nuisance_effects
    from palms.evaluation.tables import HEADLINE, PAPER, experiment_markdown, table_rows
    from palms.io import write_json, write_text

    out, records = journal.folder, journal.ordered(experiment)
    write_json(out / "results.json", as_results(experiment, records))
    heading = f"{experiment.dataset.name}, {experiment.trials} trials, seed {experiment.seed}"
    write_text(out / "table.md", experiment_markdown(records, heading))
    _show(table_rows(records, HEADLINE + PAPER))
    findings = Findings(
        experiment, records, cases, nuisance_effects(records, changed), _command(experiment, out)
    )
    write_experiment_report(out / "report.html", findings)
    typer.echo(f"Report: {out / 'report.html'}\n  beside it: results.json, table.md")


def _command(experiment: Experiment, out: Path) -> str:
    """Return the command line that runs the experiment once more, whoever does the work."""
    options: dict[str, Any] = {
        "--methods": ",".join(experiment.methods), "--trials": experiment.trials,
        "--seed": experiment.seed, "--particles": experiment.particles,
        "--walk-source": None if experiment.walk_source == "arkit" else experiment.walk_source,
        "--out": out,
    }  # fmt: skip
    given = [str(word) for pair in options.items() if pair[1] is not None for word in pair]
    given += [word for walk in experiment.only for word in ("--only", walk)]
    return shlex.join(["palms", "bench", str(experiment.dataset), *given])


def _show(rows: list[list[str]]) -> None:
    from rich.console import Console
    from rich.table import Table

    turned = list(zip(*rows, strict=True))  # methods side by side: narrow enough for a terminal
    table = Table(*turned[0], box=None, pad_edge=False)
    for row in turned[1:]:
        table.add_row(*(cell.replace(" [", "\n[") for cell in row))
    Console().print(table)
