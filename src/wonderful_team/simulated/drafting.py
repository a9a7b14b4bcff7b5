"""DraftPlan, RevisePlan, ExtractTargets, WriteSteps, ReviewPlan and ReviewSteps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from wonderful_team.contracts import (
    ClarificationDraft,
    DraftPlan,
    ExtractTargets,
    PlainPlan,
    PlanDraft,
    PlanReview,
    PlanRevision,
    ReviewPlan,
    ReviewSteps,
    RevisePlan,
    ShownSlot,
    ShownTask,
    StepList,
    SubgoalTargets,
    TargetList,
    WalkedReview,
    WriteSteps,
    arm_steps,
    can_carry,
    step_list_type,
)
from wonderful_team.contracts.review_plan import CritiqueDraft
from wonderful_team.core.actions import PickPlaceStep, Step, places_of
from wonderful_team.core.pictures import PathMark
from wonderful_team.core.values import Subgoal, Target
from wonderful_team.errors import UnsupportedQuestion
from wonderful_team.simulated.context import Context
from wonderful_team.simulated.draft import Written, key_of

SAME_ANGLE_DEG = 5.0
"""Turns that differ by less are the same: nearer than pictures show them [degrees]."""
BLIND = "one of the pictures of this task shows nothing that was ever there"


def answer_draft(context: Context, question: DraftPlan) -> PlanDraft | PlainPlan:
    """The plan that truth asks for, when every picture that shows the task is true."""
    task = context.task(question.task)
    if task is None:
        return question.in_form(blind_plan())
    return question.in_form(plan_draft(task.plan, question.with_targets))


def plan_draft(plan: Written, with_targets: bool) -> PlanDraft:
    """A written plan as an answer."""
    subgoals = [
        item if with_targets else item.model_copy(update={"targets": [], "move": None}) for item in plan.subgoals
    ]
    targets = plan.targets if with_targets else []
    reasoning = (
        f"{len(subgoals)} moves lead from this table to what is asked." if subgoals else "Nothing is left to do."
    )
    return PlanDraft(reasoning=reasoning, subgoals=subgoals, targets=targets, mode="one_step", clarification=None)


def blind_plan() -> PlanDraft:
    """What one says who sees nothing to plan from."""
    asked = ClarificationDraft(
        question=f"Which table and which pictures are meant? As they are shown, {BLIND}.", choices=[]
    )
    return PlanDraft(reasoning=BLIND, subgoals=[], targets=[], mode="one_step", clarification=asked)


def answer_revise(context: Context, question: RevisePlan) -> PlanRevision:
    """Keep a plan that is right; write another's anew."""
    task = context.task(question.task)
    if task is None:
        said = f"I cannot judge it: {BLIND}."
        return PlanRevision(reasoning=said, decision="keep", answer=said, plan=None)
    if task.right.is_plan(question.subgoals):
        said = "The plan leads to what is asked."
        return PlanRevision(reasoning=said, decision="keep", answer=said, plan=None)
    said = "The plan is written anew."
    draft = plan_draft(task.right, question.with_targets)
    return PlanRevision(reasoning=said, decision="revise", answer=said, plan=draft)


def answer_extract(context: Context, question: ExtractTargets) -> TargetList:
    """The targets of its own plan.

    Raises:
        UnsupportedQuestion: The plan is another's, or the pictures do not show the task.
    """
    plan = _own(context, question.task, question.subgoals, "ExtractTargets")
    needs = [
        SubgoalTargets(subgoal=subgoal.id, targets=draft.targets)
        for subgoal, draft in zip(question.subgoals, plan.subgoals, strict=True)
    ]
    return TargetList(reasoning="What each subgoal moves, and where to.", targets=plan.targets, needs=needs)


def answer_write_steps(context: Context, question: WriteSteps) -> StepList:
    """One step per subgoal of its own plan.

    Raises:
        UnsupportedQuestion: The plan is another's, or the pictures do not show the task.
    """
    plan = _own(context, question.task, question.subgoals, "WriteSteps")
    steps = _steps(plan, question.subgoals, question.targets, question.step_kinds)
    answer: Any = question.output().model_validate(
        {"reasoning": "One step per subgoal, in the plan's order.", "steps": steps}
    )
    written: StepList = answer
    return written


def _own(context: Context, shown: ShownTask, subgoals: Sequence[Subgoal], contract: str) -> Written:
    task = context.task(shown)
    if task is None:
        raise UnsupportedQuestion(context.name, contract, BLIND)
    plan = task.plan_of(subgoals)
    if plan is None:
        raise UnsupportedQuestion(context.name, contract, "it goes on with plans of its own only")
    return plan


def _steps(
    plan: Written, subgoals: Sequence[Subgoal], targets: Sequence[Target], kinds: Sequence[str]
) -> list[dict[str, Any]]:
    """The plan's steps with the ids that the question uses, as the robot runs them."""
    asked = {key_of(target): target.id for target in targets}
    ids = {draft.id: asked.get(key_of(draft.to_target()), draft.id) for draft in plan.targets}
    own = {draft.id: subgoal.id for draft, subgoal in zip(plan.subgoals, subgoals, strict=True)}

    def renamed(value: Any) -> Any:
        if isinstance(value, dict):
            return {**value, "target": ids[value["target"]]}
        return value

    steps: list[dict[str, Any]] = []
    for step in plan.steps:
        named = {key: renamed(value) for key, value in step.items()}
        named["subgoal"] = own[step["subgoal"]]
        if "pick" in named:
            named["pick"] = ids[step["pick"]]
        if step.get("function") is not None:
            named["function"] = own[step["function"]]
        if step["kind"] == "pick_place" and "pick_place" not in kinds and can_carry(kinds):
            more = {key: named[key] for key in ("tight", "twist_deg", "function") if key in named}
            steps += arm_steps(named["subgoal"], named["pick"], named["place"], named["rotate_deg"], kinds, **more)
        else:
            steps.append(named)
            if step["kind"] == "follow" and "home" in kinds:
                steps.append({"kind": "home", "subgoal": named["subgoal"]})
    return steps


def answer_review(context: Context, question: ReviewPlan) -> WalkedReview:
    """Approve its own plan, and another's that names everything that has to be moved and where to."""
    return question.walked(_review(context, question))


def _review(context: Context, question: ReviewPlan) -> PlanReview:
    task = context.task(question.task)
    about = question.under_check or (question.subgoals[0].id if question.subgoals else "plan")
    if task is None:
        return doubt(about, "ambiguity", f"Which table is this? As it is shown, {BLIND}.")
    if task.right.is_plan(question.subgoals):
        return approved("The plan leads to what is asked.")
    if task.plan.is_plan(question.subgoals):
        text = "Does this plan really lead to what is asked, and in this order?"
        known = any(text in line for line in question.checked)
        if known or (context.sampler is not None and context.sampler.draws(context.profile.overlooks, "plan")):
            return approved("Nothing in it looks wrong.")
        return doubt(about, "missing_prerequisite", text)
    if not question.targets:
        return approved("Its targets are not named yet.")
    examples = question.task.slots
    named = {context.meaning(target, task.main, _like(examples, target)) for target in question.targets}
    things = {meaning.thing for meaning in named if meaning is not None}
    for draft in task.right.targets:
        thing = task.right.meanings[draft.id].thing
        if "pick" in draft.use and thing not in things:
            text = f"Must the {draft.words} not be moved?"
            if not any(text in line for line in question.checked):
                return doubt(about, "missing_subgoal", text)
    return approved("Everything that has to be moved is named.")


def answer_review_steps(context: Context, question: ReviewSteps) -> PlanReview | WalkedReview:
    """Approve steps that move the right things in the right order, and a plan that nobody checked; doubt what differs."""
    return question.in_form(_review_steps(context, question))


def _review_steps(context: Context, question: ReviewSteps) -> PlanReview:
    task = context.task(question.task)
    if task is None or context.see(question.overview) is None:
        return doubt("1", "ambiguity", f"Where do these steps lead? As it is shown, {BLIND}.")
    if not question.plan_checked:
        plan_said = _review(
            context,
            ReviewPlan(
                question.task, question.step_kinds, question.subgoals, question.targets, checked=question.checked
            ),
        )
        if plan_said.doubt is not None:
            return plan_said
    plan = task.plan_of(question.subgoals)
    if plan is None:
        return approved("The steps belong to a plan of another's; nothing in them is impossible.")
    kinds = question.step_kinds or tuple(dict.fromkeys(step.kind for step in question.steps)) or ("pick_place",)
    own_steps = _steps(plan, question.subgoals, question.targets, kinds)
    wanted = step_list_type(tuple(dict.fromkeys(str(step["kind"]) for step in own_steps)) or kinds)
    right: tuple[Step, ...] = wanted.model_validate({"reasoning": "", "steps": own_steps}).to_steps()
    for number, (step, own) in enumerate(zip(question.steps, right, strict=False), start=1):
        text = f"Step {number} does something else than its subgoal asks; is it right?"
        if not _same(step, own) and not any(text in line for line in question.checked):
            return doubt(str(number), "wrong_target" if places_of(step) != places_of(own) else "needless_step", text)
    return _off_the_thing(context, question, plan) or approved("The steps do what the subgoals ask.")


def _off_the_thing(context: Context, question: ReviewSteps, plan: Written) -> PlanReview | None:
    """A doubt about the first arrow that begins beside what is picked, as for a point in a hole."""
    seen = context.see(question.overview)
    starts = {mark.label: mark.points[0] for mark in question.overview.marks if isinstance(mark, PathMark)}
    targets = {target.id: target for target in question.targets}
    moved: set[str] = set()
    for number, step in enumerate(question.steps, start=1):
        if not isinstance(step, PickPlaceStep) or step.pick in moved or seen is None:
            # What was moved before does not lie where the picture shows it.
            continue
        moved.add(step.pick)
        meant = plan.meant_by(targets[step.pick])
        start = starts.get(str(number))
        if meant is None or meant.thing is None or start is None or meant.thing not in seen.names:
            continue
        text = (
            f"Step {number} does not take hold of the {targets[step.pick].words} itself; should the point not be on it?"
        )
        known = any(text in line for line in question.checked)
        overlooked = context.sampler is not None and context.sampler.draws(context.profile.overlooks, f"point {number}")
        if seen.at(start, (meant.thing,)) is None and not known and not overlooked:
            return doubt(step.pick, "wrong_point", text)
    return None


def _same(step: Step, own: Step) -> bool:
    """Whether a step does the same; an angle that was read off pictures may be a few degrees off."""
    if isinstance(step, PickPlaceStep) and isinstance(own, PickPlaceStep):
        off = math.remainder(step.rotate_deg - own.rotate_deg, 360.0)
        return replace(step, rotate_deg=own.rotate_deg) == own and abs(off) <= SAME_ANGLE_DEG
    return step == own


def _like(slots: Sequence[ShownSlot], target: Target) -> tuple[ShownSlot, ...]:
    return tuple(slot for slot in slots if slot.name in target.like)


def approved(reasoning: str) -> PlanReview:
    """An approval."""
    return PlanReview(reasoning=reasoning, approved=True, doubt=None)


def doubt(about: str, kind: str, question: str) -> PlanReview:
    """One doubt."""
    raised = CritiqueDraft.model_validate({"about": about, "kind": kind, "question": question})
    return PlanReview(reasoning=question, approved=False, doubt=raised)
