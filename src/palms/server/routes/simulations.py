"""Simulations: try the method without a phone."""

from __future__ import annotations

from fastapi import APIRouter, HTTPException

from palms.server import messages
from palms.server.catalogue import UnknownBuilding
from palms.server.context import Operator, Parts
from palms.server.simulating import simulated

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/simulations", tags=["simulations"])


@router.post(
    "",
    dependencies=[Operator],
    responses={
        401: {"model": messages.Problem}, 404: {"model": messages.Problem},
        422: {"model": messages.Problem},
    },
)  # fmt: skip
async def simulate_walk(context: Parts, wanted: messages.SimulationRequest) -> messages.Simulation:
    """Simulate what a phone would send on a walk: a scan at its start, and odometry."""
    try:
        building = context.catalogue.building(wanted.building).id
        level = context.catalogue.level(building, wanted.level)
    except UnknownBuilding as error:
        raise HTTPException(404, str(error)) from None
    floor = await context.catalogue.floor(building, level)
    return await context.sessions.replay(
        simulated, floor.raster, wanted.path_m, wanted.seed, wanted.length_m
    )
