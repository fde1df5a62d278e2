"""Say that the loops are being compiled, when they are: only at the first start."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

from palms.cli._outputs import Speaker

__all__ = ["announcing"]


@contextlib.contextmanager
def announcing(say: Speaker) -> Iterator[None]:
    """Say once that loops are compiled, as soon as numba begins to, not when it finds them."""
    from numba.core import event

    class FirstStart(event.Listener):
        told = False

        def on_start(self, event: object) -> None:
            if not self.told:
                self.told = True
                say("Compiling the loops once; from the next start on they are ready.")

        def on_end(self, event: object) -> None:
            pass

    with event.install_listener("numba:compile", FirstStart()):
        yield
