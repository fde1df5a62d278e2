"""Text that may be packed: lines of plain and gzip files, members of zip archives and folders.

Nothing is ever unpacked onto the disk, and nothing is read beyond `MAX_BYTES`, whatever an
archive says of itself.
"""

from __future__ import annotations

import contextlib
import gzip
import io
import struct
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Final

from palms.errors import FormatError, InputError
from palms.io.files import MAX_BYTES, head, sniff
from palms.io.values import StrPath

__all__ = ["lines_of", "member_names", "open_member", "read_lines", "text_head"]

_HEAD_BYTES: Final = 65_536
_MAX_LINE: Final = 100_000  # ours: a matrix of 16 numbers takes 400
_MAX_DIRECTORY: Final = 8_000_000  # ours: about 80,000 members; a log has 20
_DAMAGE = (EOFError, zlib.error, gzip.BadGzipFile, zipfile.BadZipFile, struct.error)


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
    with _opened(path) as file:
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


@contextlib.contextmanager
def _opened(path: StrPath) -> Iterator[IO[bytes]]:
    """Open a file, or say why that cannot be."""
    if "\x00" not in str(path) and Path(path).is_dir():
        raise InputError(
            str(path), expected="a file", got="a folder", fix="name the file inside it"
        )
    try:
        file = open(path, "rb")  # noqa: SIM115 (closed below; only opening is guarded)
    except (OSError, ValueError) as error:
        missing = isinstance(error, FileNotFoundError)
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            str(path).replace("\x00", "?"),
            expected="a file that can be read",
            got="nothing there" if missing else reason,
            fix="check the name and the folder",
        ) from None
    with file:
        yield file


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
    except (*_DAMAGE, OSError) as error:
        if isinstance(error, InputError):
            raise
        raise FormatError(
            str(what), expected=expected, got=f"an archive that is damaged or cut off ({error})",
            fix="export or copy it again",
        ) from None  # fmt: skip


def member_names(path: StrPath) -> list[str]:
    """Return the names of the files in a zip archive or folder; none when it is neither.

    Examples
    --------
    >>> member_names("no such file")
    []
    """
    place = Path(path)
    try:
        if place.is_dir():
            return sorted(entry.name for entry in place.iterdir() if entry.is_file())
        if head(place, 4) != b"PK\x03\x04" or _directory_size(place) > _MAX_DIRECTORY:
            return []
        with zipfile.ZipFile(place) as archive:
            return [name for name in archive.namelist() if not name.endswith("/")]
    except (*_DAMAGE, OSError, ValueError, NotImplementedError):
        return []


def _directory_size(path: Path) -> int:
    """Bytes of a zip archive's table of contents, by its last record; 0 when there is none."""
    with open(path, "rb") as file:
        file.seek(0, io.SEEK_END)
        file.seek(max(file.tell() - _HEAD_BYTES - 22, 0))
        tail = file.read()
    at = tail.rfind(b"PK\x05\x06")
    return int(struct.unpack("<L", tail[at + 12 : at + 16])[0]) if at >= 0 else 0


@contextlib.contextmanager
def open_member(path: StrPath, name: str) -> Iterator[IO[bytes]]:
    """Open one file of a zip archive or folder, as `member_names` calls it.

    Raises
    ------
    FormatError
        When the archive is damaged, locked by a password, or says it holds more than
        `MAX_BYTES` there.
    """
    if Path(path).is_dir():
        with _opened(Path(path) / name) as file:
            yield file
        return
    try:
        with zipfile.ZipFile(path) as archive:
            size = archive.getinfo(name).file_size
            if size > MAX_BYTES:
                raise FormatError(
                    f"{path}: {name}", expected=f"at most {MAX_BYTES / 1e6:g} MB",
                    got=f"{size / 1e6:.0f} MB", fix="check that this is the right file",
                )  # fmt: skip
            with archive.open(name) as file:
                yield file
    except (*_DAMAGE, KeyError, NotImplementedError, RuntimeError) as error:
        raise FormatError(
            f"{path}: {name}", expected="a file in a zip archive", got=str(error),
            fix="export it again, without a password",
        ) from None  # fmt: skip
