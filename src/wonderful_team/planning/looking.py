"""A look after every action whose outcome is not certain: only the first part of a plan runs, then it is planned anew.

Where a push leaves a thing is decided by friction; what a plan believes of the second push is worth less than a new picture.
A thing that was picked lies where it was put, so plans of picking and placing run whole.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby

from wonderful_team.agents import step_words
from wonderful_team.core.actions import PushStep
from wonderful_team.core.values import Plan

MOST_DONE = 30
"""Most lines of what was carried out that a question holds: what is left to do is seen in the new picture, and words cost with every question."""


def is_uncertain(plan: Plan) -> bool:
    """Whether every step pushes: then a look after each of them is worth its questions."""
    return bool(plan.steps) and all(isinstance(step, PushStep) for step in plan.steps)


def first_part(plan: Plan) -> Plan:
    """The plan up to its first action: what runs before the next look. Subgoals and targets stay, to be read."""
    return replace(plan, steps=plan.steps[:1], actions=plan.actions[:1])


def done_lines(plan: Plan) -> tuple[str, ...]:
    """What the Supervisor is told of what ran before a new picture, one line per step."""
    subgoals = {subgoal.id: subgoal.text for subgoal in plan.subgoals}
    return tuple(
        f"{_named(step_words(step).partition('] ')[2], plan)}, for '{subgoals.get(step.subgoal, step.subgoal)}'"
        for step in plan.steps
    )


def condensed(lines: Sequence[str]) -> tuple[str, ...]:
    """What was carried out, for a question: what ran several times in a row stands once with its number; of many lines the last ones."""
    runs = [(line, len(list(same))) for line, same in groupby(lines)]
    left_out = sum(count for _, count in runs[:-MOST_DONE])
    told = [line if count == 1 else f"{line} ({count} times)" for line, count in runs[-MOST_DONE:]]
    return (f"{left_out} steps before these", *told) if left_out else tuple(told)


def _named(text: str, plan: Plan) -> str:
    """A step with its targets in words: a new plan has ids of its own."""
    words = {target.id: f"the {target.words}" for target in plan.targets}
    return re.sub(r"\b\w+\b", lambda match: words.get(match.group(), match.group()), text)
