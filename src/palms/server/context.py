"""Context: the parts of one server, as its routes get them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Depends, HTTPException, Request
from starlette.requests import HTTPConnection

from palms.server.catalogue import Catalogue
from palms.server.gate import Gate
from palms.server.journal import Journal
from palms.server.limits import Limits
from palms.server.messages import Problem
from palms.server.sessions import Sessions
from palms.server.workshop import Workshop

__all__ = [
    "Context",
    "Linked",
    "Operator",
    "Parts",
    "Visitor",
    "check_visitor",
    "context_of",
    "problems",
]


@dataclass(frozen=True)
class Context:
    """The parts of one server."""

    catalogue: Catalogue
    journal: Journal
    sessions: Sessions
    gate: Gate
    limits: Limits
    workshop: Workshop


def context_of(connection: HTTPConnection) -> Context:
    """Return the parts of the server that a request came to."""
    context: Context = connection.app.state.context
    return context


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return what a route says of the problems that it answers with, for OpenAPI.

    Examples
    --------
    >>> problems(401, 404)[404]["model"].__name__
    'Problem'
    """
    return {status: {"model": Problem} for status in statuses}


def _parts(request: Request) -> Context:
    return context_of(request)


def _operator(request: Request) -> None:
    """Refuse who is not the operator."""
    context = context_of(request)
    if not context.gate.is_operator(request.headers.get("authorization")):
        context.sessions.metrics.count("denied_total")
        raise HTTPException(401, "send the server's token as Authorization: Bearer TOKEN")


def check_visitor(request: Request, building: str) -> None:
    """Refuse who is neither the operator nor has a session, or a link, in this building.

    Raises
    ------
    HTTPException
        401.
    """
    context, header = context_of(request), request.headers.get("authorization", "")
    if context.gate.is_operator(header):
        return
    session = context.sessions.opened_by(header.partition(" ")[2].strip())
    if session is None or session.row.building != building:
        context.sessions.metrics.count("denied_total")
        raise HTTPException(401, "send the token, or a session's key, as Authorization: Bearer ...")


def _linked(request: Request, recording: str) -> None:
    """Refuse who is neither the operator nor has a link to this recording."""
    context, header = context_of(request), request.headers.get("authorization", "")
    grant = context.gate.linked(header.partition(" ")[2].strip())
    if context.gate.is_operator(header) or (grant is not None and grant.session == recording):
        return
    context.sessions.metrics.count("denied_total")
    raise HTTPException(401, "send the token, or a link's key, as Authorization: Bearer ...")


Parts = Annotated[Context, Depends(_parts)]
Operator = Depends(_operator)
Visitor = Depends(check_visitor)
Linked = Depends(_linked)
