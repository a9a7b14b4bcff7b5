"""Rules that a model needs in order not to fall over plain scenes stand in the words of everyone who needs them."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import pytest

from tests.agents.question_samples import SAMPLES
from tests.agents.test_agent_requests import build
from wonderful_team.agents import ROLES, Prompts

TEXTS = {name: " ".join(re.sub(r"{%.*?%}", "", text).split()) for name, text in Prompts.default().texts.items()}
"""Every file with all its passages."""
SEEING = [name for name, role in ROLES.items() if "picture of one thing alone" in " ".join(role.system.split())]
MATERIAL = "never a hole"
LATER = "as it will be once the earlier subgoals are done"
RULES = [
    ("manager.LocatePoints.md", "The point must lie on its solid material"),
    ("manager.LocatePoints.md", MATERIAL),
    ("manager.LocatePoints.md", LATER),
    ("manager.LocatePoints.md", "do not move into a corner"),
    ("supervisor.LocatePoints.md", MATERIAL),
    ("manager.ChooseMark.md", "never in a hole"),
    ("manager.ChooseMark.md", LATER),
    ("manager.ReadScene.md", LATER),
    ("manager.ReadScene.md", "do not move into a corner"),
    ("manager.ChoosePoint.md", LATER),
    ("manager.ReadScene.md", "push_end: where the front of the tool stops"),
    ("manager.ChoosePoint.md", "push_end: where the front of the tool stops"),
    ("supervisor.DraftPlan.md", "push_end: where the front of the tool stops"),
    ("supervisor.WriteSteps.md", "The middle of the thing that is moved lands there, wherever it is picked"),
    ("supervisor.WriteSteps.md", "A target that an earlier step moved means the place where it then lies"),
    ("verification.ReviewSteps.md", "The thing's middle lands at the place, wherever it is picked"),
    ("supervisor.DraftPlan.md", '"any" means one of your choice'),
    ("supervisor.DraftPlan.md", "a place must be free by the time something goes there"),
    ("supervisor.DraftPlan.md", "Several things that go into one container may lie on each other"),
    (
        "supervisor.DraftPlan.md",
        "How things are turned there counts too, unless what is known of the robot says otherwise",
    ),
    ("verification.ReviewPlan.md", "Several things that go into one container may lie on each other"),
    ("verification.ReviewPlan.md", "taken until a later subgoal clears it"),
    ("supervisor.DraftPlan.md", "on what an earlier subgoal moved, where it then lies"),
    ("supervisor.DraftPlan.md", "stay where they are, also when a picture of what is wanted leaves them out"),
    ("supervisor.DraftPlan.md", "Going back to how things were takes back what was moved out of the way, too"),
    ("supervisor.DraftPlan.md", "or that a helper function's path is only led over"),
    ("checker.JudgeBoxes.md", "A lid or a thing that covers a place now is no reason against it"),
    ("checker.JudgeBox.md", "push_start: beside the target, clear of it; of an area, inside it"),
    ("verification.ReviewSteps.md", "Approve when no answer speaks against a step, nor against the plan"),
    ("verification.ReviewSteps.md", "What a gripper carries is one arrow"),
    (
        "verification.ReviewSteps.md",
        "a strip that runs close along what must not be touched, with much more room on its other side",
    ),
    ("checker.JudgeRevision.md", "what is still wrong with the box that is kept"),
]


KINDS = [
    ("DraftPlan", "push", "what a second push of it needs is a guess until there is a new picture"),
    ("DraftPlan", "push", "A second push needs no start of its own"),
    ("RevisePlan", "push", "what it must keep away from"),
    ("WriteSteps", "push", "it is where the front of the tool stops"),
    ("WriteSteps", "close", "What is screwed on is gripped tightly and turned before it is lifted"),
    ("WriteSteps", "follow", "contact surface: the tool is lowered"),
]


@pytest.mark.parametrize(("contract", "kind", "rule"), KINDS)
def test_rules_for_a_kind_of_step_are_told_of_robots_that_have_it_alone(contract: str, kind: str, rule: str) -> None:
    sample: Any = next(one for one in SAMPLES if one.contract == contract)

    def told(*kinds: str) -> str:
        asked = build(replace(sample, step_kinds=kinds))
        return asked.system + "".join(getattr(part, "text", "") for part in asked.parts)

    assert rule in told("pick_place", kind)
    assert rule not in told("pick_place")


@pytest.mark.parametrize(("file", "rule"), RULES)
def test_a_rule_stands_where_it_is_needed(file: str, rule: str) -> None:
    assert rule in TEXTS[file]


def test_everyone_who_sees_examples_reads_them_alike() -> None:
    assert set(SEEING) == {"supervisor", "verification", "manager", "checker", "mover"}
    for role in SEEING:
        text = TEXTS[f"{role}.md"]
        assert "A plain grey example on white: the right thing has this shape, with any surface" in text
        assert "Where words and example differ, the words decide" in text
        assert "is a different thing" not in text


def test_north_is_said_to_everyone_who_sees() -> None:
    for role in ROLES:
        if role != "memory":
            assert "and so is north unless something else is said" in TEXTS[f"{role}.md"]


def test_the_review_of_steps_says_nothing_yet_only_when_nothing_was_asked() -> None:
    review = next(sample for sample in SAMPLES if sample.contract == "ReviewSteps")
    assert "nothing yet" not in "".join(getattr(part, "text", "") for part in build(review).parts)
