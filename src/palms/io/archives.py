"""Zip archives and folders of small files, read in memory: nothing is unpacked onto a disk."""

from __future__ import annotations

import contextlib
import io
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import IO, Final

from palms.errors import FormatError, InputError
from palms.io.files import MAX_BYTES, head, opened, read_bytes
from palms.io.values import StrPath, brief

__all__ = ["DAMAGE", "member_names", "open_member", "read_members"]

DAMAGE: Final = (EOFError, OSError, zlib.error, zipfile.BadZipFile, struct.error)
_ZIP_DAMAGE: Final = (*DAMAGE, NotImplementedError, RuntimeError, ValueError)
_TAIL_BYTES: Final = 65_536 + 22  # of a zip archive's last record, with its comment
_MAX_DIRECTORY: Final = 8_000_000  # ours: about 80,000 members; a log has 20
MAX_MEMBERS = 10_000  # ours: a venue in IMDF has about 20


def member_names(path: StrPath) -> tuple[str, ...]:
    """Return the names of the files in a zip archive or folder; none when it is neither.

    Examples
    --------
    >>> member_names("no such file")
    ()
    """
    place = Path(path)
    try:
        if place.is_dir():
            return tuple(sorted(entry.name for entry in place.iterdir() if entry.is_file()))
        if head(place, 4) != b"PK\x03\x04":
            return ()
        with _zip(place) as archive:
            return tuple(name for name in archive.namelist() if not name.endswith("/"))
    except (*_ZIP_DAMAGE, InputError):
        return ()


@contextlib.contextmanager
def _zip(path: Path) -> Iterator[zipfile.ZipFile]:
    """Open a zip archive, unless its table of contents is beyond reason."""
    size = _directory_size(path)
    if size > _MAX_DIRECTORY:
        raise FormatError(
            str(path), expected=f"at most {_MAX_DIRECTORY / 1e6:g} MB of names of files",
            got=f"{size / 1e6:.3g} MB", fix="check that this is the right file",
        )  # fmt: skip
    with zipfile.ZipFile(path) as archive:
        yield archive


def _directory_size(path: Path) -> int:
    """Bytes of a zip archive's table of contents, by its last record; 0 when there is none."""
    with open(path, "rb") as file:
        file.seek(0, io.SEEK_END)
        file.seek(max(file.tell() - _TAIL_BYTES, 0))
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
        with opened(Path(path) / name) as file:
            yield file
        return
    try:
        with _zip(Path(path)) as archive:
            size = archive.getinfo(name).file_size
            if size > MAX_BYTES:
                raise FormatError(
                    f"{path}: {name}", expected=f"at most {MAX_BYTES / 1e6:g} MB",
                    got=f"{size / 1e6:.0f} MB", fix="check that this is the right file",
                )  # fmt: skip
            with archive.open(name) as file:
                yield file
    except (*_ZIP_DAMAGE, KeyError) as error:
        if isinstance(error, InputError):
            raise
        raise FormatError(
            f"{path}: {name}", expected="a file in a zip archive", got=str(error),
            fix="export it again, without a password",
        ) from None  # fmt: skip


def read_members(path: StrPath, wanted: Mapping[str, str]) -> dict[str, bytes]:
    """Return the content of some files of a zip archive or a folder.

    Parameters
    ----------
    path : path
        The archive or folder.
    wanted : mapping
        Key of each file in the result, by its name in lower case without folders.

    Raises
    ------
    FormatError
        When the archive is damaged, encrypted, or holds more than `MAX_BYTES` unpacked, or
        names that lead out of it.
    """
    place = Path(path)
    if place.is_dir():
        names = [name for name in member_names(place) if name.lower() in wanted]
        return {wanted[name.lower()]: read_bytes(place / name) for name in names}
    try:
        with _zip(place) as archive:
            return _from_zip(archive, wanted, str(path))
    except _ZIP_DAMAGE as error:
        if isinstance(error, InputError):
            raise
        raise FormatError(
            str(path),
            expected="a whole zip archive",
            got=brief(str(error), 60),
            fix="download or export it again",
        ) from None


def _from_zip(archive: zipfile.ZipFile, wanted: Mapping[str, str], what: str) -> dict[str, bytes]:
    infos = archive.infolist()
    if len(infos) > MAX_MEMBERS:
        raise FormatError(what, expected=f"at most {MAX_MEMBERS:,} files", got=f"{len(infos):,}")
    found: dict[str, bytes] = {}
    left = MAX_BYTES
    for info in infos:
        name = PurePosixPath(info.filename.replace("\\", "/"))
        if name.is_absolute() or ".." in name.parts:
            raise FormatError(
                what, expected="names inside the archive", got=brief(info.filename),
                fix="do not trust where it came from",
            )  # fmt: skip
        key = wanted.get(name.name.lower())
        if key is None or key in found or "__MACOSX" in name.parts:
            continue
        with archive.open(info) as file:
            found[key] = file.read(left + 1)  # the stated size may lie
        left -= len(found[key])
        if left < 0:
            raise FormatError(what, expected=f"at most {MAX_BYTES / 1e6:g} MB", got="more unpacked")
    return found
