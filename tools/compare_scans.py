"""How real simulated scans are: them and those of the Radish logs, side by side, as Markdown.

Run it from the repository: ``python tools/compare_scans.py --results docs/results.md``. The logs
are taken from ``$PALMS_DATA``; without them the table has the simulated scans alone.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from benchmarks.harness import machine_words
from benchmarks.page import put
from benchmarks.real.cases import Key, load_case
from benchmarks.real.plans import GRADES, cache_folder
from benchmarks.real.radish import BUILDINGS, data_folder, starts
from palms import PlanRaster, Scan, SegmentClass, Settings, rasterize
from palms.evaluation.simulation import CaseSettings, generate_levels, make_site, simulate_start
from palms.evaluation.tables import markdown_table
from palms.geometry import FloatArray, distance_to_segments, lengths, rotate
from palms.heatmap import match, scan_drifts

NEAR_M = 0.3  # a wall of the plan is the one that was seen when it is so near
PLACE_M = 0.4  # the best cell so near to the truth is the true place's
FIRST_SEED, STARTS_EACH = 5000, 4  # of the simulated buildings; none of these is reported on


@dataclass(frozen=True)
class Seen:
    """A scan on its plan, and where it was really taken."""

    raster: PlanRaster
    scan: Scan
    position_m: FloatArray
    drift_rad: float


@dataclass(frozen=True)
class Figures:
    """What is compared, of one scan."""

    walls: int
    lengths_m: FloatArray
    unmatched: float
    rank: float


def simulated(count: int) -> Iterator[Seen]:
    """Yield scans in generated buildings, four in each."""
    settings = CaseSettings()
    for k in range(-(-count // STARTS_EACH)):
        seed = FIRST_SEED + k
        site = make_site(generate_levels("office", seed, 1), seed)
        raster, taken = rasterize(site.drawings[0]), []
        for s in range(min(STARTS_EACH, count - k * STARTS_EACH)):
            taken.append(simulate_start(site, s, taken, settings))
            at = taken[-1].taken
            yield Seen(raster, at.scan, site.stretch.apply(at.position_m), at.drift_rad)


def real(grade: str, apart: str) -> Iterator[Seen]:
    """Yield the scans of the logs' development starts, on the plans fitted to the rest."""
    for building in BUILDINGS:
        for start in starts(building, "development", apart):
            case = load_case(Key(building, start, grade), cache_folder())
            yield Seen(case.raster, case.scan, case.walk.start_m, case.drift_rad)


def figures(seen: Seen) -> Figures:
    """Return what is compared."""
    walls = seen.scan.walls_m
    ends = rotate(seen.scan.relative_m, seen.drift_rad) + seen.position_m
    return Figures(len(walls), lengths(walls), _unmatched(ends, seen), _rank(seen))


def _unmatched(walls: FloatArray, seen: Seen) -> float:
    """Share of the scan's metres that have no wall of the plan within 0.3 m."""
    plan = seen.raster.plan.of_class(SegmentClass.WALL, SegmentClass.DOOR, SegmentClass.GLASS)
    points = walls[:, :1] + np.linspace(0, 1, 21)[:, None] * (walls[:, 1:] - walls[:, :1])
    far = [[distance_to_segments(p, plan).min() >= NEAR_M for p in wall] for wall in points]
    return float(np.average(np.mean(far, axis=1), weights=lengths(walls)))


def _rank(seen: Seen) -> float:
    """Share of all cells of all four maps that score higher than the best near the truth.

    The maps are the paper's, whatever our own method does: so the figures of several versions
    can be compared.
    """
    settings = Settings.paper()
    drifts = scan_drifts(seen.scan, seen.raster, settings)
    grid = seen.raster.grid
    cells = grid.position_of(np.indices(grid.shape).transpose(1, 2, 0))
    near = np.linalg.norm(cells - seen.position_m, axis=2) <= PLACE_M
    maps = list(match(seen.scan, seen.raster, drifts, settings.template))
    best = max(float(scores[near].max()) for scores in maps)
    return float(np.mean([(scores > best).mean() for scores in maps]))


def table(columns: dict[str, list[Figures]]) -> str:
    """Return a Markdown table with a column for each kind of scans."""
    rows = [
        ("scans", [f"{len(each)}" for each in columns.values()]),
        ("segments a scan", [_spread([f.walls for f in e]) for e in columns.values()]),
        (
            "length of a segment, m",
            [_spread(np.concatenate([f.lengths_m for f in e])) for e in columns.values()],
        ),
        (
            "metres of wall a scan",
            [_spread([f.lengths_m.sum() for f in e]) for e in columns.values()],
        ),
        ("unmatched share, %", [_spread([100 * f.unmatched for f in e]) for e in columns.values()]),
        (
            "cells before the true place, %",
            [_spread([100 * f.rank for f in e], 4) for e in columns.values()],
        ),
        (
            "true place among the best 1 %",
            [f"{np.mean([f.rank <= 0.01 for f in e]):.0%}" for e in columns.values()],
        ),
        (
            "and among the best 0.1 %",
            [f"{np.mean([f.rank <= 0.001 for f in e]):.0%}" for e in columns.values()],
        ),
    ]
    head = ["median (10 % to 90 %)", *columns]
    return markdown_table([head, *([name, *cells] for name, cells in rows)])


def _spread(values: object, digits: int = 1) -> str:
    low, middle, high = np.percentile(np.asarray(values, float), [10, 50, 90])
    return f"{middle:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scans", type=int, default=100, help="simulated scans")
    parser.add_argument("--apart", choices=("position", "path"), default="path")
    parser.add_argument("--results", type=Path, metavar="PAGE", help="put the table into it")
    options = parser.parse_args()
    columns = {"simulated": [figures(seen) for seen in simulated(options.scans)]}
    if (data_folder() / "radish").is_dir():
        for grade in GRADES:
            found = [figures(seen) for seen in real(grade, options.apart)]
            columns[f"Radish, plan {grade}"] = found
    else:
        print(f"no Radish data in {data_folder()}: set PALMS_DATA", file=sys.stderr)
    seeds = f"{FIRST_SEED} to {FIRST_SEED + -(-options.scans // STARTS_EACH) - 1}"
    text = (
        f"Simulated: office floors of the seeds {seeds}, {STARTS_EACH} starts each. Radish: "
        f"development starts 10 m apart by {options.apart}. Ranks are in the paper's heatmaps; "
        f"{machine_words()}.\n\n{table(columns)}"
    )
    if options.results:
        put("realism", text, options.results)
    print(text)


if __name__ == "__main__":
    main()
