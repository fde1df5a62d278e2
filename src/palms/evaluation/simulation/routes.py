"""Where people can walk, and the ways they take."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.evaluation.simulation.settings import RouteSettings
from palms.evaluation.simulation.world import World, inside_of
from palms.floorplan import FloorPlan, Room, SegmentClass
from palms.geometry import FloatArray, as_readonly
from palms.grid import Grid

__all__ = ["FreeSpace", "Ways", "find_ways", "free_space"]

_CORRIDOR_DOORS = 4  # ours: a room with as many doors is one that people pass through
_PASSING = ("corridor", "foyer")  # ours: and so is one that is called so
_NEIGHBOURS = ((0, 1), (1, 0), (1, 1), (1, -1), (1, 2), (2, 1), (1, -2), (2, -1))
_START_M = 0.3  # ours: less than from one side of a wall to where people stand on the other


@dataclass(frozen=True, slots=True)
class FreeSpace:
    """Cells of a building, what walking in them costs, and where people go.

    Parameters
    ----------
    grid : Grid
        In the map frame.
    clearance_m : array_like (rows, columns)
        Distance from the middle of each cell to the nearest thing in the way; 0 outdoors.
    cost : array_like (rows, columns)
        What a metre counts there; infinite where nobody can stand.
    is_corridor : array_like (rows, columns)
        Whether people pass there on their ways.

    Examples
    --------
    >>> grid = Grid((0.0, 0.0), 1.0, (1, 2))
    >>> FreeSpace(grid, [[1, 0]], [[1, np.inf]], [[True, False]]).is_free.tolist()
    [[True, False]]
    """

    grid: Grid
    clearance_m: FloatArray
    cost: FloatArray
    is_corridor: npt.NDArray[np.bool_]

    def __post_init__(self) -> None:
        object.__setattr__(self, "clearance_m", as_readonly(self.clearance_m))
        object.__setattr__(self, "cost", as_readonly(self.cost))
        object.__setattr__(self, "is_corridor", as_readonly(self.is_corridor, np.bool_))

    @property
    def is_free(self) -> npt.NDArray[np.bool_]:
        """Cells where somebody can stand."""
        return np.isfinite(self.cost)


def free_space(world: World, settings: RouteSettings) -> FreeSpace:
    """Find out where people can walk in a world.

    Parameters
    ----------
    world : World
    settings : RouteSettings

    Examples
    --------
    >>> from palms.evaluation.simulation.settings import WorldNoise
    >>> from palms.evaluation.simulation.world import make_world
    >>> square = FloorPlan([[[0, 0], [4, 0]], [[4, 0], [4, 3]], [[4, 3], [0, 3]], [[0, 3], [0, 0]]])
    >>> world = make_world(square, WorldNoise.none(), np.random.default_rng(0))
    >>> free = free_space(world, RouteSettings())
    >>> float(free.clearance_m.max().round(1))
    1.4
    """
    import shapely

    low, high = world.plan.bounds_m
    grid = Grid.covering(low, high, settings.cell_size_m)
    centres = grid.position_of(np.indices(grid.shape).transpose(1, 2, 0)).reshape(-1, 2)
    inside = shapely.contains_xy(inside_of(world.plan), centres)
    tree = shapely.STRtree(shapely.linestrings(world.blocking_m))
    (where, _), away = tree.query_nearest(
        shapely.points(centres[inside]), return_distance=True, all_matches=False
    )
    clearance = np.zeros(len(centres))
    clearance[np.flatnonzero(inside)[where]] = away
    corridor = shapely.contains_xy(_corridors(world.plan), centres)
    crowding = np.clip(1.0 - clearance / settings.comfort_m, 0.0, 1.0)
    cost = 1.0 + settings.crowding_cost * crowding
    cost *= np.where(corridor, 1.0, settings.room_cost)
    cost[clearance < settings.body_m] = np.inf
    shape = grid.shape
    return FreeSpace(grid, clearance.reshape(shape), cost.reshape(shape), corridor.reshape(shape))


def _corridors(plan: FloorPlan) -> Any:  # noqa: ANN401
    """Area of corridors and of rooms with many doors; everything where a plan names no rooms."""
    import shapely

    ways_in = plan.of_class(SegmentClass.DOOR, SegmentClass.OPENING).mean(axis=1)

    def doors_of(room: Room) -> int:
        ring = shapely.LinearRing(room.polygon_m)
        return int((shapely.distance(shapely.points(ways_in), ring) < 0.2).sum())

    wanted = [
        room
        for room in plan.rooms
        if any(word in room.name.casefold() for word in _PASSING)
        or doors_of(room) >= _CORRIDOR_DOORS
    ]
    if not wanted:
        return inside_of(plan)
    area = shapely.union_all([shapely.Polygon(room.polygon_m).buffer(0.01) for room in wanted])
    shapely.prepare(area)
    return area


@dataclass(frozen=True, slots=True)
class Ways:
    """The cheapest ways from one point to everywhere.

    Parameters
    ----------
    grid : Grid
    cost : array_like (rows * columns,)
        What each cell costs to reach; infinite where it cannot be reached.
    before : array_like (rows * columns,)
        The cell before it on its way; negative at the start.

    Examples
    --------
    >>> ways = Ways(Grid((0.0, 0.0), 1.0, (1, 2)), [0.0, 1.0], [-9999, 0])
    >>> ways.to_cell(1).tolist()
    [[0.5, 0.5], [1.5, 0.5]]
    """

    grid: Grid
    cost: FloatArray
    before: npt.NDArray[np.int64]

    def __post_init__(self) -> None:
        object.__setattr__(self, "cost", as_readonly(self.cost))
        object.__setattr__(self, "before", as_readonly(self.before, np.int64))

    def to_cell(self, cell: int) -> FloatArray:
        """Middles (N, 2) of the cells from the start to a cell, given by its flat number."""
        chain = [cell]
        while self.before[chain[-1]] >= 0:
            chain.append(int(self.before[chain[-1]]))
        rows, columns = np.divmod(chain[::-1], self.grid.shape[1])
        return self.grid.position_of(np.column_stack([rows, columns]))


def find_ways(free: FreeSpace, start_m: npt.ArrayLike) -> Ways:
    """Find the cheapest ways from a point to everywhere (Dijkstra, sixteen neighbours).

    Parameters
    ----------
    free : FreeSpace
    start_m : array_like (2,)
        In the map frame; the nearest free cell is taken.

    Raises
    ------
    InputError
        When nobody can stand within 0.3 m of the start.

    Examples
    --------
    >>> ones = np.ones((1, 3))
    >>> free = FreeSpace(Grid((0, 0), 1.0, (1, 3)), ones, ones, ones)
    >>> find_ways(free, [0.5, 0.5]).cost.tolist()
    [0.0, 1.0, 2.0]
    """
    from scipy.sparse.csgraph import dijkstra

    source = _nearest_free(free, np.asarray(start_m, dtype=np.float64))
    cost, before = dijkstra(_graph(free), directed=False, indices=source, return_predecessors=True)
    return Ways(free.grid, cost, before)


def _nearest_free(free: FreeSpace, point: FloatArray) -> int:
    cells = np.argwhere(free.is_free)
    away = np.linalg.norm(free.grid.position_of(cells) - point, axis=1)
    if not len(cells) or away.min() > _START_M:
        raise InputError(
            "start of the walk",
            expected="a place where somebody can stand",
            got=f"({point[0]:.2f}, {point[1]:.2f})",
            fix="start in free space inside the building",
        )
    row, column = cells[away.argmin()]
    return int(row * free.grid.shape[1] + column)


def _graph(free: FreeSpace) -> Any:  # noqa: ANN401
    """Costs between neighbouring free cells, as a sparse matrix."""
    from scipy.sparse import coo_array

    rows, columns = free.grid.shape
    number = np.arange(rows * columns).reshape(rows, columns)
    start, end, weight = [], [], []
    for down, right in _NEIGHBOURS:
        a = (slice(0, max(rows - down, 0)), slice(max(0, -right), columns - max(0, right)))
        b = (slice(down, rows), slice(max(0, right), columns + min(0, right)))
        both = free.is_free[a] & free.is_free[b]
        length = np.hypot(down, right) * free.grid.cell_size_m
        start.append(number[a][both])
        end.append(number[b][both])
        weight.append(length * (free.cost[a][both] + free.cost[b][both]) / 2)
    pairs = np.concatenate(start), np.concatenate(end)
    return coo_array((np.concatenate(weight), pairs), shape=(number.size,) * 2).tocsr()
