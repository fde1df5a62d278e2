"""Who runs the batches of an experiment: this process, several, or a cluster.

The records are the same whoever runs them; only their order of arrival differs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from functools import lru_cache
from itertools import islice
from multiprocessing import get_context

from palms.errors import InputError, PalmsError
from palms.evaluation.experiment import (
    Batch,
    Experiment,
    Journal,
    Record,
    Subject,
    run_batch,
)
from palms.io import Case

__all__ = ["run_experiment"]

AHEAD = 3  # batches handed out per worker: enough to keep it busy, few in flight

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
    cases = {(case.scene, case.name): case for case in experiment.opened().cases}
    batches = experiment.batches(cases.values(), journal.done)
    load = _loader(cases, experiment.walk_source)
    if cluster is not None:
        arriving = _on_cluster(experiment, batches, load, cluster)
    elif jobs > 1:
        arriving = _in_processes(experiment, batches, load, jobs)
    else:
        arriving = (run_batch(load(batch), batch, experiment) for batch in batches)
    for records in arriving:
        journal.append(records)
        if progress is not None:
            progress(len(records))


def _loader(cases: dict[tuple[str, str], Case], source: str) -> Loader:
    @lru_cache(maxsize=4)
    def read(scene: str, walk: str) -> Subject:
        return Subject.of(cases[scene, walk], source)

    return lambda batch: read(batch.scene, batch.walk)


def _in_processes(
    experiment: Experiment, batches: Sequence[Batch], load: Loader, jobs: int
) -> Iterator[list[Record]]:
    queue, waiting = iter(batches), set[Future[list[Record]]]()
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        try:
            while True:
                for batch in queue:
                    waiting.add(pool.submit(run_batch, load(batch), batch, experiment))
                    if len(waiting) >= AHEAD * jobs:
                        break
                if not waiting:
                    return
                done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                for future in done:
                    yield future.result()
        except BrokenProcessPool:
            raise PalmsError(
                "a worker process died", fix="run the same command again: it goes on where it was"
            ) from None
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _on_cluster(
    experiment: Experiment, batches: Sequence[Batch], load: Loader, address: str
) -> Iterator[list[Record]]:
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise InputError(
            "--cluster", expected="the package distributed", got="none",
            fix="pip install 'palms-localization[cluster]'",
        ) from None  # fmt: skip
    try:
        client = Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise InputError(
            f"--cluster {address}", expected="a running scheduler", got=type(error).__name__,
            fix="start one with: dask scheduler",
        ) from None  # fmt: skip
    with client:
        queue = iter(batches)
        ahead = AHEAD * max(1, len(client.scheduler_info()["workers"]))
        submit = _submitter(client, experiment, load)
        running = as_completed([submit(batch) for batch in islice(queue, ahead)])
        for future in running:
            yield future.result()
            following = next(queue, None)
            if following is not None:
                running.add(submit(following))


def _submitter(client, experiment: Experiment, load: Loader):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN202 - distributed has no types
    def submit(batch: Batch):  # type: ignore[no-untyped-def]  # noqa: ANN202
        return client.submit(run_batch, load(batch), batch, experiment, retries=3, pure=False)

    return submit
