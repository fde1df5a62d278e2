"""Running: a server on an address, until it is stopped; also beside other work, for tests."""

from __future__ import annotations

import contextlib
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palms.errors import PalmsError
from palms.server.application import Setup, make_application
from palms.server.gate import is_loopback
from palms.server.tls import Certificate

__all__ = ["Place", "data_folder", "in_background", "run", "warm_up"]

SWITCH_S = 0.001  # ours: the loop that answers waits so long for a thread that computes
STOP_S = 5  # ours: what still runs at the end may take so long


@dataclass(frozen=True)
class Place:
    """Where a server listens.

    Parameters
    ----------
    host : str
    port : int
        0: any that is free.
    certificate : Certificate, optional
        With one it speaks TLS.
    """

    host: str = "127.0.0.1"
    port: int = 8000
    certificate: Certificate | None = None

    def listen(self) -> socket.socket:
        """Return a socket that listens.

        Raises
        ------
        PalmsError
            When the address is not this machine's, or in use.
        """
        family = socket.AF_INET6 if ":" in self.host else socket.AF_INET
        listening = socket.socket(family, socket.SOCK_STREAM)
        try:
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listening.bind((self.host, self.port))
        except (OSError, OverflowError) as error:
            listening.close()
            raise PalmsError(
                f"{self.host}:{self.port}", expected="an address of this machine that is free",
                got=getattr(error, "strerror", None) or str(error), fix="choose another --port",
            ) from None  # fmt: skip
        return listening

    def url(self, port: int) -> str:
        """Return where a browser on this machine finds it."""
        name = {"0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(self.host, self.host)
        name = f"[{name}]" if ":" in name and not name.startswith("[") else name
        return f"{'http' if self.certificate is None else 'https'}://{name}:{port}"


def _server(setup: Setup, place: Place) -> Any:  # noqa: ANN401 - uvicorn's
    import uvicorn

    if setup.gate.is_open and not is_loopback(place.host):
        raise PalmsError(
            f"address {place.host}", expected="a token, since others can reach it", got="none",
            fix="give the setup a Gate with a token",
        )  # fmt: skip
    limits, certificate = setup.limits, place.certificate
    return uvicorn.Server(
        uvicorn.Config(
            make_application(setup), log_config=None, access_log=False, server_header=False,
            date_header=False, proxy_headers=False, lifespan="on", ws="websockets-sansio",
            ws_max_size=limits.message_bytes, ws_per_message_deflate=False,
            timeout_keep_alive=5, limit_concurrency=limits.sockets + 200,
            timeout_graceful_shutdown=STOP_S,
            ssl_certfile=None if certificate is None else certificate.certificate,
            ssl_keyfile=None if certificate is None else certificate.key,
        )
    )  # fmt: skip


def run(setup: Setup, place: Place, ready: Callable[[str], object]) -> None:
    """Serve until Ctrl-C or SIGTERM.

    Parameters
    ----------
    setup : Setup
    place : Place
    ready : callable
        Is told the address as soon as the server listens.

    Raises
    ------
    PalmsError
        When it cannot listen there, or its store cannot be used.
    """
    sys.setswitchinterval(SWITCH_S)
    with contextlib.closing(place.listen()) as listening:
        _serve(_server(setup, place), listening, lambda: ready(place.url(_port(listening))))


def _port(listening: socket.socket) -> int:
    return int(listening.getsockname()[1])


@contextlib.contextmanager
def in_background(setup: Setup, place: Place | None = None) -> Iterator[str]:
    """Serve in a thread of this process; yields the address.

    Parameters
    ----------
    setup : Setup
    place : Place, optional
        Any free port of 127.0.0.1 when left out.
    """
    place = place or Place(port=0)
    with contextlib.closing(place.listen()) as listening:
        server = _server(setup, place)
        started = threading.Event()
        thread = threading.Thread(target=_serve, args=(server, listening, started.set), daemon=True)
        thread.start()
        started.wait()
        try:
            yield place.url(_port(listening))
        finally:
            server.should_exit = True
            thread.join()


def _serve(server: Any, listening: socket.socket, ready: Callable[[], object]) -> None:  # noqa: ANN401
    """Run a server; say when it takes requests, or has ended before."""
    begin = server.startup

    async def startup(sockets: list[socket.socket] | None = None) -> None:
        await begin(sockets=sockets)
        ready()

    server.startup = startup
    server.run(sockets=[listening])


def warm_up() -> None:
    """Follow a few moves in the sample building, so that nobody waits for compiled loops."""
    from palms import track
    from palms.io import open_dataset
    from palms.odometry import Odometry
    from palms.sample import sample_folder

    case = open_dataset(sample_folder()).cases[0]
    walk = case.walk().odometry()
    track(case.plan(), case.scan(), Odometry(walk.time_s[:24], walk.position_m[:24]))


def data_folder() -> Path:
    """Return where a user's store is when nothing else is said."""
    return Path.home() / ".local" / "share" / "palms"
