"""Tables into the results page, between their marks."""

from __future__ import annotations

from pathlib import Path

from palms.errors import InputError
from palms.io import write_text
from palms.io.files import read_text


def put(name: str, text: str, page: Path) -> None:
    """Replace what stands between ``<!-- table:NAME -->`` and ``<!-- /table:NAME -->``."""
    before, after = around(name, page)
    write_text(page, f"{before}\n\n{text}\n\n{after}")


def around(name: str, page: Path) -> tuple[str, str]:
    """Return the page up to the first mark, and from the second on.

    Before a long run it tells whether there will be a place for its table.
    """
    start, end = f"<!-- table:{name} -->", f"<!-- /table:{name} -->"
    content = read_text(page)
    before, _, rest = content.partition(start)
    _, found, after = rest.partition(end)
    if not found:
        raise InputError(
            str(page), expected=f"the marks {start} and {end}", got="none", fix="add them",
        )  # fmt: skip
    return before + start, end + after
