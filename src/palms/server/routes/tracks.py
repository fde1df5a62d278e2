"""Tracks: the method on recorded data; scans, for who has them in a file."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, File, Form, HTTPException, Request, UploadFile

from palms.server import messages
from palms.server.catalogue import UnknownBuilding
from palms.server.context import Parts, check_visitor, problems
from palms.server.floor import ALL
from palms.server.routes.buildings import Format, found_building, upload_of
from palms.server.workshop import read_scan_message, run_track

__all__ = ["router"]

router = APIRouter(prefix="/api/v1", tags=["tracks"])
Method = Literal["palms", "paper", "authors", "uniform", "uniform-ori", "no-scan"]


ANSWERS = problems(401, 404, 422)
Building = Annotated[str, Form(max_length=100)]


def _visitor(request: Request, building: Building) -> None:
    check_visitor(request, building)


@router.post("/tracks", dependencies=[Depends(_visitor)], responses=ANSWERS)
async def follow_walk(  # noqa: PLR0913, PLR0917 - one for each field of the form
    context: Parts,
    scan: Annotated[UploadFile, File(description="The scan")],
    walk: Annotated[UploadFile, File(description="The recorded walk")],
    building: Building,
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


@router.post("/scans", dependencies=[Depends(_visitor)], responses=ANSWERS)
async def read_scan(
    context: Parts,
    scan: Annotated[UploadFile, File(description="The scan, in any format that palms reads")],
    building: Building,
    scan_format: Format = "",
) -> messages.Scan:
    """Read a scan's file; returns it as a message for the socket. Nothing is stored."""
    found_building(context, building)
    seen = await upload_of(scan, scan_format)
    found: messages.Scan = await context.workshop.do(read_scan_message, seen)
    return found
