"""A durable store of trials: one SQLite file that several processes share and that survives `kill -9`.

A trial is written in the transaction that ends it. Work is handed out by claims with leases, so nothing runs twice and
nothing is lost but what was in flight; the same study opened again goes on where it stopped.
"""

from __future__ import annotations

import json
import sqlite3
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from wonderful_team.errors import ConfigError
from wonderful_team.evals.claims import LEASE_S, Owner, is_free
from wonderful_team.evals.places import network_file_system
from wonderful_team.evals.spending import Spending, WaitForCost, remaining
from wonderful_team.evals.trials import Condition, Row, SpendingCaps, TrialResult, TrialSpec

SCHEMA_VERSION = 1
MAX_CRASHES = 3
"""A trial whose worker process died so often is written as an error, ours, and not tried again."""
_SPEC = ("task", "seed", "repeat", "method", "model", "isolate", "perturb", "replans")
_RESULT = (
    *("outcome", "stage", "reason", "calls", "tokens", "pictures", "usd", "seconds", "rounds"),
    *("provenance", "by_role", "page", "instruction", "versions", "facts"),
)
_JSON = ("provenance", "by_role", "versions", "facts")
_TABLES = f"""
CREATE TABLE IF NOT EXISTS meta(name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS trials(
    id INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE,
    task TEXT NOT NULL, seed INTEGER NOT NULL, repeat INTEGER NOT NULL, method TEXT NOT NULL, model TEXT NOT NULL,
    isolate TEXT NOT NULL, perturb TEXT NOT NULL, replans INTEGER NOT NULL,
    state TEXT NOT NULL DEFAULT 'pending' CHECK(state IN ('pending', 'claimed', 'done')),
    owner TEXT NOT NULL DEFAULT '', lease_until_s REAL NOT NULL DEFAULT 0, crashes INTEGER NOT NULL DEFAULT 0,
    ended TEXT, {", ".join(_RESULT)});
CREATE INDEX IF NOT EXISTS trials_by_state ON trials(state, id);
CREATE TABLE IF NOT EXISTS studies(name TEXT PRIMARY KEY, request TEXT NOT NULL, started TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS wanted(study TEXT NOT NULL, trial INTEGER NOT NULL, PRIMARY KEY(study, trial)) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS discarded(
    trial INTEGER NOT NULL, why TEXT NOT NULL, calls INTEGER, tokens INTEGER, usd REAL, reason TEXT, at TEXT NOT NULL);
"""


class Store:
    """One store file.

    Args:
        path: The file; made if missing, unless `must_exist`.

    Raises:
        ConfigError: It cannot be opened, is no store of ours, or has another schema version.
    """

    def __init__(self, path: str | Path, *, must_exist: bool = False) -> None:
        self.path = Path(path)
        self.warnings: list[str] = []
        if must_exist and not self.path.is_file():
            raise ConfigError(f"store {str(self.path)!r}: there is no such file")
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._base = sqlite3.connect(self.path, timeout=60.0, isolation_level=None, check_same_thread=False)
            self._base.row_factory = sqlite3.Row
            self._open()
        except (sqlite3.Error, OSError) as error:
            raise ConfigError(f"store {str(self.path)!r} cannot be used: {error}") from error

    def _open(self) -> None:
        network = network_file_system(self.path)
        if network:
            self.warnings.append(
                f"store {self.path} lies on a network file system ({network}): locks are not reliable there. "
                "Use a local disk, or one file per machine with --shard I/N and `report *.db`"
            )
        # Write-ahead logging needs shared memory, which network file systems lack.
        self._base.execute(f"PRAGMA journal_mode={'DELETE' if network else 'WAL'}")
        self._base.execute("PRAGMA synchronous=FULL")
        tables = {row[0] for row in self._base.execute("SELECT name FROM sqlite_master WHERE type='table'")}
        if tables and "trials" not in tables:
            raise ConfigError(f"store {str(self.path)!r} is another program's database; choose another file")
        with self._writing():
            for statement in _TABLES.split(";"):
                if statement.strip():
                    self._base.execute(statement)
            self._base.execute("INSERT OR IGNORE INTO meta VALUES('schema_version', ?)", (str(SCHEMA_VERSION),))
        version = self._base.execute("SELECT value FROM meta WHERE name='schema_version'").fetchone()[0]
        if version != str(SCHEMA_VERSION):
            raise ConfigError(
                f"store {str(self.path)!r}: schema version {version}; this release reads {SCHEMA_VERSION}"
            )

    @contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        self._base.execute("BEGIN IMMEDIATE")
        try:
            yield self._base
        except BaseException:
            self._base.execute("ROLLBACK")
            raise
        self._base.execute("COMMIT")

    def close(self) -> None:
        self._base.close()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- what is wanted ----------------------------------------------------------------------------------------------

    def want(self, study: str, specs: Iterable[TrialSpec], request: Mapping[str, Any]) -> int:
        """Enter the trials of a study; those that are there already are left as they are. Returns how many are new."""
        columns = ", ".join(("key", *_SPEC))
        marks = ", ".join("?" * (1 + len(_SPEC)))
        with self._writing() as base:
            before = base.execute("SELECT COUNT(*) FROM trials").fetchone()[0]
            listed = list(specs)
            base.executemany(f"INSERT OR IGNORE INTO trials({columns}) VALUES({marks})", map(_spec_values, listed))
            base.executemany(
                "INSERT OR IGNORE INTO wanted SELECT ?, id FROM trials WHERE key = ?", [(study, s.key) for s in listed]
            )
            base.execute(
                "INSERT INTO studies VALUES(?, ?, ?) ON CONFLICT(name) DO UPDATE SET request = excluded.request",
                (study, json.dumps(dict(request)), _now()),
            )
            return int(base.execute("SELECT COUNT(*) FROM trials").fetchone()[0]) - int(before)

    def requests(self) -> list[dict[str, Any]]:
        """What was asked for, study by study, oldest first."""
        return [json.loads(row[0]) for row in self._base.execute("SELECT request FROM studies ORDER BY started, rowid")]

    # -- handing out work --------------------------------------------------------------------------------------------

    def claim(self, study: str, owner: Owner, caps: SpendingCaps | None = None) -> Claim | None:
        """Take the next trial of a study; None when there is none to take now (see `left` and `spending`).

        Raises:
            CapReached: Another trial could pass a cap of the study.
        """
        with self._writing() as base:
            row = self._next(base, study)
            if row is None:
                return None
            try:
                left = remaining(caps or SpendingCaps(), self.spending(study))
            except WaitForCost:
                return None
            base.execute(
                "UPDATE trials SET state='claimed', owner=?, lease_until_s=? WHERE id=?",
                (str(owner), time.time() + LEASE_S, row["id"]),
            )
        return Claim(int(row["id"]), _spec(row), left)

    def _next(self, base: sqlite3.Connection, study: str) -> sqlite3.Row | None:
        mine = "SELECT t.* FROM trials t JOIN wanted w ON w.trial = t.id AND w.study = ?"
        row = base.execute(f"{mine} WHERE t.state = 'pending' ORDER BY t.id LIMIT 1", (study,)).fetchone()
        if row is not None:
            return row  # type: ignore[no-any-return]
        claimed = base.execute(f"{mine} WHERE t.state = 'claimed' ORDER BY t.id", (study,)).fetchall()
        return next((one for one in claimed if is_free(one["owner"], one["lease_until_s"])), None)

    def renew(self, trial: int, owner: Owner) -> bool:
        """Extend a lease; False when the claim was lost to somebody else."""
        with self._writing() as base:
            until = time.time() + LEASE_S
            done = base.execute(
                "UPDATE trials SET lease_until_s=? WHERE id=? AND owner=? AND state='claimed'",
                (until, trial, str(owner)),
            )
            return done.rowcount == 1

    def finish(self, trial: int, owner: Owner, result: TrialResult) -> bool:
        """Write a result; False (and nothing is written) when the claim was lost and another process has the trial."""
        values = asdict(result)
        texts = [json.dumps(values[name]) if name in _JSON else values[name] for name in _RESULT]
        sets = ", ".join(f"{name}=?" for name in _RESULT)
        with self._writing() as base:
            done = base.execute(
                f"UPDATE trials SET state='done', owner='', ended=?, {sets} WHERE id=? AND owner=? AND state='claimed'",
                (_now(), *texts, trial, str(owner)),
            )
            return done.rowcount == 1

    def give_back(self, trial: int, owner: Owner, why: str = "", spent: TrialResult | None = None) -> None:
        """Let somebody else run a claimed trial; what it cost so far is booked."""
        with self._writing() as base:
            base.execute(
                "UPDATE trials SET state='pending', owner='' WHERE id=? AND owner=? AND state='claimed'",
                (trial, str(owner)),
            )
            if spent is not None:
                cost = (spent.calls, spent.tokens, spent.usd, spent.reason)
                base.execute("INSERT INTO discarded VALUES(?, ?, ?, ?, ?, ?, ?)", (trial, why, *cost, _now()))

    def crashed(self, pid: int, host: str) -> list[str]:
        """Free the claims of a worker process that died; a trial that keeps killing workers becomes an error.

        Returns:
            The scenes that were in flight.
        """
        scenes = []
        with self._writing() as base:
            held = "SELECT * FROM trials WHERE state='claimed' AND owner LIKE ?"
            for row in base.execute(held, (f"{host}|{pid}|%",)).fetchall():
                scenes.append(_spec(row).scene)
                crashes = row["crashes"] + 1
                base.execute("UPDATE trials SET state='pending', owner='', crashes=? WHERE id=?", (crashes, row["id"]))
                if crashes >= MAX_CRASHES:
                    reason = f"the worker process died {crashes} times while it ran this trial"
                    base.execute(
                        "UPDATE trials SET state='done', ended=?, outcome='error', stage='crash', reason=?, calls=0, "
                        "tokens=0, pictures=0, usd=NULL, seconds=0, rounds=0, provenance='[]', by_role='{}', page='', "
                        "instruction='', versions='{}', facts='{}' WHERE id=?",
                        (_now(), reason, row["id"]),
                    )
        return scenes

    def retry_errors(self, study: str) -> int:
        """Make the errors of a study pending again; each stays countable as discarded. Returns how many."""
        chosen = "state='done' AND outcome='error' AND id IN (SELECT trial FROM wanted WHERE study=?)"
        with self._writing() as base:
            base.execute(
                "INSERT INTO discarded SELECT id, 'error retried', calls, tokens, usd, reason, ? "
                f"FROM trials WHERE {chosen}",
                (_now(), study),
            )
            blank = ", ".join(f"{name}=NULL" for name in _RESULT)
            changed = base.execute(
                f"UPDATE trials SET state='pending', crashes=0, ended=NULL, {blank} WHERE {chosen}", (study,)
            )
            return changed.rowcount

    # -- reading -----------------------------------------------------------------------------------------------------

    def spending(self, study: str) -> Spending:
        """What the trials of a study cost so far, those retried or cut short included, and how many are in flight."""
        of_study = "JOIN wanted w ON w.trial = {id} AND w.study = ?"
        cost = "COALESCE(SUM(calls), 0), COALESCE(SUM(tokens), 0), COALESCE(SUM(usd), 0)"
        done = self._base.execute(
            f"SELECT {cost}, MAX(calls), MAX(tokens), MAX(usd), COUNT(*) - COUNT(usd), COUNT(*) "
            f"FROM trials {of_study.format(id='trials.id')} WHERE state='done'",
            (study,),
        ).fetchone()
        lost = self._base.execute(
            f"SELECT {cost} FROM discarded {of_study.format(id='discarded.trial')}", (study,)
        ).fetchone()
        return Spending(
            calls=done[0] + lost[0],
            tokens=done[1] + lost[1],
            usd=done[2] + lost[2],
            dearest=(done[3] or 0, done[4] or 0, done[5] or 0.0),
            unpriced=done[6],
            in_flight=self.count(study, "claimed"),
        )

    def count(self, study: str, state: str) -> int:
        """How many trials of a study are pending, claimed or done."""
        query = "SELECT COUNT(*) FROM trials JOIN wanted w ON w.trial = id AND w.study = ? WHERE state = ?"
        return int(self._base.execute(query, (study, state)).fetchone()[0])

    def count_all(self, study: str) -> int:
        """How many trials a study has."""
        return int(self._base.execute("SELECT COUNT(*) FROM wanted WHERE study = ?", (study,)).fetchone()[0])

    def outcomes(self, study: str) -> dict[str, int]:
        """How many ended trials of a study there are of each outcome."""
        query = (
            "SELECT outcome, COUNT(*) FROM trials JOIN wanted w ON w.trial = id AND w.study = ? "
            "WHERE state='done' GROUP BY outcome"
        )
        return {str(name): int(number) for name, number in self._base.execute(query, (study,))}

    def rows(self, study: str | None = None) -> list[Row]:
        """Every trial, in the order in which they were asked for."""
        chosen = "" if study is None else "WHERE t.id IN (SELECT trial FROM wanted WHERE study = :study)"
        query = (
            "SELECT t.*, (SELECT COUNT(*) FROM discarded d WHERE d.trial = t.id) AS lost "
            f"FROM trials t {chosen} ORDER BY t.id"
        )
        found: Sequence[sqlite3.Row] = self._base.execute(query, {"study": study}).fetchall()
        return [Row(_spec(row), _result(row) if row["state"] == "done" else None, row["lost"]) for row in found]


class Claim:
    """A trial that this process may run.

    Attributes:
        left: What the caps of the study leave for this trial; None per cap that is not set.
    """

    def __init__(self, trial: int, spec: TrialSpec, left: SpendingCaps) -> None:
        self.trial, self.spec, self.left = trial, spec, left


def _spec_values(spec: TrialSpec) -> tuple[Any, ...]:
    return (spec.key, spec.task, spec.seed, spec.repeat, *asdict(spec.condition).values())


def _spec(row: sqlite3.Row) -> TrialSpec:
    condition = Condition(row["method"], row["model"], row["isolate"], row["perturb"], row["replans"])
    return TrialSpec(row["task"], row["seed"], condition, row["repeat"])


def _result(row: sqlite3.Row) -> TrialResult:
    values = {name: json.loads(row[name]) if name in _JSON else row[name] for name in _RESULT}
    return TrialResult(**{**values, "provenance": tuple(values["provenance"])})


def _now() -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
