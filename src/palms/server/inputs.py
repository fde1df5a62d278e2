"""Inputs: from a message to its answers. On disk first, then followed, then told."""

from __future__ import annotations

import asyncio
import functools
import logging
import os
import sqlite3
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

from palms.errors import PalmsError
from palms.server import messages
from palms.server.follower import Floor, Follower
from palms.server.journal import Journal
from palms.server.limits import Limits
from palms.server.metrics import Metrics
from palms.server.pictures import heatmap_frames, particles_frame
from palms.server.session import Refused, Seat, Session

__all__ = ["Inputs", "Pools", "in_pool"]

T = TypeVar("T")
log = logging.getLogger("palms.server")


@dataclass(frozen=True)
class Pools:
    """Threads for the work: a scan that takes long does not hold up the steps of others."""

    steps: ThreadPoolExecutor
    scans: ThreadPoolExecutor
    replays: ThreadPoolExecutor

    @classmethod
    def make(cls) -> Pools:
        """Return pools for this machine."""
        cores = os.cpu_count() or 1
        return cls(
            ThreadPoolExecutor(max(2, cores), "palms-steps"),
            ThreadPoolExecutor(max(1, cores // 2), "palms-scans"),
            ThreadPoolExecutor(1, "palms-replays"),
        )

    def close(self) -> None:
        """End all threads once their work is done."""
        for pool in (self.steps, self.scans, self.replays):
            pool.shutdown()


async def in_pool(pool: ThreadPoolExecutor, work: Callable[..., T], *arguments: object) -> T:
    """Run a function in a pool of threads."""
    return await asyncio.get_running_loop().run_in_executor(pool, work, *arguments)


class Inputs:
    """Takes inputs into sessions.

    Parameters
    ----------
    journal : Journal
    limits : Limits
    pools : Pools
    metrics : Metrics
    """

    def __init__(self, journal: Journal, limits: Limits, pools: Pools, metrics: Metrics) -> None:
        self.limits = limits
        self.metrics = metrics
        self._journal = journal
        self._pools = pools
        self._drawing: set[asyncio.Task[None]] = set()

    async def rebuild(self, session: Session, floor: Floor) -> None:
        """Replay the journal of a session whose state is not in memory."""
        row = session.row
        inputs = await self._journal.do(self._journal.store.inputs, row.id)
        texts = [text for _, _, text in inputs]
        fresh = Session(row)
        session.follower = await in_pool(self._pools.replays, _replayed, fresh, floor, texts)
        session.next_seq = len(texts) + 1
        session.n_events, session.path, session.scan = fresh.n_events, fresh.path, fresh.scan
        self.metrics.count("sessions_replayed_total")

    async def catch_up(self, session: Session, seat: Seat) -> None:
        """Tell who has just come how things stand."""
        assert session.follower is not None
        if session.next_seq == 1:
            return
        if seat.number:
            seat.say(session.told_path())
        if "estimates" in seat.receive:
            seat.say(session.follower.estimate())
        self._show_particles(session, [seat])
        if session.scan is not None and "heatmaps" in seat.receive:
            await self._show_heatmaps(session, [seat])

    async def take(
        self, session: Session, message: messages.Input | tuple[messages.Reading, ...]
    ) -> messages.Ack:
        """Take an input: on disk first, then followed, then told.

        Inputs are applied in order of their sequence numbers, each once. One that comes too
        early waits for those before it. Readings without a number are the next.

        Raises
        ------
        Refused
            When too many wait, or the session has had too many.
        """
        began = time.perf_counter()
        async with session.lock:
            if session.is_over:
                raise Refused("unknown", "the session has ended")
            if isinstance(message, tuple):
                message = messages.Inertial(seq=session.next_seq, readings=message)
            if message.seq != session.next_seq:
                return self._out_of_order(session, message)
            waiting: messages.Input | None = message
            while waiting is not None:
                await self._store(session, waiting)
                stored = self._ack(session, waiting.seq, "stored")
                await self._follow(session, waiting)
                self.metrics.took(time.perf_counter() - began)
                waiting = session.ahead.pop(session.next_seq, None)
            return stored

    def _out_of_order(self, session: Session, message: messages.Input) -> messages.Ack:
        if message.seq < session.next_seq:
            self.metrics.count("repeated_total")
            return self._ack(session, message.seq, "repeated")
        too_far = message.seq >= session.next_seq + self.limits.ahead
        if too_far or len(session.ahead) >= self.limits.ahead:
            raise Refused("gap", f"send again from {session.next_seq} on")
        session.ahead[message.seq] = message
        return self._ack(session, message.seq, "waiting")

    def _ack(self, session: Session, seq: int, status: str) -> messages.Ack:
        """Acknowledge an input to the walker, if it is there; return what was said."""
        ack = messages.Ack.model_construct(seq=seq, status=status, next_seq=session.next_seq)
        if session.walker is not None:
            session.walker.say(ack)
        return ack

    async def _store(self, session: Session, message: messages.Input) -> None:
        if message.seq > self.limits.inputs:
            raise Refused("full", f"a session has at most {self.limits.inputs} inputs")
        try:
            await self._journal.append(session.row.id, message.seq, message.model_dump_json())
        except (OSError, sqlite3.Error):
            log.exception("an input could not be stored")
            self.metrics.count("defects_total")
            raise Refused("defect", "the server cannot store this now; send it again") from None
        session.next_seq = message.seq + 1
        self.metrics.count("inputs_total")

    async def _follow(self, session: Session, message: messages.Input) -> None:
        assert session.follower is not None
        is_scan = isinstance(message, messages.Scan)
        pool = self._pools.scans if is_scan else self._pools.steps
        outcome = await in_pool(pool, session.follower.apply, message)
        if outcome.error is not None:
            self.metrics.count("defects_total" if outcome.is_defect else "errors_total")
        session.tell(outcome, message)
        self.metrics.count("estimates_total")
        self._show_particles(session, session.seats)
        if outcome.scan is not None and session.wants("heatmaps"):
            drawing = asyncio.create_task(self._show_heatmaps(session, session.seats))
            self._drawing.add(drawing)
            drawing.add_done_callback(self._drawing.discard)

    def _show_particles(self, session: Session, seats: list[Seat]) -> None:
        assert session.follower is not None
        belief, seq = session.follower.localizer.belief, session.follower.seq
        wanting = [seat for seat in seats if "particles" in seat.receive]
        if belief is None or not wanting:
            return
        t_s = session.path[-1][0] if session.path else 0.0

        @functools.cache
        def frame(most: int) -> bytes:
            return particles_frame(belief.particles, seq, t_s, most)

        for seat in wanting:
            seat.outbox.latest("particles", frame(seat.max_particles))

    async def _show_heatmaps(self, session: Session, seats: list[Seat]) -> None:
        wanting = [seat for seat in seats if "heatmaps" in seat.receive]
        if not wanting or session.scan is None or session.follower is None:
            return
        seq, scan = session.scan
        raster, settings = session.follower.floor.raster, session.follower.settings
        try:
            frames = await in_pool(self._pools.scans, heatmap_frames, raster, scan, settings, seq)
        except PalmsError:  # it could not be used as a scan either
            return
        for seat in wanting:
            for index, frame in enumerate(frames):
                seat.outbox.latest(f"heatmap {index}", frame)


def _replayed(session: Session, floor: Floor, texts: list[str]) -> Follower:
    """Return the state that inputs lead to; the session notes what they led to."""
    follower = Follower(floor, session.row.terms)
    for text in texts:
        message = messages.parse_input(text)
        session.note(follower.apply(message), message.seq)
    return follower
