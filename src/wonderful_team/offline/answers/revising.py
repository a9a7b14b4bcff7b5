"""RevisePlan: change the plan where the doubt is right, else say why it stands."""

from __future__ import annotations

from wonderful_team.contracts import PlanRevision, RevisePlan
from wonderful_team.offline.answers.drafting import draft
from wonderful_team.offline.answers.moves import with_moves
from wonderful_team.offline.answers.reviewing import findings


def answer_revise(question: RevisePlan) -> PlanRevision:
    """Change the plan where the doubt is right, else say why it stands."""
    found = findings(question.task, question.subgoals, question.targets, question.step_kinds)
    concerned = [item for item in found if item.about == question.doubt.about] or found
    if not concerned:
        return PlanRevision(
            reasoning=f"Derived again from the instruction and the picture, nothing in {question.doubt.about} is amiss.",
            decision="keep",
            answer=f"{question.doubt.about} follows from the instruction and the picture; the plan stands.",
            plan=None,
        )
    plan, _ = draft(question.task, question.with_targets)
    if question.with_targets:
        plan = with_moves(plan, question.task, question.step_kinds)
    return PlanRevision(
        reasoning=f"The doubt is right: {concerned[0].question}",
        decision="revise",
        answer=f"You are right: {concerned[0].question} The plan was written anew.",
        plan=plan,
    )
