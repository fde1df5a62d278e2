"""``palms plan``: look at floor plans."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from palms.cli._options import Json, PlanPath, Png
from palms.cli._outputs import check_file, describe, write_result

if TYPE_CHECKING:
    from palms.floorplan import FloorPlan

__all__ = ["app"]

app = typer.Typer(help="Look at floor plans.", no_args_is_help=True)


@app.command(epilog="Example: palms plan info maps/E2.csv")
def info(plan: PlanPath, json: Json = None) -> None:
    """Tell what a floor plan holds: size, walls, doors, rooms."""
    from palms.io import read_floorplan

    check_file(json)
    facts = _facts(read_floorplan(plan))
    classes = [
        (name, f"{each['count']}, {each['length_m']:.1f} m")
        for name, each in facts["segments"].items()
        if each["count"]
    ]
    width, height = facts["size_m"]
    describe(
        [
            ("plan", facts["plan"]),
            *([("level", facts["level"])] if facts["level"] else []),
            ("size", f"{width:.1f} x {height:.1f} m"),
            *classes,
            ("rooms", str(len(facts["rooms"])) if facts["rooms"] else "none named"),
            ("main direction", f"{math.degrees(facts['orientation_rad']):.1f}°"),
        ],
        json,
    )
    write_result(facts, json)


def _facts(plan: FloorPlan) -> dict[str, Any]:
    from palms.floorplan import SegmentClass
    from palms.geometry import lengths
    from palms.orientation import principal_orientation

    low, high = plan.bounds_m
    segments = {each.name.lower(): plan.of_class(each) for each in SegmentClass}
    return {
        "schema": "palms-plan/1",
        "plan": plan.name,
        "level": plan.level,
        "size_m": plan.size_m.tolist(),
        "bounds_m": [low.tolist(), high.tolist()],
        "segments": {
            name: {"count": len(each), "length_m": float(lengths(each).sum())}
            for name, each in segments.items()
        },
        "rooms": [room.name for room in plan.rooms],
        "orientation_rad": principal_orientation(plan.segments_m),
    }


@app.command(epilog="Example: palms plan show maps/E2.csv --png E2.png")
def show(plan: PlanPath, png: Png = None) -> None:
    """Draw a floor plan; into <plan>.png when no file is named."""
    from palms.io import read_floorplan

    floor = read_floorplan(plan)
    target = png or Path(f"{floor.name}.png")
    check_file(target)
    from palms.cli._pictures import draw_plan

    draw_plan(target, floor)
    typer.echo(f"Picture: {target}")
