"""``palms scan``: look at scans, convert them, find walls in points and depth."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palms.cli._options import Json, OneScanFormat, OneScanOptions, Png, ScanPath
from palms.cli._outputs import check_file, describe, speaker, write_result

if TYPE_CHECKING:
    from palms.scan import Scan

__all__ = ["app"]

app = typer.Typer(
    help="Look at scans, convert them, find walls in points and depth.", no_args_is_help=True
)

OutPath = Annotated[
    Path,
    typer.Argument(
        metavar="OUT", help="A file ending in .json, or a folder Session_*.", show_default=False
    ),
]


@app.command(epilog="Example: palms scan info trajectories/E2/walk-1/Session_7")
def info(
    scan: ScanPath,
    json: Json = None,
    format: OneScanFormat = None,
    option: OneScanOptions = None,
) -> None:
    """Tell what a scan holds: walls, their range, the session, what is seen to be empty."""
    from palms.cli._inputs import Input, read_scan, scan_name

    check_file(json)
    read = read_scan(Input(scan, format, option))
    facts = {"schema": "palms-scan/1", "scan": scan_name(scan), **_facts(read)}
    describe(_words(facts), json)
    write_result(facts, json)


@app.command(epilog="Example: palms scan show trajectories/E2/walk-1/Session_7 --png scan.png")
def show(
    scan: ScanPath, png: Png = None, format: OneScanFormat = None, option: OneScanOptions = None
) -> None:
    """Draw a scan with its empty space; into <scan>.png when no file is named."""
    from palms.cli._inputs import Input, read_scan, scan_name

    seen = read_scan(Input(scan, format, option))
    target = png or Path(f"{scan_name(scan)}.png")
    check_file(target)
    _draw(target, seen)
    typer.echo(f"Picture: {target}")


@app.command(epilog="Example: palms scan convert room.json trajectories/house/walk-1/Session_1")
def convert(
    scan: ScanPath, out: OutPath, format: OneScanFormat = None, option: OneScanOptions = None
) -> None:
    """Write a scan as planes, as the PALMS data set has them."""
    from palms.cli._inputs import Input, read_scan
    from palms.io import write_scan_json

    _check_out(out)
    seen = read_scan(Input(scan, format, option))
    write_scan_json(seen, out)
    typer.echo(f"Scan: {out}")


@app.command(epilog="Example: palms scan extract room.ply scan.json --up y --png scan.png")
def extract(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="SOURCE", help="Point cloud, or folder of depth images.", show_default=False
        ),
    ],
    out: OutPath,
    *,
    up: Annotated[
        str | None,
        typer.Option(
            metavar="AXIS", help="Axis of a point cloud that points up: x, y, z, -x, -y, -z.",
            show_default=False,
        ),
    ] = None,
    position: Annotated[
        str | None,
        typer.Option(metavar="X,Y", help="Observation point on the ground.", show_default=False),
    ] = None,
    floor: Annotated[
        float | None,
        typer.Option(metavar="METRES", help="Height of the floor.", show_default=False),
    ] = None,
    min_length: Annotated[
        float, typer.Option(metavar="METRES", help="Shorter walls are left out.")
    ] = 0.4,
    gap: Annotated[
        float, typer.Option(metavar="METRES", help="Walls end where nothing is seen for longer.")
    ] = 0.3,
    png: Png = None,
    json: Json = None,
) -> None:  # fmt: skip
    """Find the walls in a point cloud or in depth images, and write them as a scan."""
    from palms.cli._inputs import scan_name
    from palms.extraction import ExtractionSettings
    from palms.io import write_scan_json

    for file in (png, json):
        check_file(file)
    _check_out(out)
    given = {"up": up, "position": position, "floor": floor}
    options = {name: value for name, value in given.items() if value is not None}
    settings = ExtractionSettings(min_length_m=min_length, gap_m=gap)
    found = _extracted(source, {**options, "settings": settings})
    write_scan_json(found, out)
    facts = {"schema": "palms-scan/1", "scan": scan_name(source), **_facts(found)}
    say = speaker(json)
    describe(_words(facts), json)
    say(f"Scan: {out}")
    if png:
        _draw(png, found)
        say(f"Picture: {png}")
    write_result(facts, json)


def _extracted(source: Path, options: dict[str, Any]) -> Scan:
    """Read points or depth; a format that has walls already is refused."""
    import inspect

    from palms.errors import InputError
    from palms.io import SCANS, choose_format, read_scan

    reader = choose_format(SCANS, source)
    if "settings" not in inspect.signature(reader.read).parameters:
        raise InputError(
            str(source), expected="points or depth images", got=f"{reader.name}, which has walls",
            fix="use palms scan convert",
        )  # fmt: skip
    return read_scan(source, format=reader.name, **options)


def _check_out(out: Path) -> None:
    from palms.cli._outputs import check_folder

    if out.is_dir() or out.suffix.lower() != ".json":
        check_folder(out)
    else:
        check_file(out)


def _draw(target: Path, scan: Scan) -> None:
    from palms.plot.output import write_figure
    from palms.plot.scans import scan_figure

    write_figure(target, scan_figure(scan))


def _words(facts: dict[str, Any]) -> list[tuple[str, str]]:
    nearest, farthest = facts["range_m"]
    share, free = facts["coverage_share"], facts["free_m2"]
    return [
        ("scan", facts["scan"]),
        ("session", facts["session"] or "not named"),
        ("walls", f"{facts['walls']}, {facts['length_m']:.1f} m"),
        ("range", f"{nearest:.1f} to {farthest:.1f} m"),
        ("taken at", f"{facts['time_s']:.1f} s of the walk"),
        (
            "coverage",
            f"{share:.0%} of the bearings, {free:.1f} m² seen to be empty"
            if facts["coverage"]
            else "not recorded",
        ),
    ]


def _facts(scan: Scan) -> dict[str, Any]:
    import numpy as np

    from palms.geometry import distance_to_segments, lengths

    walls, free = scan.walls_m, scan.coverage_m
    farthest = np.linalg.norm(walls - scan.position_m, axis=-1).max()
    share = None if free is None else float(np.isfinite(free).mean())
    area = None if free is None else float(np.nansum(free**2) * np.pi / len(free))
    return {
        "session": scan.session,
        "walls": len(walls),
        "length_m": float(lengths(walls).sum()),
        "range_m": [float(distance_to_segments(scan.position_m, walls).min()), float(farthest)],
        "position_m": scan.position_m.tolist(),
        "time_s": float(scan.time_s),
        "coverage": free is not None,
        "coverage_share": share,
        "free_m2": area,
        "walls_m": walls.tolist(),
    }
