"""The same study on a local Ray cluster with two workers: the same outcomes, and one limit for all model calls."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.evals import runners
from tests.evals.runners import toy_plan
from wonderful_team.evals import on_ray
from wonderful_team.evals.monitor import StudyMonitor
from wonderful_team.evals.store import Store
from wonderful_team.evals.study import run_study
from wonderful_team.evals.workers import Work

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.enable_socket
def test_a_study_on_two_ray_workers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ray = pytest.importorskip("ray")
    monkeypatch.setenv("PYTHONPATH", f"{ROOT}:{ROOT / 'src'}")
    plan, here, there = toy_plan(4), tmp_path / "here.db", tmp_path / "there.db"
    run_study(plan, here, runners.quick, jobs=1)
    # A short folder: Ray's sockets have a bound on the length of their path.
    ray.init(num_cpus=4, include_dashboard=False, log_to_driver=False)
    try:
        ended = run_study(plan, there, runners.quick, jobs=2, ray="local")
        assert (ended.status.done, ended.why) == (16, "")
        with Store(here) as one, Store(there) as other:
            assert [(row.spec, row.result) for row in one.rows()] == [(row.spec, row.result) for row in other.rows()]
        with Store(tmp_path / "limited.db") as store:
            small = toy_plan(2)
            store.want(small.name, small.trials(), small.request())
            from wonderful_team.evals.trials import RunSettings

            work = Work(store.path, small.name, runners.limited, RunSettings())
            monitor = StudyMonitor(store, small.name, lambda text, status: None)
            assert on_ray.run_on_ray(work, store, monitor, "local", 2, 1) == 1
            assert store.count(small.name, "done") == 8
    finally:
        ray.shutdown()
