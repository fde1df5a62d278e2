"""What generated buildings are like: every number of the generator.

The numbers are chosen for plausible university floors (simulation) and frozen: a change of
one changes every generated building, and with it every result on them.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["BUILDING_KINDS", "BuildingStyle", "RowTheme", "style_of"]

_Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class RowTheme:
    """What a row of rooms is like.

    Parameters
    ----------
    module_m : tuple of float
        Range of the width of its smallest rooms.
    offices, doubles, labs, services : float
        How often each kind of room comes.

    Examples
    --------
    >>> RowTheme((3.0, 4.0), 0.8, 0.1, 0.1, 0.0).module_m
    (3.0, 4.0)
    """

    module_m: _Range
    offices: float
    doubles: float
    labs: float
    services: float


_THEMES = (
    RowTheme((2.7, 3.9), 0.90, 0.06, 0.02, 0.02),  # self-similar offices
    RowTheme((2.8, 4.0), 0.66, 0.18, 0.10, 0.06),
    RowTheme((3.0, 3.6), 0.15, 0.25, 0.52, 0.08),  # laboratories
)


@dataclass(frozen=True, slots=True)
class BuildingStyle:
    """What buildings of one kind are like; ranges are in metres unless they say otherwise.

    Parameters
    ----------
    corridor_weights : tuple of float
        How often the main block has one, two or three parallel corridors.
    length_m : tuple
        Range of the main block's length, for one, two and three corridors.
    corridor_m, cross_m, stub_m : tuple of float
        Widths of corridors, of those that cross them and of short ones.
    row_m : tuple of float
        Depth of a row of rooms.
    core_m : tuple of float
        Distance between two corridors: one row deep, or two back to back.
    single_loaded_share : float
        Share of blocks with a corridor along the outer wall.
    cross_every_m : tuple of float
        Distance between crossing corridors.
    court_share : float
        Share of the cells between corridors that are courtyards, where they are large enough.
    dead_end_share : float
        Probability of a short corridor that leads nowhere, on each long side.
    wing_weights : tuple of float
        How often there are 0, 1, 2, 3 wings.
    wing_m : tuple of float
        Length of a wing.
    bend_deg : tuple of float
        Angle between a bent wing and what it is joined to.
    foyer_m, wedge_m : tuple of float
        Depth of the foyer between a block and its wing: a straight one, a bent one at its
        narrow end.
    lobby_share, alcove_share, suite_share : float
        Probability of a lobby in a long row, of an alcove in a wide room's wall to the
        corridor, of a door between neighbours.
    largest_m : float
        No building is longer.

    Examples
    --------
    >>> style_of("office").largest_m
    120.0
    """

    corridor_weights: tuple[float, ...] = (0.32, 0.43, 0.25)
    length_m: tuple[_Range, ...] = ((32.0, 68.0), (32.0, 68.0), (40.0, 70.0))
    corridor_m: _Range = (1.8, 2.8)
    cross_m: _Range = (1.7, 2.4)
    stub_m: _Range = (1.8, 2.4)
    row_m: _Range = (4.6, 6.6)
    core_m: _Range = (7.0, 17.0)
    single_loaded_share: float = 0.15
    cross_every_m: _Range = (16.0, 32.0)
    court_share: float = 0.22
    dead_end_share: float = 0.3
    wing_weights: tuple[float, ...] = (0.30, 0.36, 0.24, 0.10)
    wing_m: _Range = (17.0, 40.0)
    bend_deg: _Range = (20.0, 70.0)
    foyer_m: _Range = (2.6, 6.0)
    wedge_m: _Range = (1.2, 3.2)
    lobby_share: float = 0.35
    alcove_share: float = 0.25
    suite_share: float = 0.08
    largest_m: float = 120.0
    themes: tuple[RowTheme, ...] = _THEMES


_STYLES = {
    "office": BuildingStyle(),
    "campus": BuildingStyle(
        corridor_weights=(0.2, 0.5, 0.3),
        wing_weights=(0.0, 0.2, 0.4, 0.4),
        wing_m=(20.0, 48.0),
        dead_end_share=0.4,
    ),
}
BUILDING_KINDS = tuple(_STYLES)


def style_of(kind: str) -> BuildingStyle:
    """Return the style of a kind of buildings.

    Raises
    ------
    InputError
        When there is no such kind.

    Examples
    --------
    >>> style_of("castle")
    Traceback (most recent call last):
    palms.errors.InputError: kind of building: expected one of office, campus, got 'castle'
    """
    from palms.errors import InputError

    if kind not in _STYLES:
        raise InputError(
            "kind of building", expected=f"one of {', '.join(_STYLES)}", got=repr(kind)
        )
    return _STYLES[kind]
