"""Sessions: the store of live sessions, the only thing of the server that changes."""

from __future__ import annotations

import secrets
import sqlite3
from collections.abc import Callable
from typing import Literal, TypeVar

from palms.errors import InputError
from palms.server import messages
from palms.server.catalogue import Catalogue, UnknownBuilding
from palms.server.floor import ALL
from palms.server.follower import Follower, Terms
from palms.server.gate import Gate, hashed, new_secret
from palms.server.inputs import Inputs, Pools, in_pool
from palms.server.journal import Journal
from palms.server.limits import Limits
from palms.server.metrics import Metrics
from palms.server.outbox import Outbox
from palms.server.push import Push
from palms.server.session import Refused, Seat, Session
from palms.server.store import SessionRow
from palms.settings import METHODS, Settings

__all__ = ["Sessions"]

T = TypeVar("T")
Reason = Literal["ended", "dismissed", "replaced", "idle", "deleted"]
UNLOAD_S = 60.0  # ours: a session without its client is let go of in memory after this
STORED = 10  # ours: so many stored sessions for each live one


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
        self.inputs = Inputs(journal, limits, pools, self.metrics)
        self._sessions: dict[str, Session] = {}

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
        levels = self.catalogue.levels(building, level)
        try:
            floor = await self.catalogue.floor(building, level)
            follower = await in_pool(self._pools.steps, Follower, floor, terms)
        except InputError as error:
            raise Refused("full", str(error)) from None
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
        except sqlite3.IntegrityError:
            del self._sessions[row.id]
            raise Refused("unknown", "the building has just been deleted") from None
        if self.catalogue.levels(building, level) != levels:
            await self.end(session, "deleted", keep=False)
            raise Refused("unknown", "the building has just got another level; come again")
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
        except UnknownBuilding as error:
            raise Refused("unknown", str(error)) from None
        try:
            level, start_level = self._levels(building, hello)
        except UnknownBuilding as error:
            raise Refused("unknown", str(error)) from None
        except InputError as error:
            raise Refused("full", str(error)) from None
        seed = secrets.randbelow(2**31) if hello.seed is None else hello.seed
        terms = Terms(
            hello.method, hello.particles, seed, hello.source, hello.frame, start_level
        )  # fmt: skip
        if hello.method not in METHODS or hello.method == "oracle":
            raise Refused("unknown", f"method: expected one of {', '.join(METHODS)}")
        most = self.limits.particles
        if (hello.particles or terms.settings().start.n_particles) > most:
            raise Refused("full", f"particles: this server has at most {most} for a session")
        return building, level, terms

    def _levels(self, building: str, hello: messages.Hello) -> tuple[str, str | None]:
        """Return the level to walk on, or all, and where the walk is said to start."""
        level = self.catalogue.level(building, hello.level)
        several = len(self.catalogue.building(building).levels) > 1
        ours = hello.method in METHODS and Settings.for_method(hello.method).is_ours
        if hello.one_level or not several or not ours:
            return level, None
        self.catalogue.check_atlas(building)
        return ALL, hello.level

    async def rebuild(self, session: Session) -> None:
        """Replay the journal of a session whose state is not in memory."""
        async with session.lock:
            if session.follower is not None:
                return
            row = session.row
            await self.inputs.rebuild(session, await self.catalogue.floor(row.building, row.level))

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
            level=row.level or None, method=row.terms.method, seed=row.terms.seed,
            next_seq=session.next_seq, resumed=resumed, recording=row.is_recording,
            stage=found.stage, t_s=found.t_s if session.next_seq > 1 else None,
        )  # fmt: skip

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
        ack = await self.inputs.take(session, push.readings)
        session.note_push(push.number)
        return ack

    async def replay(self, work: Callable[..., T], *arguments: object) -> T:
        """Run what replays a recording, in the thread for that."""
        return await in_pool(self._pools.replays, work, *arguments)

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
