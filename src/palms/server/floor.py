"""Floor: what sessions walk on, one level of a building or all of them, ready for use."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from palms.building import Building
from palms.geodesy import Origin
from palms.localizer.live import CLEAR_M
from palms.raster import PlanRaster, rasterize
from palms.server.naming import Namer
from palms.settings import LevelSettings, RasterSettings
from palms.voice import Surroundings

__all__ = ["ALL", "Floor"]

ALL = ""  # what is stored as the level of who walks on all of them


@dataclass(frozen=True)
class Floor:
    """A level that sessions share, or all levels of a building.

    Parameters
    ----------
    raster : PlanRaster
        Of the level; of the building's atlas where there are several.
    name_of : Namer
        Who names its rooms.
    level : str or None
        None where there are several.
    building : Building, optional
        All levels, where there are several.

    Examples
    --------
    >>> from palms.floorplan import FloorPlan
    >>> hall = FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]], level="0")
    >>> Floor.of(Building((hall,)), "0").level
    '0'
    """

    raster: PlanRaster
    name_of: Namer
    level: str | None
    building: Building | None = None

    @classmethod
    def of(cls, building: Building, level: str | None = None) -> Floor:
        """Return a level of a building, or all of them, ready for sessions."""
        if level is not None:
            plan = building.level(level)
            return cls(rasterize(plan, RasterSettings()), Namer(plan), level)
        atlas, reach_m = building.atlas, LevelSettings().reach_m
        for within_m in (reach_m, reach_m + CLEAR_M):  # made now, not by several threads later
            atlas.on_stairs(np.zeros((1, 2)), within_m)
        return cls(atlas.raster(RasterSettings()), Namer(building), None, building)

    @cached_property
    def around(self) -> Surroundings:
        """Its rooms, for the voice; made once."""
        if self.building is not None:
            return Surroundings.of(self.building)
        return Surroundings((self.raster.plan,), (self.level or "",))

    @property
    def ground(self) -> PlanRaster | Building:
        """What a localizer takes."""
        return self.raster if self.building is None else self.building

    @property
    def origin(self) -> Origin | None:
        """Where on Earth the map's (0, 0) lies, where that is known."""
        return (self.raster.plan if self.building is None else self.building.levels[0]).origin
