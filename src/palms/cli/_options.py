"""Arguments and options that several commands have."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

__all__ = [
    "CellSize",
    "Json",
    "Method",
    "OnePlanFormat",
    "OnePlanOptions",
    "OneScanFormat",
    "OneScanOptions",
    "OneWalkFormat",
    "OneWalkOptions",
    "Out",
    "PlanFormat",
    "PlanOptions",
    "PlanPath",
    "Png",
    "Scale",
    "ScanFormat",
    "ScanOptions",
    "ScanPath",
    "Source",
    "WalkFormat",
    "WalkOptions",
    "WalkPath",
]


class Source(StrEnum):
    """Which odometry of a recorded walk."""

    ARKIT = "arkit"
    RONIN = "ronin"


PlanPath = Annotated[
    Path,
    typer.Argument(
        metavar="PLAN", help="Floor plan; palms formats lists what can be read.", show_default=False
    ),
]
ScanPath = Annotated[
    Path,
    typer.Argument(
        metavar="SCAN",
        help="Scan: a folder Session_* or the file in it.",
        show_default=False,
    ),
]
WalkPath = Annotated[
    Path,
    typer.Argument(
        metavar="WALK", help="Recorded walk: its JSON file or folder.", show_default=False
    ),
]
Json = Annotated[
    Path | None,
    typer.Option(
        "--json", metavar="FILE", help="Write the result as JSON; - is standard output.",
        show_default=False,
    ),
]  # fmt: skip
Png = Annotated[
    Path | None,
    typer.Option("--png", metavar="FILE", help="Write a picture.", show_default=False),
]
Out = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", help="Write figures, animation and report.html into this folder.",
        show_default=False,
    ),
]  # fmt: skip
Method = Annotated[
    str,
    typer.Option(
        "--method", metavar="NAME",
        help="palms, paper, authors, uniform, uniform-ori or no-scan.",
    ),
]  # fmt: skip
CellSize = Annotated[
    float | None,
    typer.Option(
        "--cell-size", metavar="METRES",
        help="Side of a cell, 0.1 m when left out; larger ones for very large plans.",
        show_default=False,
    ),
]  # fmt: skip


def _format_option(what: str, *names: str) -> Any:  # noqa: ANN401
    return typer.Option(
        *names, metavar="NAME", help=f"Format of the {what}; found out when left out.",
        show_default=False,
    )  # fmt: skip


def _reader_option(what: str, *names: str) -> Any:  # noqa: ANN401
    return typer.Option(
        *names, metavar="NAME=VALUE", help=f"Option for the reader of the {what}. Repeatable.",
        show_default=False,
    )  # fmt: skip


PlanFormat = Annotated[str | None, _format_option("floor plan", "--plan-format")]
PlanOptions = Annotated[list[str] | None, _reader_option("floor plan", "--plan-option")]
ScanFormat = Annotated[str | None, _format_option("scan", "--scan-format")]
ScanOptions = Annotated[list[str] | None, _reader_option("scan", "--scan-option")]
WalkFormat = Annotated[str | None, _format_option("walk", "--walk-format")]
WalkOptions = Annotated[list[str] | None, _reader_option("walk", "--walk-option")]

# Of commands that read one file; --format and --option will do.
OnePlanFormat = Annotated[str | None, _format_option("floor plan", "--plan-format", "--format")]
OnePlanOptions = Annotated[
    list[str] | None, _reader_option("floor plan", "--plan-option", "--option")
]
Scale = Annotated[
    float | None,
    typer.Option(
        "--scale",
        metavar="METRES",
        help="Metres of a pixel, or of a unit of the drawing; short for --option scale=METRES.",
        show_default=False,
    ),
]
OneScanFormat = Annotated[str | None, _format_option("scan", "--scan-format", "--format")]
OneScanOptions = Annotated[list[str] | None, _reader_option("scan", "--scan-option", "--option")]
OneWalkFormat = Annotated[str | None, _format_option("walk", "--walk-format", "--format")]
OneWalkOptions = Annotated[list[str] | None, _reader_option("walk", "--walk-option", "--option")]
