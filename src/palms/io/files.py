"""Files as such: read with guards, written whole or not at all.

Every reader of `palms.io` goes through `read_text` or `read_json`, every writer through
`write_text` or `write_json`, so that what can go wrong with any file is said once, here.
"""

from __future__ import annotations

import contextlib
import json
import os
import secrets
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

from palms.errors import FormatError, InputError, OutputError
from palms.io.values import StrPath, brief

__all__ = [
    "MAX_BYTES",
    "StrPath",
    "head",
    "make_folder",
    "opened",
    "read_bytes",
    "read_json",
    "read_text",
    "remove_stale",
    "sniff",
    "write_bytes",
    "write_json",
    "write_text",
]

MAX_BYTES = 200_000_000  # ours: a hundred times the largest plan or walk we know
_HEAD_BYTES = 65_536
_MAGIC = (
    (b"\x89PNG", "a PNG image"),
    (b"\xff\xd8\xff", "a JPEG image"),
    (b"%PDF", "a PDF document"),
    (b"PK\x03\x04", "a zip archive"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\xff\xfe", "text in UTF-16"),
    (b"\xfe\xff", "text in UTF-16"),
)


def head(path: StrPath, size: int = _HEAD_BYTES) -> bytes:
    """Return the first bytes of a file; none when it cannot be read.

    Examples
    --------
    >>> head("no such file")
    b''
    """
    try:
        with open(path, "rb") as file:
            return file.read(size)
    except (OSError, ValueError):
        return b""


def sniff(start: bytes) -> str:
    """Say what a file looks like, by its first bytes.

    Examples
    --------
    >>> sniff(b"%PDF-1.7"), sniff(b' {"a": 1}'), sniff(b"1,2,3,4")
    ('a PDF document', 'JSON', 'text')
    """
    for magic, name in _MAGIC:
        if start.startswith(magic):
            return name
    if b"\x00" in start:
        return "binary data"
    text = start.removeprefix(b"\xef\xbb\xbf").lstrip()
    if text[:1] in (b"{", b"["):
        return "JSON"
    if text[:1] == b"<":
        return "XML or HTML"
    return "text"


@contextlib.contextmanager
def opened(path: StrPath) -> Iterator[IO[bytes]]:
    """Open a file for reading, or say why that cannot be.

    Raises
    ------
    InputError
        When it is missing, a folder, or not readable.

    Examples
    --------
    >>> with opened("no/such/file.png") as file:
    ...     pass
    Traceback (most recent call last):
    palms.errors.InputError: no/such/file.png: expected a file, got nothing there; check the ...
    """
    if os.path.isdir(path):
        raise InputError(
            str(path), expected="a file", got="a folder", fix="name the file inside it"
        )
    try:
        file = open(path, "rb")  # noqa: SIM115 (closed below; only opening is guarded)
    except FileNotFoundError:
        raise InputError(
            str(path), expected="a file", got="nothing there", fix="check the name and the folder"
        ) from None
    except (OSError, ValueError) as error:
        raise _unreadable(path, error) from None
    with file:
        yield file


def _unreadable(path: StrPath, error: Exception) -> InputError:
    return InputError(
        str(path).replace("\x00", "?"), expected="a file that can be read",
        got=getattr(error, "strerror", None) or str(error), fix="check name and rights",
    )  # fmt: skip


def read_bytes(path: StrPath) -> bytes:
    """Return the content of a file, at most `MAX_BYTES` of it.

    Raises
    ------
    InputError
        When it is missing, a folder, not readable or larger.

    Examples
    --------
    >>> read_bytes("no/such/file.png")
    Traceback (most recent call last):
    palms.errors.InputError: no/such/file.png: expected a file, got nothing there; check the ...
    """
    with opened(path) as file:
        try:
            content = file.read(MAX_BYTES + 1)
        except OSError as error:
            raise _unreadable(path, error) from None
    if len(content) > MAX_BYTES:
        raise InputError(
            str(path),
            expected=f"at most {MAX_BYTES / 1e6:g} MB",
            got="more",
            fix="check that this is the right file",
        )
    return content


def read_text(path: StrPath, expected: str = "text") -> str:
    """Return the text of a file, without a byte order mark.

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
        When it is empty, or not text in UTF-8.

    Examples
    --------
    >>> read_text("no/such/file.csv")
    Traceback (most recent call last):
    palms.errors.InputError: no/such/file.csv: expected a file, got nothing there; check the ...
    """
    content = read_bytes(path)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        kind = sniff(content)
        got = kind if kind != "text" else f"a byte that is not UTF-8 at {error.start}"
        raise FormatError(
            str(path), expected=expected, got=got, fix="save it as text in UTF-8"
        ) from None
    if not text.strip():
        raise FormatError(
            str(path), expected=expected, got="an empty file", fix="export or record it again"
        )
    if "\x00" in text:
        raise FormatError(
            str(path), expected=expected, got=sniff(content), fix="check that it is the right file"
        )
    return text


def _parse_int(digits: str) -> int | float:
    return int(digits) if len(digits) < 19 else float(digits)


def read_json(path: StrPath, expected: str = "JSON") -> Any:  # noqa: ANN401
    """Return what a JSON file holds.

    Parameters
    ----------
    path : path
        The file.
    expected : str
        What it should hold, for the message.

    Raises
    ------
    InputError, FormatError
        As `read_text`; also when it is not JSON, or cut off.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/a.json", [1, 2])
    ...     read_json(f"{folder}/a.json")
    [1, 2]
    """
    text = read_text(path, expected)
    try:
        return json.loads(text, parse_int=_parse_int)
    except json.JSONDecodeError as error:
        got = f"{error.msg} (column {error.colno})"
        kind = sniff(text[:_HEAD_BYTES].encode("utf-8", "replace"))
        raise FormatError(
            f"{path} line {error.lineno}",
            expected=expected,
            got=got if kind == "JSON" else f"{kind}: {got}",
            fix="the file may be cut off or be of another format",
        ) from None
    except (RecursionError, ValueError) as error:
        raise FormatError(
            str(path), expected=expected, got=f"JSON that cannot be read ({brief(str(error), 60)})"
        ) from None


def _output_error(path: StrPath, error: Exception) -> OutputError:
    parent = Path(path).parent
    if parent.exists() and not parent.is_dir():
        got, fix = f"{parent}, which is no folder", "choose another place"
    elif not parent.exists():
        got, fix = f"no folder {parent}", "create it first"
    else:
        got = getattr(error, "strerror", None) or str(error)
        fix = "check the name, the rights and the free space"
    return OutputError(str(path), expected="a place that can be written", got=got, fix=fix)


def write_bytes(path: StrPath, content: bytes) -> None:
    """Write a file, whole or not at all.

    Raises
    ------
    OutputError
        When it cannot be written; what was there before is still there.

    Examples
    --------
    >>> write_bytes("no/such/folder/a.pgm", b"")
    Traceback (most recent call last):
    palms.errors.OutputError: no/such/folder/a.pgm: expected a place that can be written, got ...
    """
    target = Path(path)
    part = target.with_name(f".{secrets.token_hex(6)}.part")
    try:
        with open(part, "xb") as file:
            file.write(content)
        os.replace(part, target)
    except (OSError, ValueError) as error:
        raise _output_error(path, error) from None
    finally:
        with contextlib.suppress(OSError, ValueError):
            part.unlink()


def write_text(path: StrPath, text: str) -> None:
    r"""Write a text file in UTF-8, whole or not at all.

    Parameters
    ----------
    path : path
        The file; replaced when it exists. Its folder must exist.
    text : str
        What it shall hold.

    Raises
    ------
    OutputError
        When it cannot be written; what was there before is still there.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_text(f"{folder}/a.txt", "0.5, 1.5, 0\n")
    ...     read_text(f"{folder}/a.txt")
    '0.5, 1.5, 0\n'
    """
    try:
        content = text.encode("utf-8")
    except ValueError as error:
        raise _output_error(path, error) from None
    write_bytes(path, content)


def write_json(path: StrPath, value: object) -> None:
    """Write a JSON file, whole or not at all; NaN and infinity are refused.

    Parameters
    ----------
    path : path
        The file; replaced when it exists. Its folder must exist.
    value : object
        Dictionaries, lists, text, numbers, booleans and None.

    Raises
    ------
    OutputError
        When it cannot be written, or the value holds NaN, infinity or an object.

    Examples
    --------
    >>> write_json("track.json", {"x_m": float("nan")})
    Traceback (most recent call last):
    palms.errors.OutputError: track.json: expected finite numbers, text, lists, got ...
    """
    try:
        text = json.dumps(value, allow_nan=False, ensure_ascii=False)
    except (TypeError, ValueError) as error:
        raise OutputError(
            str(path), expected="finite numbers, text, lists", got=brief(str(error), 80)
        ) from None
    write_text(path, text + "\n")


def make_folder(path: StrPath) -> Path:
    """Create a folder and those above it; return it.

    Raises
    ------
    OutputError
        When something else has that name, or the rights are missing.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     make_folder(f"{folder}/maps").name
    'maps'
    """
    try:
        os.makedirs(path, exist_ok=True)
    except (OSError, ValueError) as error:
        raise OutputError(
            str(path),
            expected="a folder that can be created",
            got=getattr(error, "strerror", None) or str(error),
            fix="choose another place",
        ) from None
    return Path(path)


def remove_stale(path: StrPath) -> None:
    """Remove a file that belonged to what was just replaced, if it is there.

    Raises
    ------
    OutputError
        When it is there and stays.

    Examples
    --------
    >>> remove_stale("no such file")
    """
    try:
        Path(path).unlink(missing_ok=True)
    except (OSError, ValueError) as error:
        raise _output_error(path, error) from None
