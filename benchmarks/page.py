"""Tables into the results page, between their marks."""

from __future__ import annotations

from pathlib import Path


def put(name: str, text: str, page: Path) -> None:
    """Replace what stands between ``<!-- table:NAME -->`` and ``<!-- /table:NAME -->``."""
    start, end = f"<!-- table:{name} -->", f"<!-- /table:{name} -->"
    before, rest = page.read_text().split(start)
    page.write_text(f"{before}{start}\n\n{text}\n\n{end}{rest.split(end)[1]}")
