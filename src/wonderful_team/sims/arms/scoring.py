"""From where things ended to a score, with the stage at which a trial failed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from wonderful_team.core.geometry import Pose
from wonderful_team.core.protocols import Score
from wonderful_team.sims.arms.table import Grip
from wonderful_team.sims.tabletop.goals import Goal, Poses, off_table
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.rules import Rules

LOW_M = 0.025
"""What lies on a flat area has its bottom no higher than this: it does not lie on something else [m]."""


def lying(poses: Poses, things: Mapping[str, Thing]) -> dict[str, Pose]:
    """Poses as if everything lay on its foot where its middle is: a fruit that has rolled over lies where it lies."""
    found = {}
    for name, pose in poses.items():
        half = np.array([0.0, 0.0, things[name].body.height_m / 2])
        found[name] = Pose.at(pose.apply(half[None])[0] - half, pose.yaw_rad)
    return found


def met(goal: Goal, poses: Poses, things: Mapping[str, Thing], touched: Sequence[str]) -> str:
    """What is missing for a goal; "" when it is met: the thing lies there by itself, let go."""
    if off_table(poses[goal.thing]):
        return f"{goal.thing} fell off the table"
    if not goal.met(poses, things):
        where = (
            f"in or on {' or '.join(goal.inside)}"
            if goal.inside
            else f"off {', '.join(goal.off)}"
            if goal.off
            else "there"
        )
        return f"{goal.thing} is not {where}"
    if not goal.inside:
        return ""
    if goal.thing in touched:
        return f"{goal.thing} was not let go"
    bottom = float(poses[goal.thing].position_m[2])
    for name in goal.inside:
        place = things[name]
        rim = place.body.height_m if place.body.kind == "base" else LOW_M
        if bottom - float(poses[name].position_m[2]) < rim:
            return ""
    return f"{goal.thing} lies {100 * bottom:.1f} cm high, not down in {' or '.join(goal.inside)}"


def score_things(
    rules: Rules,
    poses: Poses,
    things: Mapping[str, Thing],
    touched: Sequence[str],
    grips: Sequence[Grip],
) -> Score:
    """Success when every goal is met as things lie now; else the first reason, and the stage.

    Args:
        rules: The goals.
        poses: Where things lie at the end.
        things: What they are.
        touched: What the robot still touches.
        grips: What the fingers closed on.
    """
    poses = lying(poses, things)
    missing = [(goal, why) for goal in rules.goals if (why := met(goal, poses, things, touched))]
    if not missing:
        return Score(True, None, "every goal is met")
    return Score(False, _stage([goal for goal, _ in missing], grips, things), "; ".join(why for _, why in missing))


def _stage(missing: Sequence[Goal], grips: Sequence[Grip], things: Mapping[str, Thing]) -> str:
    """Closed on nothing: grounding; on what no goal asks for: wrong object; never on what is asked for: plan; else execution."""
    if not grips:
        return "plan"
    if any(grip.at is None or things[grip.at].body.kind == "area" for grip in grips):
        return "grounding"
    at = {grip.at for grip in grips}
    if not at & {goal.thing for goal in missing}:
        return "wrong object" if len(at) == len(grips) else "plan"
    return "execution"
