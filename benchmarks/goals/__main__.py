"""The command: ``python -m benchmarks.goals --work DIR [--radish DIR] [--mall DIR]``."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from itertools import chain
from pathlib import Path

from benchmarks.goals import lines
from benchmarks.goals.figures import Trials
from benchmarks.goals.lines import Find, Line
from benchmarks.page import put
from benchmarks.simulated.events import read_series
from benchmarks.simulated.studies import MANY, Happenings, Nuisances
from palms.errors import PalmsError
from palms.evaluation.tables import markdown_table
from palms.io.files import read_text

EPILOG = """example:
  python -m benchmarks.goals --work results --radish results-radish --mall results-mall \\
    --results docs/results.md

DIR is what --work (of benchmarks.simulated) or --out (of benchmarks.real and benchmarks.mall)
was. What was not measured is left out, and said."""


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    try:
        text = table(options)
        if options.results:
            put("goals", text, options.results)
    except PalmsError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    print(text)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "python -m benchmarks.goals", description="Goals, and what was reached.", epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    add = parser.add_argument
    add("--work", type=Path, metavar="DIR", required=True, help="of benchmarks.simulated")
    add("--radish", type=Path, metavar="DIR", help="of benchmarks.real")
    add("--mall", type=Path, metavar="DIR", help="of benchmarks.mall")
    add("--buildings", type=int, metavar="N", default=400, help="of the study events")
    add("--results", type=Path, metavar="PAGE", help="put the table into this page")
    return parser


def table(options: argparse.Namespace) -> str:
    """Return the table of all that was measured, and what was not."""
    find, names = _finder(options), Nuisances().names
    parts: dict[str, Callable[[], Iterator[Line]]] = {
        "buildings": lambda: chain(lines.buildings(find), lines.calibration(find)),
        "nuisances": lambda: lines.nuisances(find, names),
        "Radish": lambda: lines.radish(find),
        "mall": lambda: lines.mall(find),
        "events": lambda: lines.events(find),
    }
    rows, absent = [["", "goal", "reached", "met", "by"]], []
    for name, found in parts.items():
        try:
            rows += [_row(line) for line in found()]
        except FileNotFoundError:
            absent.append(name)
    left_out = f"\n\nNot measured: {', '.join(absent)}." if absent else ""
    return markdown_table(rows) + left_out


def _row(line: Line) -> list[str]:
    met = {True: "yes", False: "no", None: ""}[line.met]
    return [line.what, line.goal, line.reached, met, f"`{line.command}`"]


def _finder(options: argparse.Namespace) -> Find:
    """Return what reads the trials of a benchmark by its name."""
    plan, doubled = Happenings(options.buildings), Nuisances()

    @cache
    def find(name: str) -> Trials:
        folders: dict[str, Path | None] = {"radish": options.radish, "mall": options.mall}
        if name in folders:
            return _results(folders[name])
        if name == "buildings":
            return list(chain.from_iterable(_results(options.work / r.out) for r in MANY.runs))
        if name.startswith("nuisances "):
            return _results(options.work / doubled.study(name.split()[1]).runs[0].out)
        return _series(options.work / plan.study(name).runs[0].out)

    return find


def _results(folder: Path | None) -> Trials:
    if folder is None or not (folder / "results.json").exists():
        raise FileNotFoundError(folder)
    trials: Trials = json.loads(read_text(folder / "results.json"))["trials"]
    return trials


def _series(folder: Path) -> Trials:
    if not (folder / "results.json").exists():
        raise FileNotFoundError(folder)
    return read_series(folder)


if __name__ == "__main__":
    sys.exit(main())
