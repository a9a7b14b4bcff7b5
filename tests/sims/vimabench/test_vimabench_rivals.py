"""Rivals at work in the adapter: views of 256 x 128 px, no depth."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import wonderful_team as wt
from tests.planning.baselines.runs import PLANNERS
from wonderful_team.sims.vimabench import VimaWorld


@pytest.mark.parametrize("name", PLANNERS)
def test_every_rival_runs_in_it(name: str, open_world: Callable[..., VimaWorld], tmp_path: Path) -> None:
    trial = wt.rollout(wt.Method(method=name, model="simulated:perfect"), open_world("rotate", seed=3), out=tmp_path)
    assert (trial.outcome, trial.stage) == ("success", None), trial.reason
    assert trial.page.is_file()
