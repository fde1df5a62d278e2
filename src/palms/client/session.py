"""A live session of one phone."""

from __future__ import annotations

import time
from collections import deque
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TypeVar

import numpy as np

from palms.errors import InputError, PalmsError
from palms.hints import Hint
from palms.odometry import Move
from palms.scan import Scan
from palms.server import messages
from palms.server.messages.frames import HeatmapFrame, ParticlesFrame

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

    from palms.client.server import Client

__all__ = ["PATIENCE_S", "LiveSession", "read_answer"]

M = TypeVar("M", bound=messages.ServerMessage)
PATIENCE_S = 30.0  # ours: an answer that takes longer does not come
RETRY_S = 0.2  # ours: between two attempts to come back


def read_answer(content: str | bytes) -> messages.ServerMessage | ParticlesFrame | HeatmapFrame:
    """Return what the server sent: a message, or a binary frame."""
    return (
        messages.parse_answer(content)
        if isinstance(content, str)
        else messages.unpack_frame(content)
    )


class LiveSession:
    """A session of one phone. Use it with ``with``: leaving ends it, unless an error does.

    Parameters
    ----------
    client : Client
    hello : messages.Hello

    Attributes
    ----------
    welcome : messages.Welcome
        The answer to hello; its `session` and `key` are what `Client.resume` takes.
    estimate : messages.Estimate or None
        The latest answer.
    events : list of messages.Event
        All that happened.
    viewers : tuple of messages.Viewer
        Who looks on.
    said : list of messages.Say
        All that was said; open the session with ``receive=("estimates", "events", "speech")``.
    """

    def __init__(self, client: Client, hello: messages.Hello) -> None:
        self.estimate: messages.Estimate | None = None
        self.events: list[messages.Event] = []
        self.viewers: tuple[messages.Viewer, ...] = ()
        self.said: list[messages.Say] = []
        self._preferences: messages.Preferences | None = None
        self._client = client
        self._hello = hello
        self._unstored: deque[messages.Input] = deque()
        self._socket: ClientConnection | None = None
        self._key = hello.key or ""
        self.welcome = self._connected()
        self._next_seq = self.welcome.next_seq

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:  # fmt: skip
        if kind is None:
            self.end()
        self.close()

    @property
    def key(self) -> str:
        """What `Client.resume` takes, together with ``welcome.session``."""
        return self._key

    def observe(self, scan: Scan) -> messages.Estimate:
        """Send a scan; return the answer."""
        free = scan.coverage_m
        coverage = None if free is None else [None if np.isnan(r) else float(r) for r in free]
        x, y = (float(v) for v in scan.position_m)
        return self._ask(
            messages.Scan(
                seq=self._next_seq, t_s=scan.time_s, planes=tuple(scan.walls_m.tolist()),
                position_m=(x, y), coverage_m=None if coverage is None else tuple(coverage),
            )
        )  # fmt: skip

    def move(self, move: Move) -> messages.Estimate:
        """Send a move; return the answer."""
        sample = messages.Sample(
            t_s=move.time_s, displacement_m=(float(move.dx_m), float(move.dy_m)),
            facing_rad=move.facing_rad,
        )  # fmt: skip
        return self._ask(messages.Odometry(seq=self._next_seq, samples=(sample,)))

    def hint(self, hint: Hint) -> messages.Estimate:
        """Send what somebody says of where the phone is; return the answer."""
        place = hint.place_m
        return self._ask(
            messages.Hint(
                seq=self._next_seq, room=hint.room, radius_m=hint.radius_m,
                level=hint.level, probability=hint.probability,
                place_m=None if place is None else (float(place[0]), float(place[1])),
            )
        )  # fmt: skip

    def change_level(self, by: int, probability: float = 0.99) -> messages.Estimate:
        """Say that the phone noticed that it went up, or down, so many levels."""
        return self._ask(
            messages.LevelChange(seq=self._next_seq, change=by, probability=probability)
        )

    def tell(self, text: str) -> messages.Estimate:
        """Say in free words where the phone is; what was understood is in `said`."""
        return self._ask(messages.Tell(seq=self._next_seq, text=text))

    def ask(self, what: messages.Question = "where") -> messages.Say:
        """Ask something; return the answer in words."""
        self._say(messages.Ask(what=what))
        while (answer := self._until(messages.Say)).kind != "answer":
            pass
        return answer

    def prefer(self, **wanted: Any) -> None:  # noqa: ANN401
        """Say how one wants to be spoken to.

        Parameters
        ----------
        **wanted
            Fields of `palms.server.messages.Preferences`.
        """
        self._preferences = messages.Preferences(**wanted)
        self._say(self._preferences)

    def pause(self) -> messages.Estimate:
        """Say that nothing comes for a while."""
        return self._ask(messages.Pause(seq=self._next_seq))

    def resume(self, same_frame: bool = True, away_s: float | None = None) -> messages.Estimate:
        """Go on; in a new frame the place is kept, and a new scan finds the drift soon."""
        return self._ask(messages.Resume(seq=self._next_seq, same_frame=same_frame, away_s=away_s))

    def share(self, ttl_s: float = 3600.0) -> str:
        """Return a key that lets others look on."""
        self._say(messages.Share(ttl_s=ttl_s))
        return self._until(messages.Link).view

    def dismiss(self, viewer: int | None = None) -> None:
        """Send a viewer away, or all of them."""
        self._say(messages.Dismiss(viewer=viewer))

    def end(self, keep_recording: bool = True) -> str | None:
        """End the session; return the name of its recording, if it was recorded."""
        if self._socket is None:
            return None
        self._say(messages.End(keep_recording=keep_recording))
        recording = self._until(messages.Ended).recording
        self.close()
        return recording

    def close(self) -> None:
        """Leave without an end; the server keeps the session for a while."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None

    def _ask(self, message: messages.Input) -> messages.Estimate:
        """Send an input until it is stored, and return its answer."""
        self._next_seq += 1
        self._unstored.append(message)
        self._say(message)
        while True:
            answer = self._next()
            if isinstance(answer, messages.Error) and answer.seq == message.seq:
                raise InputError(answer.text)
            if isinstance(answer, messages.Estimate) and answer.seq >= message.seq:
                return answer

    def _until(self, kind: type[M]) -> M:
        while True:
            answer = self._next()
            if isinstance(answer, kind):
                return answer

    def _say(self, message: messages.ClientMessage) -> None:
        from websockets.exceptions import ConnectionClosed

        try:
            self._open().send(message.model_dump_json())
        except ConnectionClosed:
            self._come_back()
            if not hasattr(message, "seq"):  # inputs have been sent again already
                self._open().send(message.model_dump_json())

    def _open(self) -> ClientConnection:
        if self._socket is None:
            raise PalmsError("session", expected="one that is open", got="one that was closed")
        return self._socket

    def _next(self) -> messages.ServerMessage:
        """Return the next message; comes back when the connection breaks."""
        from websockets.exceptions import ConnectionClosed

        while True:
            try:
                answer = read_answer(self._open().recv(PATIENCE_S))
            except (ConnectionClosed, TimeoutError):
                self._come_back()
                continue
            if isinstance(answer, ParticlesFrame | HeatmapFrame):
                continue
            return self._noted(answer)

    def _noted(self, answer: messages.ServerMessage) -> messages.ServerMessage:
        match answer:
            case messages.Error(fatal=True):
                raise PalmsError(f"{self._client.url}: {answer.text}")
            case messages.Ack():
                while self._unstored and self._unstored[0].seq < answer.next_seq:
                    self._unstored.popleft()
            case messages.Estimate():
                self.estimate = answer
            case messages.Event():
                self.events.append(answer)
            case messages.Viewers():
                self.viewers = answer.viewers
            case messages.Say():
                self.said.append(answer)
        return answer

    def _connected(self) -> messages.Welcome:
        self._socket = self._client.connect()
        self._socket.send(self._hello.model_dump_json())
        while not isinstance(answer := self._next(), messages.Welcome):
            pass
        self._key = answer.key or self._key
        self._hello = self._hello.model_copy(
            update={"session": answer.session, "key": self._key, "ticket": None}
        )
        return answer

    def _come_back(self) -> None:
        """Connect again and send what is not stored; give up after a while."""
        began = time.monotonic()
        self.close()
        while True:
            try:
                welcome = self._connected()
                break
            except PalmsError:
                if not self._key or time.monotonic() - began > PATIENCE_S:
                    raise
                time.sleep(RETRY_S)
        if self._preferences is not None:
            self._open().send(self._preferences.model_dump_json())
        for message in list(self._unstored):
            if message.seq >= welcome.next_seq:
                self._open().send(message.model_dump_json())
            else:
                self._unstored.remove(message)
