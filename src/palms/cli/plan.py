"""``palms plan``: look at floor plans, repair and convert them."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palms.cli._options import Json, OnePlanFormat, OnePlanOptions, PlanPath, Png, Scale
from palms.cli._outputs import check_file, describe, write_result

if TYPE_CHECKING:
    from palms.floorplan import FloorPlan

__all__ = ["app"]

app = typer.Typer(help="Look at floor plans, repair and convert them.", no_args_is_help=True)


@app.command(epilog="Example: palms plan info maps/E2.csv")
def info(
    plan: PlanPath,
    json: Json = None,
    format: OnePlanFormat = None,
    option: OnePlanOptions = None,
    scale: Scale = None,
) -> None:
    """Tell what a floor plan holds, and what looks wrong with it."""
    from palms.cli._inputs import Input, read_plan, scaled

    check_file(json)
    facts = _facts(read_plan(Input(plan, format, scaled(option, scale))))
    describe(_words(facts), json)
    write_result(facts, json)


def _words(facts: dict[str, Any]) -> list[tuple[str, str]]:
    classes = [
        (name, f"{each['count']}, {each['length_m']:.1f} m")
        for name, each in facts["segments"].items()
        if each["count"]
    ]
    width, height = facts["size_m"]
    angle = round(math.degrees(facts["orientation_rad"]), 1) % 90
    place = facts["origin"]
    problems = facts["problems"] or ["nothing found"]
    return [
        ("plan", facts["plan"]),
        *([("level", facts["level"])] if facts["level"] else []),
        *([("origin", f"lon {place[0]:.6f}, lat {place[1]:.6f}")] if place else []),
        ("size", f"{width:.1f} x {height:.1f} m"),
        *classes,
        ("rooms", str(len(facts["rooms"])) if facts["rooms"] else "none named"),
        ("main directions", f"{angle:.1f}° and {angle + 90:.1f}°"),
        ("free area", f"{facts['free_area_m2']:.0f} m²"),
        *[("looks wrong" if i == 0 else "", text) for i, text in enumerate(problems)],
    ]


def _facts(plan: FloorPlan) -> dict[str, Any]:
    from palms.floorplan import SegmentClass
    from palms.geometry import lengths
    from palms.orientation import principal_orientation
    from palms.repair import find_problems, free_space

    low, high = plan.bounds_m
    segments = {each.name.lower(): plan.of_class(each) for each in SegmentClass}
    space = free_space(plan)
    return {
        "schema": "palms-plan/1",
        "plan": plan.name,
        "level": plan.level,
        "origin": None if plan.origin is None else [plan.origin.lon_deg, plan.origin.lat_deg],
        "size_m": plan.size_m.tolist(),
        "bounds_m": [low.tolist(), high.tolist()],
        "segments": {
            name: {"count": len(each), "length_m": float(lengths(each).sum())}
            for name, each in segments.items()
        },
        "rooms": [room.name for room in plan.rooms],
        "orientation_rad": principal_orientation(plan.segments_m),
        "free_area_m2": space.area_m2,
        "unreachable_m2": space.unreachable_m2,
        "problems": find_problems(plan, space),
    }


@app.command(epilog="Example: palms plan show maps/E2.csv --png E2.png")
def show(
    plan: PlanPath,
    png: Png = None,
    format: OnePlanFormat = None,
    option: OnePlanOptions = None,
    scale: Scale = None,
) -> None:
    """Draw a floor plan; into <plan>.png when no file is named."""
    from palms.cli._inputs import Input, read_plan, scaled

    floor = read_plan(Input(plan, format, scaled(option, scale)))
    plain = re.sub(r"[^-.()\w ]", "_", floor.name)
    target = png or Path(f"{plain}.png")
    if png is None and target.exists() and target.samefile(plan):
        target = target.with_name(f"{target.stem}-plan.png")
    check_file(target)
    from palms.cli._pictures import draw_plan

    draw_plan(target, floor)
    typer.echo(f"Picture: {target}")


@app.command(epilog="Example: palms plan convert plan.dxf plan.csv --snap 0.02 --merge")
def convert(
    plan: PlanPath,
    target: Annotated[
        Path,
        typer.Argument(
            metavar="TARGET", help="File to write: .csv, .geojson, or .yaml for a ROS map.",
            show_default=False,
        ),
    ],
    *,
    to: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Format to write, when TARGET does not tell.",
                     show_default=False),
    ] = None,
    crop: Annotated[
        str | None,
        typer.Option(metavar="X0,Y0,X1,Y1", help="Keep what lies in this box, in metres.",
                     show_default=False),
    ] = None,
    snap: Annotated[
        float | None,
        typer.Option(metavar="METRES", help="Join ends that are that near to each other.",
                     show_default=False),
    ] = None,
    merge: Annotated[
        bool, typer.Option("--merge", help="Join walls that overlap or go on in one line.")
    ] = False,
    close_gaps: Annotated[
        float | None,
        typer.Option(metavar="METRES", help="Close gaps up to so wide between loose ends.",
                     show_default=False),
    ] = None,
    format: OnePlanFormat = None,
    option: OnePlanOptions = None,
    scale: Scale = None,
) -> None:  # fmt: skip
    """Write a floor plan in another format, repaired where that is asked for."""
    from palms import repair
    from palms.cli._inputs import Input, read_plan, scaled
    from palms.io import write_floorplan

    box = None if crop is None else _box(crop)
    floor = read_plan(Input(plan, format, scaled(option, scale)))
    check_file(target)
    told = []
    if box is not None:
        floor, text = repair.crop(floor, box)
        told.append(text)
    if snap is not None:
        floor, text = repair.snap(floor, snap)
        told.append(text)
    if merge:
        floor, text = repair.merge(floor)
        told.append(text)
    if close_gaps is not None:
        floor, text = repair.close_gaps(floor, close_gaps)
        told.append(text)
    write_floorplan(floor, target, format=to)
    for text in told:
        typer.echo(text)
    typer.echo(f"Written: {target}, {len(floor.segments_m)} segments")


def _box(text: str) -> tuple[float, float, float, float]:
    from palms.io.values import parse_number

    numbers = [parse_number(part) for part in text.split(",")]
    known = [n for n in numbers if n is not None and math.isfinite(n)]
    if len(numbers) != 4 or len(known) != 4:
        raise typer.BadParameter("--crop: four numbers between commas: x0,y0,x1,y1")
    return known[0], known[1], known[2], known[3]
