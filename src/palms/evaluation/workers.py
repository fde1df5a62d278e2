"""Who runs the batches of an experiment: this process, several, or a cluster.

The records are the same whoever runs them; only their order of arrival differs.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from functools import lru_cache
from importlib import import_module
from itertools import islice
from typing import Any

from palms.errors import InputError, PalmsError
from palms.evaluation.experiment import Batch, Experiment, Record, Subject, run_batch
from palms.evaluation.journal import Journal
from palms.io import Case
from palms.processes import in_processes

__all__ = ["run_experiment"]

AHEAD = 3  # batches handed out per worker: enough to keep it busy, few in flight
CONNECT = "10s"  # ours: a scheduler that is there answers at once
GO_ON = "run the same command again: it goes on where it was"

Loader = Callable[[Batch], Subject]
Progress = Callable[[int], None]


def run_experiment(
    experiment: Experiment,
    journal: Journal,
    jobs: int = 1,
    cluster: str | None = None,
    progress: Progress | None = None,
) -> None:
    """Run what is left of an experiment and write every finished batch to the journal.

    Parameters
    ----------
    experiment : Experiment
    journal : Journal
        Its finished trials are not run again.
    jobs : int
        Processes on this machine.
    cluster : str, optional
        Address of a running dask.distributed scheduler, such as ``tcp://host:8786``; then
        `jobs` does not count. Needs the extra ``cluster``.
    progress : callable, optional
        Called with the number of trials that were just finished.

    Raises
    ------
    InputError
        When a file of the data set is not what it should be.
    PalmsError
        When a worker died; what is in the journal stays.
    """
    cases = {(case.scene, case.name): case for case in experiment.cases()}
    batches = experiment.batches(cases.values(), journal.done)
    load = _loader(cases, experiment)
    if cluster is not None:
        arriving = _on_cluster(experiment, batches, load, cluster)
    elif jobs > 1:
        tasks = ((load(batch), batch, experiment) for batch in batches)
        arriving = in_processes(run_batch, tasks, jobs, GO_ON)
    else:
        arriving = (run_batch(load(batch), batch, experiment) for batch in batches)
    with closing(arriving):  # whatever happens here, nobody works on for nothing
        for records in arriving:
            journal.append(records)
            if progress is not None:
                progress(len(records))


def _loader(cases: dict[tuple[str, str], Case], experiment: Experiment) -> Loader:
    @lru_cache(maxsize=4)
    def read(scene: str, walk: str) -> Subject:
        return experiment.subject(cases[scene, walk])

    return lambda batch: read(batch.scene, batch.walk)


def _on_cluster(
    experiment: Experiment, batches: Sequence[Batch], load: Loader, address: str
) -> Generator[list[Record], None, None]:
    try:
        distributed: Any = import_module("distributed")
    except ImportError:
        raise InputError(
            "--cluster", expected="the package distributed", got="none",
            fix="pip install 'palms-localization[cluster]'",
        ) from None  # fmt: skip
    try:
        client = distributed.Client(address, timeout=CONNECT)
    except (OSError, ValueError) as error:
        raise InputError(
            f"--cluster {address}", expected="a running scheduler", got=type(error).__name__,
            fix="start one with: dask scheduler",
        ) from None  # fmt: skip
    with client:
        queue, submit = iter(batches), _submitter(client, experiment, load)
        running, waiting = distributed.as_completed(), 0
        while True:
            ahead = AHEAD * max(1, sum(client.nthreads().values()))  # workers come and go
            for batch in islice(queue, max(0, ahead - waiting)):
                running.add(submit(batch))
                waiting += 1
            if not waiting:
                return
            yield _result(next(running))
            waiting -= 1


def _result(future: Any) -> list[Record]:  # noqa: ANN401 - distributed has no types
    """Return what a task found; a cluster that gave up is said in one line."""
    from distributed.client import FutureCancelledError
    from distributed.scheduler import KilledWorker

    try:
        found: list[Record] = future.result()
    except (FutureCancelledError, KilledWorker) as error:
        raise PalmsError(
            "the cluster lost a task", got=type(error).__name__, fix=GO_ON
        ) from None  # fmt: skip
    return found


def _submitter(client, experiment: Experiment, load: Loader):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202 - distributed has no types
    def submit(batch: Batch):  # type: ignore[no-untyped-def]  # noqa: ANN202
        return client.submit(run_batch, load(batch), batch, experiment, retries=3, pure=False)

    return submit
