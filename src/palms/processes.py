"""Several processes that work for this one, each with a pipe of its own.

A pool that shares one pipe among its workers can hang for good when one of them is killed while
it writes its result; here the others do not notice, and this process learns of it at once.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
import traceback
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager, suppress
from itertools import islice
from multiprocessing import get_context, parent_process, resource_tracker
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from threading import Thread
from types import ModuleType
from typing import Any, TypeVar

from palms.errors import PalmsError

__all__ = ["in_order", "in_processes"]

Run = Callable[..., Any]
T = TypeVar("T")


def in_processes(run: Run, tasks: Iterator[tuple[Any, ...]], jobs: int, fix: str) -> Generator[Any]:
    """Yield what a function returns for each task, as it comes.

    Each process has one task at a time. When the iteration ends early, the processes are ended,
    whatever they do; when this process dies, they end by themselves.

    Parameters
    ----------
    run : callable
        Importable by name, or a `functools.partial` of such a one; what that holds is sent to
        each process once.
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
        first = list(islice(tasks, jobs))
        for _ in first:
            here, process = _start(run)
            workers[here] = process
        for here, task in zip(workers, first, strict=True):  # a large one waits for its reader
            _send(here, task)
        while workers:
            ready: list[Any] = wait(list(workers))
            for here in ready:
                packed = _received(here, fix)
                for task in islice(tasks, 1):  # nobody waits while this one unpacks
                    _send(here, task)
                    break
                else:
                    here.close()  # it ends when nothing more can come
                    workers.pop(here).join()
                yield _outcome_of(packed)
    finally:
        for process in workers.values():
            process.terminate()


def in_order(arriving: Iterable[tuple[int, T]]) -> Iterator[T]:
    """Yield what is numbered from 0 on in that order, each as soon as those before it are there.

    Examples
    --------
    >>> list(in_order([(1, "b"), (0, "a"), (2, "c")]))
    ['a', 'b', 'c']
    """
    waiting: dict[int, T] = {}
    turn = 0
    for number, found in arriving:
        waiting[number] = found
        while turn in waiting:
            yield waiting.pop(turn)
            turn += 1


def _start(run: Run) -> tuple[Any, BaseProcess]:
    context = get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(there, _packed(run)), daemon=True)
    with _nothing_to_run_again(), _deaf_to_interrupts():
        process.start()
    there.close()
    return here, process


@contextmanager
def _nothing_to_run_again() -> Iterator[None]:
    """Let a new process not run the user's script once more, which may have no guard."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """Let a new process hear no Ctrl-C from its first moment on; this one hears it afterwards."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    resource_tracker.ensure_running()  # its own start lets interrupts in again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _packed(value: object) -> bytes:
    """Return a pickle of a protocol that keeps arrays which nobody may write to so."""
    return pickle.dumps(value, protocol=5)


def _send(pipe: Any, value: object) -> None:  # noqa: ANN401 - either kind of connection
    with suppress(OSError):  # who is at the other end died: then there is nothing to receive
        pipe.send_bytes(_packed(value))


def _received(here: Any, fix: str) -> bytes:  # noqa: ANN401 - either kind of connection
    try:
        packed: bytes = here.recv_bytes()
    except (EOFError, OSError):
        raise PalmsError("a worker process died", fix=fix) from None
    return packed


def _outcome_of(packed: bytes) -> Any:  # noqa: ANN401 - whatever the function returns
    found, error = pickle.loads(packed)
    if error is not None:
        raise error
    return found


def _serve(there: Any, packed: bytes) -> None:  # noqa: ANN401 - either kind of connection
    """Work until there is nobody to work for; leave Ctrl-C to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_leave_with_parent, daemon=True).start()
    run = pickle.loads(packed)
    with suppress(EOFError, OSError):
        while True:
            _send(there, _outcome(run, pickle.loads(there.recv_bytes())))


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
