"""Workshop: files of others are read in a process of its own, with limits on time and memory.

A reader that hangs, eats memory or crashes takes nothing with it but that process.
"""

from __future__ import annotations

import asyncio
import contextlib
import multiprocessing
import os
import signal
import sys
import tempfile
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

from palms.errors import InputError, PalmsError
from palms.server import messages
from palms.server.limits import Limits

__all__ = ["Upload", "Workshop", "read_level_texts", "read_scan_message", "run_track"]

LONGEST_NAME = 100
_FILE_BYTES = 200_000_000  # what a reader may write


class Upload(NamedTuple):
    """A file of somebody's: its name serves for messages and its ending alone.

    Attributes
    ----------
    name : str
    content : bytes
    format : str or None
    options : tuple of str
        As ``name=value``.
    """

    name: str
    content: bytes
    format: str | None = None
    options: tuple[str, ...] = ()


@dataclass(frozen=True)
class Workshop:
    """Where files are read.

    Parameters
    ----------
    limits : Limits
    inline : bool
        Read in this process instead, without limits: for tests of everything else.
    """

    limits: Limits
    inline: bool = False

    async def do(self, work: Callable[..., Any], *arguments: object) -> Any:  # noqa: ANN401
        """Run a function, importable by name, in a process of its own.

        Raises
        ------
        InputError
            What it raised; or when it took too long, too much memory, or crashed.
        """
        if self.inline:
            return await asyncio.to_thread(work, *arguments)
        async with _turn(self.limits.uploads):
            return await asyncio.to_thread(self._in_process, work, arguments)

    def _in_process(self, work: Callable[..., Any], arguments: Sequence[object]) -> Any:  # noqa: ANN401
        """Do the work elsewhere; whatever becomes of it, no file of it stays."""
        with tempfile.TemporaryDirectory(prefix="palms-") as folder:
            return self._in_folder(folder, work, arguments)

    def _in_folder(self, folder: str, work: Callable[..., Any], arguments: Sequence[object]) -> Any:  # noqa: ANN401
        context = multiprocessing.get_context("spawn")
        here, there = context.Pipe(duplex=False)
        process = context.Process(
            target=_work, args=(there, folder, self.limits, work, tuple(arguments)), daemon=True
        )
        process.start()
        there.close()
        try:
            if not here.poll(self.limits.upload_s):
                raise InputError(
                    "file", expected=f"one that is read within {self.limits.upload_s:g} s",
                    got="one that takes longer", fix="make it smaller",
                )  # fmt: skip
            found, error = here.recv()
        except (EOFError, OSError):
            raise InputError(
                "file", expected=f"one that needs at most {self.limits.upload_memory_bytes:.2g} "
                "bytes of memory", got="one that ended its reader", fix="make it smaller",
            ) from None  # fmt: skip
        finally:
            process.kill()
            process.join()
            here.close()
        if error is not None:
            raise InputError(error)
        return found


_turns: dict[asyncio.AbstractEventLoop, asyncio.Semaphore] = {}


def _turn(most: int) -> asyncio.Semaphore:
    loop = asyncio.get_running_loop()
    for other in [other for other in _turns if other.is_closed()]:
        del _turns[other]
    return _turns.setdefault(loop, asyncio.Semaphore(most))


def _work(
    there: Connection,
    folder: str,
    limits: Limits,
    work: Callable[..., Any],
    arguments: tuple[Any, ...],
) -> None:
    """Do the work in a process of its own; errors go back as one line."""
    with contextlib.suppress(ValueError, OSError):
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    tempfile.tempdir = folder
    _restrict(limits)
    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(nowhere):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                there.send((work(*arguments), None))
        except PalmsError as error:
            there.send((None, str(error)))
        except MemoryError:
            there.send((None, "file: it takes more memory than this server gives"))
        except Exception as error:
            there.send((None, f"file: it cannot be read ({type(error).__name__})"))


def _restrict(limits: Limits) -> None:
    if sys.platform == "win32":  # there the time limit alone holds
        return
    import resource

    seconds = int(limits.upload_s) + 1
    for kind, most in (
        (resource.RLIMIT_AS, limits.upload_memory_bytes),
        (resource.RLIMIT_CPU, 2 * seconds),
        (resource.RLIMIT_FSIZE, _FILE_BYTES),
        (resource.RLIMIT_CORE, 0),
    ):
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(kind, (most, most))


def _put(upload: Upload, folder: str, stem: str) -> Path:
    """Write a file under a name of our own; only its ending is kept, and that only if plain."""
    given = upload.name.replace("\\", "/").rsplit("/", 1)[-1]
    endings = [part for part in given.split(".")[1:] if part.isascii() and part.isalnum()]
    ending = "".join(f".{part[:12].lower()}" for part in endings[-2:])
    path = Path(folder) / f"{stem}{ending}"
    path.write_bytes(upload.content)
    return path


def read_level_texts(upload: Upload, name: str, level: str) -> tuple[tuple[str, str], ...]:
    r"""Return the levels of a file: name and plan as ``palms-plan/1``, from the lowest up.

    Parameters
    ----------
    upload : Upload
    name : str
        What to call the building.
    level : str
        The one that is wanted of several, or what to call the only one; all when empty.

    Raises
    ------
    InputError
        When it cannot be read, or has no such level.

    Examples
    --------
    >>> file = Upload("../hall.csv", b"0,0,8,0\n8,0,8,5\n")
    >>> ((level, text),) = read_level_texts(file, "Hall", "")
    >>> level, text[:38]
    ('', '{"schema":"palms-plan/1","name":"Hall"')
    """
    from dataclasses import replace

    from palms.server.plans import plan_text

    with tempfile.TemporaryDirectory(prefix="palms-") as folder:
        found = _read_levels(upload, folder)
    names = [each.name for each in found]
    if len(found) > 1 and level:
        if level not in names:
            raise InputError("level", expected=f"one of {', '.join(names[:20])}", got=repr(level))
        found = found[names.index(level) : names.index(level) + 1]
    elif len(set(names)) < len(names):
        raise InputError(
            "levels", expected="names of their own", got=", ".join(names[:20]),
            fix="choose a building with the option building=NAME, or one level",
        )  # fmt: skip
    called = level if len(found) == 1 and level else None
    return tuple(
        (called or each.name, plan_text(replace(each.plan, name=name), each.stairs))
        for each in found
    )


def _read_levels(upload: Upload, folder: str) -> Sequence[Any]:
    """Read all levels of a file that may have several, unless an option says which; else one."""
    from palms.io import FLOORPLANS, choose_format, read_any
    from palms.io.levels import LevelPlan
    from palms.io.options import parse_options
    from palms.io.reading import read_levels

    def read(path: Path) -> Sequence[Any]:
        reader = choose_format(FLOORPLANS, path, upload.format)
        read_all = getattr(reader, "read_levels", None)
        if read_all is None or any(each.startswith("level=") for each in upload.options):
            plan = read_any(FLOORPLANS, path, upload.format, upload.options)
            return [LevelPlan(plan.level or "", 0.0, plan)]
        options = parse_options(read_all, upload.options, f"option of format {reader.name}")
        return read_levels(path, format=reader.name, **options)

    found: Sequence[Any] = _at(_put(upload, folder, "plan"), folder, read)
    return found


def read_scan_message(upload: Upload) -> messages.Scan:
    """Return the scan of a file as a phone would send it.

    Examples
    --------
    >>> read_scan_message(Upload("scan.json", b"[[[2, -2.5], [2, 0.5]]]")).planes
    ([[2.0, -2.5], [2.0, 0.5]],)
    """
    from palms.io import SCANS
    from palms.server.scans import scan_message

    with tempfile.TemporaryDirectory(prefix="palms-") as folder:
        scan = _read(SCANS, upload, folder, "scan")
    return scan_message(scan)


def _read(group: str, upload: Upload, folder: str, stem: str) -> Any:  # noqa: ANN401
    from palms.io import read_any

    return _at(
        _put(upload, folder, stem), folder,
        lambda path: read_any(group, path, upload.format, upload.options),
    )  # fmt: skip


def _at(path: Path, folder: str, read: Callable[[Path], Any]) -> Any:  # noqa: ANN401
    """Read a file; no message tells where it lay."""
    try:
        return read(path)
    except PalmsError as error:
        raise InputError(str(error).replace(f"{folder}{os.sep}", "")) from None


def run_track(
    levels: tuple[tuple[str, str], ...],
    scan: Upload,
    walk: Upload,
    method: str,
    source: str,
    seed: int,
) -> dict[str, Any]:
    """Return the track of a recorded walk as ``palms-track/1``.

    Parameters
    ----------
    levels : tuple of (str, str)
        Name and plan, as ``palms-plan/1``, of the levels that may be walked on.
    scan, walk : Upload
    method, source : str
    seed : int

    Raises
    ------
    InputError
        When one of them is at fault.
    """
    from palms.io import ODOMETRY, SCANS
    from palms.io.track_json import track_document
    from palms.localizer import track
    from palms.server.plans import building_of
    from palms.settings import Settings

    with tempfile.TemporaryDirectory(prefix="palms-") as folder:
        seen = _read(SCANS, scan, folder, "scan")
        recorded = _read(ODOMETRY, walk, folder, "walk")
    kind: Any = source
    odometry = recorded.odometry(kind)
    settings, building = Settings.for_method(method), building_of(levels)
    lowest = building.levels[0]
    found = track(building if settings.is_ours else lowest, seen, odometry, settings, seed)
    return track_document([found], lowest, settings, scan="scan", walk="walk", walk_source=source)
