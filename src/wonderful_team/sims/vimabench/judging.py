"""From the simulator's own word to a score, with the stage at which a trial failed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from wonderful_team.core.protocols import Score
from wonderful_team.core.text import counted

FAILURE = "the simulator says failure: a rule of the task was broken"


def score_of(said: Mapping[str, Any]) -> Score:
    """A score; None when the simulator itself failed and nothing can be said of the method.

    Args:
        said: The state, the steps with what they touched, and what is unmet.
    """
    if said["late"] and said["state"] == "open":
        return Score(None, None, "the simulator's arm did not arrive within its time: not scored")
    if said["state"] == "success":
        return Score(True, None, "every goal is met")
    reason = FAILURE if said["state"] == "failure" else _unmet(said["unmet"])
    if said["state"] == "open" and said["steps"] >= said["horizon"]:
        reason += f"; the horizon of {counted(said['horizon'], 'action')} was reached"
    upto = said["history"][: said["ended_at"] or said["horizon"]]
    return Score(False, _stage(said, upto), reason)


def _unmet(unmet: Sequence[Mapping[str, Any]]) -> str:
    if not unmet:
        return "not every goal is met"
    one = unmet[0]
    more = f"; {len(unmet) - 1} more" if len(unmet) > 1 else ""
    if one["zone"]:
        return f"not enough is in the area: {one['thing']} is {one['off_m']:.3f} m from its middle{more}"
    turned = f", turned {math.degrees(one['off_rad']):.0f} degrees off" if one["off_rad"] > 0 else ""
    return f"{one['thing']} is {one['off_m']:.3f} m from its place, allowed are {one['within_m']} m{turned}{more}"


def _stage(said: Mapping[str, Any], steps: Sequence[Mapping[str, Any]]) -> str | None:
    """Nothing or the table was touched: grounding; a wrong thing: wrong object; a wrong place or order: plan; else execution."""
    wanted = set(said["wanted"])
    if not steps:
        return None
    if said["pushed"]:
        moved = {name for step in steps for name in step["moved"]}
        if not moved:
            return "grounding"
        if not moved & wanted:
            return "wrong object"
        return "plan" if said["state"] == "failure" else "execution"
    if any(step["under_pick"] is None for step in steps):
        return "grounding"
    if any(step["under_pick"] not in wanted for step in steps):
        return "wrong object"
    if said["state"] == "failure":
        return "plan"
    for one in said["unmet"]:
        if all(step["under_pick"] != one["thing"] for step in steps):
            return "plan"
    return "execution"
