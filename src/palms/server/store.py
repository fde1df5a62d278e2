"""Store: buildings, sessions and their journals, in one SQLite file in one folder.

Everything here runs in one thread (see `palms.server.journal`); nothing of it is kept in
memory. What is deleted is overwritten.
"""

from __future__ import annotations

import contextlib
import json
import os
import sqlite3
import zlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palms.errors import InputError, OutputError
from palms.io.files import make_folder
from palms.server.follower import Terms

__all__ = ["FILE", "MIGRATIONS", "BuildingRow", "Levels", "SessionRow", "Store"]

FILE = "palms.sqlite3"
_APPLICATION = 0x50414C4D  # "PALM", so that a file of another program is refused
_LARGE = 1000  # bytes; larger inputs are compressed

MIGRATIONS: tuple[str, ...] = (
    """
    CREATE TABLE buildings (
        id TEXT PRIMARY KEY, name TEXT NOT NULL, is_sample INTEGER NOT NULL, created_s REAL NOT NULL
    ) STRICT;
    CREATE TABLE levels (
        building TEXT NOT NULL REFERENCES buildings ON DELETE CASCADE, place INTEGER NOT NULL,
        name TEXT NOT NULL, plan TEXT NOT NULL, PRIMARY KEY (building, place)
    ) STRICT, WITHOUT ROWID;
    CREATE TABLE sessions (
        id TEXT PRIMARY KEY, key_hash BLOB NOT NULL,
        building TEXT NOT NULL REFERENCES buildings, level TEXT NOT NULL, terms TEXT NOT NULL,
        is_recording INTEGER NOT NULL, created_s REAL NOT NULL, seen_s REAL NOT NULL,
        ended_s REAL
    ) STRICT;
    CREATE TABLE inputs (
        session TEXT NOT NULL REFERENCES sessions ON DELETE CASCADE, seq INTEGER NOT NULL,
        received_s REAL NOT NULL, body BLOB NOT NULL, PRIMARY KEY (session, seq)
    ) STRICT, WITHOUT ROWID;
    """,
    # sessions on all levels of a building, whose level is ''; older versions know none
    "UPDATE sessions SET terms = json_set(terms, '$.start_level', NULL);",
)
Levels = tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class BuildingRow:
    """A building as it is stored: its levels' plans as ``palms-plan/1`` texts, by name.

    From the lowest up.
    """

    id: str
    name: str
    levels: Levels
    is_sample: bool = False


@dataclass(frozen=True, slots=True)
class SessionRow:
    """A session as it is stored, without its inputs.

    Parameters
    ----------
    id : str
    key_hash : bytes
        SHA-256 of the key that its client goes on with.
    building : str
    level : str
        Empty for all levels.
    terms : Terms
    is_recording : bool
    created_s, seen_s : float
        Seconds since 1970; seen: when its client was there last.
    ended_s : float or None
        Set for recordings only.
    """

    id: str
    key_hash: bytes
    building: str
    level: str
    terms: Terms
    is_recording: bool
    created_s: float
    seen_s: float
    ended_s: float | None = None


class Store:
    """The embedded database of a server.

    Parameters
    ----------
    folder : path
        Made when it is not there; only its owner may look into it.
    migrations : sequence of str
        Scripts, one for each version of the schema.

    Raises
    ------
    InputError
        When the file is of another program, of a newer version, damaged, or in use by another
        server.
    OutputError
        When the folder cannot be made or written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     store = Store(folder)
    ...     store.add_building(BuildingRow("hall", "Hall", (("1", "{}"),)), 0.0)
    ...     names = [building.name for building in store.buildings()]
    ...     store.close()
    >>> names
    ['Hall']
    """

    def __init__(
        self, folder: str | os.PathLike[str], migrations: Sequence[str] = MIGRATIONS
    ) -> None:
        self.folder = make_folder(folder)
        self.path = self.folder / FILE
        self.is_new = not self.path.exists()
        with contextlib.ExitStack() as opened:
            self._open(opened, migrations)
            opened.pop_all()  # open until close()

    def _open(self, opened: contextlib.ExitStack, migrations: Sequence[str]) -> None:
        try:
            self.folder.chmod(0o700)
            self._lock = opened.enter_context(contextlib.closing(_locked(self.folder / "lock")))
            self._connection = opened.enter_context(contextlib.closing(_connected(self.path)))
            for pragma in (
                "journal_mode = WAL", "synchronous = FULL", "foreign_keys = ON",
                "secure_delete = ON", "temp_store = MEMORY",
            ):  # fmt: skip
                self._connection.execute(f"PRAGMA {pragma}")
            self._migrate(migrations)
        except sqlite3.DatabaseError as error:
            raise InputError(
                str(self.path), expected="a store of palms", got=str(error),
                fix="choose another --data folder, or restore a copy",
            ) from None  # fmt: skip
        except OSError as error:
            raise OutputError(
                str(self.folder), expected="a folder that can be written",
                got=error.strerror or str(error), fix="choose another --data folder",
            ) from None  # fmt: skip

    @property
    def version(self) -> int:
        """Version of the schema."""
        return int(self._connection.execute("PRAGMA user_version").fetchone()[0])

    def _migrate(self, migrations: Sequence[str]) -> None:
        """Bring the schema up to date, a version at a time, each whole or not at all."""
        (owner,) = self._connection.execute("PRAGMA application_id").fetchone()
        tables = self._connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
        if owner != _APPLICATION and tables:
            raise sqlite3.DatabaseError("a database of another program")
        if self.version > len(migrations):
            raise InputError(
                str(self.path), expected=f"a store of version {len(migrations)} or older",
                got=f"version {self.version}", fix="install the newer palms that wrote it",
            )  # fmt: skip
        for version, script in enumerate(migrations[self.version :], self.version + 1):
            self._connection.executescript(
                f"BEGIN; {script}; PRAGMA application_id = {_APPLICATION}; "
                f"PRAGMA user_version = {version}; COMMIT;"
            )

    @contextlib.contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        self._connection.execute("BEGIN IMMEDIATE")
        try:
            yield self._connection
        except BaseException:
            self._connection.execute("ROLLBACK")
            raise
        self._connection.execute("COMMIT")

    def close(self) -> None:
        """Write everything into the one file and let go of it."""
        self.forget()
        self._connection.close()
        self._lock.close()

    def forget(self) -> None:
        """Empty the write-ahead log, so that what was deleted is on disk no more."""
        self._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")

    def backup(self, path: Path) -> None:
        """Write a copy of the store as it is now, while it is in use.

        Parameters
        ----------
        path : Path
            A file that is not there yet.
        """
        copy = sqlite3.connect(path)
        try:
            self._connection.backup(copy)
        finally:
            copy.close()

    # Buildings

    def add_building(self, building: BuildingRow, now_s: float) -> None:
        """Add a building with its levels."""
        with self._transaction() as write:
            write.execute(
                "INSERT INTO buildings VALUES (?, ?, ?, ?)",
                (building.id, building.name, int(building.is_sample), now_s),
            )
            _add_levels(write, building.id, building.levels)

    def set_levels(self, building: str, levels: Levels) -> bool:
        """Replace the levels of a building; False while sessions or recordings are on all."""
        with self._transaction() as write:
            on_all = "SELECT count(*) FROM sessions WHERE building = ? AND level = ''"
            if write.execute(on_all, (building,)).fetchone()[0]:
                return False
            write.execute("DELETE FROM levels WHERE building = ?", (building,))
            _add_levels(write, building, levels)
        return True

    def buildings(self) -> list[BuildingRow]:
        """All buildings, oldest first."""
        rows = self._connection.execute(
            "SELECT id, name, is_sample FROM buildings ORDER BY created_s, id"
        ).fetchall()
        return [BuildingRow(i, name, self._levels(i), bool(sample)) for i, name, sample in rows]

    def _levels(self, building: str) -> Levels:
        rows = self._connection.execute(
            "SELECT name, plan FROM levels WHERE building = ? ORDER BY place", (building,)
        )
        return tuple(rows.fetchall())

    def delete_building(self, building: str) -> bool:
        """Delete a building; False when sessions or recordings still need it."""
        try:
            with self._transaction() as write:
                write.execute("DELETE FROM buildings WHERE id = ?", (building,))
        except sqlite3.IntegrityError:
            return False
        self.forget()
        return True

    # Sessions

    def add_session(self, row: SessionRow) -> None:
        """Add a session."""
        terms = json.dumps({name: getattr(row.terms, name) for name in Terms.__slots__})
        with self._transaction() as write:
            write.execute(
                "INSERT INTO sessions VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                (row.id, row.key_hash, row.building, row.level, terms, int(row.is_recording),
                 row.created_s, row.seen_s, row.ended_s),
            )  # fmt: skip

    def sessions(self, ended: bool = False) -> list[SessionRow]:
        """Sessions that are going on, or recordings; oldest first."""
        rows = self._connection.execute(
            f"SELECT * FROM sessions WHERE ended_s IS {'NOT' if ended else ''} NULL "
            "ORDER BY created_s, id"
        )
        return [_session(row) for row in rows.fetchall()]

    def session(self, session: str) -> SessionRow | None:
        """One session or recording; None when there is none."""
        found = self._connection.execute("SELECT * FROM sessions WHERE id = ?", (session,))
        row = found.fetchone()
        return None if row is None else _session(row)

    def append(self, entries: Iterable[tuple[str, int, float, str]]) -> None:
        """Add inputs (session, seq, received_s, text); on disk when this returns."""
        rows = [
            (session, seq, received_s, _packed(text)) for session, seq, received_s, text in entries
        ]
        with self._transaction() as write:
            write.executemany("INSERT INTO inputs VALUES (?, ?, ?, ?)", rows)

    def inputs(self, session: str) -> list[tuple[int, float, str]]:
        """Return the inputs (seq, received_s, text) of a session, in order."""
        rows = self._connection.execute(
            "SELECT seq, received_s, body FROM inputs WHERE session = ? ORDER BY seq", (session,)
        )
        return [(seq, received_s, _unpacked(body)) for seq, received_s, body in rows.fetchall()]

    def n_inputs(self, session: str) -> int:
        """How many inputs a session has."""
        found = self._connection.execute(
            "SELECT count(*) FROM inputs WHERE session = ?", (session,)
        )
        return int(found.fetchone()[0])

    def mark_seen(self, sessions: Iterable[str], now_s: float) -> None:
        """Note that the clients of sessions are there."""
        with self._transaction() as write:
            write.executemany(
                "UPDATE sessions SET seen_s = ? WHERE id = ?", [(now_s, each) for each in sessions]
            )

    def end_session(self, session: str, now_s: float) -> None:
        """End a session whose recording is kept."""
        with self._transaction() as write:
            write.execute("UPDATE sessions SET ended_s = ? WHERE id = ?", (now_s, session))

    def delete_sessions(self, sessions: Sequence[str]) -> None:
        """Delete sessions or recordings with all their inputs, for good."""
        if not sessions:
            return
        with self._transaction() as write:
            write.executemany("DELETE FROM sessions WHERE id = ?", [(each,) for each in sessions])
        self.forget()


def _add_levels(write: sqlite3.Connection, building: str, levels: Levels) -> None:
    write.executemany(
        "INSERT INTO levels VALUES (?, ?, ?, ?)",
        [(building, place, *level) for place, level in enumerate(levels)],
    )


def _connected(path: Path) -> sqlite3.Connection:
    return sqlite3.connect(path, timeout=0, isolation_level=None, check_same_thread=False)


def _locked(path: Path) -> sqlite3.Connection:
    """Keep a second server out, as long as this process lives."""
    lock = _connected(path)
    try:
        lock.execute("BEGIN EXCLUSIVE")
    except sqlite3.OperationalError:
        lock.close()
        raise InputError(
            str(path.parent), expected="a folder of its own", got="one that another server uses",
            fix="stop the other server, or choose another --data folder",
        ) from None  # fmt: skip
    return lock


def _packed(text: str) -> bytes:
    content = text.encode()
    return b"z" + zlib.compress(content, 1) if len(content) > _LARGE else b"t" + content


def _unpacked(body: bytes) -> str:
    return (zlib.decompress(body[1:]) if body[:1] == b"z" else body[1:]).decode()


def _session(row: tuple[Any, ...]) -> SessionRow:
    session, key_hash, building, level, terms, recording, created_s, seen_s, ended_s = row
    return SessionRow(
        session, bytes(key_hash), building, level, Terms(**json.loads(terms)), bool(recording),
        created_s, seen_s, ended_s,
    )  # fmt: skip
