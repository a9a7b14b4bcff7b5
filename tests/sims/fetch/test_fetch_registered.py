"""The Fetch world by name, as every command knows it: listed without the simulator, and run with it."""

from __future__ import annotations

import sys
import types
from pathlib import Path

import pytest

from wonderful_team import registry
from wonderful_team.api.known_suites import check_levels, known_suites
from wonderful_team.api.study import Study
from wonderful_team.core.protocols import privileged
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.evals.paper_tables import PAPER_TABLES
from wonderful_team.evals.suites import OPEN_LOOP, Suite
from wonderful_team.registry.worlds import own_tiers
from wonderful_team.sims.fetch import FetchWorld
from wonderful_team.sims.fetch.finding import PYTHON_VARIABLE, check_ready, find_python
from wonderful_team.sims.fetch.remote import bench


@pytest.fixture
def without(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(PYTHON_VARIABLE)
    monkeypatch.setattr("wonderful_team.sims.fetch.finding.importlib.util.find_spec", lambda name: None)


@pytest.mark.usefixtures("without")
def test_without_the_simulator_tasks_are_listed_and_the_error_names_every_step() -> None:
    assert {"fetch/lid", "fetch/lid_two"} <= set(registry.task_names())
    assert own_tiers("fetch/lid") == ("depth",)
    with pytest.raises(ConfigError) as caught:
        FetchWorld("lid")
    for word in (
        "python3 -m venv",
        'pip install "gymnasium-robotics==1.4.2" "mujoco<3.12"',
        f"export {PYTHON_VARIABLE}=",
    ):
        assert word in str(caught.value)
    with pytest.raises(ConfigError, match=PYTHON_VARIABLE):
        Study("fetch/lid", models=["offline"], seeds=[3])


@pytest.mark.usefixtures("without")
def test_doctor_calls_it_optional_and_a_broken_one_bad(monkeypatch: pytest.MonkeyPatch) -> None:
    from wonderful_team.cli.doctor import _fetch

    assert _fetch().ok
    assert "optional" in _fetch().text
    monkeypatch.setenv(PYTHON_VARIABLE, "no-such-python")
    found = _fetch()
    assert not found.ok
    assert "pip install" in found.fix


def test_doctor_names_what_it_runs_on() -> None:
    from wonderful_team.cli.doctor import _fetch

    assert _fetch().ok
    assert "640 x 480 px" in _fetch().text
    assert check_ready() == {"stand-in": "1"}


def test_an_interpreter_that_is_none_or_cannot_run_it_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    bare = tmp_path / "python"
    bare.write_text('#!/bin/sh\necho "no numpy here" >&2\nexit 78\n', encoding="utf-8")
    bare.chmod(0o755)
    monkeypatch.setenv(PYTHON_VARIABLE, str(bare))
    with pytest.raises(ConfigError, match=r"no numpy here(.|\n)*pip install"):
        FetchWorld("lid")
    monkeypatch.setenv(PYTHON_VARIABLE, str(tmp_path / "nothing"))
    with pytest.raises(ConfigError, match="valid is a Python interpreter"):
        find_python()


def test_a_mujoco_that_is_too_new_for_the_package_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("gymnasium_robotics", "gymnasium_robotics.envs", "gymnasium_robotics.envs.fetch"):
        monkeypatch.setitem(sys.modules, name, types.ModuleType(name))
    name = "gymnasium_robotics.envs.fetch.fetch_env"
    monkeypatch.setitem(sys.modules, name, types.ModuleType(name))
    monkeypatch.setitem(sys.modules, "mujoco", types.ModuleType("mujoco"))
    monkeypatch.setattr(sys.modules["mujoco"], "__version__", "3.12.0", raising=False)
    with pytest.raises(bench.Refused, match=r"mujoco 3\.12\.0 is too new for gymnasium-robotics") as caught:
        bench.load()
    assert caught.value.kind == "missing"
    monkeypatch.setattr(sys.modules["mujoco"], "__version__", "3.11.0")
    assert bench.load()[0] is sys.modules["mujoco"]
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(bench.Refused, match="fetch_env"):
        bench.load()


def test_names_and_truth_as_in_every_world() -> None:
    with pytest.raises(UnknownNameError, match="fetch/lid"):
        registry.make_world("fetch/lit")
    world = registry.make_world("fetch/lid", seed=1)
    assert privileged(world) is not None
    world.close()
    other = registry.make_world("fetch/lid", seed=1, instruction="Tidy up.")
    assert privileged(other) is None
    other.close()


def test_a_study_takes_what_may_stand_behind_a_tasks_name() -> None:
    check_levels([Suite("lid", ("fetch/lid@depth=2",), OPEN_LOOP)])
    with pytest.raises(ConfigError, match="depth=1 to depth=3"):
        check_levels([Suite("lid", ("fetch/lid@nudge=1",), OPEN_LOOP)])


def test_the_papers_table_runs_it() -> None:
    table = PAPER_TABLES["fetch"]
    assert not table.lacks
    suites = known_suites()
    single, again = (suites[name] for name in table.suites)
    assert single.tasks == again.tasks == ("fetch/lid", "fetch/lid_two")
    assert (single.protocol.replans, again.protocol.replans) == (0, 3)
