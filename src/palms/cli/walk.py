"""``palms walk``: look at recorded walks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from palms.cli._options import Json, OneWalkFormat, OneWalkOptions, WalkPath
from palms.cli._outputs import check_file, describe, write_result

if TYPE_CHECKING:
    from palms.io import RecordedWalk

__all__ = ["app"]

app = typer.Typer(help="Look at recorded walks.", no_args_is_help=True)


@app.callback()
def walk() -> None:
    """Look at recorded walks."""


@app.command(epilog="Example: palms walk info trajectories/E2/walk-1")
def info(
    walk: WalkPath,
    json: Json = None,
    format: OneWalkFormat = None,
    option: OneWalkOptions = None,
) -> None:
    """Tell what a recorded walk holds: samples, length, odometry, references."""
    from palms.cli._inputs import Source, read_walk, walk_name

    check_file(json)
    read = read_walk(Source(walk, format, option))
    facts = {"schema": "palms-walk/1", "walk": walk_name(walk), **_facts(read)}
    describe(
        [
            ("walk", facts["walk"]),
            ("session", ", ".join(facts["session"]) or "not named"),
            ("samples", f"{facts['samples']}, {facts['duration_s']:.0f} s"),
            *((name, f"{length:.1f} m") for name, length in facts["length_m"].items()),
            ("reference", f"{facts['references']} of {facts['samples']} samples"),
        ],
        json,
    )
    write_result(facts, json)


def _facts(walk: RecordedWalk) -> dict[str, Any]:
    return {
        "session": list(walk.session),
        "samples": len(walk),
        "duration_s": float(walk.time_s[-1]),
        "length_m": {name: float(walk.odometry(name).walked_m[-1]) for name in walk.sources},
        "references": int(walk.has_reference.sum()),
        "truth": walk.truth is not None,
    }
