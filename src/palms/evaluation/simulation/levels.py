"""Walks over several levels, by stairs or lift."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from palms.building import Stairs
from palms.errors import InputError
from palms.evaluation.simulation.pace import with_pause
from palms.evaluation.simulation.routes import FreeSpace, find_ways
from palms.evaluation.simulation.settings import RouteSettings
from palms.evaluation.simulation.starts import Place, wide_free
from palms.evaluation.simulation.walker import TrueWalk, plan_route, walk
from palms.geometry import FloatArray

__all__ = ["Tower", "walk_levels"]

_LIFT_SHARE = 0.3  # simulation
_LIFT_S = (12.0, 25.0)  # simulation: waiting and riding
_LANDING_M = 3.5  # ours: the phone is on the stairs within this distance of their middle


class Tower(NamedTuple):
    """Levels above each other, and what joins them.

    Attributes
    ----------
    places : sequence of Place
    names : sequence of str
        Of the levels.
    stairs : sequence of Stairs
    """

    places: Sequence[Place]
    names: Sequence[str]
    stairs: Sequence[Stairs]


def walk_levels(
    tower: Tower,
    start_m: npt.ArrayLike,
    length_m: float,
    settings: RouteSettings,
    rng: np.random.Generator,
    start_s: float = 0.0,
) -> TrueWalk:
    """Walk on the first level, take the stairs or the lift, and walk on the next ones.

    Parameters
    ----------
    tower : Tower
    start_m : array_like (2,)
        On the first level, in the map frame.
    length_m : float
        Of the whole walk; longer by the way to the stairs where that is far.
    settings : RouteSettings
    rng : numpy.random.Generator
    start_s : float

    Returns
    -------
    TrueWalk
        With the level of each sample.

    Raises
    ------
    InputError
        When nobody can get from the start to any stairs.
    """
    count = len(tower.places)
    parts: list[TrueWalk] = []
    start = np.asarray(start_m, dtype=np.float64)
    for k, place in enumerate(tower.places):
        left = length_m - sum(part.length_m for part in parts)
        share = max(left / (count - k), 0.15 * length_m)
        begin = parts[-1].time_s[-1] if parts else start_s
        route = plan_route(place.free, start, share, settings, rng)
        if k < count - 1:
            steps = int(share / np.linalg.norm(np.diff(route[:2], axis=0)))
            route, start = _to_stairs(tower, k, route[:steps], rng)
            share = _length(route) - 0.05
        part = walk(route, share, settings, rng, float(begin))
        if k < count - 1 and rng.random() < _LIFT_SHARE:
            part = with_pause(part, len(part.time_s) - 1, float(rng.uniform(*_LIFT_S)))
        parts.append(part)
    return _joined(parts, tower.names)


def _to_stairs(
    tower: Tower, k: int, route: FloatArray, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Lead a route on to stairs; return it and where they let one out on the next level."""
    free, above = tower.places[k].free, tower.places[k + 1].free
    ways = find_ways(free, route[-1])
    for index in rng.permutation(len(tower.stairs)):
        middle = tower.stairs[int(index)].position_m
        down = _landing(free, middle, np.isfinite(ways.cost).reshape(free.grid.shape))
        up = _landing(above, middle, wide_free(above))
        if down is None or up is None:
            continue
        row, column = free.grid.cell_of(down)
        leg = ways.to_cell(int(row) * free.grid.shape[1] + int(column))
        return np.concatenate([route, leg[1:]]), up
    raise InputError(
        "walk over several levels", expected="stairs that can be reached", got="none",
        fix="use a building with stairs, or one level",
    )  # fmt: skip


def _landing(
    free: FreeSpace, middle: FloatArray, allowed: npt.NDArray[np.bool_]
) -> FloatArray | None:
    """Return the allowed place nearest to the middle of the stairs."""
    where = free.grid.position_of(np.argwhere(allowed))
    away = np.linalg.norm(where - middle, axis=1)
    if not len(away) or away.min() > _LANDING_M:
        return None
    return np.asarray(where[away.argmin()])


def _length(points: FloatArray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _joined(parts: Sequence[TrueWalk], names: Sequence[str]) -> TrueWalk:
    level = tuple(
        name for part, name in zip(parts, names, strict=True) for _ in range(len(part.time_s))
    )
    return TrueWalk(
        np.concatenate([part.time_s for part in parts]),
        np.concatenate([part.position_m for part in parts]),
        np.concatenate([part.heading_rad for part in parts]),
        parts[0].start_m,
        level=level,
    )
