"""Shapefiles as such: lines and rings from .shp, attributes from .dbf, the system from .prj."""

from __future__ import annotations

import codecs
import struct
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from palms.errors import FormatError
from palms.geometry import FloatArray
from palms.io.geojson import Feature
from palms.io.values import brief, check_array, parse_number

__all__ = ["SHP_MAGIC", "parse_shapefile"]

SHP_MAGIC = struct.pack(">i", 9994)
_HEADER_BYTES = 100
_LINES, _AREAS = (3, 13, 23), (5, 15, 25)  # plain, with heights, with measures
_OTHERS = (0, 1, 8, 11, 18, 21, 28, 31)  # no geometry, points, and surfaces in space
_MAX_RECORDS = 500_000  # ours
_Shape = tuple[Sequence[FloatArray], Sequence[FloatArray]]  # lines and rings


class _Field(NamedTuple):
    name: str
    kind: str
    start: int
    end: int


def parse_shapefile(parts: Mapping[str, bytes], what: str) -> list[Feature]:
    """Return the features of a shapefile.

    Parameters
    ----------
    parts : mapping
        Content of its files by suffix: ``shp``; ``dbf`` and ``cpg`` when they are there.
    what : str
        What to call it in a message.

    Raises
    ------
    FormatError
        When it is none, or damaged.
    """
    shapes = list(_shapes(parts["shp"], what))
    rows = _rows(parts["dbf"], parts.get("cpg", b""), what) if parts.get("dbf") else []
    if rows and len(rows) != len(shapes):
        raise FormatError(
            what, expected=f"a row of attributes for each of {len(shapes)} shapes",
            got=f"{len(rows)} rows", fix="check that .shp and .dbf belong together",
        )  # fmt: skip
    return [
        Feature(tuple(lines), tuple(rings), row)
        for (lines, rings), row in zip(shapes, rows or [{}] * len(shapes), strict=True)
        if row is not None
    ]


def _shapes(
    content: bytes, what: str
) -> Iterator[tuple[Sequence[FloatArray], Sequence[FloatArray]]]:
    """Yield lines and rings of each record."""
    if len(content) < _HEADER_BYTES or content[:4] != SHP_MAGIC:
        raise FormatError(what, expected="a whole shapefile", got=brief(content[:8]))
    stated = 2 * int(struct.unpack_from(">i", content, 24)[0])
    at = _HEADER_BYTES
    for number in range(1, _MAX_RECORDS + 2):
        if at >= len(content) and at >= stated:
            return
        where = f"{what}, record {number}"
        if at + 12 > len(content):
            raise FormatError(where, expected="a record", got="the end of the file",
                              fix="it may be cut off; export it again")  # fmt: skip
        size = 2 * int(struct.unpack_from(">i", content, at + 4)[0])
        record = content[at + 8 : at + 8 + size]
        if size < 4 or len(record) != size:
            raise FormatError(
                where, expected="a whole record", got=f"{len(record)} of {size} bytes"
            )
        yield _shape(record, where)
        at += 8 + size
    raise FormatError(what, expected=f"at most {_MAX_RECORDS:,} records", got="more",
                      fix="export the building alone")  # fmt: skip


def _shape(record: bytes, what: str) -> _Shape:
    kind = struct.unpack_from("<i", record)[0]
    if kind in _OTHERS:
        return (), ()
    if kind not in (*_LINES, *_AREAS):
        raise FormatError(what, expected="a line or area", got=f"shape type {kind}")
    if len(record) < 44:
        raise FormatError(what, expected="a whole line or area", got=f"{len(record)} bytes")
    parts, points = struct.unpack_from("<ii", record, 36)
    first = 44 + 4 * parts
    if parts < 0 or points < 0 or first + 16 * points > len(record):
        raise FormatError(
            what, expected="room for its points", got=f"{points} points in {len(record)} bytes"
        )
    starts = np.frombuffer(record, "<i4", parts, 44)
    if (np.diff(starts) < 0).any() or (starts < 0).any() or (starts > points).any():
        raise FormatError(what, expected="parts one after another", got=brief(starts.tolist()))
    whole = check_array(np.frombuffer(record, "<f8", 2 * points, first).reshape(-1, 2), what,
                        (None, 2))  # fmt: skip
    found = [each for each in np.split(whole, starts[1:].tolist()) if len(each) > 1]
    return (found, ()) if kind in _LINES else ((), found)


def _rows(content: bytes, code_page: bytes, what: str) -> list[Mapping[str, Any] | None]:
    """Return the attributes of each record; None for those that are deleted."""
    if len(content) < 33:
        raise FormatError(f"{what}, .dbf", expected="a whole table", got=f"{len(content)} bytes")
    count, start, size = struct.unpack_from("<IHH", content, 4)
    fields = list(_fields(content[32:start], what))
    room = (len(content) - start) // size if size else 0
    if count > room or any(field.end > size for field in fields):
        raise FormatError(
            f"{what}, .dbf", expected=f"room for {count} rows", got=f"{room} of {size} bytes",
            fix="it may be cut off; export it again",
        )  # fmt: skip
    encoding = _encoding(code_page)
    rows: list[Mapping[str, Any] | None] = []
    for k in range(count):
        record = content[start + k * size : start + (k + 1) * size]
        values = {each.name: _value(record, each, encoding) for each in fields}
        rows.append(None if record[:1] == b"*" else values)
    return rows


def _fields(descriptions: bytes, what: str) -> Iterator[_Field]:
    at = 1  # after the mark of deletion
    for k in range(0, len(descriptions) - 31, 32):
        each = descriptions[k : k + 32]
        if each[0] == 0x0D:
            return
        name = each[:11].partition(b"\x00")[0].decode("utf-8", "replace").strip()
        yield _Field(name, chr(each[11]), at, at + each[16])
        at += each[16]


def _value(record: bytes, field: _Field, encoding: str) -> Any:  # noqa: ANN401
    raw = record[field.start : field.end]
    try:
        text = raw.decode(encoding)
    except UnicodeDecodeError:
        text = raw.decode("cp1252", "replace")
    text = text.replace("\x00", " ").strip()
    if field.kind not in "NFIO+":
        return text
    number = parse_number(text)
    if number is None or not np.isfinite(number):
        return None
    return int(number) if number == int(number) else number


def _encoding(code_page: bytes) -> str:
    name = code_page.decode("ascii", "replace").strip()
    name = f"cp{name}" if name.isdigit() and len(name) in (3, 4) else name
    try:
        return codecs.lookup(name).name
    except LookupError:
        return "utf-8"
