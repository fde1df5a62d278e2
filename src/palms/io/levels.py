"""The levels of a building, as a file has them: plans that lie above each other."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from typing import NamedTuple

from palms.errors import FormatError, PalmsWarning
from palms.floorplan import FloorPlan

__all__ = ["LevelPlan", "gather_levels"]


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
    """

    name: str
    ordinal: float
    plan: FloorPlan


def gather_levels(
    found: Iterable[tuple[str, float, Callable[[], FloorPlan]]],
) -> tuple[LevelPlan, ...]:
    """Return the levels of a file from the lowest up, without those that have no walls.

    Parameters
    ----------
    found : iterable
        Name and ordinal of each level, and a function that reads its plan.

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
    >>> up, down = ("1", 1.0, lambda: hall), ("G", 0.0, lambda: hall)
    >>> [level.name for level in gather_levels([up, down])]
    ['G', '1']
    """
    levels, problems = [], []
    for name, ordinal, read in sorted(found, key=lambda each: each[1]):
        try:
            levels.append(LevelPlan(name, ordinal, read()))
        except FormatError as error:
            problems.append((name, error))
    if problems and not levels:
        raise problems[0][1]
    for name, problem in problems:
        warnings.warn(f"level {name} is left out: {problem}", PalmsWarning, stacklevel=4)
    return tuple(levels)
