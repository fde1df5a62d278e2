"""``palms walk``: look at recorded walks, and convert them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palms.cli._options import Json, OneWalkFormat, OneWalkOptions, Png, Source, WalkPath
from palms.cli._outputs import check_file, describe, write_result

if TYPE_CHECKING:
    from palms.io import RecordedWalk
    from palms.odometry import Odometry

__all__ = ["app"]

app = typer.Typer(help="Look at recorded walks, and convert them.", no_args_is_help=True)

WalkSource = Annotated[
    Source | None,
    typer.Option(
        "--walk-source", help="Which odometry of the walk, when it has two.", show_default=False
    ),
]


@app.callback()
def walk() -> None:
    """Look at recorded walks, and convert them."""


@app.command(epilog="Example: palms walk info trajectories/E2/walk-1")
def info(
    walk: WalkPath,
    json: Json = None,
    format: OneWalkFormat = None,
    option: OneWalkOptions = None,
) -> None:
    """Tell what a recorded walk holds: samples, length, odometry, references."""
    from palms.cli._inputs import Input, read_walk, walk_name
    from palms.io import ODOMETRY, choose_format

    check_file(json)
    kind = choose_format(ODOMETRY, walk, format).name
    recorded = read_walk(Input(walk, kind, option))
    facts = {"schema": "palms-walk/1", "walk": walk_name(walk), "format": kind, **_facts(recorded)}
    describe(
        [
            ("walk", facts["walk"]),
            ("format", kind),
            ("session", ", ".join(facts["session"]) or "not named"),
            ("samples", f"{facts['samples']}, {facts['duration_s']:.0f} s"),
            *((name, _words(recorded.odometry(name))) for name in recorded.sources),
            ("reference", f"{facts['references']} of {facts['samples']} samples"),
        ],
        json,
    )
    write_result(facts, json)


def _words(odometry: Odometry) -> str:
    """Say how long an odometry is, what made it, and in which frame it lies."""
    made = {"vio": "visual-inertial", "inertial": "inertial"}[odometry.source]
    frame = "the scan's frame" if odometry.frame == "scan" else "a frame of its own"
    looks = "" if odometry.facing_rad is None else ", with where the phone looked"
    return f"{odometry.walked_m[-1]:.1f} m, {made}, in {frame}{looks}"


def _facts(walk: RecordedWalk) -> dict[str, Any]:
    known = {name: walk.odometry(name) for name in walk.sources}
    return {
        "session": list(walk.session),
        "samples": len(walk),
        "duration_s": float(walk.time_s[-1]),
        "length_m": {name: float(each.walked_m[-1]) for name, each in known.items()},
        "frame": {name: each.frame for name, each in known.items()},
        "facing": {name: each.facing_rad is not None for name, each in known.items()},
        "references": int(walk.has_reference.sum()),
        "truth": walk.truth is not None,
    }


@app.command(epilog="Example: palms walk show trajectories/E2/walk-1 --png walk-1.png")
def show(
    walk: WalkPath,
    png: Png = None,
    walk_source: WalkSource = None,
    format: OneWalkFormat = None,
    option: OneWalkOptions = None,
) -> None:
    """Draw a walk with its reference; into <walk>.png when no file is named."""
    from palms.cli._inputs import Input, read_walk, walk_name

    recorded = read_walk(Input(walk, format, option))
    odometry = recorded.odometry(walk_source.value if walk_source else recorded.usual_source)
    target = png or Path(f"{walk_name(walk)}.png")
    check_file(target)
    from palms.plot import walk_figure, write_figure

    reference = recorded.reference_m if recorded.has_reference.any() else None
    write_figure(target, walk_figure(odometry, reference, walk_name(walk)))
    typer.echo(f"Picture: {target}")


@app.command(epilog="Example: palms walk convert log.txt walk.tum")
def convert(
    walk: WalkPath,
    out: Annotated[
        Path,
        typer.Argument(
            metavar="OUT", help="The file to write: walk.tum or walk.json.", show_default=False
        ),
    ],
    walk_source: WalkSource = None,
    format: OneWalkFormat = None,
    option: OneWalkOptions = None,
) -> None:
    """Write a walk as a TUM trajectory or as a walk of the PALMS data set, by OUT's ending."""
    from palms.cli._inputs import Input, read_walk

    recorded = read_walk(Input(walk, format, option))
    check_file(out)
    if walk_source is not None:
        recorded.odometry(walk_source.value)
        only_arkit = walk_source is Source.ARKIT
        recorded = replace(recorded, ronin=None) if only_arkit else replace(recorded, arkit=None)
    _write(recorded, out)
    typer.echo(f"Walk: {out}")


def _write(walk: RecordedWalk, out: Path) -> None:
    """Write a walk in the format that has the file's ending.

    Raises
    ------
    OutputError
        When none has it.
    """
    from palms.io import ODOMETRY, choose_writer

    chosen = choose_writer(ODOMETRY, out)
    chosen.write(_from_origin(walk) if chosen.name == "tracking" else walk, out)


def _from_origin(walk: RecordedWalk) -> RecordedWalk:
    """Return a walk whose first move begins at the origin, as the data set has it.

    A walk in the scan's frame stays where it is, and the way from the origin joins its first
    move; one in a frame of its own is moved.
    """
    import numpy as np

    moved: dict[str, Any] = {}
    for name in walk.sources:
        each = walk.odometry(name)
        shift = each.start_m if each.frame == "own" else 0.0
        moved[name] = replace(each, position_m=each.position_m - shift, start_m=np.zeros(2))
    return replace(walk, **moved)
