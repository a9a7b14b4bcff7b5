"""A durable store of trials: one SQLite file that several processes share and that survives `kill -9`.

A trial is written in the transaction that ends it. Work is handed out by claims with leases, so nothing runs twice and
nothing is lost but what was in flight; the same study opened again goes on where it stopped.
"""

from __future__ import annotations

import json
import sqlite3
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from wonderful_team.core.caps import Caps
from wonderful_team.core.filesystem import make_private_folder, network_file_system, private
from wonderful_team.errors import ConfigError, FileNotWrittenError, reading
from wonderful_team.evals.leases import LEASE_S, Owner, Surroundings
from wonderful_team.evals.names import NO_MODEL
from wonderful_team.evals.schema import (
    CONDITION,
    JSON,
    RESULT,
    SCHEMA_VERSION,
    SPEC,
    check_spec,
    check_values,
    make_tables,
)
from wonderful_team.evals.spending import UNITS, Allowance, Likely, Spending, WaitForCost, allow
from wonderful_team.evals.stored_rows import Claim, costs_of, result_of, spec_of, spec_values
from wonderful_team.evals.totals import OUTCOMES
from wonderful_team.evals.trials import Row, TrialRow, TrialSpec
from wonderful_team.redaction import redact_all

CUT = "cut by the study's cap"
"""Why an attempt was discarded that had all it was allowed and wanted more."""
_REQUEST = TypeAdapter(dict[str, Any])
"""What is read out of the file is of the type that it was written with."""
_FLYING = "FROM trials t INDEXED BY trials_by_state CROSS JOIN wanted w ON w.study = ? AND w.trial = t.id WHERE t.state = 'claimed'"
MAX_CRASHES = 3
"""A trial whose worker process died so often is written as an error, ours, and not tried again."""


class Store:
    """One store file.

    Args:
        path: The file; made if missing, unless `must_exist`.
        must_exist: Refuse a path where no file is.
        checked: Every value of the file was checked just before, by the process that this one works for.
        here: The machine's clocks and processes; tests give others.

    Raises:
        ConfigError: It cannot be opened, is no store of ours, or has another schema version.
    """

    def __init__(
        self,
        path: str | Path,
        *,
        must_exist: bool = False,
        checked: bool = False,
        here: Surroundings | None = None,
    ) -> None:
        self.path = Path(path)
        self._here = here or Surroundings()
        self.warnings: list[str] = []
        if must_exist and not self.path.is_file():
            raise ConfigError(f"store {str(self.path)!r}: there is no such file")
        try:
            make_private_folder(self.path.parent)
            with suppress(OSError), open(self.path, "ab", opener=private):
                pass  # SQLite keeps the mode of a file that is there, and gives it to those beside it
            self._base = sqlite3.connect(self.path, timeout=60.0, isolation_level=None, check_same_thread=False)
            self._base.row_factory = sqlite3.Row
            try:
                self._open()
                if not checked:
                    check_values(self._base, f"store {str(self.path)!r}")
            except BaseException:
                self._base.close()
                raise
        except (sqlite3.Error, OSError, UnicodeDecodeError) as error:
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
        tables = {row[0] for row in self._base.execute("SELECT name FROM sqlite_master WHERE type='table'")}
        if tables and "trials" not in tables:
            raise ConfigError(f"store {str(self.path)!r} is another program's database; choose another file")
        with self._writing() as base:
            version = make_tables(base)
        if version != str(SCHEMA_VERSION):
            raise ConfigError(
                f"store {str(self.path)!r}: schema version {version}; this release reads {SCHEMA_VERSION}"
            )

    @contextmanager
    def _writing(self, *, durable: bool = True) -> Iterator[sqlite3.Connection]:
        """A transaction. One that is not durable survives the death of its process, but not a loss of power."""
        self._base.execute(f"PRAGMA synchronous={'FULL' if durable else 'NORMAL'}")
        self._base.execute("BEGIN IMMEDIATE")
        try:
            yield self._base
            self._base.execute("COMMIT")
        except BaseException:
            with suppress(sqlite3.Error):  # a full disk has rolled it back already
                self._base.execute("ROLLBACK")
            raise

    def close(self) -> None:
        self._base.close()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        self.close()
        if isinstance(error, sqlite3.OperationalError):
            raise FileNotWrittenError(
                self.path, str(error), "what ended before is kept; the same command goes on"
            ) from error
        if isinstance(error, sqlite3.Error | UnicodeDecodeError):
            raise ConfigError(f"store {str(self.path)!r} cannot be used: {error}") from error

    # -- what is wanted ----------------------------------------------------------------------------------------------

    def want(self, study: str, specs: Iterable[TrialSpec], request: Mapping[str, Any]) -> int:
        """Enter the trials of a study; those that are there already are left as they are. Returns how many are new."""
        columns = ", ".join(("key", *SPEC))
        marks = ", ".join("?" * (1 + len(SPEC)))
        with self._writing() as base:
            before = base.execute("SELECT COUNT(*) FROM trials").fetchone()[0]
            listed = list(specs)
            base.executemany(f"INSERT OR IGNORE INTO trials({columns}) VALUES({marks})", map(spec_values, listed))
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
        with reading(f"store {str(self.path)!r}", "a store that bench wrote and nothing changed"):
            rows = self._base.execute("SELECT request FROM studies ORDER BY started, rowid").fetchall()
            return [_REQUEST.validate_json(row[0]) for row in rows]

    # -- handing out work --------------------------------------------------------------------------------------------

    def claim(self, study: str, owner: Owner, caps: Caps | None = None) -> Claim | None:
        """Take the next trial of a study; None when there is none to take now (see `left` and `spending`).

        Raises:
            CapReached: Another trial could pass a cap of the study.
        """
        # A claim that a loss of power undoes is only a trial that is run again.
        # In a transaction of its own: it stands whether or not a trial is then taken.
        self._free_abandoned(study)
        with self._writing(durable=False) as base:
            row = self._next(base, study)
            if row is None:
                return None
            check_spec(row, f"store {str(self.path)!r}")
            try:
                allowance = self._allowance(study, row, caps)
            except WaitForCost:
                return None
            base.execute(
                "UPDATE trials SET state='claimed', owner=?, lease_until_s=?, lease_steady_s=?, held_calls=?, held_tokens=?, "
                "held_usd=? WHERE id=?",
                (str(owner), *self._leases(), *allowance.held, row["id"]),
            )
        return Claim(int(row["id"]), spec_of(row), allowance.caps)

    def check_caps(self, study: str, caps: Caps) -> None:
        """Whether the next trial may be begun, once nothing is in flight.

        Raises:
            CapReached: It may not.
        """
        self._free_abandoned(study)
        row = self._next(self._base, study)
        if row is not None:
            with suppress(WaitForCost):
                self._allowance(study, row, caps)

    def _allowance(self, study: str, row: sqlite3.Row, caps: Caps | None) -> Allowance:
        if caps is None or not set(caps.given) & set(UNITS):
            return Allowance(Caps(), (0, 0, 0.0))
        return allow(caps, self.spending(study), self._likely(row))

    def _likely(self, row: sqlite3.Row) -> Likely:
        """What the trials of the same condition took, and those of any; trials that broke before a call tell nothing."""
        if row["model"] == NO_MODEL:
            return Likely((0, 0, 0))
        taken = "SELECT COUNT(*), MAX(calls), MAX(tokens), MAX(usd) FROM dearest"
        alike = " AND ".join(f"{name} IS ?" for name in CONDITION)
        own = self._base.execute(f"{taken} WHERE {alike}", [row[name] for name in CONDITION]).fetchone()
        others = self._base.execute(taken).fetchone()
        cut = self._base.execute(
            "SELECT allowed_calls, allowed_tokens, allowed_usd FROM discarded WHERE trial=? AND why=? ORDER BY rowid DESC LIMIT 1",
            (row["id"], CUT),
        ).fetchone()
        return Likely(costs_of(own), costs_of(others), (0, 0, 0.0) if cut is None else tuple(cut))

    def _next(self, base: sqlite3.Connection, study: str) -> sqlite3.Row | None:
        # Along the index of what is pending, in order: SQLite itself would go through all that the study wants.
        mine = "FROM trials t INDEXED BY trials_by_state CROSS JOIN wanted w ON w.study = ? AND w.trial = t.id"
        row = base.execute(f"SELECT t.* {mine} WHERE t.state = 'pending' ORDER BY t.id LIMIT 1", (study,)).fetchone()
        return row  # type: ignore[no-any-return]

    def _free_abandoned(self, study: str) -> None:
        """Make the claims of processes that are gone pending again, before anything is counted: they hold part of the caps."""
        mine = f"SELECT t.* {_FLYING}"

        def abandoned() -> list[sqlite3.Row]:
            rows: list[sqlite3.Row] = self._base.execute(mine, (study,)).fetchall()
            return [
                row for row in rows if self._here.is_free(row["owner"], row["lease_until_s"], row["lease_steady_s"])
            ]

        if abandoned():
            with self._writing(durable=False) as base:
                for row in abandoned():
                    _lose(base, row, "its process ended")

    def _leases(self) -> tuple[float, float]:
        return self._here.wall_s() + LEASE_S, self._here.steady_s() + LEASE_S

    def renew(self, trial: int, owner: Owner) -> bool:
        """Extend a lease; False when the claim was lost to somebody else."""
        with self._writing(durable=False) as base:
            done = base.execute(
                "UPDATE trials SET lease_until_s=?, lease_steady_s=? WHERE id=? AND owner=? AND state='claimed'",
                (*self._leases(), trial, str(owner)),
            )
            return done.rowcount == 1

    def finish(self, trial: int, owner: Owner, result: TrialRow) -> bool:
        """Write a result; False when the claim was lost: then only what it cost is booked, in place of what it held."""
        values = ((name, redact_all(getattr(result, name))) for name in RESULT)
        texts = [json.dumps(value, default=dict) if name in JSON else value for name, value in values]
        sets = ", ".join(f"{name}=?" for name in RESULT)
        with self._writing() as base:
            done = base.execute(
                f"UPDATE trials SET state='done', owner='', ended=?, {sets} WHERE id=? AND owner=? AND state='claimed'",
                (_now(), *texts, trial, str(owner)),
            )
            if done.rowcount != 1:
                _correct(base, trial, owner, result)
            return done.rowcount == 1

    def give_back(self, trial: int, owner: Owner, why: str = "interrupted", spent: TrialRow | None = None) -> None:
        """Let somebody else run a claimed trial; what it cost is booked, or what it held where that is not known."""
        with self._writing() as base:
            row = base.execute(
                "SELECT * FROM trials WHERE id=? AND owner=? AND state='claimed'", (trial, str(owner))
            ).fetchone()
            if row is not None:
                _lose(base, row, why)
            if spent is not None:
                _correct(base, trial, owner, spent)

    def crashed(self, pid: int, host: str, ended_by_us: str = "") -> list[str]:
        """Free the claims of a worker process that died; a trial that keeps killing workers becomes an error.

        Args:
            pid: The process.
            host: Its machine.
            ended_by_us: Why we ended it: then no trial is blamed.

        Returns:
            The scenes that were in flight.
        """
        scenes = []
        with self._writing() as base:
            held = "SELECT * FROM trials WHERE state='claimed' AND owner LIKE ?"
            for row in base.execute(held, (f"{host}|{pid}|%",)).fetchall():
                scenes.append(spec_of(row).scene)
                crashes = row["crashes"] + (not ended_by_us)
                _lose(base, row, ended_by_us or "its process died")
                base.execute("UPDATE trials SET crashes=? WHERE id=?", (crashes, row["id"]))
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
                "INSERT INTO discarded(trial, why, calls, tokens, usd, reason, at) SELECT id, 'error retried', calls, tokens, usd, reason, ? "
                f"FROM trials WHERE {chosen}",
                (_now(), study),
            )
            blank = ", ".join(f"{name}=NULL" for name in RESULT)
            changed = base.execute(
                f"UPDATE trials SET state='pending', crashes=0, ended=NULL, {blank} WHERE {chosen}", (study,)
            )
            return changed.rowcount

    # -- reading -----------------------------------------------------------------------------------------------------

    def spending(self, study: str) -> Spending:
        """What the trials of a study cost so far, those retried or cut short included, and what is in flight."""
        flying = self._base.execute(
            f"SELECT COUNT(*), COALESCE(SUM(held_calls), 0), COALESCE(SUM(held_tokens), 0), COALESCE(SUM(held_usd), 0) {_FLYING}",
            (study,),
        ).fetchone()
        total = self._totals(study)
        return Spending(
            calls=total["calls"],
            tokens=total["tokens"],
            usd=total["usd"],
            unpriced=total["unpriced"],
            in_flight=flying[0],
            held=tuple(flying)[1:],
        )

    def _totals(self, study: str) -> Mapping[str, Any]:
        row = self._base.execute("SELECT * FROM totals WHERE study = ?", (study,)).fetchone()
        return Counter() if row is None else dict(row)

    def count(self, study: str, state: str) -> int:
        """How many trials of a study are pending, claimed or done."""
        total = self._totals(study)
        if state == "done":
            return int(total["done"])
        claimed = int(self._base.execute(f"SELECT COUNT(*) {_FLYING}", (study,)).fetchone()[0])
        return claimed if state == "claimed" else int(total["wanted"] - total["done"] - claimed)

    def count_all(self, study: str) -> int:
        """How many trials a study has."""
        return int(self._totals(study)["wanted"])

    def outcomes(self, study: str) -> dict[str, int]:
        """How many ended trials of a study there are of each outcome."""
        total = self._totals(study)
        return {name: int(total[name]) for name in OUTCOMES if total[name]}

    def rows(self, study: str | None = None) -> list[Row]:
        """Every trial, in the order in which they were asked for."""
        chosen = "" if study is None else "WHERE t.id IN (SELECT trial FROM wanted WHERE study = :study)"
        query = (
            "SELECT t.*, (SELECT COUNT(*) FROM discarded d WHERE d.trial = t.id) AS lost "
            f"FROM trials t {chosen} ORDER BY t.id"
        )
        with reading(f"store {str(self.path)!r}", "a store that bench wrote and nothing changed"):
            found = self._base.execute(query, {"study": study})
            return [Row(spec_of(row), result_of(row) if row["state"] == "done" else None, row["lost"]) for row in found]


def _lose(base: sqlite3.Connection, row: sqlite3.Row, why: str) -> None:
    """Make a claimed trial pending. What it held counts as spent, until its owner says what it was: money may have gone."""
    held = (row["held_calls"], row["held_tokens"], row["held_usd"])
    base.execute(
        "INSERT INTO discarded(trial, why, calls, tokens, usd, reason, at, owner, allowed_calls, allowed_tokens, allowed_usd) "
        "VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        (row["id"], why, *held, "what it held; at most this was spent", _now(), row["owner"], *held),
    )
    base.execute(
        "UPDATE trials SET state='pending', owner='', held_calls=0, held_tokens=0, held_usd=0 WHERE id=?", (row["id"],)
    )


def _correct(base: sqlite3.Connection, trial: int, owner: Owner, spent: TrialRow) -> None:
    """Book what an attempt cost in place of what it held; once."""
    base.execute(
        "UPDATE discarded SET calls=?, tokens=?, usd=?, reason=?, owner='' WHERE rowid = "
        "(SELECT MAX(rowid) FROM discarded WHERE trial=? AND owner=?)",
        (spent.calls, spent.tokens, spent.usd, spent.reason, trial, str(owner)),
    )


def _now() -> str:
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
