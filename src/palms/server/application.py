"""The application: all parts of a server put together, as an ASGI application."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, field
from pathlib import Path
from time import time

from fastapi import FastAPI, HTTPException, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from fastapi.staticfiles import StaticFiles
from starlette.exceptions import HTTPException as StarletteHTTPException
from starlette.websockets import WebSocket

from palms.errors import PalmsError
from palms.server.catalogue import Catalogue
from palms.server.context import Context
from palms.server.gate import Gate
from palms.server.guard import Guard
from palms.server.inputs import Pools
from palms.server.journal import Journal
from palms.server.limits import Limits
from palms.server.routes import (
    buildings,
    codes,
    operations,
    sessions,
    simulations,
    socket,
    tracks,
)
from palms.server.sessions import Sessions
from palms.server.store import Store
from palms.server.workshop import Workshop

__all__ = ["Setup", "make_application"]

WEB = Path(__file__).parent / "web"
SWEEP_S = 20.0  # ours: how often what nobody needs is let go
log = logging.getLogger("palms.server")


@dataclass(frozen=True)
class Setup:
    """What a server is made of.

    Parameters
    ----------
    data : Path
        The folder of its store.
    gate : Gate
        Who may come in; everybody by default, which suits 127.0.0.1 only.
    limits : Limits
    may_record : bool
        Whether sessions may be recorded when their walkers want it.
    inline_uploads : bool
        Read files in this process: for tests of everything else.
    now_s : callable
        Seconds since 1970.
    """

    data: Path
    gate: Gate = field(default_factory=Gate)
    limits: Limits = field(default_factory=Limits)
    may_record: bool = True
    inline_uploads: bool = False
    now_s: Callable[[], float] = time


def make_application(setup: Setup) -> FastAPI:
    """Return a server as an ASGI application; its store is open from now on.

    Parameters
    ----------
    setup : Setup

    Raises
    ------
    InputError, OutputError
        When the store cannot be used.
    """
    from palms import __version__

    app = FastAPI(
        title="PALMS", version=__version__, lifespan=_lifespan, docs_url=None, redoc_url=None,
        openapi_url="/api/v1/openapi.json",
        description="Buildings, live sessions and recorded walks. The socket is /api/v1/live.",
    )  # fmt: skip
    app.state.setup = setup
    app.state.store = Store(setup.data)
    app.state.sockets = set()
    for part in (buildings, sessions, tracks, simulations, codes, operations, socket):
        app.include_router(part.router)
    app.add_middleware(Guard, gate=setup.gate, limits=setup.limits)
    app.add_exception_handler(PalmsError, _input_at_fault)
    app.add_exception_handler(RequestValidationError, _request_at_fault)
    app.add_exception_handler(StarletteHTTPException, _said)
    app.mount("/", StaticFiles(directory=WEB, html=True), name="web")
    return app


@contextlib.asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    setup: Setup = app.state.setup
    journal = Journal(app.state.store, setup.now_s)
    pools = Pools.make()
    catalogue = Catalogue(journal, setup.limits, pools.scans)
    live = Sessions(catalogue, journal, setup.gate, setup.limits, pools)
    live.may_record = setup.may_record
    app.state.context = Context(
        catalogue,
        journal,
        live,
        setup.gate,
        setup.limits,
        Workshop(setup.limits, setup.inline_uploads),
    )
    await catalogue.open()
    await live.open()
    sweeper = asyncio.create_task(_sweep(live))
    try:
        yield
    finally:
        sweeper.cancel()
        await asyncio.gather(sweeper, return_exceptions=True)
        await _send_home(app.state.sockets)
        pools.close()
        await journal.close()


async def _sweep(live: Sessions) -> None:
    while True:
        try:
            await live.sweep()
        except Exception:
            log.exception("sweeping failed")
        await asyncio.sleep(SWEEP_S)


async def _send_home(sockets: set[WebSocket]) -> None:
    """Tell all clients to come again: the server stops."""
    for socket_ in list(sockets):
        with contextlib.suppress(Exception):
            await socket_.close(1012)


def _problem(status: int, text: str) -> JSONResponse:
    return JSONResponse({"error": " ".join(text.split())[:1000]}, status)


async def _input_at_fault(request: Request, error: Exception) -> JSONResponse:
    return _problem(422, str(error))


async def _request_at_fault(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    first = error.errors()[0]
    place = ".".join(str(part) for part in first["loc"])[:200]
    return _problem(422, f"request, {place}: {first['msg']}")


async def _said(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException | StarletteHTTPException)
    response = _problem(error.status_code, str(error.detail))
    response.headers.update(error.headers or {})
    return response
