"""Session: one phone, followed live; who walks, who looks on, what has been said."""

from __future__ import annotations

import asyncio
from collections import deque
from dataclasses import dataclass, field

from palms.scan import Scan
from palms.server import messages
from palms.server.follower import Follower, Outcome
from palms.server.messages.base import Message
from palms.server.outbox import Outbox
from palms.server.speech import Speech
from palms.server.store import SessionRow

__all__ = ["Refused", "Seat", "Session"]

REMEMBERED = 500  # ours: numbers of pushes, for those that come again
LONGEST_PATH = 20_000  # ours: steps that who comes later is told


class Refused(Exception):  # noqa: N818 - an answer, not a defect
    """A client is told why not.

    Parameters
    ----------
    code : str
        As in `palms.server.messages.Error`.
    text : str
        One line.
    """

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code


@dataclass(eq=False)
class Seat:
    """A client's place in a session: what it wants to hear, and what waits for it.

    Parameters
    ----------
    outbox : Outbox
    receive : frozenset of str
    max_particles : int
    number : int
        Of a viewer; 0 for the walker.
    name : str
        As a viewer calls itself.
    since_s : float
        Since when it is there, seconds since 1970.
    """

    outbox: Outbox
    receive: frozenset[str]
    max_particles: int = 2000
    number: int = 0
    name: str = ""
    since_s: float = 0.0

    def say(self, message: Message) -> None:
        """Send a message that must not be lost."""
        self.outbox.put(message.model_dump_json())

    def dismiss(self, reason: str, recording: str | None = None) -> None:
        """Say that it is over, and close."""
        self.outbox.put(
            messages.Ended.model_construct(reason=reason, recording=recording).model_dump_json()
        )
        self.outbox.close()


@dataclass(eq=False)
class Session:
    """A live session; part of the one store of sessions that changes.

    Parameters
    ----------
    row : SessionRow
        What is stored of it.
    next_seq : int
        The input that comes next.
    follower : Follower or None
        None until its journal is replayed.
    """

    row: SessionRow
    next_seq: int = 1
    follower: Follower | None = None
    walker: Seat | None = None
    viewers: dict[int, Seat] = field(default_factory=dict)
    ahead: dict[int, messages.Input] = field(default_factory=dict)
    lock: asyncio.Lock = field(default_factory=asyncio.Lock)
    n_events: int = 0
    n_viewers_ever: int = 0
    left_s: float = 0.0
    scan: tuple[int, Scan] | None = None
    path: list[tuple[float, float | None, float | None, str]] = field(default_factory=list)
    pushed: deque[int] = field(default_factory=lambda: deque(maxlen=REMEMBERED))
    is_over: bool = False
    speech: Speech | None = None

    @property
    def seats(self) -> list[Seat]:
        """The walker, where there is one, and all viewers."""
        return [*([] if self.walker is None else [self.walker]), *self.viewers.values()]

    def wants(self, channel: str) -> list[Seat]:
        """Who wants to hear something."""
        return [seat for seat in self.seats if channel in seat.receive]

    def note(self, outcome: Outcome, seq: int) -> list[str]:
        """Keep what an input led to; return its events as texts."""
        found = outcome.estimate
        if len(self.path) < LONGEST_PATH:
            self.path.append((found.t_s, found.x_m, found.y_m, found.stage))
        if outcome.scan is not None:
            self.scan = seq, outcome.scan
        texts = []
        for kind, t_s in outcome.events:
            self.n_events += 1
            texts.append(
                messages.Event.model_construct(
                    number=self.n_events, kind=kind, seq=seq, t_s=t_s
                ).model_dump_json()
            )
        return texts

    def tell(self, outcome: Outcome, message: messages.Input) -> None:
        """Send what an input led to; a viewer who is slow gets the latest estimate only."""
        seq = message.seq
        for text in self.note(outcome, seq):
            for seat in self.wants("events"):
                seat.outbox.put(text)
        if outcome.error is not None and self.walker is not None:
            self.walker.say(messages.Error(code="input", text=outcome.error[:500], seq=seq))
        estimate = outcome.estimate.model_dump_json()
        for seat in self.wants("estimates"):
            if seat is self.walker:
                seat.outbox.put(estimate)
            else:
                seat.outbox.latest("estimate", estimate)

        self._speak(outcome, message)

    def _speak(self, outcome: Outcome, message: messages.Input) -> None:
        """Say what an input led to in words, where the walker wants to hear it."""
        walker = self.walker
        if walker is None or self.follower is None:
            return
        if "speech" in walker.receive:
            facing_rad = self.follower.intake.facing_rad
            for say in self.spoken().follow(message, outcome, facing_rad):
                walker.say(say)
        elif self.speech is not None:
            self.speech.meanwhile(outcome)

    def spoken(self) -> Speech:
        """Return what speaks for this session; made when it is needed first."""
        assert self.follower is not None
        if self.speech is None:
            self.speech = Speech(self.follower)
        return self.speech

    def note_push(self, number: int | None) -> None:
        """Remember a push by its number."""
        if number is not None:
            self.pushed.append(number)

    def announce_viewers(self) -> None:
        """Tell the walker who looks on."""
        if self.walker is not None:
            listed = tuple(
                messages.Viewer(viewer=seat.number, name=seat.name, since_s=seat.since_s)
                for seat in self.viewers.values()
            )
            self.walker.say(messages.Viewers(viewers=listed))

    def told_path(self) -> messages.Path:
        """Return the path so far."""
        columns = list(zip(*self.path, strict=True)) or [(), (), (), ()]
        return messages.Path.model_construct(
            t_s=columns[0], x_m=columns[1], y_m=columns[2], stage=columns[3]
        )
