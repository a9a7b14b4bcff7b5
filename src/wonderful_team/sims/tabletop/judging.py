"""From what happened to a score, with the stage at which a trial failed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from wonderful_team.core.actions import PickPlace, Push
from wonderful_team.core.protocols import Score
from wonderful_team.core.text import counted
from wonderful_team.sims.tabletop.goals import Goal, Poses, Verdict
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.rules import Rules, RuleState
from wonderful_team.sims.tabletop.suction import Picked

MOVED_M = 0.004
"""How far a thing must have moved to count as pushed [m]."""


@dataclass(frozen=True, eq=False)
class Happened:
    """One action and the truth after it; the first entry of a history has no action."""

    poses: Poses
    progress: RuleState
    action: PickPlace | Push | None = None
    picked: Picked | None = None

    @property
    def verdict(self) -> Verdict:
        return self.progress.verdict


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
        return Score(True, None, "every goal is met")
    upto = judged[: list(judged).index(end) + 1]
    reason = end.verdict.reason or rules.unmet(end.progress)
    if len(history) - 1 > rules.horizon and end.verdict.state == "open":
        reason += f"; the horizon of {counted(rules.horizon, 'action')} was reached"
    return Score(False, _stage(rules, upto, things), reason)


def reached_of(rules: Rules, history: Sequence[Happened]) -> int:
    """How many goals held after some action that did not at the start, and how many things were gathered that were not."""
    start, *after = history[: rules.horizon + 1]
    goals = {goal for entry in after for goal in entry.progress.met} - start.progress.met
    gathered = [
        frozenset().union(*(entry.progress.counted[place] for entry in after)) - before
        for place, before in enumerate(start.progress.counted)
        if after
    ]
    return len(goals) + sum(map(len, gathered))


def _stage(rules: Rules, history: Sequence[Happened], things: Mapping[str, Thing]) -> str | None:
    """A point on no object: grounding; on a wrong one: wrong object; right ones but wrongly used: plan; else execution."""
    pairs = list(zip(history, history[1:], strict=False))
    if any(isinstance(after.action, Push) for _, after in pairs):
        return _stage_of_pushes(rules, pairs)
    done = [(before, after, after.picked) for before, after in pairs if after.picked is not None]
    if not done:
        return None
    if any(picked.under_pick is None for _, _, picked in done):
        return "grounding"
    if any(picked.under_pick not in rules.wanted for _, _, picked in done):
        return "wrong object"
    last = history[-1]
    if last.verdict.state == "failure" and rules.order != "free" and "later goal" in last.verdict.reason:
        return "plan"
    for goal in rules.phases[last.progress.phase]:
        if goal in last.progress.done:
            continue
        moves = [(b, a) for b, a, picked in done if picked.under_pick == goal.thing]
        if not moves:
            return "plan"
        stage = _stage_of_move(goal, *moves[-1], things)
        if stage is not None:
            return stage
    return "plan" if last.progress.phase < len(rules.phases) - 1 else "execution"


def _stage_of_pushes(rules: Rules, pairs: Sequence[tuple[Happened, Happened]]) -> str:
    """Nothing was moved: grounding; only what does not count: wrong object; a rule was broken: plan; else execution."""
    moved = set()
    for before, after in pairs:
        moved |= {n for n, p in after.poses.items() if math.dist(p.position_m, before.poses[n].position_m) > MOVED_M}
    if not moved:
        return "grounding"
    if not moved & rules.wanted:
        return "wrong object"
    return "plan" if pairs[-1][1].verdict.state == "failure" else "execution"


def _stage_of_move(goal: Goal, before: Happened, after: Happened, things: Mapping[str, Thing]) -> str | None:
    """Why one thing is not where it should be, from where it was told to go; None if it was told right."""
    action, picked = after.action, after.picked
    if not isinstance(action, PickPlace) or picked is None:
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
