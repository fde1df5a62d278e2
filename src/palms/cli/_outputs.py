"""Results: words, tables, JSON; and whether a place can be written, before the work starts."""

from __future__ import annotations

import contextlib
import json
import os
import secrets
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import typer

from palms.errors import OutputError

__all__ = [
    "Speaker",
    "check_file",
    "check_folder",
    "describe",
    "is_stdout",
    "progress",
    "speaker",
    "table",
    "write_result",
]

Speaker = Callable[[str], None]


def is_stdout(path: Path | None) -> bool:
    """Whether a path stands for standard output.

    Examples
    --------
    >>> is_stdout(Path("-")), is_stdout(None)
    (True, False)
    """
    return path is not None and str(path) == "-"


def speaker(json_path: Path | None) -> Speaker:
    """Return what says words: on standard error when standard output is for JSON."""
    err = is_stdout(json_path)

    def say(text: str) -> None:
        typer.echo(text, err=err)

    return say


def write_result(document: dict[str, Any], path: Path | None) -> None:
    """Write a document as JSON, whole or not at all; nothing when there is no path.

    Raises
    ------
    OutputError
        When it cannot be written.
    """
    if path is None:
        return
    if is_stdout(path):
        typer.echo(json.dumps(document, allow_nan=False, ensure_ascii=False))
        return
    from palms.io import write_json

    write_json(path, document)


def check_file(path: Path | None) -> None:
    """Make sure that a file can be written, without leaving a trace.

    Raises
    ------
    OutputError
        When it is a folder, its folder is missing, or nothing can be written there.

    Examples
    --------
    >>> check_file(Path("no/such/folder/a.json"))
    Traceback (most recent call last):
    palms.errors.OutputError: no/such/folder/a.json: expected a file that can be written, got ...
    """
    if path is None or is_stdout(path):
        return
    parent, expected = path.parent, "a file that can be written"
    if path.is_dir():
        raise OutputError(str(path), expected=expected, got="a folder", fix="name a file in it")
    if parent.exists() and not parent.is_dir():
        got, fix = f"{parent}, which is no folder", "choose another place"
        raise OutputError(str(path), expected=expected, got=got, fix=fix)
    if not parent.exists():
        raise OutputError(
            str(path), expected=expected, got=f"no folder {parent}", fix="create it first"
        )
    _probe(parent, str(path), expected)


def check_folder(path: Path | None) -> None:
    """Make sure that a folder can be made and written to, without leaving a trace.

    Raises
    ------
    OutputError
        When something else has its name, or nothing can be written there.

    Examples
    --------
    >>> check_folder(Path(__file__) / "out")
    Traceback (most recent call last):
    palms.errors.OutputError: ... expected a folder that can be written, got ...
    """
    if path is None:
        return
    existing = next(p for p in (path.absolute(), *path.absolute().parents) if p.exists())
    expected = "a folder that can be written"
    if not existing.is_dir():
        name = path if existing == path.absolute() else existing
        raise OutputError(
            str(path), expected=expected, got=f"{name}, which is no folder",
            fix="choose another place",
        )  # fmt: skip
    _probe(existing, str(path), expected)


def _probe(folder: Path, what: str, expected: str) -> None:
    trial = folder / f".{secrets.token_hex(6)}.part"
    try:
        trial.touch(exist_ok=False)
    except OSError as error:
        got = error.strerror or str(error)
        raise OutputError(what, expected=expected, got=got, fix="check the rights") from None
    finally:
        with contextlib.suppress(OSError):
            os.unlink(trial)


def table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return a table as lines of plain text; columns of numbers are set to the right.

    Examples
    --------
    >>> table(["place", "x"], [["Hall", "3.5 m"], ["Room 215", "12.0 m"]])
    ['place          x', 'Hall       3.5 m', 'Room 215  12.0 m']
    """
    columns = list(zip(headings, *rows, strict=True))
    widths = [max(map(len, column)) for column in columns]
    right = [all(c[:1] in "+-0123456789-<>" for c in column[1:]) for column in columns]
    lines = [
        "  ".join(
            cell.rjust(width) if to_right else cell.ljust(width)
            for cell, width, to_right in zip(row, widths, right, strict=True)
        )
        for row in [headings, *rows]
    ]
    return [line.rstrip() for line in lines]


def describe(facts: Sequence[tuple[str, str]], json_path: Path | None) -> None:
    """Say facts in two columns; nothing but them, unless standard output is for JSON."""
    say, width = speaker(json_path), max(len(name) for name, _ in facts)
    for name, value in facts:
        say(f"{name.ljust(width)}  {value}")


@contextlib.contextmanager
def progress(total: int, what: str) -> Iterator[Callable[[], None]]:
    """Show how far a count has come, on a terminal; silent in a pipe.

    Yields
    ------
    callable
        To be called after each.
    """
    if total < 2 or not sys.stderr.isatty():
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()
    with Progress(
        *columns, TimeRemainingColumn(), console=Console(stderr=True), transient=True
    ) as bar:
        task = bar.add_task(what, total=total)
        yield lambda: bar.advance(task)
