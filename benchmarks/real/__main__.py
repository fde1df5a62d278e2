"""The command: ``python -m benchmarks.real --out DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

from benchmarks.harness import machine_words
from benchmarks.page import put
from benchmarks.real.cases import Key, load_case, write_as_dataset
from benchmarks.real.plans import GRADES, SUITES, cache_folder
from benchmarks.real.radish import BUILDINGS, data_folder
from benchmarks.real.run import Plan, as_json, run
from benchmarks.real.table import digest, markdown
from palms.io import write_json, write_text
from palms.settings import METHODS

EXAMPLE = """examples:
  python -m benchmarks.real --methods paper,uniform --seeds 3 --jobs 2 --out results/real
  python -m benchmarks.real --write-case intel 48 results/case"""


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "python -m benchmarks.real", description="The real benchmark on the Radish logs.",
        epilog=EXAMPLE, formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    add = parser.add_argument
    add("--out", type=Path, metavar="DIR", help="where results.json and table.md go")
    add("--methods", type=_names, default=("uniform", "uniform-ori", "paper", "authors"))
    add("--buildings", type=_names, default=BUILDINGS)
    add("--grades", type=_names, default=tuple(GRADES))
    add("--suites", type=_names, default=SUITES)
    add("--starts", choices=("development", "reporting"), default="development")
    add("--apart", choices=("position", "path"), default="position",
        help="how starts are 10 m apart; by path there are more, which overlap")  # fmt: skip
    add("--seeds", type=int, default=10, help="seeds 0 to N-1 for each start")
    add("--results", type=Path, help="put a digest of the table into this page")
    add("--jobs", type=int, default=1, help="processes; the results do not depend on it")
    add("--cache", type=Path, default=cache_folder(), help="where fitted walls are kept")
    add("--write-case", nargs=3, metavar=("BUILDING", "START", "DIR"),
        help="write one case (first of --grades and --suites) as a data set instead")  # fmt: skip
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    parser = _parser()
    options = parser.parse_args(arguments)
    if not (data_folder() / "radish").is_dir():
        parser.error(f"no Radish data in {data_folder()}; set PALMS_DATA to the data folder")
    if options.write_case:
        building, start, folder = options.write_case
        key = Key(building, int(start), options.grades[0], options.suites[0])
        print(write_as_dataset(load_case(key, options.cache), Path(folder)))
        return 0
    if options.out is None:
        parser.error("say where the results go: --out DIR")
    for name, given, known in (
        ("methods", options.methods, METHODS),
        ("buildings", options.buildings, BUILDINGS),
        ("grades", options.grades, GRADES),
        ("suites", options.suites, SUITES),
    ):
        if not set(given) <= set(known):
            parser.error(f"--{name}: expected some of {', '.join(known)}; got {', '.join(given)}")
    plan = Plan(
        options.methods, options.buildings, options.grades, options.suites, options.starts,
        options.apart, options.seeds,
    )  # fmt: skip
    trials = _watched(plan, options.cache, options.jobs)
    options.out.mkdir(parents=True, exist_ok=True)
    write_json(options.out / "results.json", as_json(plan, trials))
    title = f"Radish, {plan.purpose} starts at least 10 m apart by {plan.apart}, {plan.seeds} seeds"
    write_text(options.out / "table.md", markdown(trials, title))
    if options.results:
        put("radish", f"{title}; {machine_words()}.\n\n{digest(trials)}", options.results)
    print(options.out / "table.md")
    return 0


def _watched(plan: Plan, cache: Path, jobs: int) -> list[dict[str, Any]]:
    console = Console(stderr=True)
    trials: list[dict[str, Any]] = []
    with Progress(console=console, disable=not console.is_terminal) as progress:
        bar = progress.add_task("cases", total=len(plan.tasks()))
        for rows in run(plan, cache, jobs):
            trials += rows
            progress.advance(bar)
    return trials


if __name__ == "__main__":
    sys.exit(main())
