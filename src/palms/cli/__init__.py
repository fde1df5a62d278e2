"""The command ``palms``: one file per command; what they share has a leading underscore.

Nothing heavy is imported before a command needs it, so that ``palms --help`` is quick.
"""

from __future__ import annotations

import _thread
import os
import sys

from palms.cli._garbage import collect_rarely

__all__ = ["main"]


def _again(unraisable: sys.UnraisableHookArgs) -> None:
    """Interrupt once more when an interrupt fell where nothing can be raised."""
    if issubclass(unraisable.exc_type, KeyboardInterrupt):
        from threading import Timer

        Timer(0.01, _thread.interrupt_main).start()  # here, too, it would be swallowed
    else:
        sys.__unraisablehook__(unraisable)


def main() -> None:
    """Run the command; the entry point of the package.

    One product is never spread over several cores: it is too small to gain, and its last bits
    would depend on how many there are.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.unraisablehook = _again  # the compiler's callbacks swallow what is raised in them
    collect_rarely()
    try:
        from palms.cli.app import app

        app(prog_name="palms")
    except KeyboardInterrupt:  # before or after the command itself
        sys.exit(130)
    finally:
        exec("")  # else an interrupt that went through an exec, as of a dataclass, kills later on
