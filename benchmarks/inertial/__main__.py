"""The command: ``python -m benchmarks.inertial --out DIR``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.inertial.measure import TUNED_ON, measure, read_logs
from benchmarks.inertial.table import markdown
from benchmarks.page import put
from benchmarks.real.radish import data_folder
from palms.io import write_json, write_text

EXAMPLE = """example:
  python -m benchmarks.inertial --out results/inertial --results docs/results.md"""


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        "python -m benchmarks.inertial", description="Dead reckoning on raw logs of a mall.",
        epilog=EXAMPLE, formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("--out", type=Path, metavar="DIR", required=True,
                        help="for results.json and table.md")  # fmt: skip
    parser.add_argument("--results", type=Path, help="put the table into this page")
    options = parser.parse_args(arguments)
    if not (data_folder() / "mall").is_dir():
        parser.error(f"no mall data in {data_folder()}; set PALMS_DATA to the data folder")
    rows = [row for log in read_logs() for row in measure(log)]
    walks = len({row["walk"] for row in rows})
    text = f"{walks} walks, constants of length from the ones on {TUNED_ON}.\n\n{markdown(rows)}"
    options.out.mkdir(parents=True, exist_ok=True)
    write_json(options.out / "results.json", {"schema": "palms-inertial/1", "walks": rows})
    write_text(options.out / "table.md", text + "\n")
    if options.results:
        put("inertial", text, options.results)
    print(options.out / "table.md")
    return 0


if __name__ == "__main__":
    sys.exit(main())
