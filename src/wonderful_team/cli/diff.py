"""`show RUN --diff RUN2`: two runs side by side: how they ended, their plans, their answers."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

from wonderful_team.cli.wording import action_line
from wonderful_team.core.text import ending_words, recorded_names, spoken
from wonderful_team.core.values import GroundedTarget, Plan

LABEL_WIDTH = 14
COLUMN_WIDTH = 46
NOT_ASKED = "(not asked)"
NOT_COMPARED = frozenset({"reasoning", "reason"})
"""Fields of an answer that explain and decide nothing."""


@dataclass(frozen=True)
class Row:
    """One line of the comparison."""

    label: str
    left: str
    right: str

    @property
    def same(self) -> bool:
        return self.left == self.right


@dataclass(frozen=True)
class Difference:
    """Two runs compared.

    Attributes:
        ends: Names, models, outcomes.
        plans: Plan by plan: subgoals, targets with their places, actions.
        answers: Requests whose answers differ, or that only one run asked.
        same_answers: How many requests both runs asked and answered alike.
        same_plans: Whether both made the same plans, by their ids.
    """

    ends: tuple[Row, ...]
    plans: tuple[Row, ...]
    answers: tuple[Row, ...]
    same_answers: int
    same_plans: bool

    def to_json(self) -> dict[str, Any]:
        """The comparison as JSON."""

        def rows(some: Iterable[Row]) -> list[dict[str, Any]]:
            return [{"what": row.label, "left": row.left, "right": row.right, "same": row.same} for row in some]

        return {
            "same_plans": self.same_plans,
            "same_answers": self.same_answers,
            "ends": rows(self.ends),
            "plans": rows(self.plans),
            "answers": rows(self.answers),
        }

    def lines(self) -> list[str]:
        """The comparison as text; "*" marks what differs."""
        text = [line for row in self.ends for line in _drawn(row)]
        text += ["", "plans: the same" if self.same_plans else "plans: different"]
        text += [line for row in self.plans for line in _drawn(row)]
        text += ["", f"answers: {self.same_answers} the same, {len(self.answers)} different or asked by one run only"]
        text += [line for row in self.answers for line in _drawn(row)]
        return text


def compare(one: tuple[Path, Mapping[str, Any]], two: tuple[Path, Mapping[str, Any]]) -> Difference:
    """Compare two runs, each given as its folder and its record."""
    plans = [_plans(folder, record) for folder, record in (one, two)]
    rows: list[Row] = []
    for number, (left, right) in enumerate(zip_longest(*plans), start=1):
        rows.append(Row(f"plan {number}", "" if left is None else left.id, "" if right is None else right.id))
        rows += _plan_rows(left, right)
    answers, same = _answer_rows(one[1], two[1])
    ids = [[plan.id for plan in made] for made in plans]
    names = [recorded_names(record["planner"]["instruction"]) for _, record in (one, two)]
    ends, rows, answers = ([_spoken(row, *names) for row in some] for some in (_ends(one, two), rows, answers))
    return Difference(tuple(ends), tuple(rows), tuple(answers), same, ids[0] == ids[1])


def _spoken(row: Row, left: Mapping[str, str], right: Mapping[str, str]) -> Row:
    """The row with pictures called as people call them, each side by its own instruction."""
    return Row(row.label, spoken(row.left, left), spoken(row.right, right))


def _ends(one: tuple[Path, Mapping[str, Any]], two: tuple[Path, Mapping[str, Any]]) -> list[Row]:
    def told(record: Mapping[str, Any]) -> list[tuple[str, str]]:
        configuration, outcome = record["configuration"], record["outcome"] or {"outcome": record["state"]}
        stage = f" at {outcome['stage']}" if outcome.get("stage") else ""
        ending, reason = ending_words(str(outcome["outcome"]), outcome.get("reason"))
        return [
            ("instruction", str((record["planner"]["instruction"] or {}).get("text", ""))),
            ("model", str(configuration.get("model", ""))),
            ("method", str(configuration.get("method", ""))),
            ("outcome", f"{ending}{stage} {reason}".strip()),
            ("requests", str(len(record["planner"]["requests"]))),
        ]

    (left_folder, left), (right_folder, right) = one, two
    rows = [Row("run", left_folder.resolve().name, right_folder.resolve().name)]
    return rows + [Row(name, a, b) for (name, a), (_, b) in zip(told(left), told(right), strict=True)]


def _plans(folder: Path, record: Mapping[str, Any]) -> list[Plan]:
    from wonderful_team.record.stored import stored_plan

    return [stored_plan(folder, record, number) for number in range(len(record["planner"]["plans"]))]


def _plan_rows(left: Plan | None, right: Plan | None) -> list[Row]:
    rows = []
    told = [_plan_told(plan) for plan in (left, right)]
    for label in dict.fromkeys([*told[0], *told[1]]):
        rows.append(Row(label, told[0].get(label, ""), told[1].get(label, "")))
    return rows


def _plan_told(plan: Plan | None) -> dict[str, str]:
    """A plan as named lines."""
    if plan is None:
        return {}
    words = {target.id: target.words for target in plan.targets}
    told = {"status": f"{plan.status} {plan.message}".strip()}
    told |= {f"subgoal {subgoal.id}": subgoal.text for subgoal in plan.subgoals}
    told |= {f"target {target.id}": _target_told(target.words, plan.grounded.get(target.id)) for target in plan.targets}
    told |= {
        f"question {number}": f"{doubt.about}: {doubt.question}" for number, doubt in enumerate(plan.questions, start=1)
    }
    told |= {f"action {number}": action_line(planned, words) for number, planned in enumerate(plan.actions, start=1)}
    return told


def _target_told(words: str, found: GroundedTarget | None) -> str:
    if found is None:
        return f"{words} (not looked for)"
    box = "" if found.box is None else " box ({:.0f}, {:.0f}, {:.0f}, {:.0f})".format(*found.box.as_tuple)
    points = "".join(f" {role} ({x:.1f}, {y:.1f})" for role, (x, y) in found.points.items())
    return f"{words} ({found.status}){box}{points}"


def _answer_rows(left: Mapping[str, Any], right: Mapping[str, Any]) -> tuple[list[Row], int]:
    told = [{entry["key"]: entry for entry in record["planner"]["requests"]} for record in (left, right)]
    rows, same = [], 0
    for key in dict.fromkeys([*told[0], *told[1]]):
        ends = [_end_told(entries.get(key)) for entries in told]
        if ends[0] == ends[1]:
            same += 1
        elif NOT_ASKED in ends:
            rows.append(Row(key.removesuffix(" try 1"), *("asked" if end != NOT_ASKED else end for end in ends)))
        else:
            rows.append(Row(key.removesuffix(" try 1"), *ends))
    return rows, same


def _end_told(entry: Mapping[str, Any] | None) -> str:
    """What came back to a request, in a line; explanations are left out."""
    if entry is None:
        return NOT_ASKED
    if entry["answer"]:
        return json.dumps(_without(entry["answer"]["parsed"]), ensure_ascii=False)
    if entry["invalid"]:
        return f"INVALID {entry['invalid']['error']}"
    failed = entry.get("failed")
    return f"{failed['error']}: {failed['message']}" if failed else "(no answer)"


def _without(value: Any) -> Any:
    match value:
        case Mapping():
            return {key: _without(item) for key, item in value.items() if key not in NOT_COMPARED}
        case list():
            return [_without(item) for item in value]
        case float():
            return round(value, 2)
    return value


def _drawn(row: Row) -> list[str]:
    """A row in two columns."""
    label = row.label if len(row.label) <= LABEL_WIDTH else ""
    lines = [] if label else [row.label]
    left, right = (textwrap.wrap(text, COLUMN_WIDTH) or [""] for text in (row.left, row.right))
    for number, (a, b) in enumerate(zip_longest(left, right, fillvalue="")):
        mark = " " if row.same else "*"
        lines.append(f"{label if number == 0 else '':<{LABEL_WIDTH}} {mark} {a:<{COLUMN_WIDTH}} | {b}".rstrip())
    return lines
