"""Catalogue: the buildings of a server, and their floors ready for sessions."""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from concurrent.futures import Executor

from palms.errors import InputError
from palms.floorplan import FloorPlan
from palms.raster import rasterize
from palms.sample import sample_folder
from palms.server import messages
from palms.server.follower import Floor
from palms.server.journal import Journal
from palms.server.limits import Limits
from palms.server.naming import Namer
from palms.server.plans import check_size, new_id, plan_of, plan_text, summary
from palms.server.store import BuildingRow
from palms.settings import RasterSettings

__all__ = ["Catalogue", "UnknownBuilding"]

MAX_FLOORS = 24  # ours: rasters kept at a time; one of 100 x 60 m is 10 MB
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
        """Return the name of a level: the one that is asked for, else the first."""
        names = [each.name for each in self.building(building).levels]
        if level is not None and level not in names:
            raise UnknownBuilding(
                "level", expected=f"one of {', '.join(names[:20])}", got=repr(level[:80])
            )
        return names[0] if level is None else level

    def plan_text(self, building: str, level: str | None) -> str:
        """Return a level's plan as ``palms-plan/1``."""
        return dict(self._rows[building].levels)[self.level(building, level)]

    async def add(self, plan: FloorPlan, name: str, level: str) -> messages.Building:
        """Add a building of one level.

        Raises
        ------
        InputError
            When it is too large, or there are too many.
        """
        check_size(plan, self._limits)
        if len(self._rows) >= self._limits.buildings:
            raise InputError(
                "building", expected=f"at most {self._limits.buildings} of them", got="one more",
                fix="delete one first",
            )  # fmt: skip
        row = BuildingRow(new_id(name), name, ((level, plan_text(plan)),))
        await self._journal.do(self._journal.store.add_building, row, self._journal.now_s())
        return self._keep(row)

    async def add_level(self, building: str, plan: FloorPlan, name: str) -> messages.Building:
        """Add a level to a building."""
        known = [each.name for each in self.building(building).levels]
        check_size(plan, self._limits)
        if name in known or len(known) >= self._limits.buildings:
            raise InputError("level", expected="a new name", got=repr(name))
        text = plan_text(plan)
        await self._journal.do(self._journal.store.add_level, building, name, text)
        row = self._rows[building]
        return self._keep(BuildingRow(row.id, row.name, (*row.levels, (name, text)), row.is_sample))

    async def delete(self, building: str) -> bool:
        """Delete a building; False while sessions or recordings need it."""
        self.building(building)
        if not await self._journal.do(self._journal.store.delete_building, building):
            return False
        del self._rows[building], self._summaries[building]
        for key in [key for key in self._floors if key[0] == building]:
            del self._floors[key]
        return True

    async def floor(self, building: str, level: str) -> Floor:
        """Return a level ready for sessions; made once, the least used let go."""
        key = building, level
        if key not in self._floors:
            text = self.plan_text(building, level)
            loop = asyncio.get_running_loop()
            self._floors[key] = asyncio.ensure_future(
                loop.run_in_executor(self._pool, _floor, text, level)
            )
            while len(self._floors) > MAX_FLOORS:
                self._floors.popitem(last=False)
        self._floors.move_to_end(key)
        try:
            return await asyncio.shield(self._floors[key])
        except Exception:
            self._floors.pop(key, None)
            raise


def _floor(text: str, level: str) -> Floor:
    plan = plan_of(text)
    floor = Floor(rasterize(plan, RasterSettings()), Namer(plan), level)
    _ = floor.around  # here, and not while somebody waits for an answer
    return floor


def _sample() -> BuildingRow:
    from palms.io import open_dataset

    plan = open_dataset(sample_folder()).cases[0].plan()
    return BuildingRow(SAMPLE, "Sample building", ((plan.level or "1", plan_text(plan)),), True)
