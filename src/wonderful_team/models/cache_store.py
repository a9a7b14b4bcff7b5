"""The cache's file: one SQLite database that several threads and processes may share.

It holds answers by key, never pictures, words or settings. A file that is not ours, is broken or of another version is
left as it is: the user hears so and decides.
"""

from __future__ import annotations

import contextlib
import json
import os
import sqlite3
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from wonderful_team.core.filesystem import make_private_folder, network_file_system, private
from wonderful_team.core.text import user_path
from wonderful_team.errors import ConfigError
from wonderful_team.redaction import redact_all

APPLICATION_ID = 0x57544331
"""Marks the file as ours in SQLite's header: "WTC1"."""
SCHEMA_VERSION = 1
BUSY_S = 20.0
"""How long one process waits for another that is writing [s]."""
FILE_VARIABLE = "WONDERFUL_TEAM_CACHE"
_TABLE = """CREATE TABLE answers (
    key TEXT PRIMARY KEY, answer TEXT NOT NULL, model TEXT NOT NULL, contract TEXT NOT NULL, made_s INTEGER NOT NULL
) WITHOUT ROWID"""


@dataclass(frozen=True)
class Stored:
    """One answer as it is kept.

    Attributes:
        value: The answer's fields, JSON values.
        cost: What it cost when it was made: the fields of Usage.
    """

    value: Mapping[str, Any]
    raw: str
    model_id: str
    contract: str
    repairs: tuple[str, ...] = ()
    cost: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class CacheSize:
    """How much a cache holds."""

    path: Path
    answers: int
    bytes: int
    by_model: Mapping[str, int]


def default_cache_file() -> Path:
    """$WONDERFUL_TEAM_CACHE, else `answers.sqlite` in the user's cache folder of this system."""
    named = os.environ.get(FILE_VARIABLE)
    if named:
        return user_path(named)
    if sys.platform == "win32":
        root = Path(os.environ.get("LOCALAPPDATA", "~/AppData/Local"))
    elif sys.platform == "darwin":
        root = Path("~/Library/Caches")
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    return user_path(root) / "wonderful-team" / "answers.sqlite"


class CacheStore:
    """A cache's open file.

    Attributes:
        path: The file.
        warnings: What the user should know, in words: a network file system.

    Raises:
        ConfigError: The file cannot be written, or is not a cache of ours and of this version. It is left untouched.
    """

    def __init__(self, path: str | Path | None = None) -> None:
        self.path = user_path(path) if path is not None else default_cache_file()
        self._lock = threading.RLock()
        self._connection: sqlite3.Connection | None = None
        self._process = os.getpid()
        kind = network_file_system(self.path)
        self._journal = "wal" if kind is None else "delete"
        self.warnings: tuple[str, ...] = ()
        if kind is not None:
            self.warnings = (
                f"cache file {str(self.path)!r} lies on a network file system ({kind}), where SQLite's locks are not "
                "safe between machines: keep it on a local disk (--cache-file FILE) when several machines run at once",
            )
        with self._told():
            self._open()

    def get(self, key: str) -> Stored | None:
        """The answer kept under a key, or None.

        Raises:
            ConfigError: The file was broken since it was opened.
        """
        with self._told() as connection:
            row = connection.execute("SELECT answer FROM answers WHERE key = ?", (key,)).fetchone()
        return None if row is None else self._read(key, row[0])

    def put(self, key: str, entry: Stored) -> Stored:
        """Keep an answer, without any key in it; one that stands already stays.

        Returns:
            The answer that stands: another process may have been first.
        """
        kept = {
            "value": dict(entry.value),
            "raw": entry.raw,
            "model_id": entry.model_id,
            "contract": entry.contract,
            "repairs": list(entry.repairs),
            "cost": dict(entry.cost),
        }
        text = json.dumps(redact_all(kept), ensure_ascii=False)
        now_s = int(time.time())
        with self._told() as connection:
            connection.execute(
                "INSERT OR IGNORE INTO answers VALUES (?, ?, ?, ?, ?)",
                (key, text, entry.model_id, entry.contract, now_s),
            )
            row = connection.execute("SELECT answer FROM answers WHERE key = ?", (key,)).fetchone()
        return self._read(key, row[0]) if row is not None else entry

    def forget(self, key: str) -> None:
        """Drop one answer."""
        with self._told() as connection:
            connection.execute("DELETE FROM answers WHERE key = ?", (key,))

    def clear(self) -> int:
        """Drop every answer and give the space back; returns how many there were."""
        with self._told() as connection:
            count = int(connection.execute("DELETE FROM answers").rowcount)
            connection.execute("VACUUM")
            if self._journal == "wal":
                connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        return count

    def size(self) -> CacheSize:
        """How many answers of which model, and the bytes on disk."""
        with self._told() as connection:
            rows = connection.execute("SELECT model, count(*) FROM answers GROUP BY model ORDER BY model").fetchall()
        by_model = {str(model): int(count) for model, count in rows}
        files = (self.path, self.path.with_name(self.path.name + "-wal"))
        return CacheSize(
            self.path, sum(by_model.values()), sum(file.stat().st_size for file in files if file.exists()), by_model
        )

    def close(self) -> None:
        """Close the file; the next use opens it again."""
        with self._lock:
            if self._connection is not None and self._process == os.getpid():
                self._connection.close()
            self._connection = None

    def __del__(self) -> None:
        # An open connection that is merely forgotten would be warned of by Python 3.13.
        with contextlib.suppress(Exception):
            self.close()

    # -- the file ----------------------------------------------------------------------------------------------------

    @contextlib.contextmanager
    def _told(self) -> Iterator[sqlite3.Connection]:
        """The connection, one user at a time; SQLite's errors in words that a user can act on."""
        with self._lock:
            try:
                yield self._open()
            except sqlite3.OperationalError as error:
                if "locked" in str(error):
                    why = f"another process has kept it locked for {BUSY_S:g} s"
                    raise ConfigError(f"cache file {str(self.path)!r}: {why}; try again or use another file") from error
                raise ConfigError(f"cache file {str(self.path)!r} cannot be used: {error}; {_WAYS_OUT}") from error
            except sqlite3.DatabaseError as error:
                raise ConfigError(
                    f"cache file {str(self.path)!r} is broken or no cache: {error}; {_WAYS_OUT}"
                ) from error

    def _open(self) -> sqlite3.Connection:
        if self._connection is not None and self._process == os.getpid():
            return self._connection
        # A connection must not be carried over a fork: the child opens its own.
        make_private_folder(self.path.parent, _WAYS_OUT)
        if self.path.is_dir():
            raise ConfigError(f"cache file {str(self.path)!r} is a folder; give a file (--cache-file FILE)")
        with contextlib.suppress(OSError), open(self.path, "ab", opener=private):
            pass  # SQLite keeps the mode of a file that is there, and gives it to those beside it
        connection = sqlite3.connect(self.path, timeout=BUSY_S, isolation_level=None, check_same_thread=False)
        try:
            if self._is_new(connection):
                self._create(connection)
            # NORMAL loses at most the last answers when the power fails; it never breaks the file.
            connection.execute("PRAGMA synchronous = NORMAL")
        except BaseException:
            connection.close()
            raise
        self._connection, self._process = connection, os.getpid()
        return connection

    def _is_new(self, connection: sqlite3.Connection) -> bool:
        """Whether the file is empty; refuses what is not ours. Only reads."""
        application = connection.execute("PRAGMA application_id").fetchone()[0]
        version = connection.execute("PRAGMA user_version").fetchone()[0]
        tables = [row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        if application == 0 and version == 0 and not tables:
            return True
        if application != APPLICATION_ID:
            raise ConfigError(
                f"cache file {str(self.path)!r} is a database of another program (tables: {', '.join(tables) or 'none'}); "
                f"{_WAYS_OUT}"
            )
        if version != SCHEMA_VERSION or "answers" not in tables:
            raise ConfigError(
                f"cache file {str(self.path)!r} has schema version {version}; this release reads {SCHEMA_VERSION}; "
                f"{_WAYS_OUT}"
            )
        return False

    def _create(self, connection: sqlite3.Connection) -> None:
        connection.execute("BEGIN IMMEDIATE")
        # Another process may have been first while this one waited.
        if self._is_new(connection):
            connection.execute(_TABLE)
            connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
            connection.execute(f"PRAGMA user_version = {SCHEMA_VERSION}")
        connection.execute("COMMIT")
        until = time.monotonic() + BUSY_S
        while True:
            try:
                connection.execute(f"PRAGMA journal_mode = {self._journal}")
            except sqlite3.OperationalError:
                # Changing the mode needs the file for itself and does not wait by itself.
                if time.monotonic() > until:
                    raise
                time.sleep(0.01)
            else:
                return

    def _read(self, key: str, text: str) -> Stored:
        try:
            kept = json.loads(text)
            return Stored(
                kept["value"],
                kept["raw"],
                kept["model_id"],
                kept["contract"],
                tuple(kept["repairs"]),
                kept["cost"],
            )
        except (ValueError, KeyError, TypeError) as error:
            raise ConfigError(
                f"cache file {str(self.path)!r}: the answer under {key[:12]} is broken ({error}); {_WAYS_OUT}"
            ) from error


_WAYS_OUT = "it was left as it is: move it away, or use another (--cache-file FILE), or --cache off"
