"""The command: ``python -m benchmarks.simulated STUDY --work DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.page import around, put
from benchmarks.simulated import events, nuisances
from benchmarks.simulated.steps import bench, bench_only, read
from benchmarks.simulated.studies import DOUBLING, MANY, PAPER, Happenings, Nuisances
from benchmarks.simulated.tables import buildings_table, doubling_table, paper_table
from palms.errors import PalmsError
from palms.io.files import make_folder

EPILOG = """studies:
  paper      three floors, seven starts, two walks each, 100 trials; the oracle 10
  buildings  400 buildings, one walk and one trial each; and those without right angles alone
  oracle     whether twice the particles change the oracle's `useful`, on the three floors
  events     400 buildings: a second scan, a jump, hints, three levels, inertial odometry
  nuisances  30 development buildings as they are, and with each nuisance twice as strong

example:
  python -m benchmarks.simulated paper --work results --jobs 2 --results docs/results.md

A data set that is in DIR under the name that the commands give it is used as it is."""


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "python -m benchmarks.simulated", description="Experiments on simulated buildings.",
        epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    add = parser.add_argument
    add("study", choices=("paper", "buildings", "oracle", "nuisances", "events"))
    add("--work", type=Path, metavar="DIR", required=True, help="for data sets and results")
    add("--results", type=Path, metavar="PAGE", help="put the tables into this page")
    add("--jobs", type=int, default=1, help="processes; the results do not depend on it")
    add("--buildings", type=int, metavar="N", default=400, help="events: fewer for trying")
    add("--particles", type=int, metavar="N", help="events: the methods' own when left out")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    try:
        if options.results:
            around(options.study, options.results)
        make_folder(options.work)
        if options.study == "events":
            plan = Happenings(options.buildings, particles=options.particles)
            text = _events(plan, options.work, options.jobs)
        else:
            text = table(options.study, options.work, options.jobs, options.results)
    except PalmsError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("stopped; run the same command again to go on", file=sys.stderr)
        return 130
    if options.results:
        put(options.study, text, options.results)
    print(text)
    return 0


def _events(plan: Happenings, work: Path, jobs: int) -> str:
    for k, name in enumerate(events.run(plan, work, jobs), start=1):
        print(f"{k} of {len(plan.names)}: {name}", file=sys.stderr, flush=True)
    return events.table(plan, work)


def table(study: str, work: Path, jobs: int, page: Path | None = None) -> str:
    """Do what is left of a study and return its tables."""
    if study == "nuisances":
        plan = Nuisances()
        for k, name in enumerate(nuisances.run(plan, work, jobs)):
            print(f"{k} of {len(plan.names)} nuisances: {name}", file=sys.stderr, flush=True)
        return nuisances.write(plan, work, page.parent / "figures" if page else work)
    chosen, do, write = {
        "paper": (PAPER, bench, paper_table),
        "buildings": (MANY, bench, buildings_table),
        "oracle": (DOUBLING, bench_only, doubling_table),
    }[study]
    do(chosen, work, jobs)
    return write(chosen, read(chosen, work))


if __name__ == "__main__":
    sys.exit(main())
