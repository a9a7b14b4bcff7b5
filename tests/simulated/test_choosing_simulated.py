"""Simulated models by name: which worlds give them truth, and what is said where there is none."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team.api.trial import check_isolation, model_of
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.models.error_profile import (
    Boxes,
    Confusion,
    Count,
    Detection,
    Distribution,
    ErrorProfile,
    Pointing,
    SceneKind,
)
from wonderful_team.simulated import profile_named
from wonderful_team.simulated.profiles import from_measured


@pytest.fixture
def world() -> Iterator[Any]:
    made = wt.make_world("tabletop/rotate", seed=500)
    yield made
    made.close()


def test_a_rollout_hands_the_world_over_and_the_page_says_simulated(world: Any, tmp_path: Path) -> None:
    trial = wt.rollout(wt.Team(model="simulated:perfect"), world, seed=500, out=tmp_path)
    assert trial.outcome == "success", trial.reason
    assert trial.model == "simulated:perfect"
    assert 'class="badge simulated"' in trial.page.read_text(encoding="utf-8")


def test_a_plan_needs_the_world_and_works_with_it(world: Any, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"wt\.Team\(model='simulated:perfect', world=world\)"):
        wt.Team(model="simulated:perfect", out=tmp_path).plan(world.observe(), world.instruction)
    with pytest.raises(ConfigError, match="a picture alone has none"):
        wt.Team(model={"*": "offline", "manager": "simulated:perfect"}, out=tmp_path).ground(world.observe(), ["cup"])
    assert not list(tmp_path.iterdir())
    team = wt.Team(model="simulated:perfect", world=world, out=tmp_path)
    made = team.plan(world.observe(), world.instruction, limits=world.limits)
    assert made.plan.status == "planned"
    photo = wt.Observation({"top": wt.View("top", "top", 0.0, np.full((320, 640, 3), 200, np.uint8))})
    assert team.plan(photo, world.instruction, limits=world.limits).plan.status == "needs_clarification"


def test_a_replaced_instruction_has_no_truth(tmp_path: Path) -> None:
    world = wt.make_world("tabletop/rotate", seed=500, instruction="Rotate the {dragged_obj} 10 degrees.")
    with pytest.raises(ConfigError, match="the instruction was replaced by 'Rotate the"):
        wt.rollout(wt.Team(model="simulated:perfect"), world, out=tmp_path)


def test_a_world_without_truth_is_refused(world: Any, tmp_path: Path) -> None:
    class Bare:
        vocabulary, limits, instruction = world.vocabulary, world.limits, world.instruction
        observe, execute, stop, close = world.observe, world.execute, world.stop, world.close

    with pytest.raises(ConfigError, match="this Bare has none"):
        wt.rollout(wt.Team(model="simulated:perfect"), Bare(), out=tmp_path)


def test_profiles_have_names() -> None:
    assert not profile_named("perfect").errs
    assert profile_named("coarse").errs
    with pytest.raises(
        UnknownNameError, match="Known: coarse, hasty, paper-claude-3-opus, paper-gpt-4-turbo, paper-gpt-4o, perfect"
    ):
        wt.make_model("simulated:sharp")


def test_a_measured_profile_becomes_an_error_model() -> None:
    none = Count(count=0, n=10)
    sizes = Distribution(n=10, quantiles=[0.0, 0.0, 0.01, 0.02, 0.05, 0.1, 0.2])
    measured = ErrorProfile(
        scenes=[SceneKind(kind="synthetic", seeds=[1], targets=10)],
        detection=Detection(missed=Count(count=2, n=10), imagined=none),
        pointing=Pointing(radial=sizes, spread=(0.01, 0.02), wild=Count(count=1, n=10), wild_beyond=0.1),
        boxes=Boxes(iou=sizes, edge=sizes, wild=none),
        judgement=Confusion(counts={}, wrongly_accepted=Count(count=3, n=10), wrongly_refused=none),
        failed_requests=none,
    )
    made = from_measured("mine", measured)
    assert (made.missed, made.wrong_thing, made.judgement.off[0], made.spread) == (0.2, 0.1, 0.3, (0.01, 0.02))
    assert made.edge == pytest.approx(0.02 / 0.6745)
    assert made.errs


TEAM = ("manager", "checker", "mover")


def test_isolation_gives_truth_the_other_part(world: Any) -> None:
    planning = model_of("offline", "planning", world, TEAM)
    assert planning["*"] == "offline"
    assert {planning[role].name for role in ("manager", "checker", "mover")} == {"simulated:perfect"}
    grounding = model_of("offline", "grounding", world, TEAM)
    assert grounding["*"].name == "simulated:perfect"
    assert {grounding[role] for role in ("manager", "checker", "mover")} == {"offline"}
    assert model_of("offline", "", world, TEAM) == "offline"
    with pytest.raises(ConfigError, match="valid are planning"):
        check_isolation("everything")
