"""What a model that answers rightly is asked for one plan: few questions by the lean team, every round by the paper's."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import pytest

from wonderful_team import registry
from wonderful_team.core.protocols import Event
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.runtime import rollout

TWO_TARGETS = "tabletop/visual_manipulation"
PUSHES = "tabletop/sweep_without_exceeding"


@dataclass
class Asked:
    kinds: Counter[str] = field(default_factory=Counter)

    def on_event(self, event: Event) -> None:
        if event.kind == "request":
            self.kinds[event.content.contract] += 1


def asked_for(task: str, mode: str) -> Counter[str]:
    """One trial with one attempt, which has to succeed."""
    world, heard = registry.make_world(task, 900000), Asked()
    try:
        model = registry.make_model("simulated:perfect", world=world)
        team = TeamPolicy(model, TeamConfig(mode=mode), subscribers=(heard,))  # type: ignore[arg-type]
        trial = rollout(team, world, replans=0, scorer=world.privileged, seed=900000, max_age_s=None)
    finally:
        world.close()
    assert trial.outcome == "success", trial.reason
    return heard.kinds


def test_two_targets_and_no_doubt_take_the_lean_team_at_most_five_requests():
    kinds = asked_for(TWO_TARGETS, "lean")
    assert sum(kinds.values()) <= 5, kinds
    assert not {"Remember", "WriteSteps", "JudgeBox"} & set(kinds)


def test_two_targets_take_the_papers_team_every_round_and_memory_none():
    kinds = asked_for(TWO_TARGETS, "paper")
    assert sum(kinds.values()) == 23, kinds
    assert (kinds["LocatePoints"], kinds["ChooseMark"], kinds["ChoosePoint"], kinds["Presence"]) == (6, 2, 4, 2)
    assert kinds["Remember"] == 0


@pytest.mark.parametrize("contract", ["ReviewPlan", "WriteSteps"])
def test_pushes_call_for_more(contract):
    assert asked_for(PUSHES, "lean")[contract] == 1
