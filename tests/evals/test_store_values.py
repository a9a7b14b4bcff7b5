"""What else changed a store's file is found before it is used: whole where a study begins, row by row where its workers go on."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from tests.evals.runners import quick, toy_plan
from wonderful_team.errors import ConfigError
from wonderful_team.evals import store as stores
from wonderful_team.evals.leases import Owner
from wonderful_team.evals.store import Store
from wonderful_team.evals.study import run_study
from wonderful_team.evals.trials import RunSettings
from wonderful_team.evals.workers import Work, work_until_done

PLAN = toy_plan(2)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A store with a trial of each state and an attempt that was discarded."""
    file = tmp_path / "s.db"
    with Store(file) as store:
        store.want(PLAN.name, PLAN.trials(), PLAN.request())
        for ends in (True, False, None):
            owner = Owner.this_process()
            claim = store.claim(PLAN.name, owner)
            assert claim is not None
            if ends:
                store.finish(claim.trial, owner, quick(claim.spec, RunSettings()))
            elif ends is False:
                store.give_back(claim.trial, owner)
    return file


def spoil(file: Path, *statements: str) -> None:
    with closing(sqlite3.connect(file)) as base, base:
        for (name,) in base.execute("SELECT name FROM sqlite_master WHERE type='trigger'").fetchall():
            base.execute(f"DROP TRIGGER {name}")
        for statement in statements:
            base.execute(statement)


def columns(file: Path) -> list[tuple[str, str]]:
    with closing(sqlite3.connect(file)) as base:
        tables = [row[0] for row in base.execute("SELECT name FROM sqlite_master WHERE type='table'")]
        return [
            (table, row[1])
            for table in tables
            for row in base.execute(f"PRAGMA table_info('{table}')")
            if base.execute(f"SELECT COUNT(*) FROM {table}").fetchone()[0]
        ]


def test_a_value_of_another_type_is_named_wherever_it_stands(path: Path) -> None:
    tried = 0
    for table, name in columns(path):
        # SQLite itself refuses another type there; a version is named before the values.
        if (table, name) in (("trials", "id"), ("trials", "state")) or table == "meta":
            continue
        copy = path.with_name(f"{table}-{name}.db")
        copy.write_bytes(path.read_bytes())
        last = f"rowid = (SELECT MAX(rowid) FROM {table})" if table in ("trials", "studies", "discarded") else "1"
        try:
            spoil(copy, f"UPDATE {table} SET {name} = x'ff' WHERE {last}")
        except sqlite3.IntegrityError:
            continue
        tried += 1
        with pytest.raises(ConfigError, match=f"{name} of {table} holds a value of type blob; valid: "):
            Store(copy)
    assert tried > 50


def test_a_trial_that_ended_without_an_outcome_is_refused(path: Path) -> None:
    spoil(path, "UPDATE trials SET outcome = NULL WHERE state = 'done'")
    with pytest.raises(ConfigError, match="a trial that ended lacks its outcome or what it took"):
        Store(path)


def test_all_values_are_checked_once_for_a_study_and_not_by_each_of_its_workers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    checked: list[str] = []
    real = stores.check_values
    monkeypatch.setattr(stores, "check_values", lambda base, whose: (checked.append(whose), real(base, whose)))
    ended = run_study(PLAN, tmp_path / "s.db", quick, jobs=1)
    assert ended.status.done == ended.status.total
    assert len(checked) == 1


@pytest.mark.parametrize("name", ["task", "seed", "method", "replans", "how", "looks"])
def test_a_row_spoiled_while_workers_run_is_named_before_it_is_run(path: Path, name: str) -> None:
    spoil(path, f"UPDATE trials SET {name} = x'ff' WHERE state = 'pending'")
    ran: list[object] = []

    def runner(spec: object, settings: object) -> object:
        ran.append(spec)
        raise AssertionError("it must not run")

    work = Work(path, PLAN.name, runner, RunSettings())  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match=rf"{name} of trial \d+ holds a value of type bytes; valid: "):
        work_until_done(work, lambda: False)
    assert ran == []


def test_a_spoiled_result_is_named_where_it_is_read_too(path: Path) -> None:
    with Store(path) as store:
        spoil(path, "UPDATE trials SET tokens = 'many' WHERE state = 'done'")
        with pytest.raises(ConfigError, match="a store that bench wrote and nothing changed"):
            store.rows()


def test_a_worker_makes_no_store_of_its_own(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="there is no such file"):
        work_until_done(Work(tmp_path / "gone.db", "study", quick, RunSettings()), lambda: False)
    assert not (tmp_path / "gone.db").exists()
