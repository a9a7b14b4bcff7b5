"""A model that answers from a simulator's truth, as it is seen through the pictures that it is shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from wonderful_team.contracts import (
    ChooseMark,
    ChooseMotion,
    ChoosePoint,
    DescribePictures,
    DirectPlan,
    DraftPlan,
    ExtractTargets,
    GiveBox,
    JudgeBox,
    JudgeBoxes,
    JudgeFromBoxes,
    JudgeOutcome,
    JudgeRevision,
    JudgeSubgoal,
    ListObjects,
    ListSubtasks,
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
    WriteFunction,
    WriteProgram,
    WriteSteps,
    direct_plan_type,
    in_parts,
)
from wonderful_team.core.caps import Estimate
from wonderful_team.core.protocols import SceneTruth
from wonderful_team.core.values import Answer, Instruction, Request, Usage
from wonderful_team.errors import UnsupportedQuestion
from wonderful_team.simulated import crops, drafting, grounding, listing, marks, outcome, paths, programs, turns
from wonderful_team.simulated.context import Context
from wonderful_team.simulated.error_sampler import ErrorSampler
from wonderful_team.simulated.profile import Profile
from wonderful_team.simulated.profiles import PROFILES


def answer_plan_directly(context: Context, question: PlanDirectly) -> DirectPlan:
    """What the team asks one after the other, in one answer."""
    parts = in_parts(
        question.task, question.step_kinds, question.advice, lambda part: ANSWERS[type(part)](context, part)
    )
    return direct_plan_type(question.step_kinds).model_validate(parts)


ANSWERS: dict[type[Question], Callable[[Context, Any], Any]] = {
    DraftPlan: drafting.answer_draft,
    ReviewPlan: drafting.answer_review,
    RevisePlan: drafting.answer_revise,
    ExtractTargets: drafting.answer_extract,
    WriteSteps: drafting.answer_write_steps,
    ReviewSteps: drafting.answer_review_steps,
    LocatePoints: grounding.answer_locate,
    ChooseMark: grounding.answer_choose_mark,
    GiveBox: grounding.answer_give_box,
    ReadScene: grounding.answer_read_scene,
    Presence: crops.answer_presence,
    JudgeBox: crops.answer_judge_box,
    JudgeBoxes: crops.answer_judge_boxes,
    JudgeRevision: crops.answer_judge_revision,
    MoveBox: crops.answer_move_box,
    ChoosePoint: crops.answer_choose_point,
    ReadTurn: turns.answer_read_turn,
    JudgeSubgoal: outcome.answer_subgoal,
    JudgeOutcome: outcome.answer_outcome,
    Replan: outcome.answer_replan,
    Remember: outcome.answer_remember,
    WriteFunction: paths.answer_write_function,
    ReviewPath: paths.answer_review_path,
    PlanDirectly: answer_plan_directly,
    SelectMarks: grounding.answer_select_marks,
    ListObjects: listing.answer_list_objects,
    PlanFromList: listing.answer_plan_from_list,
    DescribePictures: programs.answer_describe_pictures,
    WriteProgram: programs.answer_write_program,
    JudgeFromBoxes: programs.answer_judge_from_boxes,
    ListSubtasks: marks.answer_list_subtasks,
    ChooseMotion: marks.answer_choose_motion,
}
"""One function per kind of question."""


class SimulatedModel:
    """Answers every question rightly from truth, where the pictures show it; blind where they do not.

    It keeps nothing from one request to the next but what it measured of pictures and the plan of the newest look.

    Args:
        truth: Of one world.
        instruction: What that truth judges; another instruction is refused.
        profile: The error model; perfect makes no errors.
    """

    def __init__(
        self, truth: SceneTruth, instruction: Instruction | None = None, profile: Profile = PROFILES["perfect"]
    ) -> None:
        self.name = f"simulated:{profile.name}"
        self.profile = profile
        self._context = Context(truth, instruction, self.name, profile)

    def estimate(self, request: Request) -> Estimate:
        """What a request may cost: nothing, answered or not."""
        return Estimate(0, 0, 0.0, 0.0)

    async def answer(self, request: Request) -> Answer:
        """Answer one request.

        Raises:
            UnsupportedQuestion: A kind of question that truth does not answer, or another instruction.
        """
        kind = type(request.question)
        if kind not in ANSWERS:
            raise UnsupportedQuestion(self.name, request.contract, "the truth of a table knows no programs")
        sampler = ErrorSampler(self.profile, request) if self.profile.errs else None
        # Nothing is awaited here: a question is answered whole before the next one begins.
        self._context.sampler = sampler
        value = ANSWERS[kind](self._context, request.question)
        value, repairs = request.question.validate(value if sampler is None else sampler.perturb(value, request))
        usage = Usage(calls=1, pictures=len(request.pictures), usd=0.0)
        return Answer(value, usage, self.name, value.model_dump_json(), 1, "simulated", repairs)
