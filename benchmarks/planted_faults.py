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
from collections.abc import AsyncIterator, Callable, Iterator
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.confusion import Confusion
from benchmarks.offline_success import VIMA
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import (
    DraftPlan,
    PlanDraft,
    PlanReview,
    Question,
    ReviewPlan,
    SceneReading,
    WalkedReview,
)
from wonderful_team.contracts.plans import SubgoalDraft, TargetDraft
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Target
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.evals import Rate
from wonderful_team.models.client import ModelClient
from wonderful_team.models.wrappers import Injecting, Injection
from wonderful_team.offline import OfflineModel
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.planning.jobs import Job
from wonderful_team.planning.judged import judge_box
from wonderful_team.planning.session import AgentSession
from wonderful_team.sims.tabletop import TabletopWorld, make_world

TASKS = (*VIMA, "fruit_placement/both", "fruit_placement/misplaced")


@dataclass
class Scene:
    """One world with what is shown of it and what is true of it."""

    task: str
    seed: int
    world: TabletopWorld
    shown: SceneShown
    masks: dict[str, np.ndarray] = field(repr=False)

    @property
    def truth(self) -> Any:
        return self.world.privileged.truth()

    def box(self, name: str) -> Box:
        """Tight box of a thing in the main view [px]."""
        rows, columns = np.nonzero(self.masks[name])
        return Box(columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)


@lru_cache(maxsize=8)
def scene(task: str, seed: int) -> Scene:
    """Set one scene up."""
    world = make_world(task, seed=seed)
    shown = SceneShown(world.observe(), world.instruction, PICK_PLACE, world.limits)
    return Scene(task, seed, world, shown, world.privileged.masks())


def scenes(first: int) -> Iterator[Scene]:
    """Scenes of all tasks in turn, for ever."""
    seed = first
    while True:
        for task in TASKS:
            yield scene(task, seed)
        seed += 1


def desk_for(shown: SceneShown) -> AgentSession:
    return AgentSession(ModelClient(OfflineModel()), TeamConfig(ablation="s8"), shown.instruction.text)


async def objection(session: AgentSession, question: Question, stage: str) -> str | None:
    """What the member objects, or None when it lets the thing pass. A member that refuses to judge objects."""
    try:
        answer = await session.ask(question, stage=stage)
    except WonderfulTeamError as error:
        return f"refused: {str(error)[:160]}"
    if isinstance(answer, PlanReview | WalkedReview):
        return answer.doubt.question[:160] if answer.doubt else None
    return None if answer.decision == "accept" else f"{answer.decision}: {answer.problem[:160]}"


def unasked(where: Scene) -> list[str]:
    """Things that the instruction asks nobody to move and to put nothing on."""
    asked = {name for goal in where.truth["goals"] for name in (goal["thing"], *goal["near"])}
    return [name for name, thing in where.truth["things"].items() if name not in asked and thing["kind"] != "area"]


# --- plans ---------------------------------------------------------------------------------------------------------


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
        session = desk_for(where.shown)
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


# --- boxes ---------------------------------------------------------------------------------------------------------


def target_for(where: Scene, name: str) -> Target:
    """A target as a plan would name that thing: by its picture where the instruction has one, else by words."""
    slots = {thing: slot for slot, thing in where.truth["slots"].items() if thing}
    kind = where.truth["things"][name]["kind"]
    if name in slots:
        return Target("T1", "object", f"the object shown in {{{slots[name]}}}", source="slot", like=(slots[name],))
    return Target("T1", "object", f"the {name}" + (" of paper" if kind == "area" and "area" not in name else ""))


def wrong_box(where: Scene, name: str, kind: str, rng: np.random.Generator) -> Box | None:
    """A box with the named fault; None where the scene offers none."""
    right, whole = where.box(name), Box(0, 0, *where.shown.view.size_px)
    match kind:
        case "none":
            # Nobody draws a box to the pixel: right ones are off by up to 4 % of their side.
            jitter = rng.uniform(-0.04, 0.04, 4) * (right.width, right.height, right.width, right.height)
            return right.grown(*jitter).intersection(whole)
        case "shifted":
            radii, angle = rng.uniform(0.5, 4.0), rng.uniform(0, 2 * np.pi)
            shift = (radii * right.width / 2 * np.cos(angle), radii * right.height / 2 * np.sin(angle))
            box = right.shifted(*shift).intersection(whole)
            return box if box is not None and min(box.width, box.height) >= 8 else None
        case "another thing":
            others = [other for other in where.masks if other != name and where.masks[other].sum() > 100]
            return where.box(others[int(rng.integers(len(others)))]) if others else None
        case _:
            anything = np.any(list(where.masks.values()), axis=0)
            for _ in range(200):
                x, y = (
                    rng.uniform(right.width, whole.x1 - right.width),
                    rng.uniform(right.height, whole.y1 - right.height),
                )
                box = Box.around((x, y), right.width, right.height).intersection(whole)
                if box and not anything[int(box.y0) : int(box.y1) + 1, int(box.x0) : int(box.x1) + 1].any():
                    return box
            return None


BOX_FAULTS = ("shifted", "another thing", "bare table")


async def check_boxes(n: int, first: int) -> dict[str, Confusion]:
    """Half of the boxes are wrong; the Checker judges each crop once."""
    rng = np.random.default_rng(first)
    by_kind: dict[str, Confusion] = {}
    done = 0
    for where in scenes(first):
        if done >= n:
            return by_kind
        names = [goal["thing"] for goal in where.truth["goals"]]
        name = names[int(rng.integers(len(names)))]
        target = target_for(where, name)
        session = desk_for(where.shown)
        for kind in ("none", BOX_FAULTS[done // 2 % len(BOX_FAULTS)]):
            box = wrong_box(where, name, kind, rng)
            if box is None:
                continue
            job = Job(session, where.shown, target, 0, (), where.shown.examples([target]))
            said = await objection(session, judge_box(job, box, {}), "ground")
            bad = kind != "none"
            by_kind[kind] = by_kind.get(kind, Confusion()).add(bad=bad, objected=said is not None)
            done += 1
            if bad != (said is not None):
                print(f"    {where.task} seed {where.seed}, {name}, fault {kind}: {said or 'accepted'}")
    return by_kind


# --- wrong first boxes -----------------------------------------------------------------------------------------------


def shift_first_box(rng: np.random.Generator) -> Callable[[Any, Any], Any | None]:
    """Shift the first found box by 0.5 to 4 radii in any direction, its points with it."""

    def change(value: SceneReading, request: Any) -> Any | None:
        width, height = request.question.view.size_px
        for number, item in enumerate(value.targets):
            if item.box is None:
                continue
            box = item.box.as_box
            for _ in range(100):
                radii, angle = rng.uniform(0.5, 4.0), rng.uniform(0, 2 * np.pi)
                dx, dy = radii * box.width / 2 * np.cos(angle), radii * box.height / 2 * np.sin(angle)
                new = box.shifted(dx, dy)
                if new.x0 >= 0 and new.y0 >= 0 and new.x1 <= width and new.y1 <= height:
                    break
            else:
                return None
            moved = item.box.model_copy(update=dict(zip(("x0", "y0", "x1", "y1"), new.as_tuple, strict=True)))
            points = [
                p.model_copy(update={"point": p.point.model_copy(update={"x": p.point.x + dx, "y": p.point.y + dy})})
                for p in item.points
            ]
            wrong = item.model_copy(update={"box": moved, "points": points})
            return value.model_copy(update={"targets": [*value.targets[:number], wrong, *value.targets[number + 1 :]]})
        return None

    return change


async def recover(n: int, first: int) -> Rate:
    """Ground whole plans whose first box is wrong from the start; count right points in the end."""
    rng = np.random.default_rng(first)
    right = done = 0
    for where in scenes(first):
        if done >= n:
            return Rate(right, done)
        injection = Injection(("ReadScene",), shift_first_box(rng), "first box shifted")
        team = TeamPolicy(Injecting(OfflineModel(), [injection]), TeamConfig(mode="lean"))
        plan = await team.make_plan(
            where.world.observe(), where.world.instruction, PICK_PLACE, where.world.limits, until="grounded"
        )
        if not injection.struck:
            continue
        done += 1
        item = next(iter(plan.grounded.values()), None)
        point = next(iter(item.points.values()), None) if item else None
        goals = {goal["thing"] for goal in where.truth["goals"]}
        hit = point is not None and any(where.masks[name][int(point[1]), int(point[0])] for name in goals)
        right += hit
        if not hit:
            print(f"    {where.task} seed {where.seed}: {plan.status}: {item.status if item else plan.message}")
    return Rate(right, done)


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
