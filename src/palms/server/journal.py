"""Journal: the store's one thread, and inputs committed in groups.

Inputs that arrive while a transaction is written wait for the next, all together: each is on
disk before it is acknowledged, and a hundred sessions cost little more than one.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from palms.server.store import Store

__all__ = ["Journal"]

APART_S = 0.01  # ours: a commit takes about 4 ms of the disk; inputs that come sooner share one
T = TypeVar("T")
Entry = tuple[str, int, float, str]


class Journal:
    """The store, for an event loop.

    Parameters
    ----------
    store : Store
    now_s : callable
        Seconds since 1970.
    """

    def __init__(self, store: Store, now_s: Callable[[], float] = time.time) -> None:
        self.store = store
        self.now_s = now_s
        self._thread = ThreadPoolExecutor(1, "palms-store")
        self._waiting: list[tuple[Entry, asyncio.Future[None]]] = []
        self._writing: asyncio.Task[None] | None = None
        self._next_s = 0.0
        self.n_commits = 0

    async def do(self, work: Callable[..., T], *arguments: object) -> T:
        """Run a method of the store in its thread."""
        return await asyncio.get_running_loop().run_in_executor(self._thread, work, *arguments)

    async def append(self, session: str, seq: int, text: str) -> None:
        """Write an input; it is on disk when this returns."""
        done: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.append(((session, seq, self.now_s(), text), done))
        if self._writing is None or self._writing.done():
            self._writing = asyncio.create_task(self._write())
        await done

    async def _write(self) -> None:
        loop = asyncio.get_running_loop()
        while self._waiting:
            await asyncio.sleep(max(self._next_s - loop.time(), 0.0))
            group, self._waiting = self._waiting, []
            self._next_s = loop.time() + APART_S
            try:
                await self.do(self.store.append, [entry for entry, _ in group])
            except Exception as error:
                for _, done in group:
                    if not done.done():
                        done.set_exception(error)
                continue
            self.n_commits += 1
            for _, done in group:
                if not done.done():
                    done.set_result(None)

    async def close(self) -> None:
        """Write what waits, and close the store."""
        if self._writing is not None:
            await self._writing
        await self.do(self.store.close)
        self._thread.shutdown()
