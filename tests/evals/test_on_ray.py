"""The same study on a Ray cluster that is started here, and what is refused before any is asked."""

from __future__ import annotations

import importlib.util
import multiprocessing
from pathlib import Path

import pytest

from tests.evals import runners
from tests.evals.runners import toy_plan
from wonderful_team.errors import ClusterLostError, ConfigError, MissingExtraError
from wonderful_team.evals import on_ray
from wonderful_team.evals.monitor import StudyMonitor
from wonderful_team.evals.on_ray import check_address, run_on_ray
from wonderful_team.evals.ray_messages import Connected, Order
from wonderful_team.evals.shipment import Parcel
from wonderful_team.evals.store import Store
from wonderful_team.evals.study import run_study
from wonderful_team.evals.trials import RunSettings
from wonderful_team.evals.workers import Work

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.enable_socket
def test_a_study_on_two_ray_workers_of_this_machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ray")
    monkeypatch.setenv("PYTHONPATH", f"{ROOT}:{ROOT / 'src'}")
    monkeypatch.setenv("RAY_TMPDIR", "/tmp")  # Ray's sockets have a bound on the length of their path
    plan, here, there = toy_plan(4), tmp_path / "here.db", tmp_path / "there.db"
    run_study(plan, here, runners.quick, jobs=1)
    lines: list[str] = []
    ended = run_study(
        plan,
        there,
        runners.quick,
        jobs=2,
        ray="local",
        report=lambda text, status: lines.append(text) if text else None,
    )
    assert (ended.status.done, ended.why) == (16, "")
    assert lines == ["Ray at local: 1 node, starting 2 workers"]
    with Store(here) as one, Store(there) as other:
        assert [(row.spec, row.result) for row in one.rows()] == [(row.spec, row.result) for row in other.rows()]


@pytest.mark.parametrize("address", ["ray://127.0.0.1:10001", "somewhere", "host:", ":6379", "host:0", "host:x", ""])
def test_an_address_of_another_form_is_refused(address: str) -> None:
    with pytest.raises(ConfigError, match="valid are HOST:PORT .* auto .* local"):
        check_address(address)


@pytest.mark.enable_socket
def test_where_nothing_answers_no_study_waits() -> None:
    with pytest.raises(
        ConfigError, match=r"--ray 127\.0\.0\.1:9: nothing answers there within 5 s.*ray start --head --port 9"
    ):
        check_address("127.0.0.1:9")


def test_without_ray_the_command_to_get_it_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match="pip install"):
        run_study(toy_plan(1), tmp_path / "s.db", runners.quick, ray="local")


def test_a_connection_that_breaks_ends_the_study_and_frees_what_was_in_flight(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan, (near, far) = toy_plan(1), multiprocessing.Pipe()
    said = tmp_path / "ray.txt"
    said.write_text("connecting\nFailed to connect to GCS within 60 seconds\nbye\n", encoding="utf-8")
    with Store(tmp_path / "s.db") as store:
        store.want(plan.name, plan.trials(), plan.request())
        work = Work(store.path, plan.name, runners.quick, RunSettings())
        order = Order("a:1", 1, 4, 1, None, runners.quick, Parcel("/", "/", "", int), tmp_path, said)
        running = on_ray._Cluster(work, store, StudyMonitor(store, plan.name, lambda *_: None), near, order, {})
        running._slots = 2
        far.send(Connected(1, 1, 1))
        far.close()
        with pytest.raises(ClusterLostError, match="Failed to connect to GCS .*; what ended before is kept"):
            running.run()
        assert store.count(plan.name, "claimed") == 0
        assert store.count(plan.name, "pending") == 4


def test_run_on_ray_names_its_address_check_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: object())
    plan = toy_plan(1)
    with Store(tmp_path / "s.db") as store:
        store.want(plan.name, plan.trials(), plan.request())
        work = Work(store.path, plan.name, runners.quick, RunSettings())
        with pytest.raises(ConfigError, match="valid are HOST:PORT"):
            run_on_ray(work, store, StudyMonitor(store, plan.name, lambda *_: None), "nowhere", 1, None)
