"""How the offline model answers each kind of question."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from wonderful_team import contracts
from wonderful_team.offline.answers import crops, grounding, listing, marks, programs
from wonderful_team.offline.answers.drafting import answer_extract
from wonderful_team.offline.answers.functions import answer_write_function
from wonderful_team.offline.answers.moves import answer_draft, answer_revise
from wonderful_team.offline.answers.outcome import answer_outcome, answer_replan, answer_subgoal
from wonderful_team.offline.answers.paths import answer_review_path
from wonderful_team.offline.answers.remembering import answer_remember
from wonderful_team.offline.answers.reviewing import answer_review
from wonderful_team.offline.answers.step_review import answer_review_steps
from wonderful_team.offline.answers.steps import answer_write_steps
from wonderful_team.offline.answers.turns import answer_read_turn


def answer_plan_directly(question: contracts.PlanDirectly) -> contracts.DirectPlan:
    """What the team asks one after the other, in one answer."""
    parts = contracts.in_parts(
        question.task, question.step_kinds, question.advice, lambda part: ANSWERS[type(part)](part)
    )
    return contracts.direct_plan_type(question.step_kinds).model_validate(parts)


def answer_plan_from_list(question: contracts.PlanFromList) -> contracts.ListedPlan:
    """A plan from the pictures beside the list.

    Raises:
        UnsupportedQuestion: The list stands alone.
    """
    listing.check_pictures(question)
    task = contracts.ShownTask(question.instruction, question.views, question.slots, question.facts)
    parts = contracts.in_parts(task, question.step_kinds, question.advice, lambda part: ANSWERS[type(part)](part))
    return listing.answer_plan_from_list(question, parts)


ANSWERS: dict[type[contracts.Question], Callable[..., Any]] = {
    contracts.DraftPlan: answer_draft,
    contracts.ReviewPlan: answer_review,
    contracts.RevisePlan: answer_revise,
    contracts.ExtractTargets: answer_extract,
    contracts.LocatePoints: grounding.answer_locate,
    contracts.ChooseMark: grounding.answer_choose_mark,
    contracts.GiveBox: grounding.answer_give_box,
    contracts.ReadScene: grounding.answer_read_scene,
    contracts.Presence: crops.answer_presence,
    contracts.JudgeBox: crops.answer_judge_box,
    contracts.JudgeBoxes: crops.answer_judge_boxes,
    contracts.JudgeRevision: crops.answer_judge_revision,
    contracts.MoveBox: crops.answer_move_box,
    contracts.ChoosePoint: crops.answer_choose_point,
    contracts.ReadTurn: answer_read_turn,
    contracts.WriteSteps: answer_write_steps,
    contracts.ReviewSteps: answer_review_steps,
    contracts.WriteFunction: answer_write_function,
    contracts.ReviewPath: answer_review_path,
    contracts.Remember: answer_remember,
    contracts.JudgeSubgoal: answer_subgoal,
    contracts.JudgeOutcome: answer_outcome,
    contracts.Replan: answer_replan,
    contracts.PlanDirectly: answer_plan_directly,
    contracts.SelectMarks: grounding.answer_select_marks,
    contracts.ListObjects: listing.answer_list_objects,
    contracts.PlanFromList: answer_plan_from_list,
    contracts.DescribePictures: programs.answer_describe_pictures,
    contracts.WriteProgram: programs.answer_write_program,
    contracts.JudgeFromBoxes: programs.answer_judge_from_boxes,
    contracts.ListSubtasks: lambda question: marks.answer_list_subtasks(
        question, lambda part: ANSWERS[type(part)](part)
    ),
    contracts.ChooseMotion: marks.answer_choose_motion,
}
"""One function per kind of question; those that take independent samples also take the sample's number."""

SAMPLED: frozenset[type[contracts.Question]] = frozenset((contracts.LocatePoints,))

__all__ = ["ANSWERS", "SAMPLED"]
