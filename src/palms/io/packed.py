"""Text and bytes that may be packed by gzip.

Nothing is ever unpacked onto the disk, and nothing is read beyond `MAX_BYTES`, whatever an
archive says of itself.
"""

from __future__ import annotations

import gzip
import io
import zlib
from collections.abc import Iterator
from typing import IO, Final

from palms.errors import FormatError, InputError
from palms.io.archives import DAMAGE
from palms.io.files import MAX_BYTES, head, opened, sniff
from palms.io.values import StrPath, brief

__all__ = ["lines_of", "read_lines", "text_head", "unzipped"]

_HEAD_BYTES: Final = 65_536
_MAX_LINE: Final = 100_000  # ours: a matrix of 16 numbers takes 400


def text_head(path: StrPath) -> bytes:
    """Return the first bytes of a file, of what is inside when it is a gzip archive.

    Examples
    --------
    >>> text_head("no such file")
    b''
    """
    start = head(path)
    if not start.startswith(b"\x1f\x8b"):
        return start
    try:
        return zlib.decompressobj(wbits=31).decompress(start, _HEAD_BYTES)
    except zlib.error:
        return start


def read_lines(path: StrPath, expected: str) -> Iterator[tuple[int, str]]:
    r"""Yield number and text of each line of a text file, also of one packed by gzip.

    Parameters
    ----------
    path : path
        The file.
    expected : str
        What it should hold, for the message.

    Raises
    ------
    InputError
        When it is missing, a folder, not readable or larger than `MAX_BYTES`.
    FormatError
        When it is empty, no text, or an archive that is cut off.

    Examples
    --------
    >>> import tempfile
    >>> from palms.io.files import write_text
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/a.txt", "0.5\n1.5\n")
    ...     list(read_lines(f"{folder}/a.txt", "numbers"))
    [(1, '0.5'), (2, '1.5')]
    """
    kind = sniff(text_head(path))
    if kind not in ("text", "JSON", "XML or HTML"):
        raise FormatError(
            str(path), expected=expected, got=kind, fix="check that it is the right file"
        )
    with opened(path) as file:
        packed = head(path, 2) == b"\x1f\x8b"
        content = gzip.GzipFile(fileobj=file) if packed else file
        empty = True
        for number, line in lines_of(content, path, expected):
            empty = empty and not line.strip()
            yield number, line
    if empty:
        raise FormatError(
            str(path), expected=expected, got="an empty file", fix="export or record it again"
        )


def lines_of(
    content: IO[bytes] | gzip.GzipFile, what: StrPath, expected: str
) -> Iterator[tuple[int, str]]:
    """Yield number and text of each line of an open file, within bounds.

    Raises
    ------
    InputError
        When it holds more than `MAX_BYTES`.
    FormatError
        When a line is too long for any text, or the archive is damaged.

    Examples
    --------
    >>> list(lines_of(io.BytesIO(b"a"), "a.txt", "text"))
    [(1, 'a')]
    """
    total, number = 0, 0
    try:
        while line := content.readline(_MAX_LINE + 1):
            number, total = number + 1, total + len(line)
            if total > MAX_BYTES:
                raise InputError(
                    str(what), expected=f"at most {MAX_BYTES / 1e6:g} MB of text", got="more",
                    fix="check that this is the right file",
                )  # fmt: skip
            if len(line) > _MAX_LINE:
                raise FormatError(
                    f"{what} line {number}", expected=expected,
                    got=f"more than {_MAX_LINE} characters",
                )  # fmt: skip
            if number == 1:
                line = line.removeprefix(b"\xef\xbb\xbf")
            yield number, line.decode("utf-8", "replace").rstrip("\r\n")
    except DAMAGE as error:
        if isinstance(error, InputError):
            raise
        raise FormatError(
            str(what), expected=expected, got=f"an archive that is damaged or cut off ({error})",
            fix="export or copy it again",
        ) from None  # fmt: skip


def unzipped(content: bytes, what: str) -> bytes:
    """Return what the content of a gzip archive holds, at most `MAX_BYTES` of it.

    Anything else is returned as it is.

    Raises
    ------
    FormatError
        When it is damaged, or holds more.

    Examples
    --------
    >>> unzipped(gzip.compress(b"[]"), "a.json.gz"), unzipped(b"[]", "a.json")
    (b'[]', b'[]')
    """
    if content[:2] != b"\x1f\x8b":
        return content
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(content)) as file:
            plain = file.read(MAX_BYTES + 1)
    except (*DAMAGE, ValueError) as error:
        raise FormatError(what, expected="a whole gzip archive", got=brief(str(error))) from None
    if len(plain) > MAX_BYTES:
        raise FormatError(what, expected=f"at most {MAX_BYTES / 1e6:g} MB unpacked", got="more")
    return plain
