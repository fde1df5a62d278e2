"""Sessions: the store of live sessions, the only thing of the server that changes."""

from __future__ import annotations

import asyncio
import functools
import logging
import os
import secrets
import sqlite3
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Literal, TypeVar

from palms.errors import PalmsError
from palms.server import messages
from palms.server.catalogue import Catalogue, UnknownBuilding
from palms.server.follower import Floor, Follower, Terms
from palms.server.gate import Gate, hashed, new_secret
from palms.server.journal import Journal
from palms.server.limits import Limits
from palms.server.metrics import Metrics
from palms.server.outbox import Outbox
from palms.server.pictures import heatmap_frames, particles_frame
from palms.server.push import Push
from palms.server.session import Refused, Seat, Session
from palms.server.store import SessionRow
from palms.settings import METHODS

__all__ = ["Pools", "Sessions"]

T = TypeVar("T")
Reason = Literal["ended", "dismissed", "replaced", "idle", "deleted"]
UNLOAD_S = 60.0  # ours: a session without its client is let go of in memory after this
STORED = 10  # ours: so many stored sessions for each live one
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


async def _run(pool: ThreadPoolExecutor, work: Callable[..., T], *arguments: object) -> T:
    return await asyncio.get_running_loop().run_in_executor(pool, work, *arguments)


class Sessions:
    """All live sessions.

    Parameters
    ----------
    catalogue : Catalogue
    journal : Journal
    gate : Gate
    limits : Limits
    pools : Pools
    """

    def __init__(
        self, catalogue: Catalogue, journal: Journal, gate: Gate, limits: Limits, pools: Pools
    ) -> None:
        self.catalogue = catalogue
        self.limits = limits
        self.metrics = Metrics()
        self.may_record = True
        self._journal = journal
        self._gate = gate
        self._pools = pools
        self._sessions: dict[str, Session] = {}
        self._drawing: set[asyncio.Task[None]] = set()

    async def open(self) -> None:
        """Take up the sessions that the store has; they are replayed when a client comes."""
        for row in await self._journal.do(self._journal.store.sessions):
            n = await self._journal.do(self._journal.store.n_inputs, row.id)
            self._sessions[row.id] = Session(row, n + 1)

    @property
    def n_walkers(self) -> int:
        """Sessions whose client is there."""
        return sum(session.walker is not None for session in self._sessions.values())

    @property
    def n_viewers(self) -> int:
        """Who looks on, over all sessions."""
        return sum(len(session.viewers) for session in self._sessions.values())

    def all(self) -> list[Session]:
        """All sessions, oldest first."""
        return list(self._sessions.values())

    def find(self, session: str) -> Session:
        """Return a session.

        Raises
        ------
        Refused
            When there is none of that name.
        """
        found = self._sessions.get(session)
        if found is None or found.is_over:
            raise Refused("unknown", "there is no such session; it may have ended")
        return found

    def with_key(self, session: str | None, key: str | None) -> Session:
        """Return a session whose key somebody has; one answer for all that is wrong.

        Raises
        ------
        Refused
            When there is none, or its key is another.
        """
        found = self._sessions.get(session or "")
        known = found.row.key_hash if found is not None else hashed("no session")
        if not secrets.compare_digest(hashed(key or ""), known) or found is None or found.is_over:
            raise Refused("unknown", "there is no such session, or its key is another")
        return found

    def opened_by(self, secret: str) -> Session | None:
        """Return the session that a key or a link opens, to walk or to look on."""
        found = hashed(secret)
        grant = self._gate.linked(secret)
        for session in self._sessions.values():
            if session.row.key_hash == found or (grant and grant.session == session.row.id):
                return session
        return None

    # Coming and going

    async def begin(self, hello: messages.Hello) -> tuple[Session, str]:
        """Open a new session; return it and its key.

        Raises
        ------
        Refused
            When the server is full, or hello asks for what there is not.
        """
        self._refuse_when_full()
        building, level, terms = self._terms(hello)
        floor = await self.catalogue.floor(building, level)
        follower = await _run(self._pools.steps, Follower, floor, terms)
        self._refuse_when_full()  # others came while the floor was made
        key, now = new_secret(), self._journal.now_s()
        records = hello.record and self.may_record
        row = SessionRow(
            secrets.token_hex(12), hashed(key), building, level, terms, records, now, now
        )
        session = Session(row, follower=follower, left_s=now)
        self._sessions[row.id] = session
        try:
            await self._journal.do(self._journal.store.add_session, row)
        except Exception:
            del self._sessions[row.id]
            raise
        self.metrics.count("sessions_opened_total")
        return session, key

    def _refuse_when_full(self) -> None:
        most = self.limits.sessions
        if self.n_walkers >= most or len(self._sessions) >= STORED * most:
            self.metrics.count("refused_total")
            raise Refused("full", f"this server follows {most} sessions at a time; try again later")

    def _terms(self, hello: messages.Hello) -> tuple[str, str, Terms]:
        try:
            building = self.catalogue.building(hello.building or "").id
            level = self.catalogue.level(building, hello.level)
        except UnknownBuilding as error:
            raise Refused("unknown", str(error)) from None
        seed = secrets.randbelow(2**31) if hello.seed is None else hello.seed
        terms = Terms(hello.method, hello.particles, seed, hello.source, hello.frame)
        if hello.method not in METHODS or hello.method == "oracle":
            raise Refused("unknown", f"method: expected one of {', '.join(METHODS)}")
        most = self.limits.particles
        if (hello.particles or terms.settings().start.n_particles) > most:
            raise Refused("full", f"particles: this server has at most {most} for a session")
        return building, level, terms

    async def rebuild(self, session: Session) -> None:
        """Replay the journal of a session whose state is not in memory."""
        async with session.lock:
            if session.follower is not None:
                return
            row = session.row
            floor = await self.catalogue.floor(row.building, row.level)
            inputs = await self._journal.do(self._journal.store.inputs, row.id)
            texts = [text for _, _, text in inputs]
            fresh = Session(row)
            session.follower = await _run(self._pools.replays, _replayed, fresh, floor, texts)
            session.next_seq = len(texts) + 1
            session.n_events, session.path, session.scan = (
                fresh.n_events, fresh.path, fresh.scan
            )  # fmt: skip
            self.metrics.count("sessions_replayed_total")

    async def sit(self, session: Session, hello: messages.Hello) -> Seat:
        """Give a walker its seat; one that sat there before is sent away."""
        was_away = session.walker is None
        if was_away and session.next_seq > 1 and self.n_walkers >= self.limits.sessions:
            self._refuse_when_full()
        await self.rebuild(session)
        if session.walker is not None:
            session.walker.dismiss("replaced")
        seat = self._seat(hello)
        session.walker = seat
        session.ahead.clear()
        return seat

    async def look_on(self, session: Session, hello: messages.Hello) -> Seat:
        """Give a viewer a seat, and tell the walker.

        Raises
        ------
        Refused
            When there are too many.
        """
        if len(session.viewers) >= self.limits.viewers:
            raise Refused("full", f"{self.limits.viewers} look on already")
        await self.rebuild(session)
        seat = self._seat(hello)
        session.n_viewers_ever += 1
        seat.number, seat.name = session.n_viewers_ever, hello.name or "somebody"
        session.viewers[seat.number] = seat
        session.announce_viewers()
        return seat

    def _seat(self, hello: messages.Hello) -> Seat:
        most = min(hello.max_particles, self.limits.particles)
        return Seat(
            Outbox(self.limits.outbox), frozenset(hello.receive), most,
            since_s=self._journal.now_s(),
        )  # fmt: skip

    def welcome(
        self, session: Session, seat: Seat, key: str | None, resumed: bool
    ) -> messages.Welcome:
        """Return the answer to hello."""
        from palms import __version__

        assert session.follower is not None
        row, found = session.row, session.follower.estimate()
        return messages.Welcome(
            version=__version__, role="viewer" if seat.number else "walker", session=row.id,
            key=key, viewer=seat.number or None, building=self.catalogue.building(row.building),
            level=row.level, method=row.terms.method, seed=row.terms.seed,
            next_seq=session.next_seq, resumed=resumed, recording=row.is_recording,
            stage=found.stage, t_s=found.t_s if session.next_seq > 1 else None,
        )  # fmt: skip

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

    def leave(self, session: Session, seat: Seat) -> None:
        """Take a client's seat away; the session stays."""
        if session.walker is seat:
            session.walker = None
            session.left_s = self._journal.now_s()
            session.ahead.clear()
        elif session.viewers.pop(seat.number, None) is not None:
            session.announce_viewers()

    def dismiss(self, session: Session, viewer: int | None) -> None:
        """Send viewers away, and end the keys that they came with."""
        self._gate.revoke(session.row.id)
        for number, seat in list(session.viewers.items()):
            if viewer in (None, number):
                seat.dismiss("dismissed")
                del session.viewers[number]
        session.announce_viewers()

    async def end(self, session: Session, reason: Reason, keep: bool = True) -> None:
        """End a session: its journal goes, unless it is recorded."""
        async with session.lock:
            if session.is_over:
                return
            session.is_over = True
            store, row = self._journal.store, session.row
            kept = row.is_recording and keep and session.next_seq > 1
            if kept:
                await self._journal.do(store.end_session, row.id, self._journal.now_s())
            else:
                await self._journal.do(store.delete_sessions, [row.id])
            self._sessions.pop(row.id, None)
            self._gate.revoke(row.id)
            for seat in session.seats:
                seat.dismiss(reason, row.id if kept and seat is session.walker else None)

    # Inputs

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
        outcome = await _run(pool, session.follower.apply, message)
        if outcome.error is not None:
            self.metrics.count("defects_total" if outcome.is_defect else "errors_total")
        session.tell(outcome, message.seq)
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
            frames = await _run(self._pools.scans, heatmap_frames, raster, scan, settings, seq)
        except PalmsError:  # it could not be used as a scan either
            return
        for seat in wanting:
            for index, frame in enumerate(frames):
                seat.outbox.latest(f"heatmap {index}", frame)

    async def push(self, session: Session, push: Push) -> messages.Ack:
        """Take readings that an app pushed; a number that came before is known.

        Raises
        ------
        Refused
            When the session has had too many, or has ended.
        """
        await self.rebuild(session)
        session.left_s = self._journal.now_s()
        if push.number is not None and push.number in session.pushed:
            self.metrics.count("repeated_total")
            seq = session.next_seq - 1
            return messages.Ack(seq=seq, status="repeated", next_seq=session.next_seq)
        session.note_push(push.number)
        return await self.take(session, push.readings)

    async def replay(self, work: Callable[..., T], *arguments: object) -> T:
        """Run what replays a recording, in the thread for that."""
        return await _run(self._pools.replays, work, *arguments)

    # In the course of time

    async def sweep(self) -> None:
        """Let go of what nobody needs any more; called now and then."""
        now, limits = self._journal.now_s(), self.limits
        here = [each.row.id for each in self.all() if each.walker is not None]
        await self._journal.do(self._journal.store.mark_seen, here, now)
        for session in self.all():
            away_s = now - max(session.left_s, session.row.seen_s)
            if session.walker is None and away_s > limits.keep_s:
                await self.end(session, "idle")
            elif not session.seats and away_s > UNLOAD_S and not session.lock.locked():
                session.follower = None
        await self._forget_recordings(now)

    async def _forget_recordings(self, now: float) -> None:
        store = self._journal.store
        rows = await self._journal.do(store.sessions, True)
        old = [
            row.id for place, row in enumerate(reversed(rows))
            if now - (row.ended_s or now) > 86_400 * self.limits.recording_days
            or place >= self.limits.recordings
        ]  # fmt: skip
        await self._journal.do(store.delete_sessions, old)


def _replayed(session: Session, floor: Floor, texts: list[str]) -> Follower:
    """Return the state that inputs lead to; the session notes what they led to."""
    follower = Follower(floor, session.row.terms)
    for text in texts:
        message = messages.parse_input(text)
        session.note(follower.apply(message), message.seq)
    return follower
