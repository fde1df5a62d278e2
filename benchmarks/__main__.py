"""`make bench`: every hot path, as a table and as JSON."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

from benchmarks.harness import Result, machine_words, measure, table, write
from benchmarks.page import put

FILES = ("raster", "heatmaps", "filter", "convergence", "walk", "ours", "command")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("only", nargs="*", choices=[*FILES, []], help="some of the files")
    parser.add_argument("--json", type=Path, help="write the results here")
    parser.add_argument("--results", type=Path, help="put the table into this page")
    arguments = parser.parse_args()
    results: list[Result] = []
    for name in arguments.only or FILES:
        for case in importlib.import_module(f"benchmarks.bench_{name}").cases():
            results.append(measure(case))
            print(f"{case.name}: {results[-1].min_ms:.3g} ms", file=sys.stderr)
    text = table(results)
    print(text)
    if arguments.json:
        write(results, arguments.json)
    if arguments.results:
        put("speed", f"{text}\n\n{machine_words()}", arguments.results)


if __name__ == "__main__":
    main()
