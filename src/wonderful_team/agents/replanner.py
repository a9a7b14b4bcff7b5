"""Replanner: after execution, says what became of each subgoal and what the next plan should do differently.

Source of the role: Wang, Shen & Stadie 2024, arXiv:2407.19094; the words are ours.
"""

from __future__ import annotations

from wonderful_team.agents.common import ANSWER, DATA, INSTRUCTION, PICTURES, system_words
from wonderful_team.agents.rendering import (
    listed,
    subgoal_parts,
    subgoal_words,
    target_parts,
    task_parts,
    view_parts,
    words,
)
from wonderful_team.agents.role import Ask, role
from wonderful_team.contracts import JudgeOutcome, JudgeSubgoal, Replan
from wonderful_team.core.values import Part, Verdict

SYSTEM = system_words(
    """
You are the Replanner of a team that plans for a robot. When the robot has moved you compare what was wanted with what
the pictures show, say what became of each subgoal, and advise the Supervisor when another attempt is needed.

You see pictures of the scene, the plan, what was done and what the robot measured. Believe the pictures first: that a
step was executed does not mean that it worked. You do not write the new plan.
""",
    PICTURES,
    DATA + "\n" + INSTRUCTION,
    ANSWER,
)

JUDGE_SUBGOAL = """
The robot has carried out one subgoal of the plan and waits: say what became of it, and whether the rest of the plan can
still be carried out as it stands. Compare the pictures from before this subgoal with those from now.

status, of this subgoal alone:
- done: the pictures from now show its result, however it came about.
- not_done: they show that it was not reached. cause: what happened, if you can see it: nothing was picked up, it was put
  down in the wrong place or container, it slipped, somebody moved it.
- unclear: the pictures do not show it, for instance because something hides it.

rest_holds, of all the others: the boxes in both pictures are where the things lay when the plan was made. The later
subgoals act there. Say false when a thing that they use is not in its box any more, or is covered or turned, when a place
that they use is taken, or when something that an earlier subgoal reached is lost. A shadow, a reflection or another light
changes a picture too, and is no reason. That the later subgoals are not done yet is no reason either.
evidence: what you see, in a few words.
"""

JUDGE_OUTCOME = """
Compare the pictures from before with those from now, and give one verdict for each subgoal.
- done: the pictures from now show the result. If something was to be put back, it must be back.
- not_done: they show that the result was not reached. Say the cause if you can see it: nothing was picked up, the wrong
  thing was moved, it was put down in the wrong place, turned wrongly, knocked away, or blocked.
- undone: it was reached on the way, and a later step, as planned or by accident, took it away again. A stage that the
  plan itself meant to be passed through counts as done.
- unclear: the pictures do not show it, for instance because something hides it.
evidence: what you see, in a few words. cause is null when the subgoal is done.
"""

REPLAN = """
Decide what happens next, from the verdicts and the scene as it is now.
- done: everything the instruction asks for holds now, even if a verdict says otherwise. Cause and advice are empty.
- replan: another attempt could succeed. cause: what went wrong, in one sentence. advice: what the next plan should do
  differently, given where things lie now; name things as the pictures show them, no coordinates.
- give_up: no attempt with what the robot can do would help, for instance because a thing fell out of reach, or no
  attempt is left.
"""


def _verdict_words(verdict: Verdict) -> str:
    cause = f"; cause: {verdict.cause}" if verdict.cause is not None else ""
    evidence = f"; seen: {verdict.evidence}" if verdict.evidence else ""
    return f"{verdict.subgoal}: {verdict.status}{cause}{evidence}"


def _render_judge_subgoal(question: JudgeSubgoal) -> list[Part]:
    return [
        *task_parts(question.task, "The scene before this subgoal"),
        *subgoal_parts(question.subgoals),
        *target_parts(question.targets, "Targets, as they were found when the plan was made"),
        *words(f"To be judged now: {subgoal_words(question.subgoal)}"),
        *listed("Steps that were carried out for it, in order", question.steps, "none"),
        *listed("What the robot reported", question.measured, "nothing"),
        *listed("What a comparison of the pictures shows that the plan does not expect", question.doubts, "nothing"),
        *view_parts("The scene now", question.after),
    ]


def _render_judge_outcome(question: JudgeOutcome) -> list[Part]:
    return [
        *task_parts(question.task, "The scene before anything moved"),
        *subgoal_parts(question.subgoals),
        *target_parts(question.targets, "Targets, as they were found before"),
        *listed("Steps that were carried out, in order", question.steps, "none"),
        *listed("What the robot reported", question.measured, "nothing"),
        *view_parts("The scene now", question.after),
    ]


def _render_replan(question: Replan) -> list[Part]:
    return [
        *task_parts(question.task),
        *subgoal_parts(question.subgoals),
        *listed("Verdicts", [_verdict_words(verdict) for verdict in question.verdicts], "none"),
        *listed("What the robot reported", question.measured, "nothing"),
        *listed("Helper functions that were accepted in this task", question.functions),
        *words(f"Attempts left: {question.replans_left}."),
    ]


REPLANNER = role(
    "replanner",
    SYSTEM,
    Ask(JudgeSubgoal, JUDGE_SUBGOAL, _render_judge_subgoal),
    Ask(JudgeOutcome, JUDGE_OUTCOME, _render_judge_outcome),
    Ask(Replan, REPLAN, _render_replan),
)
