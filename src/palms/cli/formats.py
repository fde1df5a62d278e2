"""``palms formats``: what can be read and written."""

from __future__ import annotations

from typing import Any

from palms.cli._options import Json
from palms.cli._outputs import check_file, speaker, table, write_result

__all__ = ["EXAMPLE", "formats"]

EXAMPLE = "Example: palms formats --json formats.json"


def formats(json: Json = None) -> None:
    """List what can be read and written, and which extra it needs."""
    check_file(json)
    known = _known()
    say = speaker(json)
    rows = [
        [
            each["what"],
            each["name"],
            " ".join(each["suffixes"]),
            "read, write" if each["writes"] else "read",
            f"palms-localization[{each['extra']}]" if each["extra"] else "nothing",
            each["description"],
            " ".join(option["name"] for option in each["options"]) or "none",
        ]
        for each in known
    ]
    for line in table(["what", "format", "files", "can", "needs", "description", "options"], rows):
        say(line)
    write_result({"schema": "palms-formats/1", "formats": known}, json)


def _known() -> list[dict[str, Any]]:
    from palms import io

    groups = {"floor plan": io.FLOORPLANS, "scan": io.SCANS, "walk": io.ODOMETRY}
    return [
        {
            "what": what,
            "name": reader.name,
            "suffixes": list(reader.suffixes),
            "reads": True,
            "writes": getattr(reader, "write", None) is not None,
            "extra": getattr(reader, "extra", None),
            "description": getattr(reader, "description", ""),
            "options": _options(reader),
        }
        for what, group in groups.items()
        for reader in io.formats(group)
    ]


def _options(reader: Any) -> list[dict[str, Any]]:  # noqa: ANN401
    from palms.io.options import options_of

    return [
        {"name": each.name, "default": _plain(each.default)} for each in options_of(reader.read)
    ]


def _plain(value: object) -> object:
    """Return a default as JSON has it: what is no number, truth or None becomes text."""
    return value if isinstance(value, str | int | float | bool | None) else str(value)
