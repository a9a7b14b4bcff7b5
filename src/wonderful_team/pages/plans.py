"""4 and 8: the plan with its first draft as a diff, and what each replan changed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from markupsafe import Markup, escape

from wonderful_team.core.values import refusal_words
from wonderful_team.pages.look_up import chapters, target_words
from wonderful_team.pages.words import step_words, word_diff


def plans(record: dict[str, Any]) -> list[dict[str, Any]]:
    """Every plan: subgoals as a diff against its own first draft, questions, steps, helper functions."""
    before: dict[str, Any] = {}
    found = []
    for _, name, content in chapters(record):
        found.append(_plan(name, content, before))
        before = content
    return found


def _plan(name: str, current: dict[str, Any], last: dict[str, Any]) -> dict[str, Any]:
    before = current["first_draft"] or current["subgoals"]
    rows, names = diff_rows(before, current["subgoals"]), target_words(current)
    return {
        "name": name,
        "id": current["id"],
        "mode": current["mode"].replace("_", " "),
        "verified": current["verified"],
        "rows": rows,
        "changed": any(row["kind"] != "same" for row in rows),
        "questions": current["questions"],
        "steps": [{"subgoal": step["subgoal"], "words": step_words(step, names)} for step in current["steps"]],
        "message": current["message"],
        **_functions(current, last),
    }


def _functions(current: dict[str, Any], last: dict[str, Any]) -> dict[str, Any]:
    """The helper functions that this plan brought, and the names of those that its steps could call; earlier releases kept none."""
    known = [one["name"] for one in last.get("functions", ())]
    return {
        "functions": [one for one in current.get("functions", ()) if one["name"] not in known],
        "known": [one["name"] for one in current.get("functions", ()) if one["name"] in known],
    }


def diff_rows(before: Sequence[dict[str, Any]], after: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """Subgoals side by side by id: same, changed, added, removed."""
    old = {goal["id"]: goal for goal in before}
    rows = []
    for goal in after:
        was = old.pop(goal["id"], None)
        same = was is not None and was["text"] == goal["text"]
        kind = "added" if was is None else "same" if same else "changed"
        text = escape(goal["text"]) if was is None or same else word_diff(was["text"], goal["text"])
        if was is None:
            text = Markup("<ins>{}</ins>").format(goal["text"])
        rows.append({**goal, "kind": kind, "shown": text})
    for goal in old.values():
        rows.append({**goal, "kind": "removed", "shown": Markup("<del>{}</del>").format(goal["text"])})
    return rows


def replans(record: dict[str, Any]) -> list[dict[str, Any]]:
    """For each plan after the first: what was believed, what was seen, what changed."""
    planner = record["planner"]
    made = planner["plans"]
    found = []
    for number in range(1, len(made)):
        before, after = made[number - 1]["plan"], made[number]["plan"]
        verdicts = _last_said(planner, number - 1)
        refusal = [
            refusal_words(check["name"], check["value"], check["limit"])
            for gate in planner["gates"]
            if not gate["admitted"] and gate["plan"] == number - 1
            for check in gate["checks"]
            if not check["ok"]
        ]
        found.append(
            {
                "number": number,
                "believed": before["subgoals"],
                "verdicts": verdicts,
                "refusal": [] if verdicts else refusal,
                "stopped": _stopped(planner, number - 1),
                "unready": "" if before["status"] == "planned" else before["message"],
                "rows": diff_rows(before["subgoals"], after["subgoals"]),
                "steps": [step_words(step, target_words(after)) for step in after["steps"]],
                "status": after["status"].replace("_", " "),
            }
        )
    return found


def _plan_of(planner: dict[str, Any], subgoals: int) -> int | None:
    """Which plan the last of so many subgoals that ran belongs to."""
    ran = planner["subgoals"][:subgoals]
    return ran[-1]["plan"] if ran else None


def _last_said(planner: dict[str, Any], number: int) -> list[dict[str, Any]]:
    """The last verdicts on what ran of a plan: on all of it, or on single subgoals while it ran."""
    said = [one for one in planner["verdicts"] if _plan_of(planner, one["after_subgoals"]) == number]
    whole = [one["verdicts"] for one in said if not one.get("check")]
    return whole[-1] if whole else [verdict for one in said for verdict in one["verdicts"]]


def _stopped(planner: dict[str, Any], number: int) -> str:
    """Why a plan was stopped after one of its subgoals; "" where it was not."""
    checks = [one for one in planner["decisions"] if one["decision"] == "Checked" and one["reason"]]
    return next((str(one["reason"]) for one in checks if _plan_of(planner, one["so_far"]["subgoals"]) == number), "")
