"""Guard: what every request and socket must pass before any route sees it."""

from __future__ import annotations

import json
import time
from collections import OrderedDict

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from palms.server.gate import Gate
from palms.server.limits import Limits, Meter

__all__ = ["HEADERS", "Guard"]

MAX_ADDRESSES = 10_000
HEADERS = {
    "content-security-policy": (
        "default-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
        "style-src 'self'; script-src 'self'; object-src 'none'; base-uri 'none'; "
        "form-action 'none'; frame-ancestors 'none'"
    ),
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "xr-spatial-tracking=(self), camera=(self), geolocation=()",
}


class Guard:
    """Checks Host, Origin, size and rate; adds the headers that browsers mind.

    Parameters
    ----------
    app : ASGI application
    gate : Gate
    limits : Limits
    """

    def __init__(self, app: ASGIApp, gate: Gate, limits: Limits) -> None:
        self._app = app
        self._gate = gate
        self._limits = limits
        self._meters: OrderedDict[str, Meter] = OrderedDict()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let pass what may pass."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        status, problem = self._problem(scope)
        if problem is None:
            await self._app(scope, self._measured(scope, receive), _with_headers(scope, send))
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008, "reason": problem})
        else:
            await _refuse(_with_headers(scope, send), status, problem)

    def _problem(self, scope: Scope) -> tuple[int, str | None]:
        headers = Headers(scope=scope)
        host, secure = headers.get("host"), scope["scheme"] in ("https", "wss")
        if not self._gate.knows_host(host):
            return 421, "this server is not called so; see palms serve --allow-host"
        if not self._gate.knows_origin(headers.get("origin"), host, "https" if secure else "http"):
            return 403, "pages of that origin may not talk to this server"
        if self._wait_s(scope) > 0:
            return 429, "too many requests; wait a little"
        size = headers.get("content-length", "0")
        if not size.isdigit() or int(size) > self._limits.upload_bytes:
            return 413, f"at most {self._limits.upload_bytes} bytes"
        return 200, None

    def _wait_s(self, scope: Scope) -> float:
        address = (scope.get("client") or ("", 0))[0]
        meter = self._meters.pop(address, None) or Meter(
            self._limits.requests_per_s, self._limits.request_burst
        )
        self._meters[address] = meter
        if len(self._meters) > MAX_ADDRESSES:
            self._meters.popitem(last=False)
        wait_s = meter.wait_s(time.monotonic())
        if wait_s > 0:
            meter.forgive()
        return wait_s

    def _measured(self, scope: Scope, receive: Receive) -> Receive:
        """Pass a body on as long as it is not larger than allowed, whatever its header said."""
        if scope["type"] != "http":
            return receive
        left = self._limits.upload_bytes

        async def measured() -> Message:
            nonlocal left
            message = await receive()
            left -= len(message.get("body", b""))
            if left < 0:
                return {"type": "http.disconnect"}
            return message

        return measured


def _with_headers(scope: Scope, send: Send) -> Send:
    if scope["type"] != "http":
        return send

    is_data = scope["path"].startswith(("/api/", "/metrics"))

    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            known = {name for name, _ in message["headers"]}
            wanted = HEADERS | {"cache-control": "no-store" if is_data else "no-cache"}
            pairs = [(name.encode(), value.encode()) for name, value in wanted.items()]
            extra = [pair for pair in pairs if pair[0] not in known]
            message = {**message, "headers": [*message["headers"], *extra]}
        await send(message)

    return sending


async def _refuse(send: Send, status: int, problem: str) -> None:
    body = json.dumps({"error": problem}).encode()
    headers = [(b"content-type", b"application/json"), (b"content-length", b"%d" % len(body))]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
