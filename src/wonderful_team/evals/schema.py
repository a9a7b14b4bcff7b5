"""The tables of a store, and how a store of an earlier release becomes one of this release."""

from __future__ import annotations

import sqlite3

from wonderful_team.errors import ConfigError
from wonderful_team.evals import totals

SCHEMA_VERSION = 4
"""1: first release. 2: `how` and `reobserve` of a condition, and what a trial in flight holds of the study's caps. 3: leases by a clock that
does not jump; whose a discarded attempt was, and what it was allowed. 4: totals of studies, kept as trials end."""
SPEC = ("task", "seed", "repeat", "method", "model", "isolate", "perturb", "replans", "how", "looks")
CONDITION = SPEC[3:]
"""Columns of a condition, in the order of its fields; `looks` holds its `reobserve`."""
RESULT = (
    *("outcome", "stage", "reason", "calls", "tokens", "pictures", "usd", "seconds", "rounds"),
    *("provenance", "by_role", "page", "instruction", "versions", "facts"),
)
JSON = ("provenance", "by_role", "versions", "facts")
_COUNTS = ("seed", "repeat", "replans", "looks")
_NUMBER = ("integer", "real")
_NUMBERS = ("calls", "tokens", "pictures", "usd", "seconds", "rounds")
_HELD = ("held_calls", "held_tokens", "held_usd")
_ALLOWED = ("allowed_calls", "allowed_tokens", "allowed_usd")
_TABLES = f"""
CREATE TABLE IF NOT EXISTS meta(name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS trials(
    id INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE,
    task TEXT NOT NULL, seed INTEGER NOT NULL, repeat INTEGER NOT NULL, method TEXT NOT NULL, model TEXT NOT NULL,
    isolate TEXT NOT NULL, perturb TEXT NOT NULL, replans INTEGER NOT NULL,
    state TEXT NOT NULL DEFAULT 'pending' CHECK(state IN ('pending', 'claimed', 'done')),
    owner TEXT NOT NULL DEFAULT '', lease_until_s REAL NOT NULL DEFAULT 0, crashes INTEGER NOT NULL DEFAULT 0,
    ended TEXT, {", ".join(RESULT)},
    how TEXT NOT NULL DEFAULT '', looks INTEGER NOT NULL DEFAULT 0, {", ".join(f"{name} REAL NOT NULL DEFAULT 0" for name in _HELD)},
    lease_steady_s REAL NOT NULL DEFAULT 0);
CREATE INDEX IF NOT EXISTS trials_by_state ON trials(state, id);
CREATE TABLE IF NOT EXISTS studies(name TEXT PRIMARY KEY, request TEXT NOT NULL, started TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS wanted(study TEXT NOT NULL, trial INTEGER NOT NULL, PRIMARY KEY(study, trial)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS discarded(
    trial INTEGER NOT NULL, why TEXT NOT NULL, calls INTEGER, tokens INTEGER, usd REAL, reason TEXT, at TEXT NOT NULL,
    owner TEXT NOT NULL DEFAULT '', {", ".join(f"{name} REAL NOT NULL DEFAULT 0" for name in _ALLOWED)});
"""


def make_tables(base: sqlite3.Connection) -> str:
    """Make what is missing, within the caller's transaction; returns the schema version that the store then has."""
    for statement in _TABLES.split(";"):
        if statement.strip():
            base.execute(statement)
    base.execute("INSERT OR IGNORE INTO meta VALUES('schema_version', ?)", (str(SCHEMA_VERSION),))
    version = str(base.execute("SELECT value FROM meta WHERE name='schema_version'").fetchone()[0])
    if version == "1":
        base.execute("ALTER TABLE trials ADD COLUMN how TEXT NOT NULL DEFAULT ''")
        base.execute("ALTER TABLE trials ADD COLUMN looks INTEGER NOT NULL DEFAULT 0")
        for name in _HELD:
            base.execute(f"ALTER TABLE trials ADD COLUMN {name} REAL NOT NULL DEFAULT 0")
    before_totals = version in ("1", "2", "3")
    if version in ("1", "2"):
        base.execute("ALTER TABLE trials ADD COLUMN lease_steady_s REAL NOT NULL DEFAULT 0")
        base.execute("ALTER TABLE discarded ADD COLUMN owner TEXT NOT NULL DEFAULT ''")
        for name in _ALLOWED:
            base.execute(f"ALTER TABLE discarded ADD COLUMN {name} REAL NOT NULL DEFAULT 0")
    for statement in totals.TABLES:
        base.execute(statement)
    if before_totals:
        totals.fill(base)
        version = str(SCHEMA_VERSION)
        base.execute("UPDATE meta SET value=? WHERE name='schema_version'", (version,))
    if version == str(SCHEMA_VERSION):
        for statement in totals.TRIGGERS:
            base.execute(statement)
    return version


def check_values(base: sqlite3.Connection, whose: str) -> None:
    """Whether every value is of its column's type: SQLite itself takes any, and whatever else changed the file may have.

    Raises:
        ConfigError: One is not; names where it stands.
    """
    for (table,) in base.execute("SELECT name FROM sqlite_master WHERE type='table'").fetchall():
        wrong = {name: _is_other(name, valid) for name, valid in _types(base, table).items()}
        # One look at each row, whatever the number of its columns: which one it is, is asked only where one is wrong.
        if base.execute(f"SELECT 1 FROM {table} WHERE {' OR '.join(wrong.values())} LIMIT 1").fetchone() is None:
            continue
        for name, valid in _types(base, table).items():
            found = base.execute(f"SELECT typeof({name}) FROM {table} WHERE {wrong[name]} LIMIT 1").fetchone()
            if found is not None:
                raise ConfigError(
                    f"{whose}: {name} of {table} holds a value of type {found[0]}; valid: {' or '.join(valid)}"
                )
    empty = " OR ".join(f"{name} IS NULL" for name in ("outcome", "calls", "tokens", "pictures", "seconds", "rounds"))
    if base.execute(f"SELECT 1 FROM trials WHERE state = 'done' AND ({empty}) LIMIT 1").fetchone() is not None:
        raise ConfigError(f"{whose}: a trial that ended lacks its outcome or what it took")


def check_spec(row: sqlite3.Row, whose: str) -> None:
    """The same for what one row says of its trial, before that is run: the file may have been changed since all of it was checked.

    Raises:
        ConfigError: A value is of another type; names it.
    """
    for name in SPEC:
        valid = int | float if name in _COUNTS else str
        if not isinstance(row[name], valid):
            raise ConfigError(
                f"{whose}: {name} of trial {row['id']} holds a value of type {type(row[name]).__name__}; "
                f"valid: {'a number' if name in _COUNTS else 'text'}"
            )


def _types(base: sqlite3.Connection, table: str) -> dict[str, tuple[str, ...]]:
    """What SQLite calls the values that each column of a table may hold, beside none at all."""
    columns = base.execute(f"PRAGMA table_info('{table}')").fetchall()
    return {column["name"]: _NUMBER if _holds_numbers(column) else ("text",) for column in columns}


def _holds_numbers(column: sqlite3.Row) -> bool:
    return column["name"] in _NUMBERS or column["type"] in ("INTEGER", "REAL")


def _is_other(name: str, valid: tuple[str, ...]) -> str:
    return f"typeof({name}) NOT IN ({', '.join(map(repr, (*valid, 'null')))})"
