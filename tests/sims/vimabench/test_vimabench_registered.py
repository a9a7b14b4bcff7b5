"""The benchmark by name, as every command knows it: listed without a copy, and run with one."""

from __future__ import annotations

import pytest

from wonderful_team import registry
from wonderful_team.api.study import Study, known_suites
from wonderful_team.core.protocols import privileged
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.evals.suites import VIMA_TASKS
from wonderful_team.sims.vimabench.finding import PATH_VARIABLE, PYTHON_VARIABLE
from wonderful_team.sims.vimabench.tasks import TASKS, partitions


@pytest.fixture
def without(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(PYTHON_VARIABLE)
    monkeypatch.delenv(PATH_VARIABLE)


@pytest.mark.usefixtures("without")
def test_tasks_and_suites_are_listed_without_a_copy() -> None:
    assert tuple(TASKS) == VIMA_TASKS
    names = registry.task_names()
    assert {f"vimabench/{name}" for name in VIMA_TASKS} <= set(names)
    assert "your own copy" in names["vimabench/rotate"]
    suites = known_suites()
    assert suites["vimabench"].tasks == tuple(f"vimabench/{name}" for name in VIMA_TASKS)
    assert [len(suites[f"vimabench/L{level}"].tasks) for level in (1, 2, 3, 4)] == [13, 13, 12, 4]
    assert all(task.startswith("tabletop/") for task in suites["vima17/L1"].tasks)
    assert registry.task_partitions()["vimabench/follow_motion"] == partitions("follow_motion") == ("L4",)


@pytest.mark.usefixtures("without")
def test_a_study_without_a_copy_ends_before_it_starts() -> None:
    with pytest.raises(ConfigError, match="git clone"):
        Study("vimabench/rotate", models=["offline"], seeds=[3])
    Study("tabletop/rotate", models=["offline"], seeds=[3])


@pytest.mark.usefixtures("without")
def test_doctor_calls_a_missing_copy_optional_and_a_broken_one_bad(monkeypatch: pytest.MonkeyPatch) -> None:
    from wonderful_team.cli.doctor import _vimabench

    assert _vimabench().ok
    assert "optional" in _vimabench().text
    monkeypatch.setenv(PYTHON_VARIABLE, "no-such-python")
    found = _vimabench()
    assert not found.ok
    assert "git clone" in found.fix


def test_doctor_names_what_the_copy_runs_on() -> None:
    from wonderful_team.cli.doctor import _vimabench

    assert _vimabench().ok
    assert "256 x 128 px" in _vimabench().text


def test_names_that_mean_nothing_are_told_with_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="vimabench/rotate"):
        registry.make_world("vimabench/rotat")
    with pytest.raises(ConfigError, match="tabletop/rotate or vimabench/rotate"):
        registry.make_world("rotate")


def test_truth_leaves_by_the_registry_alone_and_not_with_other_words() -> None:
    world = registry.make_world("vimabench/rotate", seed=1)
    assert privileged(world) is not None
    world.close()
    other = registry.make_world("vimabench/rotate", seed=1, instruction="Turn the {dragged_obj} a little.")
    assert privileged(other) is None
    other.close()
