"""``palms simulate``: scans and walks in simulated worlds."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palms.cli._options import Json, PlanFormat, PlanOptions
from palms.cli._outputs import check_file, check_folder, is_stdout, progress, speaker, write_result

if TYPE_CHECKING:
    from palms.cli._inputs import Input
    from palms.evaluation.simulation import CaseSettings

__all__ = ["EXAMPLE", "simulate"]

EXAMPLE = "Example: palms simulate --building office --seed 7 --out simulated"
SCHEMA = "palms-simulate/1"


class Recorded(StrEnum):
    """Which odometry is recorded."""

    BOTH = "both"
    VIO = "vio"
    INERTIAL = "inertial"


class Hint(StrEnum):
    """What somebody says on the way."""

    ROOM = "room"
    PLACE = "place"


def simulate(
    plan: Annotated[
        Path | None,
        typer.Argument(
            metavar="[PLAN]", help="Floor plan to build a world from.", show_default=False
        ),
    ] = None,
    *,
    out: Annotated[
        Path, typer.Option("--out", metavar="DATASET", help="New folder for the data set.")
    ],
    building: Annotated[
        str | None,
        typer.Option(
            metavar="KIND", help="Draw buildings instead: office or campus.", show_default=False
        ),
    ] = None,
    buildings: Annotated[
        int, typer.Option(metavar="N", min=1, help="How many; their seeds are S, S + 1, ...")
    ] = 1,
    levels: Annotated[
        int, typer.Option(metavar="N", min=1, max=20, help="Levels of each; walks go up them.")
    ] = 1,
    starts: Annotated[
        int, typer.Option(metavar="N", min=1, help="Scans in all, spread over the buildings.")
    ] = 7,
    walks: Annotated[int, typer.Option(metavar="N", min=1, help="Walks from each start.")] = 2,
    length: Annotated[float, typer.Option(metavar="METRES", help="Length of a walk.")] = 147.0,
    seed: Annotated[
        int, typer.Option(metavar="S", min=0, help="Seed of the (first) building.")
    ] = 0,
    odometry: Annotated[Recorded, typer.Option(help="What the phone records.")] = Recorded.BOTH,
    rate: Annotated[
        float | None,
        typer.Option(
            metavar="HZ", help="Samples a second; one for each step when left out.",
            show_default=False,
        ),
    ] = None,
    scan_turn: Annotated[
        float, typer.Option(metavar="DEGREES", help="How far the user turns; 180 for half a scan.")
    ] = 360.0,
    second_scan: Annotated[
        float | None,
        typer.Option(metavar="METRES", help="Scan again after so many.", show_default=False),
    ] = None,
    jump: Annotated[
        float | None,
        typer.Option(
            metavar="METRES", help="Let the odometry jump after so many.", show_default=False
        ),
    ] = None,
    jump_by: Annotated[
        float | None,
        typer.Option(
            metavar="METRES", help="How far it jumps, without a turn; drawn when left out.",
            show_default=False,
        ),
    ] = None,
    hint: Annotated[
        Hint | None,
        typer.Option(help="Let somebody name the room or the place.", show_default=False),
    ] = None,
    wrong_hint: Annotated[
        bool, typer.Option("--wrong-hint", help="The hint is not true.")
    ] = False,
    hint_after: Annotated[
        float, typer.Option(metavar="METRES", help="When the hint is given.")
    ] = 30.0,
    stops: Annotated[
        bool, typer.Option("--stops", help="Walkers stand still now and then.")
    ] = False,
    rooms: Annotated[bool, typer.Option("--rooms", help="Walkers go into rooms.")] = False,
    double: Annotated[
        str | None,
        typer.Option(
            metavar="NUISANCE", help="Double one kind of noise, such as normal_sd_m.",
            show_default=False,
        ),
    ] = None,
    pictures: Annotated[
        bool, typer.Option("--pictures/--no-pictures", help="Draw every case.")
    ] = True,
    jobs: Annotated[
        int, typer.Option(metavar="N", min=1, help="Processes, each a building at a time.")
    ] = 1,
    json: Json = None,
    plan_format: PlanFormat = None,
    plan_option: PlanOptions = None,
) -> None:  # fmt: skip
    """Simulate scans and walks, in a plan's world or in buildings drawn from a seed.

    What methods are given has gone stale: walls moved, doors undrawn, the scale off. The
    noise of each case is drawn anew and kept in its nuisances.json.
    """
    from palms.cli._inputs import Input
    from palms.evaluation.simulation import CaseSettings

    _check_usage(plan, building, buildings, (starts, levels))
    settings = CaseSettings(
        length_m=length, rate_hz=rate, odometry=odometry.value,
        scan_turn_rad=math.radians(scan_turn), second_scan_m=second_scan, jump_m=jump,
        hint=None if hint is None else hint.value, hint_is_right=not wrong_hint,
        jump_size_m=jump_by, hint_m=hint_after,
        stops=stops, rooms=rooms,
    )  # fmt: skip
    check_file(json)
    _check_new(out)
    say = speaker(json)
    per_site = [starts // buildings + (k < starts % buildings) for k in range(buildings)]
    drawn = str(building) if plan is None else Input(plan, plan_format, plan_option)
    tasks = [
        _Task(drawn, seed + k, levels, (count, walks), settings, double, pictures)
        for k, count in enumerate(per_site)
    ]
    rows = []
    with progress(starts * walks, "Simulating") as advance:
        for row in _simulated(out, tasks, jobs):
            rows.append(row)
            advance()
    rows.sort(key=lambda row: row.pop("order"))
    document = {
        "schema": SCHEMA, "dataset": str(out), "seed": seed,
        "building": building, "plan": None if plan is None else str(plan), "cases": rows,
    }  # fmt: skip
    write_result(document, json)
    _tell(rows, out, say)
    if json is not None and not is_stdout(json):
        say(f"Result: {json}")


def _check_usage(
    plan: Path | None, building: str | None, buildings: int, numbers: tuple[int, int]
) -> None:
    """Refuse what makes no sense together."""
    starts, levels = numbers
    if (plan is None) == (building is None):
        raise typer.BadParameter("give a PLAN or --building KIND, one of them")
    if plan is not None and (buildings > 1 or levels > 1):
        raise typer.BadParameter("--buildings and --levels go with --building")
    if starts < buildings:
        raise typer.BadParameter(f"--starts: {buildings} buildings want at least as many")


def _check_new(out: Path) -> None:
    from palms.errors import OutputError

    check_folder(out)
    if out.is_dir() and any(out.iterdir()):
        raise OutputError(
            str(out), expected="a new folder", got="one with files in it",
            fix="remove it or choose another",
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class _Task:
    """A building, and what to simulate in it: `count` starts, and walks from each."""

    source: Input | str
    seed: int
    levels: int
    count: tuple[int, int]
    settings: CaseSettings
    double: str | None
    pictures: bool


def _simulated(out: Path, tasks: list[_Task], jobs: int) -> Iterator[dict[str, Any]]:
    """Write all cases and yield what there is to say of each, as they come."""
    from contextlib import closing

    from palms.processes import in_processes

    if min(jobs, len(tasks)) == 1:
        for task in tasks:
            yield from _written(out, task)
        return
    calls = ((out, task) for task in tasks)
    with closing(in_processes(_all_written, calls, jobs, f"remove {out} and begin anew")) as done:
        for rows in done:
            yield from rows


def _all_written(out: Path, task: _Task) -> list[dict[str, Any]]:
    return list(_written(out, task))


def _written(out: Path, task: _Task) -> Iterator[dict[str, Any]]:
    """Build one building, write its cases, and yield what there is to say of each."""
    from palms.building import Building
    from palms.cli._inputs import Input, read_plan
    from palms.evaluation.simulation import (
        Count,
        NuisanceRanges,
        generate_levels,
        make_site,
        simulate_site,
        write_simulated,
    )

    if isinstance(task.source, Input):
        building = Building((read_plan(task.source),))
    else:
        building = generate_levels(task.source, task.seed, task.levels)
    ranges = NuisanceRanges() if task.double is None else NuisanceRanges().double(task.double)
    site = make_site(building, task.seed, ranges)
    for k, case in enumerate(simulate_site(site, Count(*task.count), task.settings, ranges)):
        folder = write_simulated(out, site, case, task.pictures)
        walk = case.recorded.odometry(case.recorded.usual_source)
        yield {
            "order": (task.seed, k),
            "scene": site.name,
            "walk": case.name,
            "folder": str(folder.relative_to(out)),
            "walls": [len(scan.walls_m) for scan in case.scans],
            "walked_m": round(float(walk.walked_m[-1]), 2),
            "samples": len(walk),
            "events": [event.kind for event in case.events],
        }


def _tell(rows: list[dict[str, Any]], out: Path, say: Any) -> None:  # noqa: ANN401
    scenes = len({row["scene"] for row in rows})
    metres = sum(row["walked_m"] for row in rows)
    words = f"{scenes} buildings" if scenes > 1 else rows[0]["scene"]
    say(f"{len(rows)} walks of {metres / len(rows):.0f} m on average in {words}: {out}")
    say(f"Next: palms bench {out} --out results")
