"""The command: ``python -m benchmarks.walls``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.harness import machine_words
from benchmarks.page import put
from benchmarks.walls import clouds, simulated
from palms.plot.output import write_figure

EXAMPLE = """example:
  python -m benchmarks.walls --places 5"""


def markdown(rows: list[dict[str, Any]]) -> str:
    """A table of rows that have the same keys."""
    lines = [" | ".join(rows[0]), " | ".join("---" for _ in rows[0])]
    lines += [" | ".join(str(value) for value in row.values()) for row in rows]
    return "\n".join(f"| {line} |" for line in lines)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        "python -m benchmarks.walls", description="Walls found in depth images and point clouds.",
        epilog=EXAMPLE, formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    add = parser.add_argument
    add("--places", type=int, default=25, help="in each kind of building; seeds 0 to N-1")
    add("--results", type=Path, help="put the tables into this page")
    add("--png", type=Path, help="draw the real clouds")
    options = parser.parse_args(arguments)
    rows = []
    for kind in simulated.BUILDINGS:
        results = []
        for place in range(options.places):
            results.append(simulated.run(kind, place))
            print(f"{kind} {place}: {results[-1][2]:.1f} s", file=sys.stderr)
        rows.append(simulated.row(kind, results))
    camera = simulated.CAMERA
    text = (
        f"A turn of {camera.frames} images of {camera.columns} x {camera.rows} pixels at each "
        f"place; {machine_words()}.\n\n{markdown(rows)}"
    )
    if clouds.folder().is_dir():
        real, figure = clouds.run()
        text += f"\n\nReal clouds:\n\n{markdown(real)}"
        if options.png:
            write_figure(options.png, figure, dpi=80)
    else:
        print(f"no {clouds.folder()}; set PALMS_DATA to the data folder", file=sys.stderr)
    print(text)
    if options.results:
        put("walls", text, options.results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
