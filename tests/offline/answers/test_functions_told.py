"""A model that writes no helper functions plans as before where it is told of some."""

from __future__ import annotations

import wonderful_team as wt
from wonderful_team.agents import build_request
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import DraftPlan, Question, Replan, RevisePlan
from wonderful_team.core.values import Critique, Verdict
from wonderful_team.offline import OfflineModel

KEPT = ("path_1: a circle round T1 (T1 was the red block)",)


def test_being_told_of_functions_changes_no_answer() -> None:
    world = wt.make_world("tabletop/visual_manipulation", seed=3)
    try:
        scene = SceneShown(world.observe(), world.instruction, world.vocabulary, world.limits, world.facts)
    finally:
        world.close()
    kinds = scene.vocabulary.step_kinds

    def said(question: Question):
        return OfflineModel().answer(build_request(question, id="0/plan/main/x/1", stage="plan")).value

    draft = said(DraftPlan(scene.task, kinds, True))
    goals, targets = draft.to_subgoals(), draft.to_targets()
    doubt = Critique("G1", "collision", "Is the way free?")
    failed = (Verdict("G1", "not_done", "it slipped", "it lies beside it"),)
    assert said(DraftPlan(scene.task, kinds, True, (), KEPT)) == draft
    assert said(RevisePlan(scene.task, kinds, goals, targets, doubt, True, KEPT)) == said(
        RevisePlan(scene.task, kinds, goals, targets, doubt, True)
    )
    assert said(Replan(scene.task, goals, failed, (), 1, KEPT)) == said(Replan(scene.task, goals, failed, (), 1))
