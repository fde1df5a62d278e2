"""``palms serve``: live sessions in a browser."""

from __future__ import annotations

from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Annotated

import typer

from palms.cli._garbage import collect_as_usual
from palms.errors import InputError, PalmsError

if TYPE_CHECKING:
    from palms.server.tls import Certificate

__all__ = ["EXAMPLE", "serve"]

EXAMPLE = "Example: palms serve --port 8000 --data my-buildings"


def serve(
    *,
    host: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Address to listen at; others need the token.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(metavar="N", min=0, max=65535, help="Port; 0: any.")] = 8000,
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder of buildings and sessions; one in your home if left out.",
            show_default=False,
        ),
    ] = None,
    tls: Annotated[
        bool, typer.Option("--tls", help="Speak TLS, which phones need; self-signed if not given.")
    ] = False,
    tls_cert: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Your certificate, in PEM.", show_default=False),
    ] = None,
    tls_key: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Its key, in PEM.", show_default=False)
    ] = None,
    token_file: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="File with the token; made at random and shown once if left out.",
            show_default=False,
        ),
    ] = None,
    allow_host: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME", help="A name by which the server is called. Repeatable.",
            show_default=False,
        ),
    ] = None,
    allow_origin: Annotated[
        list[str] | None,
        typer.Option(
            metavar="URL", help="Another place whose pages may use it. Repeatable.",
            show_default=False,
        ),
    ] = None,
    recording: Annotated[
        bool, typer.Option(help="Whether sessions are recorded when their walkers want it.")
    ] = True,
    limit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE", help="Set a limit, such as sessions=50. Repeatable.",
            show_default=False,
        ),
    ] = None,
) -> None:  # fmt: skip
    """Follow phones live: buildings, sessions and their pages, from one folder."""
    _check_extra()
    from palms.server.application import Setup
    from palms.server.gate import Gate, is_loopback
    from palms.server.limits import Limits
    from palms.server.running import Place, data_folder, run
    from palms.server.tls import own_names

    limits = Limits().with_texts(limit or [])
    folder = data or data_folder()
    names = (*own_names(host), *(allow_host or ()))
    certificate = _certificate(folder, names, (tls_cert, tls_key), tls)
    token, is_new = _token(token_file, is_loopback(host))
    gate = Gate(token, names, tuple(allow_origin or ()))
    setup = Setup(folder, gate, limits, recording)
    Thread(target=_warm_up, daemon=True).start()

    def ready(url: str) -> None:
        typer.echo(f"PALMS is at {url}  (Ctrl-C ends it; buildings and sessions: {folder})")
        if certificate is not None:
            typer.echo(f"Certificate, SHA-256: {certificate.fingerprint}")
        if is_new:
            typer.echo(f"Token, shown this once: {token}")
        if certificate is None and not is_loopback(host):
            _note("without --tls others on the network can read along, and phones do not scan")

    run(setup, Place(host, port, certificate), ready)


def _warm_up() -> None:
    """Have the loops ready when the first phone comes."""
    from palms.cli._compiling import announcing
    from palms.server.running import warm_up

    try:
        with announcing(_note):
            warm_up()
    finally:
        collect_as_usual()


def _note(text: str) -> None:
    typer.echo(f"palms: note: {text}", err=True)


def _check_extra() -> None:
    """Say what is missing before anything else is looked at."""
    try:
        import fastapi  # noqa: F401
        import python_multipart  # noqa: F401
        import segno  # noqa: F401
        import uvicorn  # noqa: F401
        import websockets  # noqa: F401
    except ImportError as error:
        raise PalmsError(
            "palms serve", expected=f"the package {error.name}", got="none",
            fix='pip install "palms-localization[server]"',
        ) from None  # fmt: skip


def _certificate(
    folder: Path, names: tuple[str, ...], given_files: tuple[Path | None, Path | None], wanted: bool
) -> Certificate | None:
    from palms.io.files import make_folder
    from palms.server.tls import given, self_signed

    certificate, key = given_files
    if (certificate is None) != (key is None):
        raise InputError("TLS", expected="both --tls-cert and --tls-key", got="one of them")
    if certificate is not None and key is not None:
        return given(certificate, key)
    return self_signed(make_folder(folder), names) if wanted else None


def _token(file: Path | None, is_loopback: bool) -> tuple[str | None, bool]:
    """Return the token, and whether it was made just now; none is needed on this machine."""
    from palms.io.files import read_text
    from palms.server.gate import new_secret

    if file is not None:
        return read_text(file, "a token").strip(), False
    if is_loopback:
        return None, False
    return new_secret(), True
