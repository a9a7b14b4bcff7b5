"""The store: nothing runs twice, nothing is lost, and numbers recomputed by hand from its rows are those it reports."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from contextlib import closing
from functools import partial
from pathlib import Path

import pytest

from tests.evals import runners
from tests.evals.runners import toy_plan
from tests.evals.sweeps import killed, lines, start
from wonderful_team.core.caps import Caps
from wonderful_team.core.filesystem import network_file_system
from wonderful_team.errors import ConfigError
from wonderful_team.evals.leases import Owner, Surroundings
from wonderful_team.evals.spending import CapReached, Likely, Spending, WaitForCost, allow
from wonderful_team.evals.store import Store
from wonderful_team.evals.study import run_study
from wonderful_team.evals.trials import TrialRow

ROOT = Path(__file__).parents[2]


def _wanted(store: Store, seeds: int = 2) -> str:
    plan = toy_plan(seeds)
    store.want(plan.name, plan.trials(), plan.request())
    return plan.name


def test_a_claim_goes_to_one_owner_and_is_written_once(tmp_path: Path) -> None:
    with Store(tmp_path / "s.db") as store, Store(tmp_path / "s.db") as other:
        study = _wanted(store)
        one, two = Owner.this_process(), Owner.this_process()
        first, second = store.claim(study, one), other.claim(study, two)
        assert first is not None
        assert second is not None
        assert first.spec != second.spec
        assert not store.finish(first.trial, two, TrialRow("success"))
        assert store.finish(first.trial, one, TrialRow("failure", "plan", "why"))
        assert not store.finish(first.trial, one, TrialRow("success"))
        (ended,) = [row for row in store.rows() if row.result is not None]
        assert (ended.result.outcome, ended.result.stage) == ("failure", "plan")  # type: ignore[union-attr]


def test_a_claim_of_a_process_that_is_gone_is_free_and_of_a_living_one_is_not() -> None:
    here, mine = Surroundings(), Owner.this_process()
    wall, steady = time.time() + 60, time.monotonic() + 60
    assert not here.is_free(str(mine), wall, steady)
    assert not here.is_free(str(mine), wall - 3600, steady), (
        "the time of day says nothing about this machine's processes"
    )
    assert here.is_free(str(mine), wall, steady - 61)
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    assert here.is_free(f"{mine.host}|{gone.pid}|0|0||x", wall, steady)
    assert here.is_free(f"{mine.host}|{mine.pid}|1|0||x", wall, steady), "a later process took the number"
    assert not here.is_free("elsewhere|1|0|0||x", wall, steady)
    assert here.is_free("elsewhere|1|0|0||x", wall - 61, steady)
    assert not here.is_free(f"{mine.host}|{gone.pid}|0|{mine.pid}|{mine.born}|x", wall, steady), (
        "its parent lives and will see to it"
    )


def test_the_same_study_resumes_and_a_larger_one_runs_only_what_is_new(tmp_path: Path) -> None:
    path = tmp_path / "s.db"
    first = run_study(toy_plan(2), path, runners.quick, jobs=1)
    assert (first.status.here, first.why) == (8, "")
    again = run_study(toy_plan(2), path, runners.quick, jobs=1)
    assert (again.status.here, again.status.done) == (0, 8)
    more = run_study(toy_plan(3), path, runners.quick, jobs=1)
    assert (more.status.here, more.status.done) == (4, 12)


def test_another_programs_database_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "other.db"
    base = sqlite3.connect(path)
    base.execute("CREATE TABLE things(x)")
    base.commit()
    base.close()
    with pytest.raises(ConfigError, match="another program's database"):
        Store(path)
    (tmp_path / "text.db").write_text("not a database at all, just words\n" * 50, encoding="utf-8")
    with pytest.raises(ConfigError, match="cannot be used"):
        Store(tmp_path / "text.db")


def test_a_network_file_system_is_told() -> None:
    mounts = "/dev/sda1 / ext4 rw 0 0\nserver:/home /mnt/home nfs4 rw 0 0\n"
    assert network_file_system(Path("/mnt/home/me/s.db"), mounts) == "nfs4"
    assert network_file_system(Path("/tmp/s.db"), mounts) is None


def test_errors_are_kept_apart_and_retried_on_request(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = tmp_path / "broken"
    broken.touch()
    monkeypatch.setenv("TOY_BROKEN", str(broken))
    path = tmp_path / "s.db"
    first = run_study(toy_plan(10), path, runners.breaking, jobs=1)
    assert first.status.outcomes["error"] == 8  # seeds 1000 and 1005, two tasks, two methods
    again = run_study(toy_plan(10), path, runners.breaking, jobs=1)
    assert again.status.here == 0
    broken.unlink()
    repaired = run_study(toy_plan(10), path, runners.breaking, jobs=1, retry_errors=True)
    assert "error" not in repaired.status.outcomes
    with Store(path) as store:
        assert sum(row.discarded for row in store.rows()) == 8
        reasons = {row.result.reason for row in store.rows() if row.result is not None}
    assert not any("hung up" in reason for reason in reasons)


@pytest.mark.parametrize("cap", [35, 5])
def test_a_cap_stops_a_study_cleanly_and_is_never_passed(tmp_path: Path, cap: int) -> None:
    path = tmp_path / "s.db"
    ended = run_study(toy_plan(5), path, runners.capped, jobs=1, caps=Caps(calls=cap))
    assert "cap" in ended.why
    assert ended.status.spent.calls <= cap
    with Store(path) as store:
        results = [row.result for row in store.rows() if row.result is not None]
    assert len(results) == cap // 10
    assert all(result.outcome == "success" for result in results), "a trial cut by the study's cap is not a failure"
    whole = run_study(toy_plan(5), path, runners.capped, jobs=1)
    assert whole.status.done == 20


def test_trials_run_side_by_side_under_a_cap_and_never_pass_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TOY_LOG", str(tmp_path / "log"))
    ended = run_study(toy_plan(10), tmp_path / "s.db", runners.capped_slow, jobs=1, at_once=4, caps=Caps(calls=305))
    assert "cap of 305 calls" in ended.why
    assert ended.status.spent.calls == 300, "whatever fits is run, and nothing is cut that fits"
    assert ended.status.outcomes == {"success": 30}
    assert _most_in_flight(tmp_path / "log") >= 3


def test_a_cap_in_money_does_not_slow_models_that_cost_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TOY_LOG", str(tmp_path / "log"))
    plan = toy_plan(4, models=("offline",))
    ended = run_study(plan, tmp_path / "s.db", runners.free_slow, jobs=1, at_once=4, caps=Caps(usd=0.01))
    assert ended.why == ""
    assert _most_in_flight(tmp_path / "log") >= 3


def test_a_trial_dearer_than_its_allowance_is_cut_run_again_with_more_and_booked() -> None:
    caps = Caps(calls=100)
    known = allow(caps, Spending(calls=20), Likely((10, 0, 0), (10, 0, 0)))
    assert (known.caps.calls, known.held[0]) == (20, 20)
    cut = allow(caps, Spending(calls=40), Likely((20, 0, 0), (20, 0, 0)))
    assert cut.caps.calls == 40, "what a cut trial took counts as known"
    assert allow(caps, Spending(calls=20, held=(70, 0, 0)), Likely((10, 0, 0))).caps.calls == 10
    with pytest.raises(WaitForCost):
        allow(caps, Spending(calls=20, held=(75, 0, 0)), Likely((10, 0, 0)))
    with pytest.raises(CapReached, match="95 spent, a trial like the next one took up to 10"):
        allow(caps, Spending(calls=95), Likely((10, 0, 0)))
    assert allow(caps, Spending(), Likely()).held[0] == 100, "nothing is known yet: one trial at a time"


def test_a_store_of_the_first_release_opens_and_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "s.db"
    run_study(toy_plan(2), path, runners.quick, jobs=1)
    base = sqlite3.connect(path)
    _without_what_came_fourth(base)
    for column in ("how", "looks", "held_calls", "held_tokens", "held_usd"):
        base.execute(f"ALTER TABLE trials DROP COLUMN {column}")
    _without_what_came_third(base)
    base.execute("UPDATE meta SET value='1'")
    base.commit()
    base.close()
    again = run_study(toy_plan(3), path, runners.quick, jobs=1)
    assert (again.status.here, again.status.done) == (4, 12)


def test_a_store_of_the_second_schema_opens_and_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "s.db"
    run_study(toy_plan(2), path, runners.quick, jobs=1)
    base = sqlite3.connect(path)
    _without_what_came_fourth(base)
    _without_what_came_third(base)
    base.execute("UPDATE meta SET value='2'")
    base.commit()
    base.close()
    again = run_study(toy_plan(3), path, runners.quick, jobs=1)
    assert (again.status.here, again.status.done) == (4, 12)


@pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="counts open files where Linux tells them")
def test_a_file_that_is_no_store_is_closed_again(tmp_path: Path) -> None:
    path = tmp_path / "notes.db"
    with closing(sqlite3.connect(path)) as base:
        base.execute("CREATE TABLE notes(words TEXT)")
        base.commit()
    with pytest.raises(ConfigError, match="another program's database") as caught:
        Store(path)
    opened = [os.readlink(one) for one in Path("/proc/self/fd").iterdir() if one.is_symlink()]
    # The error is at hand, and with it all that its frames hold.
    assert caught.value.__traceback__ is not None
    assert str(path) not in opened


def _without_what_came_fourth(base: sqlite3.Connection) -> None:
    for kind, name in base.execute("SELECT type, name FROM sqlite_master WHERE type = 'trigger'").fetchall():
        base.execute(f"DROP {kind} {name}")
    for table in ("totals", "dearest"):
        base.execute(f"DROP TABLE {table}")


def test_totals_of_a_store_that_had_none_are_those_that_were_kept(tmp_path: Path) -> None:
    path = tmp_path / "s.db"
    run_study(toy_plan(3), path, runners.quick, jobs=1)

    def kept() -> list[list[tuple[object, ...]]]:
        with closing(sqlite3.connect(path)) as base:
            return [base.execute(f"SELECT * FROM {table} ORDER BY 1, 2").fetchall() for table in ("totals", "dearest")]

    before = kept()
    assert all(before)
    with closing(sqlite3.connect(path)) as base:
        _without_what_came_fourth(base)
        base.execute("UPDATE meta SET value='3'")
        base.commit()
    Store(path).close()
    assert kept() == before


def test_a_claim_reads_no_more_rows_in_a_large_study_than_in_a_small_one(tmp_path: Path) -> None:
    steps = []
    for seeds in (20, 400):
        with Store(tmp_path / f"{seeds}.db") as store:
            plan = toy_plan(seeds)
            store.want(plan.name, plan.trials(), plan.request())
            owner = Owner.this_process()
            for _ in range(seeds):
                claim = store.claim(plan.name, owner, Caps(calls=10**6))
                assert claim is not None
                store.finish(claim.trial, owner, TrialRow("success", calls=1))
            counted: list[int] = []
            # SQLite calls this once in ten of its own steps.
            store._base.set_progress_handler(partial(counted.append, 0), 10)
            assert store.claim(plan.name, owner, Caps(calls=10**6)) is not None
            steps.append(len(counted))
    assert steps[1] <= 2 * steps[0] + 10, steps


def _without_what_came_third(base: sqlite3.Connection) -> None:
    base.execute("ALTER TABLE trials DROP COLUMN lease_steady_s")
    for column in ("owner", "allowed_calls", "allowed_tokens", "allowed_usd"):
        base.execute(f"ALTER TABLE discarded DROP COLUMN {column}")


def test_a_trial_that_kills_its_worker_becomes_an_error_and_the_sweep_goes_on(tmp_path: Path) -> None:
    said: list[str] = []
    ended = run_study(toy_plan(3), tmp_path / "s.db", runners.dying, jobs=2, report=lambda text, _: said.append(text))
    assert ended.status.done == ended.status.total == 12
    assert ended.status.outcomes["error"] == 1
    assert any("a worker died (exit code 7)" in text for text in said)


@pytest.mark.parametrize("places", [1, 3])
def test_one_limit_holds_for_the_model_calls_of_all_processes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, places: int
) -> None:
    log = tmp_path / "log"
    monkeypatch.setenv("TOY_LOG", str(log))
    run_study(toy_plan(3), tmp_path / "s.db", runners.limited, jobs=2, at_once=3, calls_at_once=places)
    calls = [tuple(map(float, line.split())) for line in lines(log)]
    assert len(calls) == 12
    most = max(sum(began <= moment < ended for began, ended in calls) for moment, _ in calls)
    assert most == places


def test_several_trials_wait_at_the_same_time_in_one_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    log = tmp_path / "log"
    monkeypatch.setenv("TOY_LOG", str(log))
    started = time.monotonic()
    ended = run_study(toy_plan(10), tmp_path / "s.db", runners.slow, jobs=1, at_once=8)
    assert ended.status.done == 40
    # One after another they sleep 0.8 s; the bound leaves room for a busy machine.
    assert _most_in_flight(log) > 1, time.monotonic() - started


def _most_in_flight(log: Path) -> int:
    in_flight = most = 0
    for line in lines(log):
        in_flight += 1 if line.startswith("begin") else -1
        most = max(most, in_flight)
    return most


def test_kill_9_at_random_moments_loses_only_what_was_in_flight(tmp_path: Path) -> None:
    """The whole group is killed several times in one sweep; then the counts."""
    ended = killed(tmp_path, seed=11)
    assert ended.kills >= 3, "the sweep was too short to be killed"
    assert ended.wrong == []


def test_an_interrupt_lets_trials_in_flight_end_and_leaves_nothing_claimed(tmp_path: Path) -> None:
    log = tmp_path / "log"
    process = start(tmp_path, log)
    while len(lines(log)) < 6 and process.poll() is None:
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)
    assert process.wait(timeout=60) != 0
    with Store(tmp_path / "s.db") as store:
        (study,) = [toy_plan(20).name]
        assert store.count(study, "claimed") == 0
        assert 0 < store.count(study, "done") < 80
        done = {row.spec.key for row in store.rows() if row.result is not None}
    assert done == {line[4:] for line in lines(log) if line.startswith("end ")}


def test_two_processes_share_a_store_without_double_work(tmp_path: Path) -> None:
    log = tmp_path / "log"
    one, two = start(tmp_path, log), start(tmp_path, log)
    assert one.wait(timeout=120) == 0
    assert two.wait(timeout=120) == 0
    ended = Counter(line for line in lines(log) if line.startswith("end "))
    assert len(ended) == 80
    assert set(ended.values()) == {1}
