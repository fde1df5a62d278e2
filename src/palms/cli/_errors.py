"""What went wrong, in one line; and what was odd, once each."""

from __future__ import annotations

import contextlib
import os
import sys
import warnings
from collections.abc import Iterator
from typing import Any

import typer
from typer.core import TyperGroup

from palms.errors import PalmsError, PalmsWarning

__all__ = ["CheckedGroup", "interrupts", "one_line"]

INPUT_AT_FAULT = 1
INTERRUPTED = 130  # as shells have it: 128 + SIGINT
PIPE_CLOSED = 141  # as shells have it: 128 + SIGPIPE


def one_line(error: BaseException) -> str:
    """Say what an error means to a user.

    Examples
    --------
    >>> one_line(PalmsError("plan.csv", expected="a wall", got="none"))
    'plan.csv: expected a wall, got none'
    >>> one_line(FileNotFoundError(2, "No such file or directory", "plan.csv"))
    'plan.csv: No such file or directory'
    """
    if isinstance(error, PalmsError):
        text = str(error)
    elif isinstance(error, MemoryError):
        text = "out of memory; use fewer particles, larger cells or a smaller plan"
    elif isinstance(error, OSError):
        place = f"{error.filename}: " if error.filename else ""
        text = place + (error.strerror or str(error))
    else:
        text = (
            f"a defect of palms ({type(error).__name__}: {error}); "
            "please report it with what the same command prints as: palms --debug ..."
        )
    return " ".join(text.split())


@contextlib.contextmanager
def interrupts() -> Iterator[None]:
    """Raise an interrupt as one, when it fell into compiled code that took it for a fault.

    Examples
    --------
    >>> try:
    ...     with interrupts():
    ...         raise SystemError("with an exception set") from KeyboardInterrupt()
    ... except KeyboardInterrupt:
    ...     print("stopped")
    stopped
    """
    try:
        yield
    except SystemError as error:
        cause = error.__cause__
        while isinstance(cause, SystemError):
            cause = cause.__cause__
        if isinstance(cause, KeyboardInterrupt):
            raise KeyboardInterrupt from None
        raise


class CheckedGroup(TyperGroup):
    """A group of commands whose errors become one line and an exit code.

    Notes follow the result; an error stands alone.
    """

    def invoke(self, ctx: Any) -> Any:  # noqa: ANN401
        """Run the command; a mistake of the input ends with exit code 1."""
        with _notes() as notes:
            try:
                with interrupts():
                    result = super().invoke(ctx)
                sys.stdout.flush()
            except KeyboardInterrupt:
                raise typer.Exit(INTERRUPTED) from None
            except BrokenPipeError:
                _drop(sys.stdout)
                raise typer.Exit(PIPE_CLOSED) from None
            except Exception as error:
                if hasattr(error, "exit_code") or isinstance(error, typer.Abort):
                    raise  # typer's own: wrong usage, a wanted exit
                if ctx.params.get("debug"):
                    raise
                _say(f"palms: error: {one_line(error)}")
                if isinstance(error, OSError):
                    _drop(sys.stdout)
                raise typer.Exit(INPUT_AT_FAULT) from None
        for note in notes:
            _say(f"palms: note: {note}")
        return result


@contextlib.contextmanager
def _notes() -> Iterator[list[str]]:
    """Gather the text of each `PalmsWarning`, once."""
    found: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("always", PalmsWarning)
        others = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *rest: Any) -> None:  # noqa: ANN401
            text = " ".join(str(message).split())
            if not issubclass(category, PalmsWarning):
                others(message, category, *rest)
            elif text not in found:
                found.append(text)

        warnings.showwarning = show  # type: ignore[assignment]
        yield found


def _say(line: str) -> None:
    with contextlib.suppress(OSError):  # nobody listens; the exit code still tells
        typer.echo(line, err=True)


def _drop(stream: Any) -> None:  # noqa: ANN401
    """Let what a stream still holds go nowhere: its other end is closed or full."""
    with contextlib.suppress(OSError, ValueError):
        stream.flush()
        return
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
