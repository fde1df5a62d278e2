"""The levels of a building, as a file has them: plans that lie above each other."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from palms.errors import FormatError, InputError, PalmsWarning
from palms.floorplan import FloorPlan
from palms.io.plan_csv import plan_name
from palms.io.values import StrPath

if TYPE_CHECKING:
    from palms.building import Building, Stairs

__all__ = ["LevelPlan", "building_of", "gather_levels", "is_stairs_word", "with_level_name"]

_STAIRS = ("stairs", "staircase", "stairwell", "elevator", "lift", "escalator")


def is_stairs_word(word: object) -> bool:
    """Whether a file's word for an area says that people get to other levels there.

    Examples
    --------
    >>> is_stairs_word("Elevator"), is_stairs_word("elevator lobby"), is_stairs_word(None)
    (True, False, False)
    """
    return isinstance(word, str) and word.strip().lower() in _STAIRS


class LevelPlan(NamedTuple):
    """One level of a building.

    Attributes
    ----------
    name : str
        As the file calls it.
    ordinal : float
        Counts from the lowest level up; the ground floor's is 0 where the file says so.
    plan : FloorPlan
        In a frame that all levels share.
    stairs : tuple of Stairs
        Areas that the file has as stairs, lifts or escalators, whatever their names.
    """

    name: str
    ordinal: float
    plan: FloorPlan
    stairs: tuple[Stairs, ...] = ()


def with_level_name(plan: FloorPlan, path: StrPath) -> FloorPlan:
    """Return a plan whose level has a name: its own, else its file's after ``-level-``.

    Examples
    --------
    >>> with_level_name(FloorPlan([[[0, 0], [8, 0]]]), "maps/E2-level-3.csv").level
    '3'
    """
    if plan.level:
        return plan
    name = plan_name(path)
    return replace(plan, level=name.rpartition("-level-")[2])


def gather_levels(
    found: Iterable[tuple[str, float, Callable[[], tuple[FloorPlan, tuple[Stairs, ...]]]]],
) -> tuple[LevelPlan, ...]:
    """Return the levels of a file from the lowest up, without those that have no walls.

    Parameters
    ----------
    found : iterable
        Name and ordinal of each level, and a function that reads its plan and its stairs.

    Raises
    ------
    FormatError
        When no level can be read; the reason is that of the first.

    Warns
    -----
    PalmsWarning
        For each level that cannot be read, such as a roof without walls, when others can.

    Examples
    --------
    >>> hall = FloorPlan([[[0, 0], [8, 0]]])
    >>> up, down = ("1", 1.0, lambda: (hall, ())), ("G", 0.0, lambda: (hall, ()))
    >>> [level.name for level in gather_levels([up, down])]
    ['G', '1']
    """
    levels, problems = [], []
    for name, ordinal, read in sorted(found, key=lambda each: each[1]):
        try:
            levels.append(LevelPlan(name, ordinal, *read()))
        except FormatError as error:
            problems.append((name, error))
    if problems and not levels:
        raise problems[0][1]
    for name, problem in problems:
        warnings.warn(f"level {name} is left out: {problem}", PalmsWarning, stacklevel=4)
    return tuple(levels)


def building_of(levels: Sequence[LevelPlan], what: str) -> Building:
    """Return levels as a building, joined by the stairs that lie above each other.

    Parameters
    ----------
    levels : sequence of LevelPlan
        From the lowest up.
    what : str
        What to call the file in a message.

    Raises
    ------
    InputError
        When two levels have one name.

    Examples
    --------
    >>> hall = FloorPlan([[[0, 0], [8, 0]]])
    >>> building_of([LevelPlan("G", 0.0, hall), LevelPlan("1", 1.0, hall)], "a.zip").names
    ('G', '1')
    """
    from palms.building import Building, joined_stairs, named_stairs

    names = [level.name for level in levels]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(
            what, expected="one building, whose levels have names of their own",
            got=f"several levels called {', '.join(repr(name) for name in twice)}",
            fix="choose a building with the option building=NAME, where the format has it",
        )  # fmt: skip
    plans = [replace(level.plan, level=level.name or level.plan.level) for level in levels]
    stairs = [(*level.stairs, *named_stairs(level.plan)) for level in levels]
    return Building(tuple(plans), joined_stairs(stairs))
