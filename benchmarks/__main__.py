"""`make bench`: every hot path beside a baseline, as a table and as JSON; curves as pictures."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

from benchmarks.harness import Result, machine_words, measure, table, write
from benchmarks.page import around, put

FILES = (
    "rasterise", "template", "heatmaps", "threshold", "sample", "step", "walls", "resample",
    "convergence", "walk", "ours", "live", "command",
)  # fmt: skip
LONG = "experiment"
CURVES = "curves"


def main() -> None:
    arguments = _parser().parse_args()
    if arguments.results:
        around("speed", arguments.results)
    wanted = arguments.only or [*FILES, *([LONG] if arguments.long else []), CURVES]
    results = [each for name in wanted if name != CURVES for each in run(name)]
    text = table(results)
    print(text)
    found = drawn(arguments.figures, arguments.long) if CURVES in wanted else []
    if arguments.json:
        write(results, found, arguments.json)
    if arguments.results:
        put("speed", f"{text}\n\n{machine_words()}", arguments.results)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    names = [*FILES, LONG, CURVES]
    parser.add_argument("only", nargs="*", metavar="FILE", choices=[*names, []],
                        help=f"some of {', '.join(names)}")  # fmt: skip
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the results here")
    parser.add_argument("--results", type=Path, metavar="PAGE", help="put the table into this page")
    parser.add_argument("--figures", type=Path, metavar="DIR", help="draw the curves into it")
    parser.add_argument(
        "--long", action="store_true", help="the paper's experiment, and the curve of trials, too"
    )
    return parser


def run(name: str) -> list[Result]:
    """Measure the cases of a file, and say what they came to as they come."""
    results = []
    for case in importlib.import_module(f"benchmarks.bench_{name}").cases():
        results.append(measure(case))
        print(f"{case.name}: {results[-1].minimum:.3g} {case.unit}", file=sys.stderr)
    return results


def drawn(folder: Path | None, long: bool) -> list[dict[str, object]]:
    """Measure the curves, and draw them where there is a folder for them."""
    from benchmarks.curves import as_json, curves, draw, trials

    growth, parallel = list(curves()), list(trials()) if long else []
    if folder:
        draw(growth, folder / "speed.png")
        if parallel:
            draw(parallel, folder / "speed-trials.png")
    return as_json([*growth, *parallel])


if __name__ == "__main__":
    main()
