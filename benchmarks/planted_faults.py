"""Do the members that check disagree when they should? Plant faults, ask, and print confusion matrices.

    python -m benchmarks.planted_faults                   # 200 plans, 200 boxes, 100 wrong first boxes; seeds from 1000
    python -m benchmarks.planted_faults --first 0 --n 40  # development seeds

Plans: a step missing, swapped, needless, or about the wrong thing, against untouched ones. Boxes: shifted by 0.5 to 4
radii, on another thing, on the bare table, against right ones. First boxes: shifted likewise at the start of
grounding; counted is whether the point that comes out in the end lies on the right thing.

The model is `offline` (classical vision and a grammar); the figures say nothing about any vision-language model.
"""

from __future__ import annotations

import argparse
import asyncio
import json
from collections.abc import AsyncIterator, Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.confusion import Confusion
from benchmarks.planted_boxes import check_boxes, recover
from benchmarks.planted_scenes import TASKS, Scene, objection, scenes, session_for
from wonderful_team.contracts import (
    DraftPlan,
    PlanDraft,
    ReviewPlan,
)
from wonderful_team.contracts.plans import SubgoalDraft, TargetDraft
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.planning.session import AgentSession


def unasked(where: Scene) -> list[str]:
    """Things that the instruction asks nobody to move and to put nothing on."""
    asked = {name for goal in where.truth["goals"] for name in (goal["thing"], *goal["near"])}
    return [name for name, thing in where.truth["things"].items() if name not in asked and thing["kind"] != "area"]


def missing(plan: PlanDraft, where: Scene, rng: np.random.Generator) -> PlanDraft | None:
    """One subgoal is left out."""
    if not plan.subgoals:
        return None
    gone = plan.subgoals[int(rng.integers(len(plan.subgoals)))].id
    kept = [subgoal for subgoal in plan.subgoals if subgoal.id != gone]
    kept = [s.model_copy(update={"after": [name for name in s.after if name != gone]}) for s in kept]
    return plan.model_copy(update={"subgoals": kept})


def swapped(plan: PlanDraft, where: Scene, rng: np.random.Generator) -> PlanDraft | None:
    """What is moved and where it goes exchange their places in one subgoal."""
    by_id = {target.id: target for target in plan.targets}
    for number, subgoal in enumerate(plan.subgoals):
        if len(subgoal.targets) == 2:
            one, two = (by_id[name].words for name in subgoal.targets)
            if one in subgoal.text and two in subgoal.text:
                text = subgoal.text.replace(one, "\0").replace(two, one).replace("\0", two)
                wrong = subgoal.model_copy(update={"text": text, "targets": subgoal.targets[::-1]})
                return _with_subgoal(plan, number, wrong)
    return None


def wrong_target(plan: PlanDraft, where: Scene, rng: np.random.Generator) -> PlanDraft | None:
    """Another thing of the scene takes the place of what is moved."""
    others = unasked(where)
    if not plan.subgoals or not others:
        return None
    subgoal, other = plan.subgoals[0], others[int(rng.integers(len(others)))]
    target = next(target for target in plan.targets if target.id == subgoal.targets[0])
    if target.words not in subgoal.text:
        return None
    words = f"the {other}"
    changed = subgoal.model_copy(update={"text": subgoal.text.replace(target.words, words, 1)})
    new = target.model_copy(update={"words": words, "like": [], "where": ""})
    targets = [new if item.id == target.id else item for item in plan.targets]
    return _with_subgoal(plan.model_copy(update={"targets": targets}), 0, changed)


def needless(plan: PlanDraft, where: Scene, rng: np.random.Generator) -> PlanDraft | None:
    """A further subgoal moves something that nobody asked for."""
    others = unasked(where)
    if not plan.subgoals or not others:
        return None
    thing, place = others[0], plan.targets[-1]
    target = TargetDraft(id="T90", kind="object", words=f"the {thing}", part=None, where="", like=[], use=["pick"])
    extra = SubgoalDraft(
        id="G90",
        text=f"put {target.words} into {place.words}",
        after=[],
        targets=["T90", place.id],
        function=None,
    )
    return plan.model_copy(update={"subgoals": [*plan.subgoals, extra], "targets": [*plan.targets, target]})


PLAN_FAULTS: dict[str, Callable[[PlanDraft, Scene, np.random.Generator], PlanDraft | None]] = {
    "missing": missing,
    "swapped": swapped,
    "wrong target": wrong_target,
    "needless": needless,
}


def _with_subgoal(plan: PlanDraft, number: int, subgoal: SubgoalDraft) -> PlanDraft:
    return plan.model_copy(update={"subgoals": [*plan.subgoals[:number], subgoal, *plan.subgoals[number + 1 :]]})


def spoil(right: PlanDraft, where: Scene, rng: np.random.Generator, kinds: list[str]) -> tuple[str, PlanDraft] | None:
    """The first kind of fault that this plan and scene allow, and the plan with it; None when none does."""
    for kind in kinds:
        plan = PLAN_FAULTS[kind](right, where, rng)
        if plan is not None:
            return kind, plan
    return None


async def spoiled_plans(n: int, first: int) -> AsyncIterator[tuple[Scene, AgentSession, str, PlanDraft]]:
    """`n` plans with their scenes, in pairs: a right one ("none"), then the same with one fault, all kinds in turn."""
    rng = np.random.default_rng(first)
    done, kinds = 0, list(PLAN_FAULTS)
    for where in scenes(first):
        if done >= n:
            return
        session = session_for(where.shown)
        try:
            right: PlanDraft = await session.ask(DraftPlan(where.shown.task, PICK_PLACE.step_kinds, True), stage="plan")
        except WonderfulTeamError as error:
            print(f"    {where.task} seed {where.seed}: no draft to spoil: {error}")
            continue
        spoiled = spoil(right, where, rng, kinds)
        if spoiled is None:
            continue
        # The kind that was used goes to the end, so that all kinds come up as often as the scenes allow.
        kinds.sort(key=lambda kind: kind == spoiled[0])
        for kind, plan in (("none", right), spoiled):
            yield where, session, kind, plan
            done += 1


async def check_plans(n: int, first: int) -> dict[str, Confusion]:
    """Half of the plans are spoiled; Verification looks at each whole plan once."""
    by_kind: dict[str, Confusion] = {}
    async for where, session, kind, plan in spoiled_plans(n, first):
        question = ReviewPlan(where.shown.task, PICK_PLACE.step_kinds, plan.to_subgoals(), plan.to_targets())
        said = await objection(session, question, "plan")
        bad = kind != "none"
        by_kind[kind] = by_kind.get(kind, Confusion()).add(bad=bad, objected=said is not None)
        if bad != (said is not None):
            print(f"    {where.task} seed {where.seed}, fault {kind}: {said or 'approved'}")
    return by_kind


def total(by_kind: dict[str, Confusion]) -> Confusion:
    """All kinds in one matrix."""
    return Confusion(
        sum(m.caught for m in by_kind.values()),
        sum(m.missed for m in by_kind.values()),
        sum(m.false_alarms for m in by_kind.values()),
        sum(m.passed for m in by_kind.values()),
    )


def show(title: str, by_kind: dict[str, Confusion]) -> None:
    """Print one member's matrix, whole and by kind of fault."""
    print(f"\n{title}")
    print("\n".join(total(by_kind).lines()))
    for kind, matrix in by_kind.items():
        if kind != "none":
            print(f"    {kind:15s} caught {matrix.catch_rate}")


async def measure(options: argparse.Namespace) -> dict[str, Any]:
    """Run all three and print them."""
    print(f"model: offline; simulated tabletop; tasks {', '.join(TASKS)}; seeds from {options.first}")
    plans = await check_plans(options.n, options.first)
    show("Verification on plans", plans)
    boxes = await check_boxes(options.n, options.first)
    show("Checker on boxes", boxes)
    rate = await recover(options.n // 2, options.first)
    print(f"\nA wrong first box ends in a right point: {rate}")
    return {
        "verification": {kind: asdict(matrix) for kind, matrix in plans.items()},
        "checker": {kind: asdict(matrix) for kind, matrix in boxes.items()},
        "wrong_first_box": asdict(rate),
        "first_seed": options.first,
        "model": "offline",
    }


def main() -> None:
    """Parse arguments, run, print, and optionally write JSON."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=int, default=200, help="judgements per member, half of them of bad things")
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    record = asyncio.run(measure(options))
    if options.json:
        options.json.write_text(json.dumps(record, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
