"""Tracks: the method on recorded data."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, File, Form, HTTPException, UploadFile

from palms.server import messages
from palms.server.catalogue import UnknownBuilding
from palms.server.context import Operator, Parts
from palms.server.floor import ALL
from palms.server.routes.buildings import Format, upload_of
from palms.server.workshop import run_track

__all__ = ["router"]

router = APIRouter(prefix="/api/v1/tracks", tags=["tracks"])
Method = Literal["palms", "paper", "authors", "uniform", "uniform-ori", "no-scan"]


@router.post(
    "",
    dependencies=[Operator],
    responses={
        401: {"model": messages.Problem}, 404: {"model": messages.Problem},
        422: {"model": messages.Problem},
    },
)  # fmt: skip
async def follow_walk(  # noqa: PLR0913, PLR0917 - one for each field of the form
    context: Parts,
    scan: Annotated[UploadFile, File(description="The scan")],
    walk: Annotated[UploadFile, File(description="The recorded walk")],
    building: Annotated[str, Form(max_length=100)],
    level: Annotated[str, Form(max_length=200)] = "",
    method: Annotated[Method, Form()] = "palms",
    source: Annotated[Literal["arkit", "ronin"], Form()] = "arkit",
    seed: Annotated[int, Form(ge=0, le=2**53)] = 0,
    scan_format: Format = "",
    walk_format: Format = "",
) -> dict[str, Any]:
    """Follow a recorded walk, from its scan on; returns palms-track/1. Nothing is stored."""
    try:
        found = context.catalogue.building(building).id
        kept = context.catalogue.level(found, level) if level else ALL
        if kept == ALL:
            context.catalogue.check_atlas(found)
    except UnknownBuilding as error:
        raise HTTPException(404, str(error)) from None
    seen, recorded = await upload_of(scan, scan_format), await upload_of(walk, walk_format)
    document: dict[str, Any] = await context.workshop.do(
        run_track, context.catalogue.levels(found, kept), seen, recorded, method, source, seed
    )
    return document
