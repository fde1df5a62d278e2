"""``palms track``: follow a recorded walk."""

from __future__ import annotations

import os
import warnings
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palms.cli._levels import Above, AllLevels, HintProbability, Level, Near, RoomName
from palms.cli._options import (
    CellSize,
    Json,
    Method,
    Out,
    PlanFormat,
    PlanOptions,
    PlanPath,
    ScanFormat,
    ScanOptions,
    ScanPath,
    Source,
    WalkFormat,
    WalkOptions,
    WalkPath,
)
from palms.cli._outputs import (
    Speaker,
    check_file,
    check_folder,
    is_stdout,
    progress,
    speaker,
    table,
    write_result,
)
from palms.errors import PalmsWarning

if TYPE_CHECKING:
    from palms.cli._inputs import Case
    from palms.localizer import Track
    from palms.plot.story import Story
    from palms.settings import Settings

__all__ = ["EXAMPLE", "track"]

EXAMPLE = (
    "Example: palms track maps/E2.csv trajectories/E2/walk-1/Session_7 trajectories/E2/walk-1 "
    "--trials 10 --json track.json"
)


def track(
    plan: PlanPath,
    scan: ScanPath,
    walk: WalkPath,
    *,
    method: Method = "palms",
    walk_source: Annotated[
        Source | None,
        typer.Option(
            "--walk-source",
            show_default=False,
            help="Which odometry of the walk; when left out arkit, else the one that it has.",
        ),
    ] = None,
    particles: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Number of particles; the method's own when left out.",
            show_default=False,
        ),
    ] = None,
    seed: Annotated[
        int, typer.Option(metavar="S", min=0, help="Seed of the first trial; the i-th has S + i.")
    ] = 0,
    trials: Annotated[
        int, typer.Option(metavar="N", min=1, help="How often, each with a seed of its own.")
    ] = 1,
    above: Above = None,
    all_levels: AllLevels = False,
    near: Near = None,
    room: RoomName = None,
    level: Level = None,
    hint_probability: HintProbability = 0.9,
    spoken: Annotated[
        bool,
        typer.Option("--say", help="Print what a walker would have been told, with the times."),
    ] = False,
    json: Json = None,
    out: Out = None,
    cell_size: CellSize = None,
    plan_format: PlanFormat = None,
    plan_option: PlanOptions = None,
    scan_format: ScanFormat = None,
    scan_option: ScanOptions = None,
    walk_format: WalkFormat = None,
    walk_option: WalkOptions = None,
) -> None:
    """Follow a recorded walk and tell when and where it was localized."""
    from palms.cli import _inputs as inputs
    from palms.cli import _levels as levels
    from palms.cli._words import advised

    settings = inputs.make_settings(method, cell_size, particles)
    hints = levels.hints_of(near, room, level, hint_probability, settings)
    building = levels.read_building(
        inputs.Input(plan, plan_format, plan_option), above or (), all_levels
    )
    case = inputs.read_case(
        building,
        inputs.Input(scan, scan_format, scan_option),
        inputs.Input(walk, walk_format, walk_option),
        walk_source.value if walk_source else None,
    )
    case = replace(case, hints=hints)
    check_file(json)
    check_folder(out)
    say = speaker(json)
    case = prepared(case, settings)
    tracks = follow(case, settings, range(seed, seed + trials))
    if case.advice is not None:
        say(advised(case.advice))
    tell(tracks, case, say)
    note_jumps(case, settings)
    if spoken:
        read_out(case, settings, seed, say)
    write_result(document(tracks, case, settings), json)
    if json is not None and not is_stdout(json):
        say(f"Result: {json}")
    if out is not None:
        from palms.cli._pictures import tell_story

        draw(out, tell_story(case, settings, seed), case, say)


def prepared(case: Case, settings: Settings) -> Case:
    """Return a case whose plan is in cells and whose scan was searched for, once for all."""
    import palms
    from palms.advice import advise
    from palms.cli._compiling import announcing

    with announcing(lambda text: typer.echo(text, err=True)):
        if case.building is None:
            case = replace(case, raster=palms.rasterize(case.plan, settings.raster))
        if not settings.start.by_scan:
            return case
        found = palms.locate(case.ground, case.scan, settings)
    return replace(case, found=found, advice=advise(case.scan, found))


def read_out(case: Case, settings: Settings, seed: int, say: Speaker) -> None:
    """Say the sentences that the voice has for the first trial."""
    from palms.voice.recorded import narrate

    plan = case.building or case.plan
    for _, time_s, saying in narrate(plan, case.told, case.odometry, settings, seed):
        details = "" if saying.details is None else f" ({saying.details})"
        say(f"{time_s:6.1f} s  {saying.text}{details}")


def follow(case: Case, settings: Settings, seeds: range) -> list[Track]:
    """Return one track for each seed; shows progress on a terminal."""
    import palms
    from palms.cli._compiling import announcing

    jobs = min(len(seeds), os.cpu_count() or 1)
    found = []
    with (
        announcing(lambda text: typer.echo(text, err=True)),
        progress(len(seeds), "Following the walk") as advance,
        closing(
            palms.track_trials(case.ground, case.told, case.odometry, settings, seeds, jobs)
        ) as tracks,
    ):
        for each in tracks:
            found.append(each)
            advance()
    return found


def tell(tracks: list[Track], case: Case, say: Speaker) -> None:
    """Say what came out: a line for each trial, and all together when there are several."""
    from palms.cli._words import HEADINGS, at_the_end, outcome, row, summary

    if len(tracks) > 1:
        for line in table(HEADINGS, [row(each, case) for each in tracks]):
            say(line)
        say(summary(tracks, case))
        return
    (only,) = tracks
    for first, second in (outcome(only, case), at_the_end(only, case)):
        say(typer.style(first, bold=True))
        if second:
            say(f"  {second}")


def note_jumps(case: Case, settings: Settings) -> None:
    """Note which moves the method took for none of the phone's."""
    from palms.jumps import jumps_of

    found = jumps_of(case.odometry, settings.jump) if settings.is_ours else []
    if found:
        longest = max(found, key=lambda move: move.length_m)
        also = f" and {len(found) - 1} more" if len(found) > 1 else ""
        warnings.warn(
            f"the walk's odometry jumps by {longest.length_m:.1f} m at {longest.time_s:.1f} s"
            f"{also}, faster than anybody walks; that was taken for an error of the tracking",
            PalmsWarning,
            stacklevel=2,
        )


def draw(folder: Path, story: Story, case: Case, say: Speaker) -> None:
    """Write report, figures and animation of one trial, and say where they are."""
    from palms.cli._pictures import draw_walk

    report, *others = draw_walk(folder, story, case)
    say(f"Report: {report}")
    say(f"  beside it: {', '.join(path.name for path in others)}")


def document(tracks: list[Track], case: Case, settings: Settings) -> dict[str, object]:
    """Return tracks as a ``palms-track/1`` document, with the names of the input."""
    from palms.io.track_json import track_document

    return track_document(
        tracks, case.plan, settings, case.advice,
        scan=case.scan_name, walk=case.walk_name, walk_source=case.source,
    )  # fmt: skip
