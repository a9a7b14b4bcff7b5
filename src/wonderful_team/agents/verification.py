"""Verification: checks the plan and the steps, and raises at most one doubt at a time.

Source of the role: Wang, Shen & Stadie 2024, arXiv:2407.19094; the words are ours.
"""

from __future__ import annotations

from wonderful_team.agents.common import ANSWER, DATA, EXAMPLES, INSTRUCTION, PICTURES, system_words
from wonderful_team.agents.rendering import (
    ability_parts,
    listed,
    picture_parts,
    subgoal_parts,
    target_parts,
    task_parts,
    words,
)
from wonderful_team.agents.role import Ask, role
from wonderful_team.agents.step_words import step_words
from wonderful_team.contracts import ReviewPlan, ReviewSteps
from wonderful_team.core.values import Part

SYSTEM = system_words(
    """
You are Verification in a team that plans for a robot. Before anything moves you find what would make the plan fail.
You do not write plans: you approve, or you ask the Supervisor one question about one subgoal or one step.

You see the instruction, the views of the scene, the plan and what was checked before. Judge against what the pictures
show. Wording, style and exact positions are not your concern: other agents measure positions, and a gate checks limits.
""",
    PICTURES + "\n" + EXAMPLES,
    DATA + "\n" + INSTRUCTION,
    ANSWER,
)

KINDS = """
- collision: carried out as written, something would hit, push over or bury something else.
- physical_constraint: it cannot be done like that: closed, covered, too large for the place, out of what the robot
  can do.
- missing_prerequisite: something has to happen first that no earlier subgoal brings about.
- ambiguity: more than one thing in the scene fits the words, and it matters which.
- needless_step: it does not serve the instruction, or repeats another one.
- wrong_target: the thing, the place, the angle or the order is not what the instruction or its pictures ask for.
""".strip()

REVIEW_PLAN = f"""
Check whether the plan, carried out in its order, fulfils the whole instruction in this scene.
Imagine each subgoal done, one after the other, and look for:
{KINDS}

Approve when you find nothing that would make it fail; most short plans are sound. Otherwise ask one question, the most
serious one, about one subgoal: name its id, and say what in the picture or the instruction raises it. Do not ask again
what the list of earlier checks has settled. If a subgoal is named to be checked now, judge that one only, given the
others. For a plan without subgoals, ask about "plan". When you are not sure that something is wrong, approve.
"""

REVIEW_STEPS = f"""
Check the steps before the robot runs them. The picture of the plan shows every target's box with its label and the
steps as numbered arrows. Do the steps carry out the plan, on the right things, in the right order, and with the angles
and sides that the instruction states?
{KINDS}

Approve when you find nothing that would make it fail. Otherwise ask one question, the most serious one, about one
step: give its number. Do not ask again what the list of earlier checks has settled. When you are not sure that
something is wrong, approve.
"""


def _render_review_plan(question: ReviewPlan) -> list[Part]:
    which = f"subgoal {question.under_check} only" if question.under_check is not None else "the whole plan"
    return [
        *task_parts(question.task),
        *ability_parts(question.step_kinds),
        *subgoal_parts(question.subgoals),
        *target_parts(question.targets),
        *listed("Checked or asked before", question.checked, "nothing yet"),
        *words(f"To be checked now: {which}."),
    ]


DRAWN = "the plan drawn over the main view"

PLAN_TOO = """
The plan itself was not checked before: check it now, together with the steps. Does it fulfil the whole instruction in this
scene, is nothing missing, is nothing in the way, and are these the right things? A doubt about the plan is about a
subgoal: give its id. A doubt about a step alone gives the step's number.
"""


def _render_review_steps(question: ReviewSteps) -> list[Part]:
    steps = [f"{number}. {step_words(step)}" for number, step in enumerate(question.steps, start=1)]
    # Where the overview is the main view itself, it is shown once.
    drawn = [] if question.overview is question.task.main else picture_parts(question.overview, DRAWN)
    title = "The scene now" if drawn else f"The scene now, with {DRAWN}"
    return [
        *task_parts(question.task, title),
        *(ability_parts(question.step_kinds) if question.step_kinds else []),
        *subgoal_parts(question.subgoals),
        *target_parts(question.targets),
        *drawn,
        *words("Steps:", *(steps or ["none"])),
        *listed("Checked or asked before", question.checked, "nothing yet"),
        *([] if question.plan_checked else words(PLAN_TOO)),
    ]


VERIFICATION = role(
    "verification",
    SYSTEM,
    Ask(ReviewPlan, REVIEW_PLAN, _render_review_plan),
    Ask(ReviewSteps, REVIEW_STEPS, _render_review_steps),
)
