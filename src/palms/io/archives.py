"""Archives and folders of small files, read in memory: nothing is unpacked onto a disk."""

from __future__ import annotations

import os
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from palms.errors import FormatError, InputError
from palms.io.files import MAX_BYTES, read_bytes
from palms.io.values import StrPath, brief

__all__ = ["member_names", "read_members"]

MAX_MEMBERS = 10_000  # ours: a venue in IMDF has about 20


def member_names(path: Path) -> tuple[str, ...]:
    """Names of the files in a zip archive or a folder; none when it is neither.

    Examples
    --------
    >>> member_names(Path("no such folder"))
    ()
    """
    try:
        if path.is_dir():
            return tuple(sorted(entry.name for entry in os.scandir(path) if entry.is_file()))
        with zipfile.ZipFile(path) as archive:
            return tuple(archive.namelist()[:MAX_MEMBERS])
    except (OSError, zipfile.BadZipFile, ValueError, NotImplementedError):
        return ()


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
        with zipfile.ZipFile(place) as archive:
            return _from_zip(archive, wanted, str(path))
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError,
            OSError, ValueError) as error:  # fmt: skip
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
