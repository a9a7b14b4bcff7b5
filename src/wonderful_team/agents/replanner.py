"""Replanner: after execution, says what became of each subgoal and what the next plan should do differently.

Source of the role: Wang, Shen & Stadie 2024, arXiv:2407.19094; the words are ours.
"""

from __future__ import annotations

from wonderful_team.agents.common import ANSWER, DATA, INSTRUCTION, PICTURES, system_words
from wonderful_team.agents.rendering import listed, subgoal_parts, target_parts, task_parts, view_parts, words
from wonderful_team.agents.role import Ask, role
from wonderful_team.contracts import JudgeOutcome, Replan
from wonderful_team.core.values import Part, Verdict

SYSTEM = system_words(
    """
You are the Replanner of a team that plans for a robot. After the robot has moved you compare what was wanted with what
the pictures show, say what became of each subgoal, and advise the Supervisor when another attempt is needed.

You see pictures of the scene, the plan, what was done and what the robot measured. Believe the pictures first: that a
step was executed does not mean that it worked. You do not write the new plan.
""",
    PICTURES,
    DATA + "\n" + INSTRUCTION,
    ANSWER,
)

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
    Ask(JudgeOutcome, JUDGE_OUTCOME, _render_judge_outcome),
    Ask(Replan, REPLAN, _render_replan),
)
