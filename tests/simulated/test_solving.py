"""The whole chain with a model that makes no errors, and what happens when it is shown something else."""

from __future__ import annotations

import pytest

from wonderful_team.offline import OfflineModel

from .tables import set_table, solve


@pytest.mark.parametrize("task", ["rotate", "rearrange", "follow_order", "novel_adj", "twist", "rearrange@L3"])
def test_it_solves_what_the_oracle_solves(task: str) -> None:
    trial = solve(task)
    assert trial.outcome == "success", trial.reason
    assert trial.model == "simulated:perfect"
    assert trial.usage.usd == 0.0


def test_pushes_are_looked_at_and_planned_anew() -> None:
    trial = solve("sweep_without_exceeding", replans=10)
    assert trial.outcome == "success", trial.reason
    assert trial.verdicts


@pytest.mark.slow
@pytest.mark.parametrize("task", ["rotate", "pick_in_order_then_restore", "same_shape", "sweep_without_exceeding"])
def test_the_published_algorithms_lead_there_too(task: str) -> None:
    trial = solve(task, way="paper", replans=10 if task.startswith("sweep") else 0)
    assert trial.outcome == "success", trial.reason


@pytest.mark.parametrize("show", ["shifted", "flipped", "noised"])
@pytest.mark.parametrize("only", ["", "top"])
def test_other_pixels_mean_failure(show: str, only: str) -> None:
    assert solve("visual_manipulation", show=show, only=only).outcome == "failure"


def test_truth_grounds_what_another_model_plans() -> None:
    planner = OfflineModel()
    own = dict.fromkeys(("supervisor", "verification", "replanner", "memory"), planner)
    trial = solve("visual_manipulation", models=own)
    assert trial.outcome == "success", trial.reason


def test_truth_plans_what_another_model_grounds() -> None:
    own = dict.fromkeys(("manager", "checker", "mover"), OfflineModel())
    trial = solve("visual_manipulation", models=own)
    assert trial.outcome == "success", trial.reason


def test_errors_follow_from_the_profile_and_the_request_alone() -> None:
    for _ in range(2):
        with set_table("same_shape", profile="coarse") as table, set_table("same_shape") as right:
            from wonderful_team.contracts import ReadScene

            targets = tuple(right.targets())
            first, again, true = (one.ask(ReadScene(targets, (), one.scene.views[0])) for one in (table, table, right))
            assert first == again
            assert first != true
            off = [
                abs(a.box.x0 - b.box.x0) / (b.box.x1 - b.box.x0)
                for a, b in zip(first.targets, true.targets, strict=True)
                if a.found
            ]
            assert 0 < max(off) < 0.5
