"""Put into the pages what their code prints now: ``python -m tests.docs.refresh``.

Only what the tests would refuse is changed. Read the differences before you keep them.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from tests.docs.pages import PAGES, blocks, commands, name_of, run, same, shell_environment
from tests.docs.test_code import run_python


def refreshed(page: Path, folder: Path) -> str:
    """Return the page with what its code prints when it runs in a folder."""
    text, names, printed = page.read_text(), {"__name__": "page"}, ""
    environment = shell_environment(folder.parent)
    for block in blocks(page):
        if block.kind == "python":
            with contextlib.chdir(folder):
                printed = run_python(block.text, names, name_of(page))
        elif block.kind == "console":
            for command, shown in commands(block.text):
                output, folder = run(command, folder, environment)
                if shown.strip() and not same(shown, output):
                    text = text.replace(shown, output.rstrip() + "\n", 1)
        elif block.kind == "text" and printed:
            if not same(block.text, printed):
                text = text.replace(block.text, printed, 1)
            printed = ""
    return text


def main() -> None:
    for page in PAGES:
        with tempfile.TemporaryDirectory() as folder:
            work = Path(folder) / "work"
            work.mkdir()
            text = refreshed(page, work)
        if text != page.read_text():
            page.write_text(text)
            os.write(1, f"{name_of(page)}\n".encode())


if __name__ == "__main__":
    main()
