"""`direct`: one model, one call: plan and points together. With a check, further calls may send the plan back.

Source: the single-model comparison of Wang, Shen & Stadie 2024, arXiv:2407.19094 (Appendix F.1, direct coordinates with and without
labelled axes; Appendix G.2, the column "direct output (w/ labeled axes)").
Followed: all coordinates in one answer of one model, axes labelled or not; no grounding team, no memory, one attempt.
Left open by the paper: the words, the form of the answer, whether plan and points come in one answer (here they do, and with each
thing's box, from which the code that every method shares computes pushes and places beside a thing), and how often a doubt sends a
plan back (here at most `CHECKS` times; each check is made without knowledge of those before).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from wonderful_team.agents.common import ANSWER, BESIDE, DATA, EXAMPLES, INSTRUCTION, LISTED, PICTURES, system_words
from wonderful_team.agents.plan_drawn import plan_drawn
from wonderful_team.agents.rendering import (
    ability_parts,
    answer_in,
    listed,
    picture_parts,
    subgoal_parts,
    target_parts,
    task_parts,
    words,
)
from wonderful_team.agents.role import Ask, role
from wonderful_team.agents.scene import SceneShown, show_views
from wonderful_team.agents.step_words import step_words
from wonderful_team.contracts import DirectPlan, PlanDirectly, PlanReview, ReadScene, ReviewSteps, SceneReading
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Axes
from wonderful_team.core.values import Critique, GroundedTarget, Observation, Part, Plan, Target
from wonderful_team.models.client import ModelClient
from wonderful_team.planning.baselines.open_loop import OpenLoop, pointed

CHECKS = 2
"""How often a plan that was doubted is made anew."""

SYSTEM = system_words(
    """
You plan for a robot and point at what it has to touch, alone and in one answer. Nobody finds positions for you and nobody
corrects them: a point that is off by more than a little misses.
""",
    PICTURES + "\n" + EXAMPLES,
    DATA + "\n" + INSTRUCTION,
    ANSWER,
)

PLAN = f"""
Write the whole plan: subgoals, targets with their points, and the robot's steps.
- A subgoal states one result that a later picture can show. Ids G1, G2, and so on, in the order in which they are carried out.
- Each target has its box, if it is a thing, and one point for each use. pick, grasp: on the solid material of the thing, near its middle, never in a hole.
  place: where the middle of what is put there will lie. push_start: beside the thing, on the side away from where it should go.
- Steps name targets by id. A place is "at" a target, "beside" a target (then give the side, as the main view shows it), or the
  "origin" of a target (where it stood at the start). Every subgoal is served; use only what the robot can do.
- rotate_deg: only what the instruction or its pictures state; clockwise seen from above is positive; 0 when nothing is said.
- A target that is not in the main view has no box and no points and is listed in absent. Do not guess.
- No subgoals, targets and steps only when the main view shows that the instruction is already fulfilled.

{LISTED} Empty for a thing that others are only placed beside.
{BESIDE}
"""

CHECK = """
Check this plan before the robot runs it. The picture of the plan shows its points, and its steps as numbered arrows. Do the
steps do what the instruction asks, on the right things, at the right places, in the right order and with the right angles?
Approve when they do. Otherwise ask one question about the step that is most wrong: give its number, and say what should be
different. For a point that lies beside its thing give the target's id instead, with the kind wrong_point.
"""

FIND = """
Say where each target is: its box, tight round all of it, and its point, on its solid material near the middle.
A target that is not in the main view is not found: no box and no points. Do not guess.
"""


def _render_plan(question: PlanDirectly) -> list[Part]:
    return [
        *task_parts(question.task),
        *ability_parts([kind for kind in question.step_kinds if kind != "follow"]),
        *listed("What went wrong before, to be avoided now", question.advice),
        *answer_in(question.view),
    ]


def _render_check(question: ReviewSteps) -> list[Part]:
    steps = [f"{number}. {step_words(step)}" for number, step in enumerate(question.steps, start=1)]
    return [
        *task_parts(question.task),
        *subgoal_parts(question.subgoals),
        *target_parts(question.targets),
        *picture_parts(question.overview, "the plan drawn over the main view"),
        *words("Steps:", *steps),
    ]


def _render_find(question: ReadScene) -> list[Part]:
    return [
        *picture_parts(question.view, "the main view"),
        *target_parts(question.targets),
        *answer_in(question.view),
    ]


PLANNER = role(
    "planner",
    SYSTEM,
    Ask(PlanDirectly, PLAN, _render_plan),
    Ask(ReviewSteps, CHECK, _render_check),
    Ask(ReadScene, FIND, _render_find),
)


class Direct(OpenLoop):
    """One call for everything.

    Args:
        client: Where the model is asked.
        axes: Label the axes of the main view.
        checked: Let the same model look at the drawn plan, and plan anew after a doubt.
    """

    def __init__(self, client: ModelClient, *, axes: bool = False, checked: bool = False) -> None:
        super().__init__(client, "direct" + (":axes" if axes else "") + (":checked" if checked else ""), PLANNER)
        self._axes, self._checked = axes, checked

    async def make_plan(self, scene: SceneShown, start: Plan, advice: tuple[str, ...]) -> Plan:
        """One plan; with a check, at most `CHECKS` more."""
        plan = await self._draft(scene, start, advice)
        for _ in range(CHECKS if self._checked else 0):
            doubt = await self._doubt(scene, plan) if plan.actions else None
            if doubt is None:
                return self.keep(replace(plan, verified=True))
            asked = replace(start, questions=(*plan.questions, replace(doubt, changed=True)))
            plan = await self._draft(scene, asked, (*advice, f"{doubt.about}: {doubt.question}"))
        return plan

    async def _draft(self, scene: SceneShown, start: Plan, advice: tuple[str, ...]) -> Plan:
        task = scene.task
        if self._axes:
            task = replace(task, views=(scene.labelled, *scene.views[1:]), slots=scene.ticked_slots)
        answer = await self.ask(PlanDirectly(task, scene.vocabulary.step_kinds, advice), PLANNER, "plan")
        drafted: DirectPlan = answer.value
        grounded = {
            draft.id: pointed(
                draft.to_target(),
                {entry.role: entry.point.as_tuple for entry in draft.points},
                task.main,
                "not in the main view" if draft.id in drafted.absent else "pointed at with the plan",
                answer.provenance,
                None if draft.box is None else draft.box.as_box,
            )
            for draft in drafted.targets
        }
        subgoals = [goal.to_subgoal() for goal in drafted.subgoals]
        return self.with_actions(scene, start, subgoals, grounded, drafted.to_steps())

    async def _doubt(self, scene: SceneShown, plan: Plan) -> Critique | None:
        shown = plan_drawn(scene, plan.grounded, plan.actions)
        question = ReviewSteps(scene.task, plan.subgoals, plan.targets, plan.steps, shown)
        answer = await self.ask(question, PLANNER, "plan")
        review: PlanReview = answer.value
        if review.doubt is None:
            return None
        doubt = review.doubt
        about = f"step {doubt.about}" if doubt.about.isdigit() else doubt.about
        return Critique(about, doubt.kind, doubt.question, provenance=answer.provenance)

    async def ground(self, observation: Observation, asked: Sequence[str]) -> list[GroundedTarget]:
        """Things found by their descriptions, all in one answer, without a plan."""
        view = show_views(observation)[0]
        view = view.marked(Axes()) if self._axes else view
        targets = tuple(Target(f"T{number}", "object", said) for number, said in enumerate(asked, start=1))
        answer = await self.ask(ReadScene(targets, (), view), PLANNER, "ground")
        reading: SceneReading = answer.value
        found = {item.id: item for item in reading.targets}
        return [
            pointed(
                target,
                {entry.role: entry.point.as_tuple for entry in found[target.id].points},
                view,
                "pointed at" if found[target.id].found else "not in the main view",
                answer.provenance,
                None if (box := found[target.id].box) is None else box.as_box,
            )
            for target in targets
        ]

    async def locate(self, observation: Observation, asked: Sequence[str]) -> list[Box | None]:
        """Where things in a photo are: a box in pixels of the photo for each, or None."""
        return [item.box for item in await self.ground(observation, asked)]
