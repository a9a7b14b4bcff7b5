"""A pick point in the hole of a ring: which member catches it, and what it costs when nobody can."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from wonderful_team.contracts import PointPx, ReadScene, RolePoint
from wonderful_team.core.values import Answer, Request, Trial
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.runtime import rollout
from wonderful_team.sims.tabletop import make_world
from wonderful_team.simulated import PROFILES, SimulatedModel

TASK, SEED = "same_shape", 900004
"""Two rings have to be put into a bowl."""


class Middling:
    """A Manager who takes the middle of every box for the point to pick at, at its first look."""

    name = "middling"

    def __init__(self, model: Any) -> None:
        self.model = model

    async def answer(self, request: Request) -> Answer:
        answer: Answer = await self.model.answer(request)
        if request.contract != ReadScene.__name__:
            return answer
        items = []
        for item in answer.value.targets:
            box = item.box.as_box
            middle = RolePoint(role="pick", point=PointPx(x=box.centre[0], y=box.centre[1]))
            points = [middle if point.role == "pick" else point for point in item.points]
            items.append(item.model_copy(update={"points": points}))
        return replace(answer, value=answer.value.model_copy(update={"targets": items}))


def run(members: str) -> Trial:
    world = make_world(TASK, seed=SEED)
    try:
        model = SimulatedModel(world.privileged, world.instruction, PROFILES["perfect"])
        team = TeamPolicy({"*": model, "manager": Middling(model)}, TeamConfig(mode="lean", ablation=members))
        return rollout(team, world, scorer=world.privileged, seed=SEED, max_age_s=None)
    finally:
        world.close()


def told(trial: Trial, who: str) -> list[str]:
    grounded = trial.plans[-1].grounded.values()
    return [event.text for item in grounded for event in item.history if event.text.startswith(f"{who}: reject the")]


@pytest.mark.parametrize(
    ("members", "who"), [("full", "Checker"), ("s1", "Checker"), ("s2", "Verification"), ("s3", "")]
)
def test_the_checker_catches_it_else_verification_else_nobody(members: str, who: str) -> None:
    """s1 has no Verification, s2 no Checker, s3 neither."""
    trial = run(members)
    assert (trial.outcome == "success") is bool(who), trial.reason
    for one in ("Checker", "Verification"):
        assert bool(told(trial, one)) is (one == who)
    doubts = [doubt.kind for plan in trial.plans for doubt in plan.questions]
    assert ("wrong_point" in doubts) is (who == "Verification")
