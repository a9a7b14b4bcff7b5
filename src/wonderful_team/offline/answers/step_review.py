"""ReviewSteps: every step against its subgoal, the order, and the drawn boxes and arrows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

from wonderful_team.contracts import CritiqueDraft, PlanReview, ReviewPlan, ReviewSteps, WalkedReview
from wonderful_team.core.actions import (
    SIDES,
    At,
    Beside,
    CloseStep,
    MoveStep,
    OpenStep,
    OriginOf,
    PickPlaceStep,
    Place,
    PushStep,
    RotateGripperStep,
    Step,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, PathMark, Picture
from wonderful_team.core.values import Subgoal, Target
from wonderful_team.offline.answers.reviewing import named, review_of_plan
from wonderful_team.offline.answers.roles import Task, tasks_of
from wonderful_team.offline.answers.steps import place_of
from wonderful_team.offline.eyes import Eyes, eyes_of, eyes_of_task

SAME_ANGLE_DEG = 0.5
"""Turns closer than this are the same [degrees]."""

Problem: TypeAlias = tuple[int | str, str, str]
"""Number of the step (id of the target, for a doubt about its point or box), kind of doubt, question."""


def answer_review_steps(question: ReviewSteps) -> PlanReview | WalkedReview:
    """Check the plan where nobody did, every step against its subgoal, and the drawn arrows against the boxes."""
    return question.in_form(_review(question))


def _review(question: ReviewSteps) -> PlanReview:
    if not question.plan_checked:
        parts = (question.task, question.step_kinds, question.subgoals, question.targets)
        plan = review_of_plan(ReviewPlan(*parts, checked=question.checked))
        if plan.doubt is not None:
            return plan
    eyes = eyes_of_task(question.task)
    asked = {item.id: (item, _one_by_one(tasks_of(item, question.targets, eyes))) for item in question.subgoals}
    problems = _step_problems(question.steps, asked, eyes)
    problems += _order_problems(question.steps, question.subgoals)
    problems += _drawn_problems(question.overview, question)
    fresh = [item for item in problems if not any(item[2] in line for line in question.checked)]
    if not fresh:
        return PlanReview(
            reasoning=f"All {len(question.steps)} steps move what their subgoals name to where they say, in order.",
            approved=True,
            doubt=None,
        )
    number, kind, text = fresh[0]
    subject = f"Step {number} does not do" if isinstance(number, int) else f"{number} does not lie where it serves"
    return PlanReview(
        reasoning=f"{subject} what its subgoal says.",
        approved=False,
        doubt=CritiqueDraft(about=str(number), kind=kind, question=text),
    )


def _one_by_one(tasks: Sequence[Task]) -> list[Task]:
    """A task with stops on its way is one task for each of them, and then itself."""
    return [part for task in tasks for part in (*(replace(task, place=stop, stops=()) for stop in task.stops), task)]


def _step_problems(steps: Sequence[Step], asked: dict[str, tuple[Subgoal, list[Task]]], eyes: Eyes) -> list[Problem]:
    problems: list[Problem] = []
    used: dict[str, int] = {}
    closed = False
    for number, step in enumerate(steps, start=1):
        if step.subgoal not in asked:
            problems.append((number, "needless_step", f"Step {number} serves no subgoal of the plan; what is it for?"))
            continue
        subgoal, tasks = asked[step.subgoal]
        if isinstance(step, PickPlaceStep | PushStep):
            turn = used.get(step.subgoal, 0)
            used[step.subgoal] = turn + 1
            if turn >= len(tasks):
                text = f"'{subgoal.text}' is done by an earlier step; what is step {number} for?"
                problems.append((number, "needless_step", text))
                continue
            problems += _compare(number, step, tasks[turn], subgoal, eyes)
        elif isinstance(step, MoveStep) and isinstance(step.to, At):
            parts = {part.id for task in tasks for part in (task.thing, task.place) if part is not None}
            if step.to.target not in parts:
                text = f"'{subgoal.text}' does not speak of {step.to.target}; why move there in step {number}?"
                problems.append((number, "wrong_target", text))
        elif isinstance(step, CloseStep | OpenStep):
            closed = isinstance(step, CloseStep)
        elif isinstance(step, RotateGripperStep) and closed:
            # An open gripper turns nothing but itself.
            turns = [task.rotate_deg for task in tasks]
            if not any(_same_angle(step.rotate_deg, turn) for turn in turns):
                text = f"'{subgoal.text}' asks for {turns[0]:g} degrees; why {step.rotate_deg:g} in step {number}?"
                problems.append((number, "wrong_target", text))
    return problems


def _compare(number: int, step: PickPlaceStep | PushStep, task: Task, subgoal: Subgoal, eyes: Eyes) -> list[Problem]:
    start = step.pick if isinstance(step, PickPlaceStep) else step.start.target
    end = step.place if isinstance(step, PickPlaceStep) else step.end
    if task.thing is not None and start != task.thing.id:
        text = f"'{subgoal.text}' moves {task.thing.id} ({task.thing.words}); why does step {number} take {start}?"
        return [(number, "wrong_target", text)]
    if isinstance(step, PickPlaceStep) and not _same_angle(step.rotate_deg, task.rotate_deg):
        text = f"'{subgoal.text}' asks for a turn of {task.rotate_deg:g} degrees; why {step.rotate_deg:g} in step {number}?"
        return [(number, "wrong_target", text)]
    if task.aim is None and task.place is None:
        return []
    problem = _wrong_place(end, task, eyes)
    return [(number, "wrong_target", f"'{subgoal.text}': {problem} in step {number}?")] if problem else []


def _wrong_place(end: Place, task: Task, eyes: Eyes) -> str:
    """What is wrong with where a step puts the thing, or ""."""
    wanted = place_of(task, eyes)
    same_spot = isinstance(end, At) and task.thing is not None and end.target == task.thing.id
    if wanted["how"] == "origin":
        right = isinstance(end, OriginOf) and end.target == wanted["target"]
        if task.thing is not None and wanted["target"] != task.thing.id:
            return "" if right else f"must it not go to where {wanted['target']} stood"
        return "" if right or same_spot else f"why does it leave its place for {end.target}"
    if end.target != wanted["target"]:
        return f"is {end.target} the right place"
    if isinstance(end, OriginOf):
        return f"should it not go to {end.target} rather than to where that stood"
    if task.how in SIDES and task.place is not None and task.place.kind == "object":
        if not isinstance(end, Beside) or end.side != task.how:
            return f"must it not go to the side '{task.how}' of {end.target}"
    elif task.how in ("in", "on") and isinstance(end, Beside):
        return f"must it not go {task.how} {end.target} rather than beside it"
    return ""


def _same_angle(one: float, other: float) -> bool:
    return abs((one - other + 180) % 360 - 180) <= SAME_ANGLE_DEG


def _order_problems(steps: Sequence[Step], subgoals: Sequence[Subgoal]) -> list[Problem]:
    first: dict[str, int] = {}
    last: dict[str, int] = {}
    for number, step in enumerate(steps, start=1):
        first.setdefault(step.subgoal, number)
        last[step.subgoal] = number
    problems: list[Problem] = []
    for subgoal in subgoals:
        if subgoal.id not in first:
            if steps:
                text = f"Which step serves {subgoal.id} '{subgoal.text}'? None does."
                problems.append((len(steps), "missing_prerequisite", text))
            continue
        for name in subgoal.after:
            if name in last and last[name] > first[subgoal.id]:
                number = first[subgoal.id]
                text = f"{name} must be reached before {subgoal.id}, but step {number} comes before step {last[name]}; why?"
                problems.append((number, "missing_prerequisite", text))
    return problems


def _drawn_problems(overview: Picture, question: ReviewSteps) -> list[Problem]:
    """A drawn arrow must begin at the box of what is picked, until a step has moved it; a box must hold what its words name."""
    boxes = {mark.label.split()[0]: mark.box for mark in overview.marks if isinstance(mark, BoxMark) and mark.label}
    here = eyes_of(overview, question.task.slots)
    problems: list[Problem] = []
    arrows = [mark for mark in overview.marks if isinstance(mark, PathMark) and mark.points]
    numbered = {mark.label.split()[0].rstrip(".:"): mark for mark in arrows if mark.label}
    targets = {target.id: target for target in question.targets}
    moved: set[str] = set()
    for number, step in enumerate(question.steps, start=1):
        if not isinstance(step, PickPlaceStep):
            continue
        box = None if step.pick in moved else boxes.get(step.pick)
        arrow = numbered.get(str(number))
        moved.add(step.pick)
        if box is not None and arrow is not None and not box.scaled(1.3).contains(arrow.points[0]):
            text = f"The arrow of step {number} begins beside the box of {step.pick}; is its point right?"
            problems.append((step.pick, "wrong_point", text))
        if step.pick in targets and step.pick in boxes:
            problems += _boxed_wrongly(number, targets[step.pick], boxes[step.pick], here)
    return problems


def _boxed_wrongly(number: int, target: Target, box: Box, here: Eyes) -> list[Problem]:
    who = named(target, here)
    thing = here.thing(who.number) if who is not None else None
    if thing is None or thing.box.intersection(box) is not None:
        return []
    text = f"The box of {target.id} is not on the {target.words}, which I see elsewhere; is step {number} right?"
    return [(target.id, "wrong_box", text)]
