"""When garbage is collected: hardly in a command that ends soon, as usual in one that stays.

What a command imports are 200,000 objects, which collections look through again and again
while they are made, and thrice more when the process ends: a fifth of a second start to end.
"""

from __future__ import annotations

import atexit
import gc

__all__ = ["collect_as_usual", "collect_rarely"]

RARELY = 400_000  # ours: new objects before they are looked through; all imports make fewer
USUAL = gc.get_threshold()


def collect_rarely() -> None:
    """Let garbage lie until it is much, and all that is left when the process ends."""
    gc.set_threshold(RARELY, *USUAL[1:])
    atexit.register(gc.freeze)


def collect_as_usual() -> None:
    """Collect garbage little by little, so that nobody waits for it; what is there now stays."""
    gc.freeze()
    gc.set_threshold(*USUAL)
