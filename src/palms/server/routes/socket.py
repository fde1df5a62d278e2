"""The socket: hello, then inputs and answers, until one of both ends it."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections.abc import Awaitable
from typing import NoReturn

from fastapi import APIRouter, WebSocket
from starlette.websockets import WebSocketDisconnect, WebSocketState

from palms.errors import InputError
from palms.server import messages
from palms.server.context import Context, context_of
from palms.server.limits import Meter
from palms.server.messages.inputs import cost
from palms.server.outbox import Slow
from palms.server.session import Refused, Seat, Session

__all__ = ["router"]

router = APIRouter()
log = logging.getLogger("palms.server")
CLOSE = {"full": 1013, "slow": 1013, "size": 1009, "stopping": 1012, "defect": 1011}


@router.websocket("/api/v1/live")
async def live(websocket: WebSocket) -> None:
    """Talk to one client: docs/reference/messages.md."""
    context = context_of(websocket)
    sockets: set[WebSocket] = websocket.app.state.sockets
    await websocket.accept()
    if len(sockets) >= context.limits.sockets:
        context.sessions.metrics.count("refused_total")
        await _close(websocket, "full", "too many sockets; try again later")
        return
    sockets.add(websocket)
    try:
        await _Conversation(websocket, context).run()
    finally:
        sockets.discard(websocket)


async def _close(websocket: WebSocket, code: str, text: str) -> None:
    with contextlib.suppress(RuntimeError, WebSocketDisconnect, OSError, TimeoutError):
        error = messages.Error.model_construct(code=code, text=text, fatal=True)
        async with asyncio.timeout(1.0):
            await websocket.send_text(error.model_dump_json())
            await websocket.close(CLOSE.get(code, 1008))


class _Fatal(Exception):  # noqa: N818 - an answer that ends the conversation
    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code


class _Conversation:
    """One socket from its hello to its end."""

    def __init__(self, websocket: WebSocket, context: Context) -> None:
        self._socket = websocket
        self._context = context
        self._sessions = context.sessions
        self._limits = context.limits
        self._meter = Meter(context.limits.messages_per_s, context.limits.burst)

    async def run(self) -> None:
        """Talk until it is over; say what was wrong, if anything."""
        try:
            hello = await self._hello()
            session, seat, welcome = await self._admit(hello)
        except (_Fatal, Refused) as error:
            await _close(self._socket, error.code, str(error))
            return
        except WebSocketDisconnect:
            return
        try:
            await self._talk(session, seat, welcome)
        except (_Fatal, Refused) as error:
            await _close(self._socket, error.code, str(error))
        except Slow:
            self._sessions.metrics.count("slow_total")
            await _close(self._socket, "slow", "you take too long to read; come again")
        except (WebSocketDisconnect, OSError):
            pass
        finally:
            self._sessions.leave(session, seat)

    async def _text(self, patience_s: float | None) -> str:
        try:
            async with asyncio.timeout(patience_s):
                received = await self._socket.receive()
        except TimeoutError:
            raise _Fatal("slow", f"no message for {patience_s:g} s") from None
        if received["type"] == "websocket.disconnect":
            raise WebSocketDisconnect(received.get("code") or 1005)
        text = received.get("text")
        if text is None:
            raise _Fatal("message", "message: expected JSON as text, got bytes")
        if len(text) > self._limits.message_bytes:
            raise _Fatal("size", f"message: expected at most {self._limits.message_bytes} bytes")
        return str(text)

    async def _hello(self) -> messages.Hello:
        try:
            hello = messages.parse_message(await self._text(self._limits.hello_s))
        except InputError as error:
            raise _Fatal("message", str(error)) from None
        if not isinstance(hello, messages.Hello):
            raise _Fatal("protocol", "the first message must be hello")
        if hello.protocol != messages.SCHEMA:
            raise _Fatal("protocol", f"this server speaks {messages.SCHEMA} only")
        return hello

    async def _admit(self, hello: messages.Hello) -> tuple[Session, Seat, messages.Welcome]:
        """Give a client its seat, if it may have one."""
        sessions = self._sessions
        if hello.role == "viewer":
            session = sessions.find(self._viewed(hello))
            seat = await sessions.look_on(session, hello)
            return session, seat, sessions.welcome(session, seat, None, False)
        if hello.session is not None:
            session = sessions.with_key(hello.session, hello.key)
            seat = await sessions.sit(session, hello)
            sessions.metrics.count("sessions_resumed_total")
            return session, seat, sessions.welcome(session, seat, None, True)
        hello = self._allowed(hello)
        session, key = await sessions.begin(hello)
        seat = await sessions.sit(session, hello)
        return session, seat, sessions.welcome(session, seat, key, False)

    def _is_operator(self) -> bool:
        return self._context.gate.is_operator(self._socket.headers.get("authorization"))

    def _denied(self, text: str) -> NoReturn:
        self._sessions.metrics.count("denied_total")
        raise _Fatal("forbidden", text)

    def _viewed(self, hello: messages.Hello) -> str:
        """Return the session that a viewer may see."""
        gate = self._context.gate
        if hello.view is not None:
            grant = gate.linked(hello.view)
        elif hello.ticket is not None:
            grant = gate.redeem(hello.ticket)
        elif self._is_operator() and hello.session is not None:
            return hello.session
        else:
            grant = None
        if grant is None or grant.role != "viewer" or grant.session is None:
            self._denied("looking on needs a link or a ticket that has not expired")
        return grant.session

    def _allowed(self, hello: messages.Hello) -> messages.Hello:
        """Return the hello of who may open a session, in the building of its ticket."""
        if self._is_operator():
            return hello
        grant = None if hello.ticket is None else self._context.gate.redeem(hello.ticket)
        if grant is None or grant.role != "walker":
            self._denied("a new session needs a ticket that has not been used, or the token")
        if grant.building is None:
            return hello
        if hello.building not in (None, grant.building):
            self._denied("the ticket is for another building")
        return hello.model_copy(update={"building": grant.building})

    async def _talk(self, session: Session, seat: Seat, welcome: messages.Welcome) -> None:
        await self._socket.send_text(welcome.model_dump_json())
        await self._sessions.inputs.catch_up(session, seat)
        sender = asyncio.create_task(
            seat.outbox.send_all(self._send, self._limits.send_s), name="sender"
        )
        reader = asyncio.create_task(self._read(session, seat), name="reader")
        try:
            done, _ = await asyncio.wait({sender, reader}, return_when=asyncio.FIRST_COMPLETED)
            if reader in done:
                await _flushed(reader, sender, seat)
            await sender
            await self._socket.close(1000)
        finally:
            for task in (reader, sender):
                task.cancel()
            await asyncio.gather(reader, sender, return_exceptions=True)

    async def _send(self, content: str | bytes) -> None:
        if self._socket.client_state is not WebSocketState.CONNECTED:
            raise WebSocketDisconnect(1006)
        await self._socket.send(
            {"type": "websocket.send", "text": content}
            if isinstance(content, str)
            else {"type": "websocket.send", "bytes": content}
        )

    async def _read(self, session: Session, seat: Seat) -> None:
        """Take messages until the client ends the session or goes."""
        while True:
            text = await self._text(self._patience_s(session, seat))
            message = self._message(text, seat)
            wait_s = self._meter.wait_s(time.monotonic(), 1.0 if message is None else cost(message))
            if wait_s > 0:
                await asyncio.sleep(wait_s)
            if message is None:
                continue
            if session.walker is not seat and not seat.number:
                return  # replaced; its outbox says so
            if await self._answer(session, seat, message):
                return

    def _message(self, text: str, seat: Seat) -> messages.ClientMessage | None:
        """Return a message; None when it is none, which the client is told."""
        try:
            return messages.parse_message(text)
        except InputError as error:
            self._sessions.metrics.count("errors_total")
            seat.say(messages.Error(code="message", text=str(error)[:500]))
            return None

    def _patience_s(self, session: Session, seat: Seat) -> float | None:
        paused = session.follower is not None and session.follower.intake.is_paused
        return None if seat.number or paused else self._limits.idle_s

    async def _answer(self, session: Session, seat: Seat, message: messages.ClientMessage) -> bool:
        """Do what a message asks for; True when that ends the session."""
        if isinstance(message, messages.Hello):
            seat.say(messages.Error(code="protocol", text="hello comes once, and first"))
        elif seat.number:
            seat.say(messages.Error(code="forbidden", text="who looks on sends nothing"))
        elif isinstance(message, messages.Share):
            view = self._context.gate.link(session.row.id, message.ttl_s)
            seat.say(messages.Link(view=view, expires_in_s=message.ttl_s))
        elif isinstance(message, messages.Dismiss):
            self._sessions.dismiss(session, message.viewer)
        elif isinstance(message, messages.Ask):
            seat.say(session.spoken().ask(message.what))
        elif isinstance(message, messages.Preferences):
            for say in session.spoken().prefer(message):
                seat.say(say)
        elif isinstance(message, messages.End):
            await asyncio.shield(self._sessions.end(session, "ended", message.keep_recording))
            return True
        else:
            await self._take(session, seat, message)
        return False

    async def _take(self, session: Session, seat: Seat, message: messages.Input) -> None:
        try:
            # once it is on disk it is followed, whether or not the client is still there
            await asyncio.shield(self._sessions.inputs.take(session, message))
        except Refused as error:
            seat.say(
                messages.Error.model_construct(
                    code=error.code, text=str(error), seq=message.seq, next_seq=session.next_seq
                )
            )


async def _flushed(reader: Awaitable[None], sender: asyncio.Task[None], seat: Seat) -> None:
    """Raise what ended the reader; when it was the session, let the last words out first."""
    await reader
    seat.outbox.close()
    await asyncio.wait({sender}, timeout=5.0)
