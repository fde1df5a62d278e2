"""Limits: how much of everything a server takes; each can be set."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

from palms.errors import SettingsError

__all__ = ["Limits", "Meter"]


@dataclass(frozen=True, slots=True)
class Limits:
    """How much of everything a server takes.

    Parameters
    ----------
    sessions : int
        Live sessions with a client; more are refused, those that are there go on.
    viewers : int
        Of one session.
    sockets : int
        Open sockets altogether.
    message_bytes : int
        Of one message.
    messages_per_s : float
        Of one client; who is quicker is read more slowly. A scan counts as ten, and so do a
        hundred samples.
    burst : int
        So many messages at once, after a gap of the network.
    ahead : int
        Messages kept that wait for one before them.
    particles : int
        Of one session.
    inputs : int
        Of one session.
    hello_s : float
        So long may a socket stay without its hello.
    idle_s : float
        So long without a message, and a socket is closed.
    keep_s : float
        So long is a session kept without its client.
    send_s : float
        A client that takes nothing for so long is let go.
    outbox : int
        Messages that may wait for a slow client.
    ticket_s : float
        So long is a one-time ticket good.
    upload_bytes : int
        Of one request.
    upload_s : float
        So long may a file take to be read.
    upload_memory_bytes : int
        So much memory may it take.
    uploads : int
        Files read at the same time.
    plan_cells : int
        Of a level's raster.
    building_cells : int
        Of all levels together, to be searched as one.
    plan_segments : int
        Of a level.
    buildings : int
        Altogether.
    recordings : int
        Altogether.
    recording_days : float
        So long is a recording kept.
    requests_per_s : float
        Of one address.
    request_burst : int
        So many requests at once.

    Examples
    --------
    >>> Limits().with_texts(["sessions=10"]).sessions
    10
    """

    sessions: int = 120
    viewers: int = 8
    sockets: int = 400
    message_bytes: int = 1_000_000
    messages_per_s: float = 30.0
    burst: int = 200
    ahead: int = 200
    particles: int = 50_000
    inputs: int = 200_000
    hello_s: float = 10.0
    idle_s: float = 300.0
    keep_s: float = 3600.0
    send_s: float = 20.0
    outbox: int = 500
    ticket_s: float = 300.0
    upload_bytes: int = 20_000_000
    upload_s: float = 30.0
    upload_memory_bytes: int = 1_500_000_000
    uploads: int = 2
    plan_cells: int = 6_000_000
    building_cells: int = 20_000_000
    plan_segments: int = 100_000
    buildings: int = 200
    recordings: int = 500
    recording_days: float = 30.0
    requests_per_s: float = 20.0
    request_burst: int = 200

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            if not (math.isfinite(value) and value > 0):
                raise SettingsError(f"limit {each.name}", expected="above 0", got=str(value))

    def with_texts(self, texts: Sequence[str]) -> Limits:
        """Return limits with some set as ``name=value``.

        Raises
        ------
        SettingsError
            When there is no such limit, or its value is no number above 0.
        """
        kinds = {each.name: int if each.type == "int" else float for each in fields(self)}
        found: dict[str, float] = {}
        for text in texts:
            name, equals, value = text.partition("=")
            name = name.strip().replace("-", "_")
            if not equals or name not in kinds:
                raise SettingsError(
                    "limit", expected=f"name=value with one of {', '.join(kinds)}", got=repr(text)
                )
            try:
                found[name] = kinds[name](value)
            except ValueError:
                raise SettingsError(f"limit {name}", expected="a number", got=value) from None
        return replace(self, **found)  # type: ignore[arg-type]


class Meter:
    """Says how long to wait before the next message, so that no more come than allowed.

    Parameters
    ----------
    per_s : float
    burst : int

    Examples
    --------
    >>> meter = Meter(10.0, 2)
    >>> [round(meter.wait_s(5.0), 2) for _ in range(4)]
    [0.0, 0.0, 0.1, 0.2]
    """

    def __init__(self, per_s: float, burst: int) -> None:
        self.per_s = per_s
        self.burst = burst
        self._left = float(burst)
        self._at_s: float | None = None

    def wait_s(self, now_s: float, cost: float = 1.0) -> float:
        """Count a message that came now for so many; return for how long it has to wait."""
        passed = 0.0 if self._at_s is None else max(now_s - self._at_s, 0.0)
        self._at_s = now_s
        self._left = min(self._left + passed * self.per_s, float(self.burst)) - cost
        return max(-self._left / self.per_s, 0.0)

    def forgive(self) -> None:
        """Take the latest message back: it was refused."""
        self._left += 1
