"""From what happened to a score, with the stage at which a trial failed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from wonderful_team.actions import PickPlace
from wonderful_team.interfaces import Score
from wonderful_team.sims.tabletop.goals import Goal, Poses, Rules, Verdict
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.suction import Picked


@dataclass(frozen=True, eq=False)
class Happened:
    """One action and the truth after it; the first entry of a history has no action."""

    poses: Poses
    verdict: Verdict
    action: PickPlace | None = None
    picked: Picked | None = None


def score_of(rules: Rules, history: Sequence[Happened], things: Mapping[str, Thing]) -> Score:
    """Judge a history: the first end that was reached counts, and nothing after the horizon does."""
    judged = history[: rules.horizon + 1]
    if rules.ends_when_reached:
        ends = [entry for entry in judged[1:] if entry.verdict.state != "open"]
        end = ends[0] if ends else judged[-1]
    else:
        failed = [entry for entry in judged if entry.verdict.state == "failure"]
        end = failed[0] if failed else judged[-1]
    if end.verdict.state == "success":
        return Score(True, None, f"all {len(rules.goals)} goals are met")
    upto = judged[: list(judged).index(end) + 1]
    reason = end.verdict.reason or _unmet(rules, end.poses, things)
    if len(history) - 1 > rules.horizon and end.verdict.state == "open":
        reason += f"; the horizon of {rules.horizon} actions was reached"
    return Score(False, _stage(rules, upto, things), reason)


def _unmet(rules: Rules, poses: Poses, things: Mapping[str, Thing]) -> str:
    missing = [goal.thing for goal in rules.goals if not goal.met(poses, things)]
    return f"goals not met: {', '.join(missing)}" if missing else "nothing was done"


def _stage(rules: Rules, history: Sequence[Happened], things: Mapping[str, Thing]) -> str | None:
    """A point on no object: grounding; on a wrong one: wrong object; right ones but wrongly used: plan; else execution."""
    done = [(before, after) for before, after in zip(history, history[1:], strict=False) if after.picked is not None]
    if not done:
        return None
    wanted = {goal.thing for goal in rules.goals}
    for _, after in done:
        if after.picked is not None and after.picked.under_pick is None:
            return "grounding"
        if after.picked is not None and after.picked.under_pick not in wanted:
            return "wrong object"
    final = history[-1].poses
    for goal in rules.goals:
        if goal.met(final, things):
            continue
        last = [(b, a) for b, a in done if a.picked is not None and a.picked.under_pick == goal.thing]
        if not last:
            return "plan"
        before, after = last[-1]
        stage = _stage_of_move(goal, before, after, things)
        if stage is not None:
            return stage
    return "execution"


def _stage_of_move(goal: Goal, before: Happened, after: Happened, things: Mapping[str, Thing]) -> str | None:
    """Why one thing is not where it should be, from where it was told to go; None if it was told right."""
    action, picked = after.action, after.picked
    if action is None or picked is None:
        return None
    place = (float(action.place_m[0]), float(action.place_m[1]))
    targets = goal.target_points(before.poses)
    right_things = (*goal.near, *goal.inside)
    aimed_well = any(math.dist(place, target) < goal.within_m for target in targets) or (
        picked.under_place is not None and picked.under_place in right_things
    )
    if right_things and not aimed_well:
        return "grounding" if picked.under_place in (None, goal.thing) else "wrong object"
    if targets and not aimed_well:
        return "plan"
    if goal.off and picked.under_place in goal.off:
        return "plan"
    if goal.yaw_rad is not None:
        told = before.poses[goal.thing].yaw_rad + action.yaw_rad
        if abs(math.remainder(told - goal.yaw_rad, 2 * math.pi)) > math.radians(15):
            return "plan"
    return None
