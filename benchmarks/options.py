"""What the command lines of the benchmarks share."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

from benchmarks.harness import machine_words
from benchmarks.page import around, put
from palms.errors import PalmsError
from palms.io import write_json, write_text
from palms.io.files import make_folder

Rows = list[dict[str, Any]]


def parser(module: str, description: str, epilog: str) -> argparse.ArgumentParser:
    """Return a parser with the options that every benchmark of methods has."""
    made = argparse.ArgumentParser(
        f"python -m {module}", description=description, epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    add = made.add_argument
    add("--out", type=Path, metavar="DIR", help="for results.json and table.md")
    add("--results", type=Path, metavar="PAGE", help="put the tables into this page")
    add("--seeds", type=int, default=10, help="seeds 0 to N-1 for each walk")
    add("--jobs", type=int, default=1, help="processes; the results do not depend on it")
    return made


def choice(
    made: argparse.ArgumentParser, option: str, known: Sequence[str], default: Sequence[str]
) -> None:
    """Add an option that takes some of the known names."""

    def some(text: str) -> tuple[str, ...]:
        given = tuple(name.strip() for name in text.split(",") if name.strip())
        if not given or not set(given) <= set(known):
            raise argparse.ArgumentTypeError(
                f"expected some of {', '.join(known)}; got {text or 'none'}"
            )
        return given

    made.add_argument(f"--{option}", type=some, metavar="NAMES", default=tuple(default))


def check_data(made: argparse.ArgumentParser, data: Path) -> None:
    """Refuse to start without data."""
    if not data.is_dir():
        made.error(f"no data in {data}; set PALMS_DATA to the data folder")


def check(
    made: argparse.ArgumentParser, options: argparse.Namespace, data: Path, mark: str
) -> None:
    """Refuse to start what could not end: without data, or with nowhere to write."""
    check_data(made, data)
    if options.out is None:
        made.error("say where the results go: --out DIR")
    try:
        make_folder(options.out)
        if options.results:
            around(mark, options.results)
    except PalmsError as error:
        made.error(str(error))


def watched(tasks: Iterable[Rows], total: int, what: str) -> Rows:
    """Return the rows of all tasks; on a terminal, show how far it is."""
    console = Console(stderr=True)
    with Progress(console=console, disable=not console.is_terminal) as progress:
        return list(_rows(progress.track(tasks, total=total, description=what)))


def _rows(tasks: Iterable[Rows]) -> Iterator[dict[str, Any]]:
    for rows in tasks:
        yield from rows


def write(
    options: argparse.Namespace, content: dict[str, Any], texts: tuple[str, str, str], mark: str
) -> None:
    """Write results and tables; the texts are title, whole table, and what the page gets."""
    title, whole, digest = texts
    write_json(options.out / "results.json", content)
    write_text(options.out / "table.md", whole)
    if options.results:
        put(mark, f"{title}; {machine_words()}.\n\n{digest}", options.results)
    print(options.out / "table.md")
