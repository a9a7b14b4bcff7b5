"""How the offline model answers each kind of question."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from wonderful_team.contracts import (
    ChooseMark,
    ChoosePoint,
    DirectPlan,
    DraftPlan,
    ExtractTargets,
    GiveBox,
    JudgeBox,
    JudgeBoxes,
    JudgeOutcome,
    JudgeRevision,
    ListedPlan,
    ListObjects,
    LocatePoints,
    MoveBox,
    PlanDirectly,
    PlanFromList,
    Presence,
    Question,
    ReadScene,
    ReadTurn,
    Remember,
    Replan,
    ReviewPath,
    ReviewPlan,
    ReviewSteps,
    RevisePlan,
    SelectMarks,
    ShownTask,
    WriteSteps,
    direct_plan_type,
    in_parts,
)
from wonderful_team.offline.answers import listing
from wonderful_team.offline.answers.crops import (
    answer_choose_point,
    answer_judge_box,
    answer_judge_boxes,
    answer_judge_revision,
    answer_move_box,
    answer_presence,
)
from wonderful_team.offline.answers.drafting import answer_extract
from wonderful_team.offline.answers.grounding import (
    answer_choose_mark,
    answer_give_box,
    answer_locate,
    answer_read_scene,
    answer_select_marks,
)
from wonderful_team.offline.answers.moves import answer_draft, answer_revise
from wonderful_team.offline.answers.outcome import answer_outcome, answer_replan
from wonderful_team.offline.answers.paths import answer_review_path
from wonderful_team.offline.answers.remembering import answer_remember
from wonderful_team.offline.answers.reviewing import answer_review
from wonderful_team.offline.answers.step_review import answer_review_steps
from wonderful_team.offline.answers.steps import answer_write_steps
from wonderful_team.offline.answers.turns import answer_read_turn


def answer_plan_directly(question: PlanDirectly) -> DirectPlan:
    """What the team asks one after the other, in one answer."""
    parts = in_parts(question.task, question.step_kinds, question.advice, lambda part: ANSWERS[type(part)](part))
    return direct_plan_type(question.step_kinds).model_validate(parts)


def answer_plan_from_list(question: PlanFromList) -> ListedPlan:
    """A plan from the pictures beside the list.

    Raises:
        UnsupportedQuestion: The list stands alone.
    """
    listing.check_pictures(question)
    task = ShownTask(question.instruction, question.views, question.slots, question.facts)
    parts = in_parts(task, question.step_kinds, question.advice, lambda part: ANSWERS[type(part)](part))
    return listing.answer_plan_from_list(question, parts)


ANSWERS: dict[type[Question], Callable[..., Any]] = {
    DraftPlan: answer_draft,
    ReviewPlan: answer_review,
    RevisePlan: answer_revise,
    ExtractTargets: answer_extract,
    LocatePoints: answer_locate,
    ChooseMark: answer_choose_mark,
    GiveBox: answer_give_box,
    ReadScene: answer_read_scene,
    Presence: answer_presence,
    JudgeBox: answer_judge_box,
    JudgeBoxes: answer_judge_boxes,
    JudgeRevision: answer_judge_revision,
    MoveBox: answer_move_box,
    ChoosePoint: answer_choose_point,
    ReadTurn: answer_read_turn,
    WriteSteps: answer_write_steps,
    ReviewSteps: answer_review_steps,
    ReviewPath: answer_review_path,
    Remember: answer_remember,
    JudgeOutcome: answer_outcome,
    Replan: answer_replan,
    PlanDirectly: answer_plan_directly,
    SelectMarks: answer_select_marks,
    ListObjects: listing.answer_list_objects,
    PlanFromList: answer_plan_from_list,
}
"""One function per kind of question; those that take independent samples also take the sample's number."""

SAMPLED: frozenset[type[Question]] = frozenset((LocatePoints,))

__all__ = ["ANSWERS", "SAMPLED"]
