"""``palms scan``: look at scans."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from palms.cli._options import Json, OneScanFormat, OneScanOptions, ScanPath
from palms.cli._outputs import check_file, describe, write_result

if TYPE_CHECKING:
    from palms.scan import Scan

__all__ = ["app"]

app = typer.Typer(help="Look at scans.", no_args_is_help=True)


@app.callback()
def scan() -> None:
    """Look at scans."""


@app.command(epilog="Example: palms scan info trajectories/E2/walk-1/Session_7")
def info(
    scan: ScanPath,
    json: Json = None,
    format: OneScanFormat = None,
    option: OneScanOptions = None,
) -> None:
    """Tell what a scan holds: walls, their range, the session."""
    from palms.cli._inputs import Source, read_scan, scan_name

    check_file(json)
    read = read_scan(Source(scan, format, option))
    facts = {"schema": "palms-scan/1", "scan": scan_name(scan), **_facts(read)}
    nearest, farthest = facts["range_m"]
    describe(
        [
            ("scan", facts["scan"]),
            ("session", facts["session"] or "not named"),
            ("walls", f"{facts['walls']}, {facts['length_m']:.1f} m"),
            ("range", f"{nearest:.1f} to {farthest:.1f} m"),
            ("taken at", f"{facts['time_s']:.1f} s of the walk"),
            ("coverage", "known" if facts["coverage"] else "not recorded"),
        ],
        json,
    )
    write_result(facts, json)


def _facts(scan: Scan) -> dict[str, Any]:
    import numpy as np

    from palms.geometry import distance_to_segments, lengths

    walls = scan.walls_m
    farthest = np.linalg.norm(walls - scan.position_m, axis=-1).max()
    return {
        "session": scan.session,
        "walls": len(walls),
        "length_m": float(lengths(walls).sum()),
        "range_m": [float(distance_to_segments(scan.position_m, walls).min()), float(farthest)],
        "position_m": scan.position_m.tolist(),
        "time_s": float(scan.time_s),
        "coverage": scan.coverage_m is not None,
    }
