"""Health, metrics and a copy of the store."""

from __future__ import annotations

import tempfile
from pathlib import Path

from fastapi import APIRouter, Response

from palms.server import messages
from palms.server.context import Operator, Parts

__all__ = ["router"]

router = APIRouter(tags=["operations"])


@router.get("/health")
async def health(context: Parts) -> messages.Health:
    """Say that the server works, its store included."""
    from palms import __version__

    await context.journal.do(lambda: context.journal.store.version)
    return messages.Health(version=__version__)


@router.get("/metrics", dependencies=[Operator], response_class=Response)
async def metrics(context: Parts) -> Response:
    """Say what the server has counted, as Prometheus reads it."""
    sessions = context.sessions
    gauges = {
        "sessions": len(sessions.all()), "walkers": sessions.n_walkers,
        "viewers": sessions.n_viewers, "buildings": len(context.catalogue.all()),
        "journal_commits": context.journal.n_commits,
    }  # fmt: skip
    return Response(sessions.metrics.text(gauges), media_type="text/plain; version=0.0.4")


@router.get("/api/v1/backup", dependencies=[Operator], response_class=Response)
async def backup(context: Parts) -> Response:
    """Return a copy of the store as it is now; put it into an empty folder to use it."""
    with tempfile.TemporaryDirectory(prefix="palms-") as folder:
        path = Path(folder) / "palms.sqlite3"
        await context.journal.do(context.journal.store.backup, path)
        content = path.read_bytes()
    return Response(
        content, media_type="application/vnd.sqlite3",
        headers={"content-disposition": "attachment; filename=palms.sqlite3"},
    )  # fmt: skip
