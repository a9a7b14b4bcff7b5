"""Mistakes that were planted into a run (labelled injected), each with what caught it, or that nobody did."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from wonderful_team.core.text import counted
from wonderful_team.pages.look_up import chapters
from wonderful_team.pages.pictures import Album
from wonderful_team.pages.plans import diff_rows
from wonderful_team.pages.requests import Asked
from wonderful_team.pages.strips import history_frames

_PLANS = frozenset({"DraftPlan", "RevisePlan", "ExtractTargets"})


def planted(record: dict[str, Any], album: Album, asked: Sequence[Asked]) -> list[dict[str, Any]]:
    """One card per planted mistake: what it was, the change that undid it, and who caught it."""
    found: list[dict[str, Any]] = []
    plans = {number: content for number, _, content in chapters(record)}
    for one in asked:
        if one.answer is None or one.answer["provenance"] != "injected":
            continue
        plan = plans.get(one.attempt)
        if plan is None:
            continue
        label = next((text.removeprefix("injected: ") for text in one.answer["repairs"]), "an answer was replaced")
        card = _in_plan(plan) if one.entry["contract"] in _PLANS else _in_targets(record, plan, one, album)
        found.append({"label": label, "anchor": one.anchor, **card})
    return found


def _in_plan(plan: dict[str, Any]) -> dict[str, Any]:
    """A wrong plan: the lines that changed, and the doubts that changed them."""
    rows = diff_rows(plan["first_draft"] or plan["subgoals"], plan["subgoals"])
    doubts = [
        doubt["question"]
        for doubt in plan["questions"]
        if doubt["changed"] and doubt["kind"] not in ("wrong_point", "wrong_box")
    ]
    changed = [row["shown"] for row in rows if row["kind"] != "same"]
    return {"by": "Verification" if doubts else "", "said": doubts, "rows": changed, "frames": []}


def _in_targets(record: dict[str, Any], plan: dict[str, Any], one: Asked, album: Album) -> dict[str, Any]:
    """A wrong box: as it was planted, what the Checker said of it, and as it was used."""
    for position, (name, item) in enumerate(plan["grounded"].items()):
        history = item["history"]
        first = next((k for k, event in enumerate(history) if event["provenance"] == "injected"), None)
        if name not in one.entry["targets"] or first is None:
            continue
        verdicts = [event["text"] for event in history[first:] if event["what"] in ("verdict", "move")]
        refused = any(event["what"] == "move" for event in history[first:]) or any(
            word in text.lower() for text in verdicts for word in ("revise", "reject")
        )
        frames = history_frames(record, plan, item, album, position)
        wanted = [
            frame for frame in frames if frame["provenance"] == "injected" or frame["what"] in ("move", "as used")
        ]
        return {"by": "the Checker" if refused else "", "said": verdicts, "rows": [], "frames": wanted}
    return {"by": "", "said": [], "rows": [], "frames": []}


def sentence(cards: Sequence[dict[str, Any]]) -> str:
    """How many were planted and caught; "" without any."""
    caught = sum(bool(card["by"]) for card in cards)
    if not cards:
        return ""
    how = "all" if caught == len(cards) and caught > 2 else "both" if caught == len(cards) == 2 else f"{caught}"
    return f"{counted(len(cards), 'planted mistake')}, {how} caught"
