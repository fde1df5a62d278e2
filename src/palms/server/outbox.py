"""Outbox: what waits for one client, so that a slow one holds nobody up."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Awaitable, Callable

__all__ = ["Outbox", "Slow"]

Content = str | bytes


class Slow(Exception):  # noqa: N818 - says what the client is
    """A client took too long."""


class Outbox:
    """Messages that wait for one client: some in order, of some only the latest.

    Parameters
    ----------
    most : int
        Messages that may wait in order; a client that is farther behind is let go.

    Examples
    --------
    >>> outbox = Outbox(10)
    >>> outbox.latest("particles", b"old"); outbox.latest("particles", b"new"); outbox.put("ack")
    >>> outbox.take(), outbox.take(), outbox.take()
    ('ack', b'new', None)
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._ordered: deque[Content] = deque()
        self._latest: dict[str, Content] = {}
        self._news = asyncio.Event()
        self._closed = False
        self.is_slow = False

    def put(self, content: Content) -> None:
        """Add a message that must not be lost."""
        if len(self._ordered) >= self._most:
            self.is_slow = True
        else:
            self._ordered.append(content)
        self._news.set()

    def latest(self, name: str, content: Content) -> None:
        """Add a message that replaces what waits under the same name."""
        self._latest[name] = content
        self._news.set()

    def close(self) -> None:
        """Let the sender end once all is sent."""
        self._closed = True
        self._news.set()

    def take(self) -> Content | None:
        """Return the next message; None when there is none."""
        if self._ordered:
            return self._ordered.popleft()
        if self._latest:
            return self._latest.pop(next(iter(self._latest)))
        return None

    async def send_all(self, send: Callable[[Content], Awaitable[None]], patience_s: float) -> None:
        """Send until the outbox is closed and empty.

        Raises
        ------
        Slow
            When the client is too far behind, or takes nothing for `patience_s`.
        """
        while True:
            content = self.take()
            if self.is_slow:
                raise Slow
            if content is not None:
                try:
                    async with asyncio.timeout(patience_s):
                        await send(content)
                except TimeoutError:
                    raise Slow from None
            elif self._closed:
                return
            else:
                self._news.clear()
                await self._news.wait()
