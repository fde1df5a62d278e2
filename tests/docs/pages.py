"""The pages of the documentation, and what is in them."""

from __future__ import annotations

import contextlib
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from typer.testing import CliRunner

from palms.cli.app import app

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
TOP = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")
PAGES = sorted(
    [ROOT / name for name in TOP]
    + list(DOCS.rglob("*.md"))
    + list((ROOT / "changelog.d").glob("*.md"))
    + list((ROOT / "examples").glob("*.md"))
)
_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_PLAIN = re.compile(r"palms( [\w./:,=-]+)+")  # nothing that a shell would have to understand
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


class Block(NamedTuple):
    """A block of code: its language, and its text."""

    kind: str
    text: str


def name_of(page: Path) -> str:
    return str(page.relative_to(ROOT))


def blocks(page: Path) -> list[Block]:
    return [Block(*found) for found in _BLOCK.findall(page.read_text())]


def prose(page: Path) -> str:
    """The page without its blocks of code."""
    return _BLOCK.sub("", page.read_text())


def table_rows(page: Path) -> list[list[str]]:
    """Cells of all rows of all tables."""
    lines = [line for line in prose(page).splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def commands(text: str) -> list[tuple[str, str]]:
    """Commands of a console block, each with the output that the page shows."""
    parts = re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]
    return [(command, shown) for command, _, shown in (part.partition("\n") for part in parts)]


def run(command: str, folder: Path, environment: dict[str, str]) -> tuple[str, Path]:
    """Output of a command, and the folder that it leaves the shell in.

    A plain ``palms`` command runs in this process, which has the libraries and loops ready.
    """
    if not _PLAIN.fullmatch(command):
        return run_in_shell(command, folder, environment)
    with contextlib.chdir(folder):
        result = CliRunner().invoke(app, shlex.split(command)[1:], env=environment)
    assert result.exit_code == 0, f"{command}\n{result.output}"
    return result.stdout, folder


def run_in_shell(command: str, folder: Path, environment: dict[str, str]) -> tuple[str, Path]:
    """The same, whatever the command is."""
    script = f"{command}\nstatus=$?\nprintf '\\001'\npwd\nexit $status"
    done = subprocess.run(
        ["bash", "-c", script], cwd=folder, env=environment, capture_output=True, text=True,
        timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    output, _, left = done.stdout.rpartition("\x01")
    return output, Path(left.strip())


def same(shown: str, printed: str) -> bool:
    """Whether a page shows what was printed: the same words, and nearly the same numbers.

    A line `...` of the page stands for any lines. Numbers may be off by 10 % or by one of
    the second digit, since the last digits differ between machines.
    """
    wanted = shown.strip("\n").split("\n")
    got = printed.strip("\n").split("\n")
    return _same_lines([line.rstrip() for line in wanted], [line.rstrip() for line in got])


def _same_lines(wanted: list[str], got: list[str]) -> bool:
    if not wanted:
        return not got
    if wanted[0] == "...":
        return any(_same_lines(wanted[1:], got[i:]) for i in range(len(got) + 1))
    return bool(got) and _same_line(wanted[0], got[0]) and _same_lines(wanted[1:], got[1:])


def _same_line(wanted: str, got: str) -> bool:
    if " ".join(_NUMBER.sub("#", wanted).split()) != " ".join(_NUMBER.sub("#", got).split()):
        return False
    pairs = zip(_NUMBER.findall(wanted), _NUMBER.findall(got), strict=True)
    return all(_near(float(a), float(b)) for a, b in pairs)


def _near(a: float, b: float) -> bool:
    return abs(a - b) <= max(0.5, 0.1 * abs(a))


def shell_environment(home: Path) -> dict[str, str]:
    """What a shell needs to find the commands of this environment, with another home."""
    path = f"{Path(python()).parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PATH": path, "HOME": str(home), "COLUMNS": "200"}


def python() -> str:
    return sys.executable
