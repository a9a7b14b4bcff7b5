"""High-level planning: the Supervisor drafts, Verification doubts, the Supervisor revises or answers.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Algorithm 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from wonderful_team.contracts import (
    DraftPlan,
    ExtractTargets,
    PlanDraft,
    PlanRevision,
    ReviewPlan,
    RevisePlan,
    TargetList,
    WalkedReview,
)
from wonderful_team.core.text import counted
from wonderful_team.core.values import Answer, Critique, Subgoal, Target
from wonderful_team.errors import NeedsClarification
from wonderful_team.planning.scene import SceneShown
from wonderful_team.planning.session import AgentSession


@dataclass(frozen=True, eq=False)
class PlanState:
    """A plan on its way to approval."""

    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    mode: Literal["full", "one_step"]
    first_draft: tuple[Subgoal, ...]
    verified: bool = False
    questions: tuple[Critique, ...] = ()
    reasoning: str = ""


async def draft(
    session: AgentSession, scene: SceneShown, advice: Sequence[str] = (), done: Sequence[str] = ()
) -> PlanState:
    """The Supervisor's first draft.

    Raises:
        NeedsClarification: Neither picture nor instruction settles what is meant.
    """
    with_targets = session.config.mode == "lean"
    question = DraftPlan(scene.task, scene.vocabulary.step_kinds, with_targets, tuple(advice), tuple(done))
    written: PlanDraft = await session.ask(question, stage="plan")
    if written.clarification is not None:
        raise NeedsClarification(written.clarification.question, written.clarification.choices)
    subgoals = written.to_subgoals()
    state = PlanState(
        subgoals, written.to_targets() if with_targets else (), written.mode, subgoals, reasoning=written.reasoning
    )
    session.stage("draft", _count(state))
    return state


async def verify(session: AgentSession, scene: SceneShown, state: PlanState) -> PlanState:
    """Verification's loop; with Verification switched off, the draft as it is."""
    if not session.members.verification:
        session.stage("checked", "not checked: Verification is switched off")
        return state
    checked: list[str] = []
    passed: set[str] = set()
    overruled = False
    while True:
        under_check = _next_subgoal(state, passed)
        review = await session.ask_whole(
            ReviewPlan(
                scene.task, scene.vocabulary.step_kinds, state.subgoals, state.targets, under_check, tuple(checked)
            ),
            stage="plan",
        )
        verdict: WalkedReview = review.value
        if verdict.doubt is None:
            if under_check is not None:
                passed.add(under_check)
                checked.append(f"{under_check} approved")
                # A doubt that was answered but not followed is settled by one look at the whole plan.
                if overruled or _next_subgoal(state, passed) is not None:
                    continue
            state = replace(state, verified=True)
            break
        if len(state.questions) >= session.config.bounds.questions:
            session.warn(
                f"Verification still doubts after {counted(len(state.questions), 'question')}: {verdict.doubt.question}"
            )
            break
        doubt = Critique(verdict.doubt.about, verdict.doubt.kind, verdict.doubt.question, provenance=review.provenance)
        state, answered = await _resolve(session, scene, state, doubt)
        checked += settled_lines((answered,))
        # A revised plan is a new plan: each of its subgoals may be checked once more.
        overruled = not answered.changed
        passed = set() if answered.changed else passed | ({under_check} if under_check else set())
    session.stage("checked", _told(state))
    return state


def settled_lines(questions: Sequence[Critique]) -> tuple[str, ...]:
    """What was asked before and how it was settled, one line each."""
    return tuple(
        f"asked about {one.about}: {one.question} Answer: {one.answer} ({'changed' if one.changed else 'kept'})"
        for one in questions
    )


async def _resolve(
    session: AgentSession, scene: SceneShown, state: PlanState, doubt: Critique
) -> tuple[PlanState, Critique]:
    with_targets = session.config.mode == "lean"
    reply: Answer = await session.ask_whole(
        RevisePlan(scene.task, scene.vocabulary.step_kinds, state.subgoals, state.targets, doubt, with_targets),
        stage="plan",
    )
    revision: PlanRevision = reply.value
    answered = replace(doubt, answer=revision.answer, changed=revision.plan is not None)
    if revision.plan is None:
        return replace(state, questions=(*state.questions, answered)), answered
    if revision.plan.clarification is not None:
        raise NeedsClarification(revision.plan.clarification.question, revision.plan.clarification.choices)
    return (
        replace(
            state,
            subgoals=revision.plan.to_subgoals(),
            targets=revision.plan.to_targets() if with_targets else (),
            mode=revision.plan.mode,
            questions=(*state.questions, answered),
            reasoning=revision.plan.reasoning or revision.reasoning,
        ),
        answered,
    )


async def extract_targets(session: AgentSession, scene: SceneShown, state: PlanState) -> PlanState:
    """In `paper`: list the targets of the approved plan, and which subgoal needs which."""
    if session.config.mode == "lean" or not state.subgoals:
        return state
    listed: TargetList = await session.ask(ExtractTargets(scene.task, state.subgoals), stage="plan")
    needs = {need.subgoal: tuple(need.targets) for need in listed.needs}
    return replace(
        state,
        targets=tuple(target.to_target() for target in listed.targets),
        subgoals=tuple(replace(subgoal, targets=needs[subgoal.id]) for subgoal in state.subgoals),
    )


def _next_subgoal(state: PlanState, passed: set[str]) -> str | None:
    if state.mode == "one_step":
        return None
    return next((subgoal.id for subgoal in state.subgoals if subgoal.id not in passed), None)


def _count(state: PlanState) -> str:
    text = counted(len(state.subgoals), "subgoal")
    if state.targets:
        text += ", " + counted(len(state.targets), "target")
    return text if state.subgoals else "nothing to do: the instruction is already fulfilled"


def _told(state: PlanState) -> str:
    if not state.questions:
        return "approved at once" if state.verified else "not approved"
    last = state.questions[-1]
    outcome = "plan changed" if last.changed else "answered, plan kept"
    end = "" if state.verified else "; not approved within the bound"
    return f'{counted(len(state.questions), "question")}: "{last.question}" -> {outcome}{end}'
