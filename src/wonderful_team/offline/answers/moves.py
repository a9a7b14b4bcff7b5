"""DraftPlan and RevisePlan: the plan, with the pick and place of every subgoal that is carried out by one."""

from __future__ import annotations

from collections.abc import Sequence

from wonderful_team.contracts import (
    DraftPlan,
    MoveDraft,
    PlainPlan,
    PlanDraft,
    PlanRevision,
    RevisePlan,
    SubgoalDraft,
    arm_steps,
    can_carry,
)
from wonderful_team.contracts.shown import ShownTask
from wonderful_team.core.values import Target
from wonderful_team.errors import UnsupportedQuestion, WonderfulTeamError
from wonderful_team.offline.answers.drafting import draft
from wonderful_team.offline.answers.reviewing import findings, lacking
from wonderful_team.offline.answers.steps import steps_of_subgoal
from wonderful_team.offline.eyes import Eyes, eyes_of_task

IN_PLACE = {"trace", "shake", "twist"}
"""Kinds of aims that nothing but their own kind of step carries out: a robot without it is told so before anything is looked for."""


def answer_draft(question: DraftPlan) -> PlanDraft | PlainPlan:
    """Read the instruction, look at the picture, write the plan."""
    plan, aims = draft(question.task, question.with_targets, question.advice)
    lacks = next((text for aim in aims.aims for text in lacking({aim.kind} & IN_PLACE, question.step_kinds)), "")
    if lacks and plan.subgoals:
        raise UnsupportedQuestion(
            "offline", "DraftPlan", f"{lacks} is not among what this robot does: {', '.join(question.step_kinds)}"
        )
    if question.plain:
        return question.in_form(plan)
    return with_moves(plan, question.task, question.step_kinds) if question.with_targets else plan


def answer_revise(question: RevisePlan) -> PlanRevision:
    """Change the plan where the doubt is right, else say why it stands."""
    found = findings(question.task, question.subgoals, question.targets, question.step_kinds)
    concerned = [item for item in found if item.about == question.doubt.about] or found
    if not concerned:
        about = question.doubt.about
        why = f"Derived again from the instruction and the picture, nothing in {about} is amiss."
        stands = f"{about} follows from the instruction and the picture; the plan stands."
        return PlanRevision(reasoning=why, decision="keep", answer=stands, plan=None)
    plan, _ = draft(question.task, question.with_targets)
    if question.with_targets:
        plan = with_moves(plan, question.task, question.step_kinds)
    doubt = concerned[0].question
    told = f"You are right: {doubt} The plan was written anew."
    return PlanRevision(reasoning=f"The doubt is right: {doubt}", decision="revise", answer=told, plan=plan)


def with_moves(plan: PlanDraft, task: ShownTask, step_kinds: Sequence[str]) -> PlanDraft:
    """The plan with the move of every subgoal that one pick and place carries out."""
    if not plan.subgoals or not ("pick_place" in step_kinds or can_carry(step_kinds)):
        return plan
    eyes, targets = eyes_of_task(task), plan.to_targets()
    subgoals = [item.model_copy(update={"move": _move(item, targets, step_kinds, eyes)}) for item in plan.subgoals]
    return plan.model_copy(update={"subgoals": subgoals})


def _move(subgoal: SubgoalDraft, targets: Sequence[Target], step_kinds: Sequence[str], eyes: Eyes) -> MoveDraft | None:
    """The one pick and place that would be written for a subgoal; None where it takes something else."""
    goal = subgoal.to_subgoal()
    try:
        wanted = steps_of_subgoal(goal, targets, step_kinds, eyes)
        carried = steps_of_subgoal(goal, targets, ("pick_place",), eyes)
    except WonderfulTeamError:
        # What cannot be written as steps is refused by name when steps are asked for.
        return None
    if len(carried) != 1:
        return None
    move = MoveDraft.model_validate({name: carried[0][name] for name in MoveDraft.model_fields})
    if wanted == carried:
        return move
    plain = can_carry(step_kinds) and wanted == arm_steps(
        goal.id, move.pick, move.place.model_dump(), move.rotate_deg, step_kinds
    )
    return move if plain else None
