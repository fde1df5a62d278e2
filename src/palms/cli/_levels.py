"""Several levels and hints: options that commands share, and what they mean."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palms.cli._inputs import Input
from palms.errors import InputError

if TYPE_CHECKING:
    from palms.building import Building
    from palms.floorplan import FloorPlan
    from palms.hints import Hint
    from palms.settings import Settings

__all__ = [
    "Above",
    "AllLevels",
    "HintProbability",
    "Level",
    "Near",
    "RoomName",
    "hints_of",
    "read_building",
]

NEAR_M = 5.0  # ours: radius of --near where none is said

Above = Annotated[
    list[Path] | None,
    typer.Option(
        "--above", metavar="FILE", show_default=False,
        help="Plan of the next level up, in the same frame. Repeatable; PLAN is the lowest.",
    ),
]  # fmt: skip
AllLevels = Annotated[
    bool, typer.Option("--all-levels", help="Take all levels that PLAN holds (IMDF, GeoJSON).")
]
Near = Annotated[
    str | None,
    typer.Option(
        "--near", metavar="X,Y[,RADIUS]", show_default=False,
        help="Hint: it starts near this place of the map, within 5 m if no radius is given.",
    ),
]  # fmt: skip
RoomName = Annotated[
    str | None,
    typer.Option(
        "--room", metavar="NAME", help="Hint: it starts in this room.", show_default=False
    ),
]
Level = Annotated[
    str | None,
    typer.Option(
        "--level", metavar="NAME", help="Hint: it starts on this level.", show_default=False
    ),
]
HintProbability = Annotated[
    float,
    typer.Option("--hint-probability", metavar="P", help="How often such hints are true."),
]


def read_building(plan: Input, above: Sequence[Path], all_levels: bool) -> Building:
    """Read the plan, or the plans, that a user named; of one level, too.

    Parameters
    ----------
    plan : Input
        The lowest level; or a file of several.
    above : sequence of Path
        Plans of the levels above, from the next one up.
    all_levels : bool
        Whether to take all levels of the plan's file.

    Raises
    ------
    InputError
        When a file is at fault, two levels have one name, or a plan lies nowhere above the
        lowest one.
    """
    from palms.building import Building
    from palms.cli._inputs import read_plan
    from palms.io.levels import with_level_name

    if all_levels and above:
        raise InputError("--above", expected="either that or --all-levels", got="both")
    if all_levels:
        return _all_levels(plan)
    if not above:
        return Building((read_plan(plan),))
    paths = (plan.path, *above)
    read = [read_plan(plan), *(read_plan(Input(path)) for path in above)]
    plans = [with_level_name(each, path) for each, path in zip(read, paths, strict=True)]
    for each, path in zip(plans[1:], above, strict=True):
        _check_frame(plans[0], each, path)
    return Building(tuple(plans))


def _all_levels(plan: Input) -> Building:
    from palms.io import FLOORPLANS, choose_format
    from palms.io import read_building as read_levels
    from palms.io.options import parse_options

    reader = choose_format(FLOORPLANS, plan.path, plan.format)
    read = getattr(reader, "read_levels", None) or reader.read
    options = parse_options(read, plan.options or (), f"option of format {reader.name}")
    return read_levels(plan.path, format=reader.name, **options)


def _check_frame(lowest: FloorPlan, plan: FloorPlan, path: Path) -> None:
    """Refuse a plan whose frame cannot be that of the lowest level."""
    (low, high), (left, right) = lowest.bounds_m, plan.bounds_m
    if (right < low).any() or (left > high).any():
        x, y, to_x, to_y = (*left, *right)
        raise InputError(
            f"--above {path}",
            expected="a plan above the lowest one, in its frame",
            got=f"one from x {x:.0f} to {to_x:.0f} m, y {y:.0f} to {to_y:.0f} m, beside it",
            fix="shift it to the frame of the lowest plan",
        )


def hints_of(
    near: str | None,
    room: str | None,
    level: str | None,
    probability: float,
    settings: Settings,
) -> tuple[Hint, ...]:
    """Return what a user said of where it starts.

    Parameters
    ----------
    near : str or None
        As ``X,Y`` or ``X,Y,RADIUS``, metres of the map.
    room, level : str or None
    probability : float
    settings : Settings
        Of the method, which must be one that listens.

    Raises
    ------
    InputError
        When a number is none, or out of its range, or the method takes no hints.

    Examples
    --------
    >>> from palms.settings import Settings
    >>> (hint,) = hints_of("3,4,2.5", None, "2", 0.9, Settings())
    >>> hint.place_m.tolist(), hint.radius_m, hint.level
    ([3.0, 4.0], 2.5, '2')
    """
    import numpy as np

    from palms.hints import Hint

    said = [name for name, what in (("--near", near), ("--room", room), ("--level", level)) if what]
    if not said:
        return ()
    if not settings.is_ours:
        raise InputError(
            said[0], expected="a method that takes hints (palms, no-scan)", got=settings.method
        )
    hints = []
    if near is not None:
        place, radius = _near(near)
        hints.append(Hint(np.array(place), radius, None, level, probability))
    if room is not None:
        hints.append(Hint(room=room, level=level, probability=probability))
    return tuple(hints) or (Hint(level=level, probability=probability),)


def _near(text: str) -> tuple[tuple[float, float], float]:
    from palms.io.values import parse_number

    numbers = [parse_number(part) for part in text.split(",")]
    known = [number for number in numbers if number is not None]
    if len(known) != len(numbers) or len(numbers) not in (2, 3):
        raise InputError(
            "--near", expected="X,Y or X,Y,RADIUS in metres", got=repr(text), fix="such as 12.5,3,5"
        )
    x, y, radius = (*known, NEAR_M)[:3]
    return (x, y), radius
