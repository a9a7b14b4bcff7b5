"""Wrong boxes: does the Checker object to them, and does grounding recover from a wrong first one? Run by `planted_faults`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.confusion import Confusion
from benchmarks.planted_scenes import Scene, objection, scenes, session_for
from wonderful_team.contracts import (
    SceneReading,
)
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Target
from wonderful_team.evals import Rate
from wonderful_team.models.wrappers import Injecting, Injection
from wonderful_team.offline import OfflineModel
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.planning.jobs import Job
from wonderful_team.planning.judged import judge_box


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
        session = session_for(where.shown)
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
