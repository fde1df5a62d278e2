"""A server, as a client sees it."""

from __future__ import annotations

import json
import ssl
import urllib.error
import urllib.request
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from palms.client.session import PATIENCE_S, LiveSession, read_answer
from palms.errors import PalmsError
from palms.server import messages
from palms.server.messages.frames import HeatmapFrame, ParticlesFrame

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

__all__ = ["Client"]


class Client:
    """A PALMS server, as a client sees it.

    Parameters
    ----------
    url : str
        As ``https://palms.local:8000``.
    token : str, optional
        The operator's.
    trust : ssl.SSLContext, optional
        Which certificates to trust; the system's when left out.
    """

    def __init__(
        self, url: str, token: str | None = None, trust: ssl.SSLContext | None = None
    ) -> None:
        self.url = url.rstrip("/")
        self._headers = {} if token is None else {"Authorization": f"Bearer {token}"}
        self._trust = trust

    @property
    def socket_url(self) -> str:
        """Where its socket is."""
        return "ws" + self.url.removeprefix("http") + "/api/v1/live"

    def get(self, path: str) -> Any:  # noqa: ANN401 - whatever the JSON holds
        """Return what a path below ``/api/v1`` says.

        Raises
        ------
        PalmsError
            When the server refuses, or cannot be reached.
        """
        request = urllib.request.Request(f"{self.url}/api/v1/{path}", headers=self._headers)
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_S, context=self._trust) as answer:
                return json.load(answer)
        except urllib.error.HTTPError as error:
            raise PalmsError(f"{self.url}: {_reason(error)}") from None
        except (OSError, ValueError) as error:
            raise PalmsError(self.url, expected="a PALMS server", got=str(error)) from None

    def buildings(self) -> tuple[messages.Building, ...]:
        """Return the server's buildings."""
        listed = json.dumps(self.get("buildings"))
        return messages.BuildingList.model_validate_json(listed).buildings

    def session(self, building: str, **options: Any) -> LiveSession:  # noqa: ANN401
        """Open a session in a building.

        Parameters
        ----------
        building : str
            Its id.
        **options
            More fields of `palms.server.messages.Hello`.
        """
        return LiveSession(self, messages.Hello(building=building, **options))

    def resume(self, session: str, key: str, **options: Any) -> LiveSession:  # noqa: ANN401
        """Go on with a session that was opened before, perhaps by another process."""
        return LiveSession(self, messages.Hello(session=session, key=key, **options))

    def watch(
        self,
        view: str | None = None,
        session: str | None = None,
        **options: Any,  # noqa: ANN401
    ) -> Iterator[messages.ServerMessage | ParticlesFrame | HeatmapFrame]:
        """Look on at a session until it ends: by a link, or as the operator.

        Parameters
        ----------
        view : str, optional
            The key of a link.
        session : str, optional
            The session, for the operator.
        **options
            More fields of `palms.server.messages.Hello`, such as what to receive.
        """
        hello = messages.Hello(role="viewer", view=view, session=session, **options)
        with self.connect() as socket:
            socket.send(hello.model_dump_json())
            for content in socket:
                answer = read_answer(content)
                if isinstance(answer, messages.Error) and answer.fatal:
                    raise PalmsError(f"{self.url}: {answer.text}")
                yield answer

    def connect(self) -> ClientConnection:
        """Open a socket.

        Raises
        ------
        PalmsError
            When the package websockets is missing, or nobody answers.
        """
        try:
            from websockets.exceptions import WebSocketException
            from websockets.sync.client import connect
        except ImportError:
            raise PalmsError(
                "palms.client", expected="the package websockets", got="none",
                fix='pip install "palms-localization[client]"',
            ) from None  # fmt: skip
        try:
            opening: Any = connect(
                self.socket_url, additional_headers=self._headers, ssl=self._trust,
                open_timeout=PATIENCE_S, max_size=None, compression=None,
            )  # fmt: skip
            socket: ClientConnection = opening.__enter__()  # it is left by close()
        except (OSError, WebSocketException) as error:
            raise PalmsError(self.url, expected="a PALMS server", got=str(error)) from None
        return socket


def _reason(error: urllib.error.HTTPError) -> str:
    try:
        return str(json.load(error)["error"])
    except (OSError, ValueError, KeyError, TypeError):
        return f"{error.code} {error.reason}"
