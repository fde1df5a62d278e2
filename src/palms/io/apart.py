"""Foreign parsers run in a process of their own, with bounds on memory and time.

A damaged file can crash a library of C++, or make it hang or eat memory; then the child process
dies and the caller gets one clear line. Run as a module, this file is the child.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import os
import pickle
import subprocess
import sys
from typing import Any

from palms.errors import FormatError, PalmsError
from palms.io.values import StrPath

__all__ = ["require", "run_apart"]

SECONDS = 180.0  # ours: a large model takes 30
MAX_BYTES = 1_000_000_000  # ours: of the child's own data
_PLENTY = 4  # times the bytes: reserved address space is more than what is used


def require(module: str) -> None:
    """Make sure that a library of an extra is there, without importing it.

    Raises
    ------
    ModuleNotFoundError
        When it is not.

    Examples
    --------
    >>> require("numpy")
    """
    if importlib.util.find_spec(module) is None:
        raise ModuleNotFoundError(f"No module named {module!r}", name=module)


def run_apart(target: str, arguments: tuple[Any, ...], path: StrPath, kind: str) -> Any:  # noqa: ANN401
    """Call a function in a process of its own and return what it returns.

    Parameters
    ----------
    target : str
        The function, as ``package.module:function``.
    arguments : tuple
        What it takes; they and the result are pickled.
    path : path
        The file that it reads, for messages.
    kind : str
        What the file should be, as "a PDF document".

    Raises
    ------
    PalmsError
        What the function raised.
    FormatError
        When it crashed, took too long or too much memory.

    Examples
    --------
    >>> run_apart("math:hypot", (3.0, 4.0), "a.pdf", "a PDF document")
    5.0
    """
    paths = os.pathsep.join(filter(None, sys.path))
    try:
        done = subprocess.run(
            [sys.executable, "-m", "palms.io.apart"], input=pickle.dumps((target, arguments)),
            capture_output=True, timeout=SECONDS, check=False,
            env={**os.environ, "PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1"},
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise FormatError(
            str(path), expected=kind, got=f"one that takes more than {SECONDS:g} s to read",
            fix="export the part that is needed alone",
        ) from None  # fmt: skip
    if done.returncode or not done.stdout:
        raise FormatError(
            str(path), expected=f"{kind} that is whole", got="one that its reader cannot survive",
            fix="it may be damaged; export it again",
        )  # fmt: skip
    result, error = pickle.loads(done.stdout)
    if isinstance(error, MemoryError):
        raise FormatError(
            str(path), expected=f"{kind} that fits into {MAX_BYTES / 1e9:g} GB", got="a larger one",
            fix="export the part that is needed alone",
        ) from None  # fmt: skip
    if error is not None:
        raise error
    return result


def _limit_memory() -> None:
    """Bound what the process may take, where the system can."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (MAX_BYTES, MAX_BYTES))
        resource.setrlimit(resource.RLIMIT_AS, (_PLENTY * MAX_BYTES, _PLENTY * MAX_BYTES))


def main() -> None:
    """Do what the parent asks for on standard input; answer on standard output."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print is no answer
    target, arguments = pickle.load(sys.stdin.buffer)
    module, _, name = target.partition(":")
    _limit_memory()
    answer: tuple[Any, BaseException | None]
    try:
        answer = (getattr(importlib.import_module(module), name)(*arguments), None)
    except (PalmsError, ImportError, MemoryError) as error:
        answer = (None, error)
    with answers:
        pickle.dump(answer, answers)


if __name__ == "__main__":
    main()
