"""What waits for a slow client."""

import asyncio

import pytest

from palms.server.outbox import Outbox, Slow


async def never(content):
    await asyncio.Event().wait()


def test_a_client_that_takes_nothing_is_let_go():
    async def run():
        outbox = Outbox(10)
        outbox.put("one")
        await outbox.send_all(never, 0.01)

    with pytest.raises(Slow):
        asyncio.run(run())


def test_a_client_that_is_too_far_behind_is_let_go():
    async def run():
        outbox, sent = Outbox(3), []
        for number in range(4):
            outbox.put(str(number))

        async def send(content):
            sent.append(content)

        await outbox.send_all(send, 1.0)

    with pytest.raises(Slow):
        asyncio.run(run())


def test_of_what_can_be_replaced_only_the_latest_waits():
    async def run():
        outbox, sent = Outbox(2), []
        for number in range(1000):
            outbox.latest("particles", b"%d" % number)
        outbox.put("event")

        async def send(content):
            sent.append(content)

        outbox.close()
        await outbox.send_all(send, 1.0)
        return sent

    assert asyncio.run(run()) == ["event", b"999"]


def test_what_comes_while_it_sends_is_sent_too():
    async def run():
        outbox, sent = Outbox(2), []

        async def send(content):
            sent.append(content)
            if len(sent) < 5:
                outbox.put(str(len(sent)))
            else:
                outbox.close()

        outbox.put("0")
        await outbox.send_all(send, 1.0)
        return sent

    assert asyncio.run(run()) == ["0", "1", "2", "3", "4"]
