"""XML as a stream of events: no tree in memory, no entity declared, nothing fetched."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from typing import Protocol
from xml.parsers import expat

from palms.errors import FormatError
from palms.io.files import read_bytes, sniff
from palms.io.values import StrPath, brief

__all__ = ["XmlEvents", "looks_like", "parse_xml"]

MAX_ELEMENTS = 1_500_000  # ours: keeps memory under a gigabyte
MAX_DEPTH = 200  # ours: a drawing of groups in groups has 20


class XmlEvents(Protocol):
    """What wants to hear of elements; names come without their namespace's prefix."""

    def start(self, name: str, attributes: Mapping[str, str]) -> None:
        """Begin an element."""

    def end(self, name: str) -> None:
        """End it."""

    def text(self, text: str) -> None:
        """Take a piece of the text between."""


def _local(name: str) -> str:
    return name.rpartition(":")[2]


class _Guard:
    """Passes events on, and refuses what no plan needs."""

    def __init__(self, events: XmlEvents, what: str, root: str) -> None:
        self.events, self.what, self.root = events, what, root
        self.depth = self.elements = 0

    def start(self, name: str, attributes: Mapping[str, str]) -> None:
        local = _local(name)
        if not self.elements and local != self.root:
            raise FormatError(
                self.what, expected=f"XML of <{self.root}>", got=f"<{brief(local)[1:-1]}>",
                fix="check that it is the right file",
            )  # fmt: skip
        self.depth += 1
        self.elements += 1
        if self.depth > MAX_DEPTH:
            raise FormatError(self.what, expected=f"elements {MAX_DEPTH} deep", got="deeper ones")
        if self.elements > MAX_ELEMENTS:
            raise FormatError(
                self.what, expected=f"at most {MAX_ELEMENTS:,} elements", got="more",
                fix="export the building alone",
            )  # fmt: skip
        self.events.start(local, {_local(key): value for key, value in attributes.items()})

    def end(self, name: str) -> None:
        self.depth -= 1
        self.events.end(_local(name))

    def entity(self, name: str, *_: object) -> None:
        raise FormatError(
            self.what, expected="XML without entities of its own", got=f"entity {brief(name)}",
            fix="save it again, as plain as the program can",
        )  # fmt: skip


def parse_xml(path: StrPath, root: str, events: XmlEvents) -> None:
    """Hand the elements of an XML file to `events`, one after another.

    Parameters
    ----------
    path : path
    root : str
        What the outermost element must be called.
    events : XmlEvents

    Raises
    ------
    InputError
        When the file cannot be read.
    FormatError
        When it is not whole XML, of another root, declares entities, or is larger or deeper
        than any plan.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_text
    >>> class Names(list):
    ...     def start(self, name, attributes): self.append((name, attributes))
    ...     def end(self, name): pass
    ...     def text(self, text): pass
    >>> names = Names()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/a.svg", '<svg><path d="M0 0"/></svg>')
    ...     parse_xml(f"{folder}/a.svg", "svg", names)
    >>> names
    [('svg', {}), ('path', {'d': 'M0 0'})]
    """
    content = read_bytes(path)
    if not content.strip():
        raise FormatError(str(path), expected=f"XML of <{root}>", got="an empty file")
    guard = _Guard(events, str(path), root)
    parser = expat.ParserCreate()
    parser.StartElementHandler = guard.start
    parser.EndElementHandler = guard.end
    parser.CharacterDataHandler = events.text
    parser.EntityDeclHandler = guard.entity
    parser.buffer_text = True
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, ValueError, LookupError) as error:  # and unknown encodings
        if isinstance(error, FormatError):
            raise
        kind = sniff(content[:1000])
        got = brief(str(error), 60) if kind == "XML or HTML" else kind
        raise FormatError(
            str(path), expected=f"whole XML of <{root}>", got=got,
            fix="it may be cut off or of another format",
        ) from None  # fmt: skip


def looks_like(start: bytes, root: str) -> bool:
    """Whether the beginning of a file is XML whose outermost element has a name.

    Examples
    --------
    >>> looks_like(b"<?xml version='1.0'?><!-- by hand --><osm version='0.6'>", "osm")
    True
    >>> looks_like(b"osm,1,2", "osm")
    False
    """
    if not start.lstrip(b"\xef\xbb\xbf\xff\xfe\x00 \t\r\n").startswith(b"<"):
        return False
    names: list[str] = []

    def named(name: str, *_: object) -> None:
        names.append(_local(name))
        raise StopIteration

    parser = expat.ParserCreate()
    parser.StartElementHandler = named
    parser.StartDoctypeDeclHandler = named
    with contextlib.suppress(expat.ExpatError, ValueError, LookupError, StopIteration):
        parser.Parse(start, False)
    return names == [root]
