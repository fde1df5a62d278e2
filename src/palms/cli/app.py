"""The root command: its commands, and what is said when something goes wrong."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from palms.cli import bench, demo, formats, locate, plan, scan, serve, simulate, track, walk
from palms.cli._errors import CheckedGroup

__all__ = ["app"]

app = typer.Typer(
    name="palms",
    cls=CheckedGroup,
    help="Find where a phone is inside a building, from its floor plan, one LiDAR scan and a walk.",
    epilog="Start with: palms demo",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich" if sys.stdout.isatty() else None,  # plain and quicker in a pipe
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _show_version(wanted: bool) -> None:
    if wanted:
        import palms

        typer.echo(f"palms {palms.__version__}")
        raise typer.Exit


@app.callback()
def palms(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Say the version."),
    ] = False,
    debug: Annotated[
        bool, typer.Option("--debug", help="Show the traceback of an error, for a report.")
    ] = False,
) -> None:
    """Take the options that hold for every command."""


for command, name, epilog in (
    (demo.demo, "demo", demo.EXAMPLE),
    (locate.locate, "locate", locate.EXAMPLE),
    (track.track, "track", track.EXAMPLE),
    (simulate.simulate, "simulate", simulate.EXAMPLE),
    (bench.bench, "bench", bench.EXAMPLE),
    (serve.serve, "serve", serve.EXAMPLE),
):
    app.command(name, epilog=epilog)(command)
for group, name in ((plan.app, "plan"), (scan.app, "scan"), (walk.app, "walk")):
    app.add_typer(group, name=name)
app.command("formats", epilog=formats.EXAMPLE)(formats.formats)
