"""JudgeSubgoal, JudgeOutcome, Replan and Remember: what became of a plan, from the pictures before and after."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from wonderful_team.contracts import (
    Advice,
    JudgeOutcome,
    JudgeSubgoal,
    MemoryEntry,
    Outcome,
    Remember,
    Replan,
    SubgoalOutcome,
    VerdictDraft,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark
from wonderful_team.core.values import Subgoal, Target, TrueThing
from wonderful_team.simulated.context import Context
from wonderful_team.simulated.plan import SAME_M, Move, moves_of
from wonderful_team.simulated.seeing import Seen

SAME_BOX = 0.3
"""A marked box means the thing with which it shares at least this much (intersection over union)."""
UNSEEN = "what the pictures show was never there"
LOST = "what is asked cannot be reached any more"


def answer_outcome(context: Context, question: JudgeOutcome) -> Outcome:
    """A subgoal is reached when nothing is left to do with what it moves; of several for one thing, the last are open."""
    context.check_words(question.task)
    before = context.see(question.task.main)
    after = [context.see(picture) for picture in question.after]
    if before is None or not after or any(seen is None or not seen.current for seen in after):
        return Outcome(
            reasoning=UNSEEN, verdicts=[_verdict(subgoal, "unclear", UNSEEN) for subgoal in question.subgoals]
        )
    left = moves_of(context.truth.oracle(), context.truth, context.instruction)
    solved = context.truth.score().success is True
    moved = _moved(before, question)
    open_ones = {} if solved else _open(question.subgoals, moved, left)
    lost = not solved and not left
    verdicts = []
    for subgoal in question.subgoals:
        if subgoal.id in open_ones:
            verdicts.append(_verdict(subgoal, "not_done", open_ones[subgoal.id]))
        elif lost:
            verdicts.append(_verdict(subgoal, "not_done", LOST))
        else:
            verdicts.append(_verdict(subgoal, "done", "the table after shows it"))
    done = sum(item.status == "done" for item in verdicts)
    return Outcome(reasoning=f"{done} of {len(verdicts)} subgoals are reached", verdicts=verdicts)


def answer_subgoal(context: Context, question: JudgeSubgoal) -> SubgoalOutcome:
    """A subgoal is reached when what it moves is not to be moved for it any more; the rest holds when nothing that it uses has moved."""
    context.check_words(question.task)
    before = context.see(question.task.main)
    after = [context.see(picture) for picture in question.after]
    if before is None or not after or any(seen is None or not seen.current for seen in after):
        return SubgoalOutcome(
            reasoning=UNSEEN, status="unclear", evidence=UNSEEN, cause=None, rest_holds=True, what_changed=""
        )
    left = moves_of(context.truth.oracle(), context.truth, context.instruction)
    solved = context.truth.score().success is True
    moved = _moved(before, question, first=True)
    if solved:
        cause = None
    elif not left:
        cause = LOST
    elif question.subgoal.id in moved:
        cause = _open((question.subgoal, *question.later), moved, left).get(question.subgoal.id)
    else:
        # Which thing it moved does not show: as many moves as subgoals are left when it is done.
        cause = "more moves are left than the plan has" if len(left) > len(question.later) else None
    things, was = context.truth.things(), before.sight.things
    used = {moved[subgoal.id] for subgoal in question.later if subgoal.id in moved} - {moved.get(question.subgoal.id)}
    gone = sorted(name for name in used if name in was and _away(was[name], things[name]))
    # What the plan does not move any more, of a plan of which everything is known.
    known = all(subgoal.id in moved for subgoal in (question.subgoal, *question.later))
    undone = sorted({move.thing for move in left} - set(moved.values())) if known else []
    changed = "; ".join(
        [*(f"the {things[name].words} has moved" for name in gone)]
        + [f"the {things[name].words} has to be moved (again)" for name in undone]
    )
    return SubgoalOutcome(
        reasoning=f"{len(left)} moves are still to be made",
        status="not_done" if cause is not None else "done",
        evidence=cause or "the table after shows it",
        cause=cause,
        rest_holds=not changed,
        what_changed=changed,
    )


def _away(was: TrueThing, now: TrueThing) -> bool:
    return bool(np.linalg.norm(now.position_m - was.position_m) > SAME_M)


def _verdict(subgoal: Subgoal, status: str, evidence: str) -> VerdictDraft:
    cause = evidence if status == "not_done" else None
    return VerdictDraft.model_validate({"subgoal": subgoal.id, "status": status, "cause": cause, "evidence": evidence})


def _moved(before: Seen, question: JudgeOutcome | JudgeSubgoal, first: bool = False) -> Mapping[str, str]:
    """Which thing each subgoal moves: the one in the box of its first target, as it is marked.

    `first`: none where that target has no box, which was moved before; else the first that has one.
    """
    boxes = {
        mark.label.split()[0]: mark.box for mark in question.task.main.marks if isinstance(mark, BoxMark) and mark.label
    }
    targets = {target.id: target for target in question.targets}
    found = {}
    for subgoal in question.subgoals:
        things = [name for name in subgoal.targets if name in targets and _is_thing(targets[name])]
        for name in things[:1] if first else things:
            if name in boxes:
                thing = _thing_in(before, boxes[name])
                if thing is not None:
                    found[subgoal.id] = thing
                    break
    return found


def _is_thing(target: Target) -> bool:
    return target.kind == "object"


def _thing_in(seen: Seen, box: Box) -> str | None:
    boxes = {name: found for name in seen.names if (found := seen.box(name)) is not None}
    best = max(boxes, key=lambda name: boxes[name].iou(box), default=None)
    return best if best is not None and boxes[best].iou(box) >= SAME_BOX else None


def _open(subgoals: tuple[Subgoal, ...], moved: Mapping[str, str], left: list[Move]) -> dict[str, str]:
    """The subgoals that are not reached, each with the reason."""
    still = {move.thing for move in left}
    found: dict[str, str] = {}
    for thing in still:
        own = [subgoal.id for subgoal in subgoals if moved.get(subgoal.id) == thing]
        count = sum(move.thing == thing for move in left)
        found.update({name: "it still has to be moved" for name in own[-count:]})
    if left and not found and subgoals:
        found[subgoals[-1].id] = "something else still has to be moved"
    return found


def answer_replan(context: Context, question: Replan) -> Advice:
    """Go on while something is left to do and can be done."""
    context.check_words(question.task)
    task = context.task(question.task)
    if task is None:
        return Advice(reasoning=UNSEEN, decision="give_up", cause=UNSEEN, advice="")
    if context.truth.score().success is True:
        return Advice(reasoning="everything is as asked", decision="done", cause="", advice="")
    cause = f"{len(task.right.subgoals)} moves are still to be made"
    if not task.right.subgoals:
        return Advice(reasoning=LOST, decision="give_up", cause=LOST, advice="")
    if question.replans_left <= 0:
        return Advice(reasoning="no replan is left", decision="give_up", cause=cause, advice="")
    return Advice(reasoning=cause, decision="replan", cause=cause, advice="Plan again from the table as it is now.")


def answer_remember(context: Context, question: Remember) -> MemoryEntry:
    """Keep nothing: every answer is found anew."""
    return MemoryEntry(keep=False, key="", summary="")
