"""palms bench: the paper's experiment on any data set."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palms.cli._errors import INTERRUPTED

if TYPE_CHECKING:
    from palms.evaluation.experiment import Experiment, Journal

EXAMPLE = "Example: palms bench data --methods paper,uniform --trials 10 --out results"


def bench(
    dataset: Annotated[
        Path, typer.Argument(metavar="DATASET", help="Folder with maps/ and trajectories/.")
    ],
    out: Annotated[
        Path,
        typer.Option(metavar="DIR", help="Results; a run that was stopped goes on from them."),
    ],
    methods: Annotated[
        str, typer.Option(metavar="NAMES", help="Methods, separated by commas.")
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
        str, typer.Option(metavar="SOURCE", help="arkit or ronin: which odometry of the walks.")
    ] = "arkit",
) -> None:
    """Run methods over all walks of a data set, many trials each; write tables and results."""
    from palms.errors import InputError
    from palms.evaluation.experiment import Experiment, Journal

    names = tuple(name.strip() for name in methods.split(",") if name.strip())
    if walk_source not in ("arkit", "ronin"):
        raise InputError("--walk-source", expected="arkit or ronin", got=walk_source)
    experiment = Experiment(dataset, names, trials, seed, particles, walk_source)
    cases = experiment.cases()
    journal = Journal(out, experiment.to_json(cases))
    try:
        _run(experiment, journal, len(cases), jobs, cluster)
    except KeyboardInterrupt:
        typer.echo("stopped; run the same command again to go on", err=True)
        raise typer.Exit(INTERRUPTED) from None
    _write(experiment, journal, out)


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


def _write(experiment: Experiment, journal: Journal, out: Path) -> None:
    from palms.evaluation.experiment import as_results
    from palms.evaluation.tables import HEADLINE, PAPER, experiment_markdown, table_rows
    from palms.io import write_json, write_text

    records = journal.ordered(experiment)
    results = as_results(experiment, records)
    write_json(out / "results.json", results)
    heading = f"{experiment.dataset.name}, {experiment.trials} trials, seed {experiment.seed}"
    write_text(out / "table.md", experiment_markdown(results["trials"], heading))
    _show(table_rows(results["trials"], HEADLINE + PAPER))
    typer.echo(f"wrote {out / 'results.json'}, {out / 'table.md'}")


def _show(rows: list[list[str]]) -> None:
    from rich.console import Console
    from rich.table import Table

    turned = list(zip(*rows, strict=True))  # methods side by side: narrow enough for a terminal
    table = Table(*turned[0], box=None, pad_edge=False)
    for row in turned[1:]:
        table.add_row(*row)
    Console().print(table)
