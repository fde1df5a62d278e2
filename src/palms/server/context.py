"""Context: the parts of one server, as its routes get them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, HTTPException, Request
from starlette.requests import HTTPConnection

from palms.server.catalogue import Catalogue
from palms.server.gate import Gate
from palms.server.journal import Journal
from palms.server.limits import Limits
from palms.server.sessions import Sessions
from palms.server.workshop import Workshop

__all__ = ["Context", "Operator", "Parts", "context_of"]


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


def _parts(request: Request) -> Context:
    return context_of(request)


def _operator(request: Request) -> None:
    """Refuse who is not the operator."""
    context = context_of(request)
    if not context.gate.is_operator(request.headers.get("authorization")):
        context.sessions.metrics.count("denied_total")
        raise HTTPException(401, "send the server's token as Authorization: Bearer TOKEN")


Parts = Annotated[Context, Depends(_parts)]
Operator = Depends(_operator)
