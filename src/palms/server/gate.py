"""Gate: who may come in. A token for operators, one-time tickets for sockets, keys for sessions.

Secrets are kept as their SHA-256 alone and compared in constant time.
"""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass
from urllib.parse import urlsplit

from palms.errors import InputError

__all__ = ["Gate", "Grant", "hashed", "is_loopback", "new_secret"]

MAX_TICKETS = 10_000
SHORTEST_TOKEN = 16


def new_secret() -> str:
    """Return 192 random bits as text for a URL's fragment or a header.

    Examples
    --------
    >>> len(new_secret()), new_secret() == new_secret()
    (32, False)
    """
    return secrets.token_urlsafe(24)


def hashed(secret: str) -> bytes:
    """Return what is kept of a secret."""
    return hashlib.sha256(secret.encode("utf-8", "replace")).digest()


def is_loopback(host: str) -> bool:
    """Whether an address is this machine's alone.

    Examples
    --------
    >>> is_loopback("127.0.0.1"), is_loopback("localhost"), is_loopback("0.0.0.0")
    (True, True, False)
    """
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


@dataclass(frozen=True, slots=True)
class Grant:
    """What a ticket or a link opens, and until when.

    Parameters
    ----------
    role : {"walker", "viewer", "operator"}
    session : str or None
        The only session that it opens; None: a new one, or any for an operator.
    until_s : float
        On the gate's clock.
    building : str or None
        For a walker: the only building; None: any.
    """

    role: str
    session: str | None
    until_s: float
    building: str | None = None


class Gate:
    """Keeps the secrets of a server.

    Parameters
    ----------
    token : str or None
        The operator's; None where everybody on this machine is the operator.
    hosts : sequence of str
        Names under which the server is called, besides addresses.
    origins : sequence of str
        Other places whose pages may talk to it, as ``https://map.example``.
    now_s : callable
        A clock that is never set.

    Raises
    ------
    InputError
        When the token is too short.

    Examples
    --------
    >>> gate = Gate("a token of some length")
    >>> gate.is_operator("Bearer a token of some length"), gate.is_operator("Bearer guess")
    (True, False)
    >>> ticket = gate.ticket("viewer", "s1", 60.0)
    >>> gate.redeem(ticket).session, gate.redeem(ticket)
    ('s1', None)
    """

    def __init__(
        self,
        token: str | None = None,
        hosts: tuple[str, ...] = (),
        origins: tuple[str, ...] = (),
        now_s: Callable[[], float] = time.monotonic,
    ) -> None:
        if token is not None and len(token) < SHORTEST_TOKEN:
            raise InputError(
                "token", expected=f"at least {SHORTEST_TOKEN} characters", got=str(len(token)),
                fix="leave it out, and one is made",
            )  # fmt: skip
        self._token = None if token is None else hashed(token)
        self._hosts = frozenset(name.lower() for name in ("localhost", *hosts))
        self._origins = frozenset(origin.lower().rstrip("/") for origin in origins)
        self._now_s = now_s
        self._tickets: dict[bytes, Grant] = {}
        self._links: dict[bytes, Grant] = {}

    @property
    def is_open(self) -> bool:
        """Whether there is no token: everybody who can reach it is the operator."""
        return self._token is None

    def is_operator(self, authorization: str | None) -> bool:
        """Whether a header ``Authorization: Bearer TOKEN`` is the operator's."""
        if self._token is None:
            return True
        kind, _, token = (authorization or "").partition(" ")
        matches = hmac.compare_digest(hashed(token.strip()), self._token)
        return matches and kind.lower() == "bearer"

    def ticket(
        self, role: str, session: str | None, for_s: float, building: str | None = None
    ) -> str:
        """Return a new ticket, good once."""
        until_s = self._now_s() + for_s
        return self._granted(self._tickets, Grant(role, session, until_s, building))

    def link(self, session: str, for_s: float) -> str:
        """Return a new key that lets others look on until it expires."""
        return self._granted(self._links, Grant("viewer", session, self._now_s() + for_s))

    def _granted(self, book: dict[bytes, Grant], grant: Grant) -> str:
        now = self._now_s()
        for key in [key for key, each in book.items() if each.until_s <= now]:
            del book[key]
        while len(book) >= MAX_TICKETS:
            del book[next(iter(book))]
        secret = new_secret()
        book[hashed(secret)] = grant
        return secret

    def redeem(self, ticket: str) -> Grant | None:
        """Take a ticket; None when it is not known, used or expired."""
        grant = self._tickets.pop(hashed(ticket), None)
        return grant if grant is not None and grant.until_s > self._now_s() else None

    def linked(self, view: str) -> Grant | None:
        """Return what a link opens; None when it is not known or expired."""
        grant = self._links.get(hashed(view))
        return grant if grant is not None and grant.until_s > self._now_s() else None

    def revoke(self, session: str) -> None:
        """End all links and tickets of a session."""
        for book in (self._links, self._tickets):
            for key in [key for key, each in book.items() if each.session == session]:
                del book[key]

    def knows_host(self, host: str | None) -> bool:
        """Whether a Host header names this server: by an address, or by a name it knows.

        A page of others that has its own name point here (DNS rebinding) fails.
        """
        try:
            name = urlsplit(f"//{host}").hostname if host else None
        except ValueError:
            return False
        if name is None:
            return False
        try:
            ipaddress.ip_address(name)
            return True
        except ValueError:
            return name.lower() in self._hosts

    def knows_origin(self, origin: str | None, host: str | None, scheme: str) -> bool:
        """Whether a page may talk to the server: one of its own, or of a place it was told.

        A request without an Origin is no page of others.
        """
        if origin is None:
            return True
        own = f"{scheme}://{host}".lower()
        return origin.lower() in (own, *self._origins)
