"""Buildings: upload, list, show, delete; levels and rooms."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, File, Form, HTTPException, Query, Response, UploadFile

from palms.errors import InputError
from palms.server import messages
from palms.server.catalogue import UnknownBuilding
from palms.server.context import Context, Operator, Parts, Visitor, problems
from palms.server.workshop import Upload, read_level_texts

__all__ = ["found_building", "router", "upload_of"]

router = APIRouter(prefix="/api/v1/buildings", tags=["buildings"])
PlanFile = Annotated[UploadFile, File(description="The floor plan, in any format that palms reads")]
Name = Annotated[str, Form(max_length=100, description="What to call it")]
LevelName = Annotated[
    str, Form(max_length=40, description="The level, or which of the file's; all if left out")
]
Below = Annotated[str, Form(max_length=200, description="The level that it lies under")]
Format = Annotated[str, Form(max_length=40, description="The file's format; found out if left out")]
Options = Annotated[
    list[str], Form(max_length=20, description="Options of its reader, as name=value")
]
VISITED = problems(401, 404)
LevelQuery = Annotated[str | None, Query(max_length=200, description="The lowest if left out")]
RoomsOf = Annotated[str | None, Query(max_length=200, description="All levels if left out")]


def found_building(context: Context, building: str) -> messages.Building:
    """Return a building, or answer that there is none."""
    try:
        return context.catalogue.building(building)
    except UnknownBuilding as error:
        raise HTTPException(404, str(error)) from None


@router.get("", dependencies=[Operator], responses=problems(401))
async def list_buildings(context: Parts) -> messages.BuildingList:
    """List all buildings."""
    return messages.BuildingList(buildings=context.catalogue.all())


@router.get("/{building}", dependencies=[Visitor], responses=VISITED)
async def show_building(context: Parts, building: str) -> messages.Building:
    """Show one building in few words."""
    return found_building(context, building)


@router.get(
    "/{building}/plan",
    response_model=messages.Plan,
    dependencies=[Visitor],
    responses=VISITED,
)
async def show_plan(context: Parts, building: str, level: LevelQuery = None) -> Response:
    """Show a level whole: segments, rooms, outline."""
    found_building(context, building)
    try:
        text = context.catalogue.plan_text(building, level)
    except UnknownBuilding as error:
        raise HTTPException(404, str(error)) from None
    return Response(text, media_type="application/json")


@router.get("/{building}/rooms", dependencies=[Visitor], responses=VISITED)
async def show_rooms(context: Parts, building: str, level: RoomsOf = None) -> list[messages.Room]:
    """List the rooms of a level, or of all."""
    found = found_building(context, building)
    names = [each.name for each in found.levels] if level is None else [level]
    try:
        texts = [(name, context.catalogue.plan_text(building, name)) for name in names]
    except UnknownBuilding as error:
        raise HTTPException(404, str(error)) from None
    return [
        messages.Room(name=room.name, polygon_m=room.polygon_m, level=name)
        for name, text in texts
        for room in messages.Plan.model_validate_json(text).rooms
    ]


async def upload_of(file: UploadFile, format: str = "", options: list[str] | None = None) -> Upload:
    """Return an uploaded file with what is said about it."""
    content = await file.read()
    listed = tuple(option for option in options or () if option)
    return Upload((file.filename or "file")[-100:], content, format or None, listed)


@router.post(
    "",
    status_code=201,
    dependencies=[Operator],
    responses=problems(401, 422),
)
async def add_building(
    context: Parts,
    file: PlanFile,
    name: Name = "",
    level: LevelName = "",
    format: Format = "",
    option: Options = [],  # noqa: B006 - a form's default
) -> messages.Building:
    """Upload a floor plan; it becomes a building of all levels that the file has."""
    upload = await upload_of(file, format, option)
    called = name.strip() or upload.name.rsplit(".", 1)[0] or "building"
    levels = await context.workshop.do(read_level_texts, upload, called, level.strip())
    return await context.catalogue.add(
        tuple((own_name or "1", text) for own_name, text in levels), called
    )


@router.post(
    "/{building}/levels",
    status_code=201,
    dependencies=[Operator],
    responses=problems(401, 404, 422),
)  # fmt: skip
async def add_level(  # noqa: PLR0913, PLR0917 - one for each field of the form
    context: Parts,
    building: str,
    file: PlanFile,
    level: LevelName = "",
    below: Below = "",
    format: Format = "",
    option: Options = [],  # noqa: B006 - a form's default
) -> messages.Building:
    """Upload one more level of a building, in the frame of the others."""
    known = found_building(context, building)
    upload = await upload_of(file, format, option)
    levels = await context.workshop.do(read_level_texts, upload, known.name, level.strip())
    if len(levels) > 1:
        raise InputError(
            "file", expected="one level", got=", ".join(name for name, _ in levels)[:200],
            fix="say which as level",
        )  # fmt: skip
    own_name, text = levels[0]
    called = own_name or str(len(known.levels) + 1)
    return await context.catalogue.add_level(building, text, called, below.strip())


@router.delete(
    "/{building}",
    status_code=204,
    dependencies=[Operator],
    responses=problems(401, 404, 409),
)  # fmt: skip
async def delete_building(context: Parts, building: str) -> None:
    """Delete a building for good; its sessions and recordings must have gone before."""
    found_building(context, building)
    try:
        deleted = await context.catalogue.delete(building)
    except InputError as error:
        raise HTTPException(404, str(error)) from None
    if not deleted:
        raise HTTPException(409, "sessions or recordings of this building exist; delete them first")
