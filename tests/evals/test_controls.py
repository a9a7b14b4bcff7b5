"""The controls in worlds of different actions: the oracle solves the scene, chance does not."""

from __future__ import annotations

import pytest

from wonderful_team.api.trial import run_trial
from wonderful_team.evals.trials import Condition, RunSettings, TrialSpec


@pytest.mark.parametrize("task", ["tabletop/rearrange", "tabletop/sweep_without_exceeding", "arms/shake"])
def test_the_oracle_solves_and_chance_does_not(task: str) -> None:
    if task.startswith("arms/"):
        pytest.importorskip("mink", reason="the extra `arms` is not installed")
    ended = {
        name: run_trial(TrialSpec(task, 6000, Condition(name, "-")), RunSettings()) for name in ("oracle", "random")
    }
    assert ended["oracle"].outcome == "success", ended["oracle"].reason
    # It acted: where it cannot, it says nothing about the scorer.
    assert ended["random"].outcome == "failure"
    assert "this world runs" not in ended["random"].reason
