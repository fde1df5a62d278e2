"""Sessions and recordings, for the operator; tickets; readings that an app pushes."""

from __future__ import annotations

import asyncio
from typing import Annotated, Any

from fastapi import APIRouter, Body, Header, HTTPException, Response

from palms.server import messages
from palms.server.context import Context, Linked, Operator, Parts, problems
from palms.server.push import readings_of
from palms.server.recordings import (
    dataset_zip,
    recording_document,
    recording_frames,
    recording_track,
)
from palms.server.routes.buildings import found_building
from palms.server.session import Refused, Session
from palms.server.store import Levels, SessionRow

__all__ = ["router"]

router = APIRouter(prefix="/api/v1", tags=["sessions"])
DENIED, MISSING = problems(401), problems(401, 404)


@router.get("/sessions", dependencies=[Operator], responses=DENIED)
async def list_sessions(context: Parts) -> messages.SessionList:
    """List the live sessions; where they are is not told."""
    return messages.SessionList(
        sessions=tuple(_summary(session) for session in context.sessions.all())
    )


def _summary(session: Session) -> messages.SessionSummary:
    row, follower = session.row, session.follower
    stage = "unloaded" if follower is None else str(follower.localizer.estimate.stage)
    return messages.SessionSummary(
        session=row.id, building=row.building, level=row.level or None, method=row.terms.method,
        stage=stage, is_connected=session.walker is not None, is_recording=row.is_recording,
        n_viewers=len(session.viewers), n_inputs=session.next_seq - 1, created_s=row.created_s,
        seen_s=max(row.seen_s, session.left_s),
    )  # fmt: skip


@router.delete("/sessions/{session}", status_code=204, dependencies=[Operator], responses=MISSING)
async def delete_session(context: Parts, session: str) -> None:
    """End a session and delete all of it, also what was recorded."""
    try:
        found = context.sessions.find(session)
    except Refused as error:
        raise HTTPException(404, str(error)) from None
    await asyncio.shield(context.sessions.end(found, "deleted", keep=False))


@router.post("/tickets", dependencies=[Operator], status_code=201, responses=MISSING)
async def make_ticket(context: Parts, wanted: messages.TicketRequest) -> messages.Ticket:
    """Make a ticket for one hello: to walk, or to look on at a session."""
    if wanted.role == "viewer":
        try:
            context.sessions.find(wanted.session or "")
        except Refused as error:
            raise HTTPException(404, str(error)) from None
    elif wanted.building is not None:
        found_building(context, wanted.building)
    session = wanted.session if wanted.role == "viewer" else None
    for_s = context.limits.ticket_s
    ticket = context.gate.ticket(wanted.role, session, for_s, wanted.building)
    return messages.Ticket(ticket=ticket, expires_in_s=for_s)


@router.get("/recordings", dependencies=[Operator], responses=DENIED)
async def list_recordings(context: Parts) -> messages.RecordingList:
    """List the recorded sessions."""
    store = context.journal.store
    found = []
    for row in await context.journal.do(store.sessions, True):
        n = await context.journal.do(store.n_inputs, row.id)
        found.append(
            messages.RecordingSummary(
                recording=row.id, building=row.building, level=row.level or None, n_inputs=n,
                created_s=row.created_s, ended_s=row.ended_s or row.created_s,
            )
        )  # fmt: skip
    return messages.RecordingList(recordings=tuple(found))


async def _recording(context: Context, recording: str) -> tuple[SessionRow, list[Any], Levels]:
    """Return a recording with its inputs and the levels that it walked on."""
    store = context.journal.store
    row = await context.journal.do(store.session, recording)
    if row is None or row.ended_s is None:
        raise HTTPException(404, "there is no such recording")
    inputs = await context.journal.do(store.inputs, row.id)
    return row, inputs, context.catalogue.levels(row.building, row.level)


@router.get("/recordings/{recording}", dependencies=[Operator], responses=MISSING)
async def show_recording(context: Parts, recording: str) -> dict[str, Any]:
    """Export a recording as JSON: palms-recording/1."""
    row, inputs, _ = await _recording(context, recording)
    return recording_document(row, inputs)


@router.post("/recordings/{recording}/links", dependencies=[Operator], responses=MISSING)
async def share_recording(
    context: Parts, recording: str, wanted: messages.LinkRequest
) -> messages.Link:
    """Make a link: a key with which others see the recording's track and plan, until it expires."""
    row, _, _ = await _recording(context, recording)
    view = context.gate.link(row.id, wanted.ttl_s)
    return messages.Link(view=view, expires_in_s=wanted.ttl_s)


@router.get("/recordings/{recording}/track", dependencies=[Linked], responses=MISSING)
async def show_track(context: Parts, recording: str) -> dict[str, Any]:
    """Follow a recording again: the estimates and events that its walker got."""
    row, inputs, levels = await _recording(context, recording)
    document: dict[str, Any] = await context.sessions.replay(recording_track, row, inputs, levels)
    return document


@router.get(
    "/recordings/{recording}/frames",
    dependencies=[Linked],
    responses={**MISSING, 200: {"content": {"application/octet-stream": {}}}},
    response_class=Response,
)
async def show_frames(context: Parts, recording: str) -> Response:
    """Follow a recording again: its particles and heatmaps, each frame after its length."""
    row, inputs, plan = await _recording(context, recording)
    content: bytes = await context.sessions.replay(recording_frames, row, inputs, plan)
    return Response(content, media_type="application/octet-stream")


@router.get(
    "/recordings/{recording}/dataset",
    dependencies=[Operator],
    responses={**MISSING, 200: {"content": {"application/zip": {}}}},
    response_class=Response,
)
async def export_dataset(context: Parts, recording: str) -> Response:
    """Export a recording as a data set folder for palms bench, zipped."""
    row, inputs, levels = await _recording(context, recording)
    content: bytes = await context.sessions.replay(dataset_zip, row, inputs, levels)
    name = f"attachment; filename=palms-{row.id}.zip"
    return Response(content, media_type="application/zip", headers={"content-disposition": name})


@router.delete(
    "/recordings/{recording}", status_code=204, dependencies=[Operator], responses=MISSING
)
async def delete_recording(context: Parts, recording: str) -> None:
    """Delete a recording for good."""
    row, _, _ = await _recording(context, recording)
    context.gate.revoke(row.id)
    await context.journal.do(context.journal.store.delete_sessions, [row.id])


@router.post(
    "/push/{session}",
    responses=problems(404, 422, 503),
)  # fmt: skip
async def push_readings(
    context: Parts,
    session: str,
    body: Annotated[dict[str, Any], Body(description="As Sensor Logger pushes it")],
    authorization: Annotated[str, Header(description="Bearer, and the session's key")] = "",
) -> messages.Ack:
    """Take inertial readings that the app Sensor Logger pushes; the server finds the steps.

    Repeated pushes are known by their `messageId`.
    """
    try:
        found = context.sessions.with_key(session, authorization.partition(" ")[2].strip())
    except Refused as error:
        raise HTTPException(404, str(error)) from None
    try:
        return await asyncio.shield(context.sessions.push(found, readings_of(body)))
    except Refused as error:
        raise HTTPException(503, str(error)) from None
