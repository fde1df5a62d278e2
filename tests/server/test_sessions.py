"""The store of sessions in the course of time: what is kept, and for how long."""

import asyncio
import json
from contextlib import asynccontextmanager

import pytest

from palms.server import messages
from palms.server.catalogue import Catalogue
from palms.server.gate import Gate
from palms.server.inputs import Pools
from palms.server.journal import Journal
from palms.server.limits import Limits
from palms.server.session import Refused
from palms.server.sessions import Sessions
from palms.server.store import Store
from tests.server.conftest import new_store, whole_walk

HELLO = {"building": "hall", "particles": 200, "seed": 1}


class Clock:
    def __init__(self):
        self.now = 1e6

    def __call__(self):
        return self.now


@asynccontextmanager
async def opened(folder, clock, limits=None):
    """Sessions over a folder, without a network."""
    journal = Journal(Store(folder), clock)
    pools = Pools.make()
    limits = limits or Limits()
    catalogue = Catalogue(journal, limits, pools.steps)
    sessions = Sessions(catalogue, journal, Gate(), limits, pools)
    await catalogue.open()
    await sessions.open()
    yield sessions
    pools.close()
    await journal.close()


async def walked(sessions, n=5, **fields):
    """A session whose client has sent n inputs and is still there."""
    hello = messages.Hello(**(HELLO | fields))
    session, key = await sessions.begin(hello)
    seat = await sessions.sit(session, hello)
    for message in whole_walk()[:n]:
        await sessions.inputs.take(session, messages.parse_input(json.dumps(message)))
    return session, key, seat


@pytest.fixture
def folder(tmp_path):
    return new_store(tmp_path / "data")


def test_a_session_without_its_client_is_kept_an_hour_and_then_gone(folder):
    async def run():
        clock = Clock()
        async with opened(folder, clock) as sessions:
            session, _, seat = await walked(sessions)
            clock.now += 10_000
            await sessions.sweep()  # its client is there
            sessions.leave(session, seat)
            clock.now += 3599
            await sessions.sweep()
            assert sessions.find(session.row.id) is session
            clock.now += 2
            await sessions.sweep()
            with pytest.raises(Refused):
                sessions.find(session.row.id)
            assert sessions._journal.store.session(session.row.id) is None

    asyncio.run(run())


def test_an_hour_counts_over_a_restart(folder):
    async def run():
        clock = Clock()
        async with opened(folder, clock) as sessions:
            session, key, _ = await walked(sessions)
            await sessions.sweep()
        clock.now += 3500
        async with opened(folder, clock) as sessions:
            await sessions.sweep()
            assert sessions.with_key(session.row.id, key).next_seq == 6
        clock.now += 200
        async with opened(folder, clock) as sessions:
            await sessions.sweep()
            assert sessions.all() == []

    asyncio.run(run())


def test_a_session_that_was_let_go_of_in_memory_comes_back_the_same(folder):
    async def run():
        clock = Clock()
        async with opened(folder, clock) as sessions:
            session, _, seat = await walked(sessions)
            before = session.follower.estimate()
            path = list(session.path)
            sessions.leave(session, seat)
            clock.now += 61
            await sessions.sweep()
            assert session.follower is None
            seat = await sessions.sit(session, messages.Hello(**HELLO))
            assert session.follower.estimate() == before
            assert session.path == path
            assert session.next_seq == 6

    asyncio.run(run())


def test_a_recorded_session_whose_client_vanished_is_kept_for_its_days(folder):
    async def run():
        clock = Clock()
        async with opened(folder, clock, Limits(recording_days=2)) as sessions:
            session, _, seat = await walked(sessions, record=True)
            sessions.leave(session, seat)
            clock.now += 4000
            await sessions.sweep()
            store = sessions._journal.store
            assert [row.id for row in store.sessions(True)] == [session.row.id]
            assert store.n_inputs(session.row.id) == 5
            clock.now += 2 * 86_400 + 1
            await sessions.sweep()
            assert store.sessions(True) == []

    asyncio.run(run())


def test_only_so_many_recordings_are_kept_the_oldest_go(folder):
    async def run():
        clock = Clock()
        async with opened(folder, clock, Limits(recordings=2)) as sessions:
            names = []
            for _ in range(3):
                clock.now += 10
                session, _, _ = await walked(sessions, 1, record=True)
                await sessions.end(session, "ended")
                names.append(session.row.id)
            await sessions.sweep()
            assert [row.id for row in sessions._journal.store.sessions(True)] == names[1:]

    asyncio.run(run())


def test_inputs_of_many_sessions_share_their_commits(folder):
    async def run():
        async with opened(folder, Clock()) as sessions:
            found = [await walked(sessions, 1) for _ in range(6)]
            before = sessions._journal.n_commits
            inputs = [messages.parse_input(json.dumps(each)) for each in whole_walk()[1:9]]
            for message in inputs:
                await asyncio.gather(*(sessions.inputs.take(s, message) for s, _, _ in found))
            commits = sessions._journal.n_commits - before
            assert commits < len(found) * len(inputs)
            assert all(s.next_seq == 10 for s, _, _ in found)
            answers = {s.follower.estimate().model_dump_json() for s, _, _ in found}
            assert len(answers) == 1

    asyncio.run(run())


def test_a_store_that_fails_acknowledges_nothing(folder, monkeypatch):
    async def run():
        async with opened(folder, Clock()) as sessions:
            session, _, seat = await walked(sessions, 2)
            while seat.outbox.take():
                pass

            def full(entries):
                raise OSError("no space left")

            monkeypatch.setattr(sessions._journal.store, "append", full)
            message = messages.parse_input(json.dumps(whole_walk()[2]))
            with pytest.raises(Refused, match="send it again"):
                await sessions.inputs.take(session, message)
            assert seat.outbox.take() is None
            monkeypatch.undo()
            assert session.next_seq == 3
            await sessions.inputs.take(session, message)
            assert session.next_seq == 4

    asyncio.run(run())
