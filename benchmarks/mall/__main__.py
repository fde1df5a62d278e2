"""The command: ``python -m benchmarks.mall --out DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from benchmarks import options as shared
from benchmarks.mall.cases import FRAMES
from benchmarks.mall.run import Plan, as_json, run
from benchmarks.mall.table import digest, markdown
from benchmarks.mall.walks import FLOORS
from benchmarks.real.radish import data_folder
from palms.settings import METHODS

ROWS = ("uniform", "uniform-ori", "paper", "authors", "palms", "no-scan")
EXAMPLE = """example:
  python -m benchmarks.mall --methods paper,uniform --seeds 3 --jobs 2 --out results/mall"""


def _parser() -> argparse.ArgumentParser:
    parser = shared.parser("benchmarks.mall", "Real walks on the floors of a mall.", EXAMPLE)
    shared.choice(parser, "methods", METHODS, ROWS)
    shared.choice(parser, "floors", FLOORS, FLOORS)
    shared.choice(parser, "frames", FRAMES, FRAMES)  # of the walk: the scan's, or its own
    parser.add_argument("--walks", type=int, help="only the first N walks of each floor")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    parser = _parser()
    options = parser.parse_args(arguments)
    shared.check(parser, options, data_folder() / "mall", "mall")
    plan = Plan(options.methods, options.floors, options.frames, options.seeds, options.walks)
    content = as_json(plan)
    trials = shared.watched(run(plan, options.jobs), len(plan.tasks()), "walks")
    walks = len({trial["walk"] for trial in trials})
    seeds = "1 seed" if plan.seeds == 1 else f"{plan.seeds} seeds"
    title = f"Mall, {walks} walks on {', '.join(plan.floors)}, {seeds}"
    texts = (title, markdown(trials, title), digest(trials))
    shared.write(options, {**content, "trials": trials}, texts, "mall")
    return 0


if __name__ == "__main__":
    sys.exit(main())
