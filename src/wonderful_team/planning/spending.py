"""Where the lean way asks more: the reasons, in words. A plain plan and a plain target have none, and are asked about less.

What a model itself says it is not sure of counts first; then what is known to go wrong: look-alikes, small things, angles,
pushes, paths, and whatever went wrong before.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from wonderful_team.contracts import SceneTarget, can_carry
from wonderful_team.core.actions import At, PickPlaceStep, Step
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import Subgoal, Target
from wonderful_team.motion.places import TO_PICK, TO_PLACE

SAME_ANGLE_DEG = 0.5
"""Turns that differ by no more are the same [degrees]."""
SMALL_SHARE = 1.0 / 32.0
"""A thing whose longer side is less than this share of the view's longer side is small (20 px of 640)."""
AGREE_SHARE = 0.15
"""Guesses agree when none lies further from their middle than this share of the target's shorter side …"""
AGREE_VIEW_SHARE = 0.01
"""… or, where no box of the target is known yet, of the view's longer side (6 px of 640)."""
COMPACT = 2.0
"""A box is compact when its longer side is at most this many times its shorter one."""
CENTRAL_SHARE = 1.0 / 6.0
"""A point is central when it lies in the middle cell of a grid of three by three: this share of the box off its middle."""


def plan_reasons(
    subgoals: Sequence[Subgoal],
    moves: Sequence[PickPlaceStep],
    instruction: str,
    *,
    unsure: str = "",
    full: bool = False,
    doubted: bool = False,
    failed: bool = False,
) -> tuple[str, ...]:
    """Why a plan is checked by itself before anything is looked for; none for a plain one.

    Args:
        subgoals: Of the plan.
        moves: The picks and places that its subgoals state.
        instruction: The user's words: an angle that they state is not in doubt.
        unsure: What the Supervisor says that it is not sure of.
        full: The Supervisor asks for a full check.
        doubted: Verification has doubted the plan before.
        failed: Something went wrong before.
    """
    said = {move.subgoal for move in moves}
    unsaid = [subgoal.id for subgoal in subgoals if subgoal.id not in said or subgoal.function]
    turned = [step.subgoal for step in inferred_turns(moves, instruction)]
    reasons = {
        "nothing is to be done": not subgoals,
        f"the Supervisor is not sure: {unsure}": bool(unsure),
        "the Supervisor asks for a full check": full,
        "it was doubted": doubted,
        "something went wrong before": failed,
        f"more than a pick and a place: {', '.join(unsaid)}": bool(unsaid),
        f"an angle that no words state: {', '.join(turned)}": bool(turned),
    }
    return tuple(reason for reason, holds in reasons.items() if holds)


def inferred_turns(steps: Iterable[Step], instruction: str) -> list[Step]:
    """The steps that turn something by an angle that does not stand in the instruction's words."""
    stated = [float(number) for number in re.findall(r"\d+(?:\.\d+)?", instruction)]
    return [
        step
        for step in steps
        if (turn := abs(float(getattr(step, "rotate_deg", 0.0))))
        and not any(abs(turn - number) <= SAME_ANGLE_DEG for number in stated)
    ]


def steps_said(
    subgoals: Sequence[Subgoal], targets: Sequence[Target], moves: Sequence[PickPlaceStep], step_kinds: Sequence[str]
) -> bool:
    """Whether the plan says everything that its steps need: one pick and one place for each subgoal, with their points."""
    by_id = {target.id: target for target in targets}
    turns = any(move.rotate_deg for move in moves)
    return (
        ("pick_place" in step_kinds or (can_carry(step_kinds) and ("rotate_gripper" in step_kinds or not turns)))
        and [move.subgoal for move in moves] == [subgoal.id for subgoal in subgoals]
        and not any(subgoal.function for subgoal in subgoals)
        and all(_has_points(move, by_id) for move in moves)
    )


def _has_points(move: PickPlaceStep, by_id: Mapping[str, Target]) -> bool:
    lands = set(by_id[move.place.target].roles) if isinstance(move.place, At) else set(TO_PLACE)
    return bool(set(by_id[move.pick].roles) & set(TO_PICK)) and bool(lands & set(TO_PLACE))


def target_reason(target: Target, read: SceneTarget, box: Box, view_px: tuple[int, int]) -> str:
    """Why a target's box is judged by itself; "" for a plain one.

    Args:
        target: What was looked for.
        read: What the Manager said of it.
        box: Where it is [view px].
        view_px: Width and height of the view.
    """
    if read.unsure:
        return f"the Manager is not sure: {read.unsure}"
    if target.kind == "object" and target.where:
        return f"told apart by where it is: {target.where}"
    if "push_start" in target.roles:
        return "it is pushed"
    if target.kind == "object" and max(box.width, box.height) < SMALL_SHARE * max(view_px):
        return "small"
    return ""


def agree(points: Sequence[Point], box: Box | None, view_px: tuple[int, int]) -> Point | None:
    """The guess nearest to the middle of all, where they agree; None where they do not.

    Args:
        points: In view pixels.
        box: The last box of the target, if there was one [view px].
        view_px: Width and height of the view.
    """
    reach = AGREE_VIEW_SHARE * max(view_px) if box is None else AGREE_SHARE * min(box.width, box.height)
    middle = (sum(x for x, _ in points) / len(points), sum(y for _, y in points) / len(points))
    off = [max(abs(x - middle[0]), abs(y - middle[1])) for x, y in points]
    return points[off.index(min(off))] if max(off) <= reach else None


def is_central(point: Point, box: Box) -> bool:
    """Whether a point lies in the middle of a compact box: then it need not be chosen more finely."""
    (x, y), (cx, cy) = point, box.centre
    compact = max(box.width, box.height) <= COMPACT * min(box.width, box.height)
    return compact and abs(x - cx) <= CENTRAL_SHARE * box.width and abs(y - cy) <= CENTRAL_SHARE * box.height
