"""Arguments and options that several commands have."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

__all__ = [
    "CellSize",
    "Json",
    "Method",
    "Out",
    "PlanPath",
    "Png",
    "ScanPath",
    "Source",
    "WalkPath",
]


class Source(StrEnum):
    """Which odometry of a recorded walk."""

    ARKIT = "arkit"
    RONIN = "ronin"


PlanPath = Annotated[
    Path,
    typer.Argument(metavar="PLAN", help="Floor plan, such as maps/E2.csv.", show_default=False),
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
