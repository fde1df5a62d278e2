"""Simulations: try the method without a phone."""

from __future__ import annotations

import numpy as np
from fastapi import APIRouter, HTTPException

from palms.building import Stairs
from palms.errors import InputError
from palms.server import messages
from palms.server.catalogue import UnknownBuilding
from palms.server.context import Operator, Parts, problems
from palms.server.simulating import Drawn, simulated

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/simulations", tags=["simulations"])


@router.post(
    "",
    dependencies=[Operator],
    responses=problems(401, 404, 422),
)  # fmt: skip
async def simulate_walk(context: Parts, wanted: messages.SimulationRequest) -> messages.Simulation:
    """Simulate what a phone would send on a walk: a scan at its start, and odometry."""
    try:
        building = context.catalogue.building(wanted.building).id
        names = [context.catalogue.level(building, name) for name in _levels(wanted)]
    except UnknownBuilding as error:
        raise HTTPException(404, str(error)) from None
    found = context.catalogue.building(building)
    rasters = {
        level.name: (await context.catalogue.floor(building, level.name)).raster
        for level in found.levels if level.name in names
    }  # fmt: skip
    stairs = [Stairs(each.name, np.array(each.polygon_m)) for each in found.stairs]
    drawn = Drawn(wanted.path_m, names, [level.name for level in found.levels])
    return await context.sessions.replay(
        simulated, rasters, stairs, drawn, wanted.seed, wanted.length_m
    )


def _levels(wanted: messages.SimulationRequest) -> list[str | None]:
    """Return the level of each corner of a path; of a walk to be chosen, the level alone."""
    n = 1 if wanted.path_m is None else len(wanted.path_m)
    if wanted.levels and len(wanted.levels) != n:
        raise InputError(
            "levels", expected=f"one for each of {n} corners", got=str(len(wanted.levels))
        )
    return [*wanted.levels] or [wanted.level] * n
