"""The team looks again after every push, and only then; the offline model sweeps what it is asked to."""

from __future__ import annotations

from dataclasses import replace

import pytest

from wonderful_team.contracts import DraftPlan
from wonderful_team.core.actions import At, PickPlaceStep, PushStep
from wonderful_team.core.protocols import Act
from wonderful_team.core.values import Answer, Instruction, Plan, Request, StepReport, Subgoal, Target
from wonderful_team.offline import OfflineModel
from wonderful_team.planning import TeamPolicy
from wonderful_team.planning.looking import MOST_DONE, condensed, done_lines, first_part, is_uncertain
from wonderful_team.runtime import rollout
from wonderful_team.sims.tabletop import make_world

PUSHES = (PushStep("G1", At("T1"), At("T2")), PushStep("G1", At("T1"), At("T3")))
PLAN = Plan(Instruction("sweep"), "planned", (Subgoal("G1", "push the block into the frame"),), steps=PUSHES)


def test_only_plans_of_pushes_are_cut() -> None:
    assert is_uncertain(PLAN)
    assert not is_uncertain(replace(PLAN, steps=(*PUSHES, PickPlaceStep("G1", "T1", At("T2")))))
    assert not is_uncertain(replace(PLAN, steps=()))
    first = first_part(PLAN)
    assert first.steps == PUSHES[:1]
    assert first.id != PLAN.id
    (line,) = done_lines(first)
    assert line == "push from T1 to T2, for 'push the block into the frame'"
    named = replace(first, targets=(Target("T1", "object", "red block"), Target("T2", "area", "open side")))
    assert done_lines(named) == ("push from the red block to the open side, for 'push the block into the frame'",)


def test_what_ran_again_and_again_is_condensed_and_of_much_the_last() -> None:
    assert condensed(()) == ()
    assert condensed(("a", "b", "b", "b", "a")) == ("a", "b (3 times)", "a")
    assert condensed(["push"] * 100) == ("push (100 times)",)
    many = [f"push {number // 2}" for number in range(200)]
    told = condensed(many)
    assert len(told) == MOST_DONE + 1
    assert told[0] == f"{200 - 2 * MOST_DONE} steps before these"
    assert told[-1] == "push 99 (2 times)"


class Watched(TeamPolicy):
    """Keeps what the team decided."""

    def __init__(self) -> None:
        super().__init__(OfflineModel())
        self.acts: list[Act] = []

    async def decide(self, situation):  # type: ignore[no-untyped-def]
        decision = await super().decide(situation)
        if isinstance(decision, Act):
            self.acts.append(decision)
        return decision


def run(task: str, seed: int, reobserve: int) -> tuple[Watched, str]:
    world, team = make_world(task, seed=seed), Watched()
    try:
        trial = rollout(team, world, reobserve=reobserve, scorer=world.privileged)
    finally:
        world.close()
    return team, trial.outcome


def test_every_push_is_followed_by_a_look() -> None:
    team, outcome = run("sweep_without_touching", 504, reobserve=12)
    assert outcome == "success"
    assert all(act.reobserve and len(act.actions) == 1 for act in team.acts)


def test_open_loop_sweeps_in_one_plan() -> None:
    team, outcome = run("sweep_without_exceeding", 505, reobserve=0)
    assert outcome == "success"
    assert [act.reobserve for act in team.acts] == [False]


def test_picking_and_placing_runs_whole() -> None:
    team, outcome = run("visual_manipulation", 505, reobserve=5)
    assert outcome == "success"
    assert [act.reobserve for act in team.acts] == [False]


def test_a_push_that_ran_again_and_again_is_one_line_of_the_next_question(monkeypatch: pytest.MonkeyPatch) -> None:
    world, drafts = make_world("sweep_without_exceeding", seed=3), list[DraftPlan]()

    class Heard(OfflineModel):
        def answer(self, request: Request) -> Answer:
            if isinstance(request.question, DraftPlan):
                drafts.append(request.question)
            return super().answer(request)

    monkeypatch.setattr(world, "execute", lambda action: StepReport(action, True, {}))
    try:
        rollout(TeamPolicy(Heard()), world, reobserve=4)
    finally:
        world.close()
    assert [len(draft.task.done) for draft in drafts] == [0, 1, 1, 1, 1]
    assert drafts[-1].task.done[0] == f"{drafts[1].task.done[0]} (4 times)"
