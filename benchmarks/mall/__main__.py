"""The command: ``python -m benchmarks.mall --out DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

from benchmarks.harness import machine_words
from benchmarks.mall.cases import FRAMES
from benchmarks.mall.run import Plan, as_json, run
from benchmarks.mall.table import digest, markdown
from benchmarks.mall.walks import FLOORS
from benchmarks.page import put
from benchmarks.real.radish import data_folder
from palms.io import write_json, write_text
from palms.settings import METHODS

ROWS = ("uniform", "uniform-ori", "paper", "authors", "palms", "no-scan")
EXAMPLE = """example:
  python -m benchmarks.mall --methods paper,uniform --seeds 3 --jobs 2 --out results/mall"""


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "python -m benchmarks.mall", description="Real walks on the floors of a mall.",
        epilog=EXAMPLE, formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    add = parser.add_argument
    add("--out", type=Path, metavar="DIR", required=True, help="for results.json and table.md")
    add("--results", type=Path, help="put the tables of all floors into this page")
    add("--methods", type=_names, default=ROWS)
    add("--floors", type=_names, default=FLOORS)
    add("--frames", type=_names, default=FRAMES, help="of the walk: the scan's, or its own")
    add("--seeds", type=int, default=10, help="seeds 0 to N-1 for each walk")
    add("--walks", type=int, help="only the first N walks of each floor")
    add("--jobs", type=int, default=1, help="processes; the results do not depend on it")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    parser = _parser()
    options = parser.parse_args(arguments)
    if not (data_folder() / "mall").is_dir():
        parser.error(f"no mall data in {data_folder()}; set PALMS_DATA to the data folder")
    for name, given, known in (
        ("methods", options.methods, METHODS),
        ("floors", options.floors, FLOORS),
        ("frames", options.frames, FRAMES),
    ):
        if not set(given) <= set(known):
            parser.error(f"--{name}: expected some of {', '.join(known)}; got {', '.join(given)}")
    plan = Plan(options.methods, options.floors, options.frames, options.seeds, options.walks)
    content = as_json(plan)
    trials = _watched(plan, options.jobs)
    options.out.mkdir(parents=True, exist_ok=True)
    write_json(options.out / "results.json", {**content, "trials": trials})
    walks = len({trial["walk"] for trial in trials})
    title = f"Mall, {walks} walks on {', '.join(plan.floors)}, {plan.seeds} seeds"
    write_text(options.out / "table.md", markdown(trials, title))
    if options.results:
        put("mall", f"{title}; {machine_words()}.\n\n{digest(trials)}", options.results)
    print(options.out / "table.md")
    return 0


def _watched(plan: Plan, jobs: int) -> list[dict[str, Any]]:
    console = Console(stderr=True)
    trials: list[dict[str, Any]] = []
    with Progress(console=console, disable=not console.is_terminal) as progress:
        bar = progress.add_task("walks", total=len(plan.tasks()))
        for rows in run(plan, jobs):
            trials += rows
            progress.advance(bar)
    return trials


if __name__ == "__main__":
    sys.exit(main())
