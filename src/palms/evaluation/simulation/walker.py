"""A person walking through a simulated world: the truth of a walk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.evaluation.simulation.routes import FreeSpace, Ways, find_ways
from palms.evaluation.simulation.settings import RouteSettings
from palms.geometry import FloatArray, as_readonly, check_finite, check_points, wrap_angle

__all__ = ["TrueWalk", "plan_route", "walk"]

_FINE_M = 0.05  # ours: spacing of the points of a route
_TRIES = 12  # ours: goals considered for each leg
_TURN_BACK_RAD = np.deg2rad(120.0)  # simulation: people seldom turn on the spot
_AHEAD_M = 1.5  # ours: over which length a leg's first direction is taken


@dataclass(frozen=True, slots=True)
class TrueWalk:
    """Where somebody really was.

    Parameters
    ----------
    time_s : array_like (T,)
        End of each step, increasing.
    position_m : array_like (T, 2)
        Position at those times, in the map frame.
    heading_rad : array_like (T,)
        Direction of each step, in the map frame.
    start_m : array_like (2,)
        Where the first step began.
    facing_rad : array_like (T,), optional
        Where the phone looks at those times, in the map frame.
    level : sequence of str
        Name of the floor at those times; empty when there is only one.

    Raises
    ------
    InputError
        When lengths differ or a number is not finite.

    Examples
    --------
    >>> truth = TrueWalk([0.5, 1.0], [[0.6, 0.0], [1.2, 0.0]], [0.0, 0.0], [0.0, 0.0])
    >>> truth.length_m
    1.2
    """

    time_s: FloatArray
    position_m: FloatArray
    heading_rad: FloatArray
    start_m: FloatArray
    facing_rad: FloatArray | None = None
    level: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "position_m", check_points(self.position_m, "true positions"))
        count = (len(self.position_m),)
        object.__setattr__(self, "time_s", check_finite(self.time_s, "true times", count))
        object.__setattr__(self, "heading_rad", check_finite(self.heading_rad, "headings", count))
        object.__setattr__(self, "start_m", check_finite(self.start_m, "true start", (2,)))
        if self.facing_rad is not None:
            facing = check_finite(self.facing_rad, "true facing", count)
            object.__setattr__(self, "facing_rad", facing)
        if self.level and len(self.level) != count[0]:
            raise InputError("true levels", expected=str(count[0]), got=str(len(self.level)))

    @property
    def walked_m(self) -> FloatArray:
        """Distance walked (T,) at the end of each step."""
        return np.cumsum(np.linalg.norm(self.moves_m, axis=1))

    @property
    def moves_m(self) -> FloatArray:
        """Steps (T, 2) in the map frame."""
        return np.diff(self.position_m, axis=0, prepend=self.start_m[None])

    @property
    def length_m(self) -> float:
        """Length of the walk."""
        return float(np.linalg.norm(self.moves_m, axis=1).sum())


def plan_route(
    free: FreeSpace,
    start_m: npt.ArrayLike,
    length_m: float,
    settings: RouteSettings,
    rng: np.random.Generator,
) -> FloatArray:
    """Find a way of a given length from goal to goal.

    Parameters
    ----------
    free : FreeSpace
    start_m : array_like (2,)
        In the map frame.
    length_m : float
        The route is at least this long.
    settings : RouteSettings
    rng : numpy.random.Generator

    Returns
    -------
    ndarray (N, 2)
        Points every 5 cm, in the map frame, corners smoothed.

    Raises
    ------
    InputError
        When nobody can stand at the start or go anywhere from there.

    Examples
    --------
    >>> from palms.grid import Grid
    >>> ones = np.ones((4, 200))
    >>> free = FreeSpace(Grid((0, 0), 0.15, (4, 200)), ones, ones, ones)
    >>> rng = np.random.default_rng(0)
    >>> route = plan_route(free, [0.3, 0.3], 40.0, RouteSettings(), rng)
    >>> bool(np.linalg.norm(np.diff(route, axis=0), axis=1).sum() > 40)
    True
    """
    start = check_finite(start_m, "start of the walk", (2,))
    route = np.array([start])
    while _length(route) < 1.05 * length_m + 2 * settings.smooth_m:
        ways = find_ways(free, route[-1])
        leg = _choose_leg(free, ways, route, settings, rng)
        if _length(leg) < 1.0:
            raise InputError(
                "start of the walk",
                expected="a place that leads somewhere",
                got=f"({start[0]:.2f}, {start[1]:.2f}), shut in",
                fix="start elsewhere, or with less furniture",
            )
        route = np.concatenate([route, leg[1:]])
    return _smoothed(free, _resampled(route, _FINE_M), settings)


def walk(
    route_m: FloatArray,
    length_m: float,
    settings: RouteSettings,
    rng: np.random.Generator,
    start_s: float = 0.0,
) -> TrueWalk:
    """Walk along a route, step by step.

    Parameters
    ----------
    route_m : ndarray (N, 2)
        In the map frame; the walk starts at its first point.
    length_m : float
        How far; at most a step is missing.
    settings : RouteSettings
    rng : numpy.random.Generator
    start_s : float
        When the first step begins.

    Returns
    -------
    TrueWalk
        One entry for each step.

    Examples
    --------
    >>> route = np.array([[0.0, 0.0], [30.0, 0.0]])
    >>> truth = walk(route, 20.0, RouteSettings(), np.random.default_rng(0))
    >>> round(truth.length_m), round(float(truth.time_s[-1]))
    (20, 17)
    """
    count = int(2 * length_m / settings.step_m) + 2
    step = np.maximum(rng.normal(settings.step_m, settings.step_sd_m, count), 0.2)
    speed = np.maximum(rng.normal(settings.speed_m_s, settings.speed_sd_m_s, count), 0.2)
    position = _at(route_m, np.concatenate([[0.0], np.cumsum(step)]))
    moves = np.diff(position, axis=0)
    walked = np.cumsum(np.linalg.norm(moves, axis=1))
    kept = int(np.searchsorted(walked, length_m + settings.step_m / 2))
    heading = np.arctan2(moves[:kept, 1], moves[:kept, 0])
    time = start_s + np.cumsum(step / speed)[:kept]
    return TrueWalk(time, position[1 : kept + 1], heading, as_readonly(position[0]))


def _length(points: FloatArray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _at(points: FloatArray, places_m: FloatArray) -> FloatArray:
    """Points (K, 2) at distances along a line of points; its end beyond."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    return np.column_stack([np.interp(places_m, along, points[:, i]) for i in (0, 1)])


def _resampled(points: FloatArray, spacing_m: float) -> FloatArray:
    return _at(points, np.arange(0.0, _length(points) + spacing_m, spacing_m))


def _choose_leg(
    free: FreeSpace,
    ways: Ways,
    route: FloatArray,
    settings: RouteSettings,
    rng: np.random.Generator,
) -> FloatArray:
    """Of some far goals take the one whose way covers most new ground, without turning back."""
    in_room = rng.random() < settings.room_visit_share
    wanted = (free.is_corridor != in_room).ravel() & (free.clearance_m.ravel() > settings.body_m)
    reached = np.isfinite(ways.cost)
    far = reached & wanted & (ways.cost >= settings.goal_m)
    if not far.any():
        far = reached & (ways.cost >= 0.8 * ways.cost[reached].max())
    goals = rng.choice(np.flatnonzero(far), _TRIES)
    legs = [ways.to_cell(int(goal)) for goal in goals]
    return max(legs, key=lambda leg: _novelty(leg, route))


def _novelty(leg: FloatArray, route: FloatArray) -> float:
    """Share of a leg that was not walked before; less when it turns back at once."""
    from scipy.spatial import KDTree

    away, _ = KDTree(route).query(leg)
    share = float((away > 1.0).mean())
    if len(route) < 2 or len(leg) < 2:
        return share
    came = route[-1] - _at(route[::-1], np.array([_AHEAD_M]))[0]
    goes = _at(leg, np.array([_AHEAD_M]))[0] - leg[0]
    turn = wrap_angle(np.arctan2(goes[1], goes[0]) - np.arctan2(came[1], came[0]))
    return share - (1.0 if abs(turn) > _TURN_BACK_RAD else 0.0)


def _smoothed(free: FreeSpace, route: FloatArray, settings: RouteSettings) -> FloatArray:
    """Cut corners as far as walls allow."""
    from scipy.ndimage import gaussian_filter1d, map_coordinates

    def clearance(points: FloatArray) -> FloatArray:
        cells = ((points - free.grid.origin_m) / free.grid.cell_size_m - 0.5)[:, ::-1]
        return np.asarray(map_coordinates(free.clearance_m, cells.T, order=1, mode="nearest"))

    allowed = min(float(clearance(route).min()), settings.body_m)
    for smooth_m in (settings.smooth_m, settings.smooth_m / 2, settings.smooth_m / 4):
        smooth = gaussian_filter1d(route, smooth_m / _FINE_M, axis=0, mode="nearest")
        smooth = np.concatenate([route[:1], smooth[1:]])
        if clearance(smooth).min() >= allowed - 0.02:
            return _resampled(smooth, _FINE_M)
    return route
