"""``palms demo``: the whole method on the sample building."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palms.cli._options import Json
from palms.cli._outputs import check_file, check_folder, is_stdout, speaker, write_result

if TYPE_CHECKING:
    from palms.cli._inputs import Case

__all__ = ["EXAMPLE", "demo"]

EXAMPLE = "Example: palms demo --out my-demo"
SEED = 0


def demo(
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Folder for report, figures, animation.")
    ] = Path("palms-demo"),
    json: Json = None,
) -> None:
    """Localize a phone in the sample building that comes with palms, and draw a report."""
    from palms.cli._compiling import announcing
    from palms.cli._inputs import make_settings
    from palms.cli.track import document, draw, tell

    check_file(json)
    check_folder(out)
    say = speaker(json)
    case, settings = _sample(), make_settings("palms")
    width, height = case.plan.size_m
    say(
        f"A sample building: a university floor of {width:.0f} x {height:.0f} m with "
        f"{len(case.plan.rooms)} rooms and corridors,\n"
        f"one LiDAR scan ({len(case.scan.walls_m)} walls seen) and a walk of "
        f"{case.odometry.walked_m[-1]:.0f} m. Where is the phone?\n"
    )
    with announcing(lambda text: typer.echo(text, err=True)):
        from palms.cli._pictures import tell_story

        story = tell_story(case, settings, SEED)
    tracks = [story.track]
    tell(tracks, case, say)
    write_result(document(tracks, case, settings), json)
    say("\nDrawing ...")
    draw(out, story, case, say)
    if json is not None and not is_stdout(json):
        say(f"Result: {json}")


def _sample() -> Case:
    from palms.cli._inputs import Input, read_case
    from palms.io import open_dataset
    from palms.sample import sample_folder

    case = open_dataset(sample_folder()).cases[0]
    paths = case.plan_path, case.scan_paths[0], case.walk_path
    plan, scan, walk = (Input(path) for path in paths)
    return read_case(plan, scan, walk)
