"""``palms locate``: one scan alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from palms.cli._levels import Above, AllLevels, HintProbability, Level, Near, RoomName
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
    from palms.advice import Advice
    from palms.building import Building
    from palms.hints import Hint
    from palms.places import Place
    from palms.scan import Scan
    from palms.settings import Settings

__all__ = ["EXAMPLE", "locate"]

EXAMPLE = "Example: palms locate maps/E2.csv trajectories/E2/walk-1/Session_7 --top 3"


def locate(
    plan: PlanPath,
    scan: ScanPath,
    *,
    top: Annotated[int, typer.Option(min=1, help="How many places to tell.")] = 5,
    above: Above = None,
    all_levels: AllLevels = False,
    near: Near = None,
    room: RoomName = None,
    level: Level = None,
    hint_probability: HintProbability = 0.9,
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
    from palms.cli import _levels as levels
    from palms.cli._compiling import announcing
    from palms.cli._inputs import Input, make_settings, read_scan, scan_name
    from palms.cli._words import advised
    from palms.io.track_json import locate_document

    settings = make_settings(method, cell_size)
    hints = levels.hints_of(near, room, level, hint_probability, settings)
    building = levels.read_building(Input(plan, plan_format, plan_option), above or (), all_levels)
    seen = read_scan(Input(scan, scan_format, scan_option))
    check_file(json)
    check_file(png)
    say = speaker(json)
    with announcing(lambda text: typer.echo(text, err=True)):
        found, advice = _found(building, seen, hints, settings)
    places = found if len(building.levels) == 1 else _on_levels(found, building)
    _tell(places, building, top, say)
    say(advised(advice))
    write_result(locate_document(places[:top], building, scan_name(scan), settings, advice), json)
    if json is not None and not is_stdout(json):
        say(f"Result: {json}")
    if png is not None:
        from palms.cli._pictures import draw_places

        draw_places(png, building.atlas.plan, seen, found[:top])
        say(f"Picture: {png}")


def _found(
    building: Building, scan: Scan, hints: Sequence[Hint], settings: Settings
) -> tuple[Sequence[Place], Advice]:
    """Return places of the building's atlas, and how much the scan and the hints tell."""
    import palms
    from palms.advice import advise
    from palms.places import find_places
    from palms.posterior import Posterior, hinted

    found = palms.locate(building, scan, settings)
    raster = building.atlas.raster(settings.raster)
    atlas = building.atlas if len(building.levels) > 1 else None
    for hint in hints:
        assert isinstance(found, Posterior)  # of the methods that take hints
        found = hinted(found, hint, raster, atlas)
    return find_places(found), advise(scan, found)


def _on_levels(places: Sequence[Place], building: Building) -> list[Place]:
    from palms.places import place_on_level

    return [place_on_level(place, building.atlas) for place in places]


def _tell(places: Sequence[Place], building: Building, top: int, say: Speaker) -> None:
    several = len(building.levels) > 1
    rows = [
        [
            str(rank),
            *([str(place.level)] if several else []),
            building.level(place.level or building.names[0]).room_at((place.x_m, place.y_m)) or "-",
            f"{place.x_m:.1f} m",
            f"{place.y_m:.1f} m",
            f"{math.degrees(place.drift_rad):.1f}°",
            f"{100 * place.p:.1f} %" if place.p >= 0.001 else "< 0.1 %",
        ]
        for rank, place in enumerate(places[:top], start=1)
    ]
    level = ["level"] if several else []
    for line in table(["", *level, "place", "x", "y", "drift", "probability"], rows):
        say(line)
    held = 100 * sum(place.p for place in places[:top])
    if len(places) > top:
        say(f"{len(places)} places in all; these {len(rows)} hold {held:.0f} % of the belief.")
