"""Catalogue: the buildings of a server, and their floors ready for sessions."""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from concurrent.futures import Executor
from dataclasses import replace

import numpy as np

from palms.building import GAP_M
from palms.errors import InputError
from palms.sample import sample_folder
from palms.server import messages
from palms.server.floor import ALL, Floor
from palms.server.journal import Journal
from palms.server.limits import Limits
from palms.server.plans import (
    building_of,
    check_size,
    in_frame,
    new_id,
    place_among,
    plan_of,
    plan_text,
    stairs_of,
    summary,
)
from palms.server.store import BuildingRow, Levels
from palms.settings import RasterSettings

__all__ = ["Catalogue", "UnknownBuilding"]

MAX_FLOORS = 24  # ours: kept at a time; a level of 100 x 60 m is 10 MB
MAX_CELLS = 20_000_000  # ours: of all that are kept, but for the latest; 300 MB
MAX_LEVELS = 200  # ours
SAMPLE = "sample"


class UnknownBuilding(InputError):  # noqa: N818 - says what it is
    """There is no such building, or no such level."""


class Catalogue:
    """The buildings.

    Parameters
    ----------
    journal : Journal
    limits : Limits
    pool : Executor
        Rasters are made there.
    """

    def __init__(self, journal: Journal, limits: Limits, pool: Executor) -> None:
        self._journal = journal
        self._limits = limits
        self._pool = pool
        self._rows: dict[str, BuildingRow] = {}
        self._summaries: dict[str, messages.Building] = {}
        self._floors: OrderedDict[tuple[str, str], asyncio.Future[Floor]] = OrderedDict()

    async def open(self) -> None:
        """Read what is stored; a new store gets the sample building."""
        store = self._journal.store
        if store.is_new:
            await self._journal.do(store.add_building, _sample(), self._journal.now_s())
        for row in await self._journal.do(store.buildings):
            self._keep(row)

    def _keep(self, row: BuildingRow) -> messages.Building:
        self._rows[row.id] = row
        self._summaries[row.id] = summary(row)
        return self._summaries[row.id]

    def all(self) -> tuple[messages.Building, ...]:
        """All buildings in few words, oldest first."""
        return tuple(self._summaries.values())

    def building(self, building: str) -> messages.Building:
        """Return one building in few words.

        Raises
        ------
        UnknownBuilding
            When there is none of that name.
        """
        if building not in self._summaries:
            raise UnknownBuilding(
                "building", expected="one that is listed", got=repr(building[:80])
            )
        return self._summaries[building]

    def level(self, building: str, level: str | None) -> str:
        """Return the name of a level: the one that is asked for, else the lowest."""
        names = [each.name for each in self.building(building).levels]
        if level is not None and level not in names:
            raise UnknownBuilding(
                "level", expected=f"one of {', '.join(names[:20])}", got=repr(level[:80])
            )
        return names[0] if level is None else level

    def plan_text(self, building: str, level: str | None) -> str:
        """Return a level's plan as ``palms-plan/1``."""
        return dict(self._rows[building].levels)[self.level(building, level)]

    def levels(self, building: str, level: str) -> Levels:
        """Return the levels that a session walks on: names and plans, from the lowest up."""
        levels = self._rows[building].levels
        return levels if level == ALL else ((level, dict(levels)[level]),)

    def check_atlas(self, building: str) -> None:
        """Refuse to have all levels of a building searched together when they are too large.

        Raises
        ------
        InputError
            When the raster of all would be larger than the server takes.
        """
        bounds = np.array([level.bounds_m for level in self.building(building).levels])
        size = bounds[:, 1].max(axis=0) - bounds[:, 0].min(axis=0) + GAP_M
        cells = len(bounds) * float(size.prod()) / RasterSettings().cell_size_m ** 2
        if cells > self._limits.building_cells:
            raise InputError(
                "building", expected=f"at most {self._limits.building_cells:,} cells to search",
                got=f"{cells:,.0f} on all levels", fix="say level and one_level",
            )  # fmt: skip

    async def add(self, levels: Levels, name: str) -> messages.Building:
        """Add a building, its levels from the lowest up.

        Raises
        ------
        InputError
            When it is too large, or there are too many.
        """
        if len(levels) > MAX_LEVELS:
            raise InputError(
                "building", expected=f"at most {MAX_LEVELS} levels", got=str(len(levels))
            )
        for plan in building_of(levels).levels:
            check_size(plan, self._limits)
        if len(self._rows) >= self._limits.buildings:
            raise InputError(
                "building", expected=f"at most {self._limits.buildings} of them", got="one more",
                fix="delete one first",
            )  # fmt: skip
        row = BuildingRow(new_id(name), name, levels)
        await self._journal.do(self._journal.store.add_building, row, self._journal.now_s())
        return self._keep(row)

    async def add_level(
        self, building: str, text: str, name: str, below: str = ""
    ) -> messages.Building:
        """Add a level to a building.

        Parameters
        ----------
        building : str
        text : str
            The plan, as ``palms-plan/1``.
        name : str
        below : str
            The level that it lies under; by its number, else on top, when empty.

        Raises
        ------
        InputError
            When there is a level of that name, or too many, or it lies beside the others; or
            while sessions or recordings are on all levels, since theirs must stay the same.
        """
        known, plan = [each.name for each in self.building(building).levels], plan_of(text)
        check_size(plan, self._limits)
        if name in known or len(known) >= MAX_LEVELS:
            raise InputError(
                "level", expected=f"a new name, and at most {MAX_LEVELS} levels", got=repr(name)
            )
        row, place = self._rows[building], place_among(known, name, below)
        text = in_frame(plan, stairs_of(text), plan_of(row.levels[0][1]))
        levels = (*row.levels[:place], (name, text), *row.levels[place:])
        if not await self._journal.do(self._journal.store.set_levels, building, levels):
            raise InputError(
                "building", expected="no session or recording on all of its levels",
                got="some", fix="end or delete them first",
            )  # fmt: skip
        self._floors.pop((building, ALL), None)
        return self._keep(replace(row, levels=levels))

    async def delete(self, building: str) -> bool:
        """Delete a building; False while sessions or recordings need it."""
        self.building(building)
        if not await self._journal.do(self._journal.store.delete_building, building):
            return False
        del self._rows[building], self._summaries[building]
        for key in [key for key in self._floors if key[0] == building]:
            del self._floors[key]
        return True

    def _n_cells(self) -> int:
        """Cells of all floors that are ready, but for the latest."""
        ready = [each.result() for each in list(self._floors.values())[:-1] if _is_ready(each)]
        return sum(floor.raster.inside.size for floor in ready)

    async def floor(self, building: str, level: str) -> Floor:
        """Return a level, or all of them, ready for sessions; made once, the least used let go."""
        key = building, level
        if key not in self._floors:
            levels = self.levels(building, level)
            loop = asyncio.get_running_loop()
            self._floors[key] = asyncio.ensure_future(
                loop.run_in_executor(self._pool, _floor, levels, level)
            )
            while len(self._floors) > MAX_FLOORS or self._n_cells() > MAX_CELLS:
                self._floors.popitem(last=False)
        self._floors.move_to_end(key)
        try:
            return await asyncio.shield(self._floors[key])
        except Exception:
            self._floors.pop(key, None)
            raise


def _floor(levels: Levels, level: str) -> Floor:
    floor = Floor.of(building_of(levels), None if level == ALL else level)
    _ = floor.around  # here, and not while somebody waits for an answer
    return floor


def _is_ready(floor: asyncio.Future[Floor]) -> bool:
    return floor.done() and not floor.cancelled() and floor.exception() is None


def _sample() -> BuildingRow:
    from palms.io import open_dataset

    plan = open_dataset(sample_folder()).cases[0].plan()
    return BuildingRow(SAMPLE, "Sample building", ((plan.level or "1", plan_text(plan)),), True)
