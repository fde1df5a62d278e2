"""``palms locate``: one scan alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from palms.cli._options import (
    CellSize,
    Json,
    Method,
    PlanFormat,
    PlanOptions,
    PlanPath,
    Png,
    ScanFormat,
    ScanOptions,
    ScanPath,
)
from palms.cli._outputs import Speaker, check_file, is_stdout, speaker, table, write_result

if TYPE_CHECKING:
    from palms.floorplan import FloorPlan
    from palms.places import Place

__all__ = ["EXAMPLE", "locate"]

EXAMPLE = "Example: palms locate maps/E2.csv trajectories/E2/walk-1/Session_7 --top 3"


def locate(
    plan: PlanPath,
    scan: ScanPath,
    *,
    top: Annotated[int, typer.Option(min=1, help="How many places to tell.")] = 5,
    json: Json = None,
    png: Png = None,
    method: Method = "palms",
    cell_size: CellSize = None,
    plan_format: PlanFormat = None,
    plan_option: PlanOptions = None,
    scan_format: ScanFormat = None,
    scan_option: ScanOptions = None,
) -> None:
    """Tell where one scan may have been taken: places with drift and probability."""
    import palms
    from palms.cli._compiling import announcing
    from palms.cli._inputs import Input, make_settings, read_plan, read_scan, scan_name
    from palms.io.track_json import locate_document
    from palms.places import find_places

    settings = make_settings(method, cell_size)
    floor = read_plan(Input(plan, plan_format, plan_option))
    seen = read_scan(Input(scan, scan_format, scan_option))
    check_file(json)
    check_file(png)
    say = speaker(json)
    with announcing(lambda text: typer.echo(text, err=True)):
        places = find_places(palms.locate(floor, seen, settings))
    _tell(places, floor, top, say)
    write_result(locate_document(places[:top], floor, scan_name(scan), settings), json)
    if json is not None and not is_stdout(json):
        say(f"Result: {json}")
    if png is not None:
        from palms.cli._pictures import draw_places

        draw_places(png, floor, seen, places[:top])
        say(f"Picture: {png}")


def _tell(places: Sequence[Place], plan: FloorPlan, top: int, say: Speaker) -> None:
    rows = [
        [
            str(rank),
            plan.room_at((place.x_m, place.y_m)) or "-",
            f"{place.x_m:.1f} m",
            f"{place.y_m:.1f} m",
            f"{math.degrees(place.drift_rad):.1f}°",
            f"{100 * place.p:.1f} %" if place.p >= 0.001 else "< 0.1 %",
        ]
        for rank, place in enumerate(places[:top], start=1)
    ]
    for line in table(["", "place", "x", "y", "drift", "probability"], rows):
        say(line)
    held = 100 * sum(place.p for place in places[:top])
    if len(places) > top:
        say(f"{len(places)} places in all; these {len(rows)} hold {held:.0f} % of the belief.")
