"""A pick and place as the steps of an arm with a gripper: what follows from a plan that says it, and for models that write steps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from wonderful_team.contracts.steps import StepList, step_list_type
from wonderful_team.core.actions import At, Beside, OriginOf, PickPlaceStep, Place, Step

NEEDED = ("move", "open", "close")
"""Kinds of step without which an arm picks nothing up."""
SQUARE_DEG = 90.0
"""Between two grips that centre the fingers on a thing [degrees]."""


def steps_of_moves(moves: Sequence[PickPlaceStep], step_kinds: Sequence[str]) -> tuple[Step, ...]:
    """Picks and places as the steps of a robot that has no such step, but can carry; else as they are."""
    if "pick_place" in step_kinds:
        return tuple(moves)
    written = [
        step
        for move in moves
        for step in arm_steps(move.subgoal, move.pick, _as_draft(move.place), move.rotate_deg, step_kinds)
    ]
    made: StepList = step_list_type(tuple(step_kinds)).model_validate({"reasoning": "", "steps": written})
    return made.to_steps()


def _as_draft(place: Place) -> dict[str, Any]:
    how = {At: "at", Beside: "beside", OriginOf: "origin"}[type(place)]
    return {"target": place.target, "how": how, "side": getattr(place, "side", None)}


def can_carry(step_kinds: Sequence[str]) -> bool:
    """Whether an arm with these kinds of step can pick a thing up and put it down."""
    return set(NEEDED) <= set(step_kinds)


def arm_steps(
    subgoal: str,
    pick: str,
    place: Mapping[str, Any],
    rotate_deg: float,
    step_kinds: Sequence[str],
    *,
    tight: bool = False,
    twist_deg: float = 0.0,
    function: str | None = None,
) -> list[dict[str, Any]]:
    """Over the thing, down, close, up, turn, over the place, down, open, up, and out of the cameras' sight, as `StepList` takes them.

    Every way across the table is made clear of everything; only then the tool goes down.

    Args:
        subgoal: That they carry out.
        pick: Id of the target that is picked.
        place: Where it goes, as a PlaceDraft.
        rotate_deg: How far it is turned clockwise.
        step_kinds: What the robot runs; without `rotate_gripper` nothing is turned, without `home` it stays over the place.
        tight: Whether the gripper keeps squeezing.
        twist_deg: How far the thing is turned clockwise where it is, before it is lifted, as to screw it off. It is gripped twice,
            a quarter apart, so that the fingers turn about its axis though the camera was some millimetres off.
        function: Whose path it follows in the air before it is put down, as to shake it.
    """
    thing = {"target": pick, "how": "at", "side": None}

    def move(to: Mapping[str, Any], height: str) -> dict[str, Any]:
        return {"kind": "move", "subgoal": subgoal, "to": dict(to), "height": height}

    def rotated(angle_deg: float) -> list[dict[str, Any]]:
        return [{"kind": "rotate_gripper", "subgoal": subgoal, "rotate_deg": angle_deg}] if angle_deg else []

    def closed(tight: bool) -> dict[str, Any]:
        return {"kind": "close", "subgoal": subgoal, "tight": tight}

    # One grip puts the fingers' middle over a thing along the way they close alone: what is to be turned about its own axis
    # is gripped once across that turn first, and the turn itself needs no more room than before.
    across = math.copysign(SQUARE_DEG, -twist_deg)
    centred = [closed(False), {"kind": "open", "subgoal": subgoal}, *rotated(across)] if twist_deg else []
    path = [{"kind": "follow", "subgoal": subgoal, "function": function, "contact": "air"}] if function else []
    home = [{"kind": "home", "subgoal": subgoal}] if "home" in step_kinds else []
    return [
        {"kind": "open", "subgoal": subgoal},
        move(thing, "clear"),
        move(thing, "above"),
        move(thing, "at"),
        *centred,
        closed(tight),
        *rotated(twist_deg),
        move(thing, "clear"),
        *path,
        *rotated(rotate_deg),
        move(place, "clear"),
        move(place, "at"),
        {"kind": "open", "subgoal": subgoal},
        move(place, "clear"),
        *home,
    ]
