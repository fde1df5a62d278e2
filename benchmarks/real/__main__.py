"""The command: ``python -m benchmarks.real --out DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks import options as shared
from benchmarks.real.cases import Key, load_case, write_as_dataset
from benchmarks.real.plans import GRADES, SUITES, cache_folder
from benchmarks.real.radish import BUILDINGS, data_folder
from benchmarks.real.run import KNOWN, ROWS, Plan, as_json, run
from benchmarks.real.table import digest, markdown

EXAMPLE = """examples:
  python -m benchmarks.real --methods paper,uniform --seeds 3 --jobs 2 --out results/real
  python -m benchmarks.real --write-case intel 48 results/case"""


def _parser() -> argparse.ArgumentParser:
    parser = shared.parser("benchmarks.real", "The real benchmark on the Radish logs.", EXAMPLE)
    shared.choice(parser, "methods", KNOWN, ROWS)
    shared.choice(parser, "buildings", BUILDINGS, BUILDINGS)
    shared.choice(parser, "grades", tuple(GRADES), tuple(GRADES))
    shared.choice(parser, "suites", SUITES, SUITES)
    add = parser.add_argument
    add("--starts", choices=("development", "reporting"), default="development")
    add("--apart", choices=("position", "path"), default="position",
        help="how starts are 10 m apart; by path there are more, which overlap")  # fmt: skip
    add("--cache", type=Path, default=cache_folder(), help="where fitted walls are kept")
    add("--write-case", nargs=3, metavar=("BUILDING", "START", "DIR"),
        help="write one case (first of --grades and --suites) as a data set instead")  # fmt: skip
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    parser = _parser()
    options = parser.parse_args(arguments)
    data = data_folder() / "radish"
    if options.write_case:
        shared.check_data(parser, data)
        building, start, folder = options.write_case
        key = Key(building, int(start), options.grades[0], options.suites[0])
        print(write_as_dataset(load_case(key, options.cache), Path(folder)))
        return 0
    shared.check(parser, options, data, "radish")
    plan = Plan(
        options.methods, options.buildings, options.grades, options.suites, options.starts,
        options.apart, options.seeds,
    )  # fmt: skip
    content = as_json(plan)
    trials = shared.watched(run(plan, options.cache, options.jobs), len(plan.tasks()), "cases")
    title = f"Radish, {plan.purpose} starts at least 10 m apart by {plan.apart}, {plan.seeds} seeds"
    texts = (title, markdown(trials, title), digest(trials))
    shared.write(options, {**content, "trials": trials}, texts, "radish")
    return 0


if __name__ == "__main__":
    sys.exit(main())
