"""High-level planning: the Supervisor drafts, Verification doubts, the Supervisor revises or answers.

Source: Wang, Shen & Stadie 2024, arXiv:2407.19094, Algorithm 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import (
    DraftPlan,
    ExtractTargets,
    PlanDraft,
    PlanRevision,
    ReviewPlan,
    RevisePlan,
    SubgoalDraft,
    TargetList,
    WalkedReview,
)
from wonderful_team.core.steps import PickPlaceStep
from wonderful_team.core.text import counted
from wonderful_team.core.values import Answer, Critique, Subgoal, Target
from wonderful_team.errors import NeedsClarification
from wonderful_team.planning.function_library import told as told_functions
from wonderful_team.planning.notes import one_line
from wonderful_team.planning.session import AgentSession
from wonderful_team.planning.spending import plan_reasons


@dataclass(frozen=True, eq=False)
class PlanState:
    """A plan on its way to approval.

    Attributes:
        moves: The picks and places that its subgoals state.
        unsure, reasoning: What the Supervisor was not sure of, and what decided the plan, in its words.
        reviewed: Verification has looked at the plan by itself, whatever it said.
        advice: What went wrong before, as the Supervisor was told.
    """

    subgoals: tuple[Subgoal, ...]
    targets: tuple[Target, ...]
    mode: Literal["full", "one_step"]
    first_draft: tuple[Subgoal, ...]
    verified: bool = False
    questions: tuple[Critique, ...] = ()
    moves: tuple[PickPlaceStep, ...] = ()
    unsure: str = ""
    reasoning: str = ""
    reviewed: bool = False
    advice: tuple[str, ...] = ()


async def draft(session: AgentSession, scene: SceneShown, advice: Sequence[str] = ()) -> PlanState:
    """The Supervisor's first draft.

    Raises:
        NeedsClarification: Neither picture nor instruction settles what is meant.
    """
    with_targets = session.config.mode == "lean"
    known = told_functions(session.functions)
    question = DraftPlan(scene.task, scene.vocabulary.step_kinds, with_targets, tuple(advice), known)
    written: PlanDraft = await session.ask(question, stage="plan")
    if written.clarification is not None:
        raise NeedsClarification(written.clarification.question, written.clarification.choices)
    first = PlanState((), (), written.mode, written.to_subgoals(), advice=tuple(advice))
    state = _as_written(first, written, session)
    session.stage("draft", _count(state))
    return state


def _as_written(state: PlanState, written: PlanDraft, session: AgentSession) -> PlanState:
    """The state with a newly written plan in it, which nobody has looked at yet."""
    with_targets = session.config.mode == "lean"
    targets = written.to_targets() if with_targets else ()
    if session.members.manager:  # without a Manager nobody draws an outline: a point has to do
        targets = tuple(replace(target, landmark=_is_landmark(target, written)) for target in targets)
    return replace(
        state,
        subgoals=written.to_subgoals(),
        targets=targets,
        mode=written.mode,
        moves=written.to_moves() if with_targets else (),
        unsure=written.unsure,
        reasoning=written.reasoning,
        verified=False,
        reviewed=False,
    )


def _is_landmark(target: Target, written: PlanDraft) -> bool:
    """Whether a target has no use of its own: others are placed beside it, or a helper function's path is led over it."""
    named = [item for item in written.subgoals if target.id in item.targets]
    return (
        target.kind == "object"
        and not target.use
        and bool(named)
        and all(_outline_serves(target, item) for item in named)
    )


def _outline_serves(target: Target, item: SubgoalDraft) -> bool:
    """Whether a subgoal that names a target needs no more of it than its outline."""
    move = item.move
    if move is None:
        return item.function is not None
    return (move.place.target, move.place.how) == (target.id, "beside") and move.pick != target.id


async def verify_where_needed(
    session: AgentSession, scene: SceneShown, state: PlanState, failed: bool = False
) -> PlanState:
    """`lean`: a plain plan is checked together with its steps, drawn over the picture; any other one by itself first.

    Args:
        session: Who asks.
        scene: What is seen.
        state: The plan.
        failed: Something went wrong before.
    """
    why = plan_reasons(
        state.subgoals,
        state.moves,
        scene.instruction.text,
        unsure=state.unsure,
        full=state.mode == "full",
        doubted=bool(state.questions),
        failed=failed,
    )
    if why or not (session.config.sparing and session.members.verification):
        return await verify(session, scene, state)
    session.skip("ReviewPlan", "a plain plan is checked with its steps")
    return state


async def verify(session: AgentSession, scene: SceneShown, state: PlanState) -> PlanState:
    """Verification's loop; with Verification switched off, the draft as it is."""
    if not session.members.verification:
        session.stage("checked", "not checked: Verification is switched off")
        return state
    if state.unsure:
        session.note("verification", "unsure", one_line(f"The Supervisor is not sure: {state.unsure}"))
    whole = session.config.sparing
    checked = list(settled_lines(state.questions))
    passed: set[str] = set()
    overruled = False
    while True:
        under_check = _next_subgoal(state, passed, whole)
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
                if overruled or _next_subgoal(state, passed, whole) is not None:
                    continue
            state = replace(state, verified=True)
            break
        if len(state.questions) >= session.config.bounds.questions:
            session.warn(
                f"Verification still doubts after {counted(len(state.questions), 'question')}: {verdict.doubt.question}"
            )
            break
        doubt = Critique(verdict.doubt.about, verdict.doubt.kind, verdict.doubt.question, provenance=review.provenance)
        state, answered = await resolve(session, scene, state, doubt)
        checked += settled_lines((answered,))
        # A revised plan is a new plan: each of its subgoals may be checked once more.
        overruled = not answered.changed
        passed = set() if answered.changed else passed | ({under_check} if under_check else set())
    state = replace(state, reviewed=True)
    session.stage("checked", told(state))
    return state


def settled_lines(questions: Sequence[Critique]) -> tuple[str, ...]:
    """What was asked before and how it was settled, one line each."""
    return tuple(
        f"asked about {one.about}: {one.question} Answer: {one.answer} ({'changed' if one.changed else 'kept'})"
        for one in questions
    )


async def resolve(
    session: AgentSession, scene: SceneShown, state: PlanState, doubt: Critique
) -> tuple[PlanState, Critique]:
    """The Supervisor's answer to a doubt about the plan: perhaps a new plan, and the doubt with its answer.

    Raises:
        NeedsClarification: Neither picture nor instruction settles what is meant.
    """
    with_targets = session.config.mode == "lean"
    known, kinds = told_functions(session.functions), scene.vocabulary.step_kinds
    reply: Answer = await session.ask_whole(
        RevisePlan(scene.task, kinds, state.subgoals, state.targets, doubt, with_targets, known), stage="plan"
    )
    revision: PlanRevision = reply.value
    answered = replace(doubt, answer=revision.answer, changed=revision.plan is not None)
    remember_doubt(session, "plan", answered, revision.reasoning)
    state = replace(state, questions=(*state.questions, answered))
    if revision.plan is None:
        return state, answered
    if revision.plan.clarification is not None:
        raise NeedsClarification(revision.plan.clarification.question, revision.plan.clarification.choices)
    return _as_written(state, revision.plan, session), answered


def remember_doubt(session: AgentSession, stage: str, doubt: Critique, reasoning: str) -> None:
    """Let Memory keep what a doubt settled: the plan shows what was decided, not why."""
    what = "Changed" if doubt.changed else "Kept as it was"
    because = f" Because: {reasoning}" if reasoning else ""
    session.remember(
        "supervisor",
        stage,
        f"Verification doubted {doubt.about} ({doubt.kind}): {doubt.question}",
        f"{what}. {doubt.answer}{because}",
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


def _next_subgoal(state: PlanState, passed: set[str], whole: bool) -> str | None:
    """The subgoal to look at now; None for the whole plan at once."""
    if whole or state.mode == "one_step":
        return None
    return next((subgoal.id for subgoal in state.subgoals if subgoal.id not in passed), None)


def _count(state: PlanState) -> str:
    text = counted(len(state.subgoals), "subgoal")
    if state.targets:
        text += ", " + counted(len(state.targets), "target")
    return text if state.subgoals else "nothing to do: the instruction is already fulfilled"


def told(state: PlanState) -> str:
    """How Verification's check of a plan went, in one line."""
    if not state.questions:
        return "approved at once" if state.verified else "not approved"
    last = state.questions[-1]
    outcome = "plan changed" if last.changed else "answered, plan kept"
    end = "" if state.verified else "; not approved within the bound"
    return f'{counted(len(state.questions), "question")}: "{last.question}" -> {outcome}{end}'
