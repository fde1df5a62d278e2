"""Where users scan: places with something to see, far from each other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.evaluation.simulation.routes import FreeSpace
from palms.evaluation.simulation.scanner import SimulatedScan, take_scan
from palms.evaluation.simulation.settings import ScannerNoise, StartSettings
from palms.evaluation.simulation.world import World
from palms.geometry import FloatArray, directions, lengths
from palms.scan import Scan

__all__ = ["Place", "choose_start", "is_sensible", "take_any_scan", "wide_free"]

_TRIES = 40  # ours: places that a user tries before taking what there is
_CROSSING_RAD = np.deg2rad(30.0)  # ours: walls at a larger angle count as running another way


class Place(NamedTuple):
    """A level where somebody may stand.

    Attributes
    ----------
    world : World
    free : FreeSpace
    """

    world: World
    free: FreeSpace


def is_sensible(scan: Scan, settings: StartSettings, turn_rad: float = 2 * np.pi) -> bool:
    """Whether a user would take a scan for a good one.

    Parameters
    ----------
    scan : Scan
    settings : StartSettings
    turn_rad : float
        How far the user turned: a part of a turn needs a part of the walls.

    Examples
    --------
    >>> is_sensible(Scan([[[2, -2], [2, 2]]]), StartSettings())
    False
    """
    share = min(turn_rad / (2 * np.pi), 1.0)
    walls = scan.walls_m
    length, angle = lengths(walls), directions(walls)
    main = angle[length.argmax()]
    turned = np.abs(np.mod(angle - main + np.pi / 2, np.pi) - np.pi / 2)
    crossing = float(length[turned > _CROSSING_RAD].sum())
    enough = len(walls) >= max(2.0, settings.walls * share)
    return bool(
        enough
        and length.sum() >= settings.length_m * share
        and crossing >= settings.second_m * share
    )


def wide_free(free: FreeSpace) -> npt.NDArray[np.bool_]:
    """Return the cells (rows, columns) of the largest part of a level that hangs together.

    Examples
    --------
    >>> from palms.grid import Grid
    >>> cost = [[1.0, 1.0, np.inf, 1.0]]
    >>> free = FreeSpace(Grid((0, 0), 1.0, (1, 4)), np.ones((1, 4)), cost, np.ones((1, 4)))
    >>> wide_free(free).tolist()
    [[True, True, False, False]]
    """
    from scipy.ndimage import label

    number, _ = label(free.is_free, structure=np.ones((3, 3)))
    sizes = np.bincount(number.ravel())
    sizes[0] = 0
    return np.asarray(number == sizes.argmax()) & free.is_free


def choose_start(
    place: Place,
    others_m: FloatArray,
    noise: ScannerNoise,
    settings: StartSettings,
    rng: np.random.Generator,
) -> SimulatedScan:
    """Choose a place as a user would, and scan there.

    Parameters
    ----------
    place : Place
    others_m : array_like (N, 2)
        Starts chosen before.
    noise : ScannerNoise
    settings : StartSettings
    rng : numpy.random.Generator

    Returns
    -------
    SimulatedScan
        With a drift of its own.

    Raises
    ------
    InputError
        When no wall is seen from anywhere.

    Examples
    --------
    >>> from palms.evaluation.simulation import (
    ...     RouteSettings, WorldNoise, free_space, make_world, sample_building)
    >>> rng = np.random.default_rng(0)
    >>> world = make_world(sample_building(), WorldNoise(), rng)
    >>> place = Place(world, free_space(world, RouteSettings()))
    >>> none = np.empty((0, 2))
    >>> taken = choose_start(place, none, ScannerNoise(), StartSettings(), rng)
    >>> is_sensible(taken.scan, StartSettings())
    True
    """
    best: SimulatedScan | None = None
    for position in _candidates(place.free, np.asarray(others_m).reshape(-1, 2), settings, rng):
        drift = rng.uniform(-np.pi, np.pi)
        taken = _scan_or_none(place.world, position, drift, noise, rng)
        if taken is None:
            continue
        if is_sensible(taken.scan, settings, noise.turn_rad):
            return taken
        if best is None or len(taken.scan.walls_m) > len(best.scan.walls_m):
            best = taken
    if best is None:
        raise InputError(
            "start", expected="a place from which a wall is seen", got="none",
            fix="check the plan's unit and that it has walls",
        )  # fmt: skip
    return best


def take_any_scan(
    world: World,
    near_m: FloatArray,
    drift_rad: float,
    noise: ScannerNoise,
    rng: np.random.Generator,
) -> SimulatedScan | None:
    """Scan at a place, again if nothing was seen; None when nothing is seen three times."""
    for _ in range(3):
        taken = _scan_or_none(world, near_m, drift_rad, noise, rng)
        if taken is not None:
            return taken
    return None


def _scan_or_none(
    world: World,
    position: FloatArray,
    drift: float,
    noise: ScannerNoise,
    rng: np.random.Generator,
) -> SimulatedScan | None:
    try:
        return take_scan(world, position, drift, noise, rng)
    except InputError:
        return None


def _candidates(
    free: FreeSpace, others: FloatArray, settings: StartSettings, rng: np.random.Generator
) -> FloatArray:
    """Places (K, 2) to try, in turn: far from the others as long as there are such."""
    wide = wide_free(free)
    fits = wide & (free.clearance_m >= settings.clearance_m)
    cells = np.argwhere(fits if fits.any() else wide)
    if not len(cells):
        raise InputError(
            "start", expected="a place where somebody can stand", got="none",
            fix="check the plan's unit and that its rooms are wide enough",
        )  # fmt: skip
    where = free.grid.position_of(cells)
    corridor = free.is_corridor[tuple(cells.T)]
    weight = np.where(
        corridor,
        settings.corridor_share / max(corridor.sum(), 1),
        (1 - settings.corridor_share) / max((~corridor).sum(), 1),
    )
    away = np.full(len(cells), np.inf)
    if len(others):
        away = np.linalg.norm(where[:, None] - others[None], axis=2).min(axis=1)
    for apart in (settings.apart_m, settings.apart_m / 2, settings.apart_m / 4, 0.0):
        far = weight * (away >= apart)
        if far.sum() > 0:
            break
    count = min(_TRIES, int((far > 0).sum()))
    return where[rng.choice(len(cells), count, replace=False, p=far / far.sum())]
