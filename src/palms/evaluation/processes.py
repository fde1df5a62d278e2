"""Several processes that work for this one, each with a pipe of its own.

A pool that shares one pipe among its workers can hang for good when one of them is killed while
it writes its result; here the others do not notice, and this process learns of it at once.
"""

from __future__ import annotations

import os
import signal
import traceback
from collections.abc import Callable, Generator, Iterator
from contextlib import suppress
from itertools import islice
from multiprocessing import get_context, parent_process
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from threading import Thread
from typing import Any

from palms.errors import PalmsError

__all__ = ["in_processes"]

Run = Callable[..., Any]


def in_processes(run: Run, tasks: Iterator[tuple[Any, ...]], jobs: int, fix: str) -> Generator[Any]:
    """Yield what a function returns for each task, as it comes.

    Each process has one task at a time. When the iteration ends early, the processes are ended,
    whatever they do; when this process dies, they end by themselves.

    Parameters
    ----------
    run : callable
        Importable by name.
    tasks : iterator of tuple
        Arguments for each call.
    jobs : int
        Processes.
    fix : str
        What to do when a process dies, for the message.

    Raises
    ------
    PalmsError
        When a process died.

    Examples
    --------
    >>> list(in_processes(pow, iter([]), 2, "run it again"))
    []
    """
    workers: dict[Any, BaseProcess] = {}  # by this end of their pipes
    try:
        for _, task in zip(range(jobs), tasks, strict=False):
            here, process = _start(run)
            workers[here] = process
            here.send(task)
        while workers:
            ready: list[Any] = wait(list(workers))
            for here in ready:
                found = _received(here, fix)
                for task in islice(tasks, 1):
                    with suppress(OSError):  # it died: then there is nothing to receive
                        here.send(task)
                    break
                else:
                    here.close()  # it ends when nothing more can come
                    workers.pop(here).join()
                yield found
    finally:
        for process in workers.values():
            process.terminate()


def _start(run: Run) -> tuple[Any, BaseProcess]:
    context = get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(there, run), daemon=True)
    process.start()
    there.close()
    return here, process


def _received(here: Any, fix: str) -> Any:  # noqa: ANN401 - whatever the function returns
    try:
        found, error = here.recv()
    except (EOFError, OSError):
        raise PalmsError("a worker process died", fix=fix) from None
    if error is not None:
        raise error
    return found


def _serve(there: Any, run: Run) -> None:  # noqa: ANN401 - either kind of connection
    """Work until there is nobody to work for; leave Ctrl-C to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_leave_with_parent, daemon=True).start()
    with suppress(EOFError, OSError):
        while True:
            there.send(_outcome(run, there.recv()))


def _outcome(run: Run, task: tuple[Any, ...]) -> tuple[Any, Exception | None]:
    try:
        return run(*task), None
    except Exception as error:
        error.add_note(traceback.format_exc())  # of this process, for palms --debug
        return None, error


def _leave_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
