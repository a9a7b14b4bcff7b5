"""The page's sections, top to bottom, from the record: values that the template only has to lay out."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from markupsafe import Markup

from wonderful_team.core.text import counted, ending_words, recorded_names, spoken
from wonderful_team.core.values import refusal_words
from wonderful_team.pages import cost
from wonderful_team.pages.look_up import grounded_plan, last_plan, main_key, scene_of
from wonderful_team.pages.motion import motions
from wonderful_team.pages.pictures import Album, pictured
from wonderful_team.pages.plans import plans, replans
from wonderful_team.pages.requests import Asked
from wonderful_team.pages.running import actions, execution
from wonderful_team.pages.strips import detected, overviews, targets
from wonderful_team.pages.words import brief, money, pretty_name, seconds

__all__ = [
    "actions",
    "before_after",
    "detected",
    "execution",
    "head",
    "instruction",
    "motions",
    "overviews",
    "plans",
    "replans",
    "reproduce",
    "story",
    "summary",
    "targets",
    "title",
    "warnings",
]

_TONES = {
    "success": "good",
    "planned": "good",
    "grounded": "good",
    "checked": "good",
    "draft": "good",
    "unscored": "plain",
    "failure": "bad",
    "error": "odd",
    "interrupted": "odd",
    "needs_clarification": "odd",
    "not_understood": "odd",
    "budget": "odd",
    "running": "plain",
}
_BADGES = {
    "offline": "classical vision and a grammar answered; no vision-language model took part",
    "simulated": "a simulated model with access to the truth answered; not a measurement of any real model",
    "injected": "an answer was replaced from outside, such as a planted mistake",
    "cached": "answers came from the cache",
    "replayed": "answers were replayed from an earlier run",
    "scripted": "answers were written beforehand",
    "detector": "a detector said where things are; no grounding team took part",
}


def title(record: dict[str, Any]) -> str:
    """What the browser's tab says."""
    return f"{pretty_name(_outcome(record)['outcome'])} · {_text(record)[:80]}"


def _text(record: dict[str, Any]) -> str:
    said = record["planner"]["instruction"]
    return spoken(said["text"], recorded_names(said)) if said else "a run without an instruction"


def _outcome(record: dict[str, Any]) -> dict[str, Any]:
    outcome = record["outcome"]
    if outcome is not None:
        return dict(outcome)
    state = record["state"]
    reason = "it was still running when this page was made" if state == "running" else "it ended before an outcome"
    return {"outcome": state, "stage": None, "reason": reason}


def head(record: dict[str, Any], asked: Sequence[Asked], planted: str = "") -> dict[str, Any]:
    """1: the verdict bar."""
    outcome = _outcome(record)
    current = last_plan(record)
    settings = record["configuration"]
    total = cost.per_role(asked)
    facts = [
        ("method", outcome.get("method") or settings.get("method")),
        ("model", outcome.get("model") or settings.get("model")),
        ("detector", settings.get("detector")),
        ("scene", settings.get("scene")),
        ("seed", settings.get("seed")),
        ("time", seconds(record["clock"].get("seconds")) if record["clock"].get("seconds") is not None else None),
        ("calls", f"{total[-1].calls}" if total else None),
        ("pictures", f"{total[-1].pictures}" if total else None),
        ("cost", money(total[-1].usd) if total else None),
    ]
    name = str(outcome["outcome"])
    words, reason = ending_words(name, outcome.get("reason") or _plain_reason(name, current))
    choices = current["choices"] if current else []
    reason = reason.partition(" Choices: ")[0] if choices else reason
    return {
        "outcome": words,
        "tone": _TONES.get(name, "bad"),
        "stage": outcome.get("stage"),
        "reason": brief(reason),
        "planted": planted,
        "whole_reason": reason if reason != brief(reason) else "",
        "choices": choices,
        "badges": _badges(asked, current),
        "unverified": bool(current and current["status"] == "planned" and not current["verified"]),
        "facts": [(key, value) for key, value in facts if value not in (None, "")],
    }


def summary(record: dict[str, Any]) -> dict[str, Any]:
    """A run in one line of a table."""
    outcome, settings = _outcome(record), record["configuration"]
    answers = [request["answer"] for request in record["planner"]["requests"] if request["answer"]]
    prices = [answer["usage"]["usd"] for answer in answers]
    name = str(outcome["outcome"])
    words, reason = ending_words(name, outcome.get("reason") or _plain_reason(name, last_plan(record)))
    return {
        "text": _text(record),
        "started": str(record["clock"].get("started", ""))[:16].replace("T", " "),
        "scene": settings.get("scene") or "",
        "outcome": words,
        "tone": _TONES.get(name, "bad"),
        "reason": reason,
        "method": outcome.get("method") or settings.get("method") or "",
        "model": outcome.get("model") or settings.get("model") or "",
        "usd": None if any(price is None for price in prices) else sum(prices),
        "seconds": record["clock"].get("seconds"),
        "calls": sum((one.get("failed") or {}).get("sent", True) for one in record["planner"]["requests"]),
    }


def _plain_reason(name: str, current: dict[str, Any] | None) -> str:
    if name == "planned" and current is not None:
        return f"{counted(len(current['actions']), 'action')} for {counted(len(current['subgoals']), 'subgoal')}."
    return ""


def _badges(asked: Sequence[Asked], current: dict[str, Any] | None) -> list[tuple[str, str]]:
    found = {one.answer["provenance"] for one in asked if one.answer is not None}
    for grounded in (current or {}).get("grounded", {}).values():
        found |= {event["provenance"] for event in grounded["history"]}
    return [(name, words) for name, words in _BADGES.items() if name in found]


def instruction(record: dict[str, Any], album: Album) -> Markup:
    """The instruction with its pictures in the place of their names."""
    said = record["planner"]["instruction"]
    if said is None:
        return Markup("")

    def slot(key: str, name: str) -> Markup:
        picture = album.image(key, f"{name} of the instruction", "slot")
        return Markup('<span class="slot-box">{}<span class="slot-name">{}</span></span>').format(picture, name)

    return pictured(said["text"], record, album, slot)


def before_after(record: dict[str, Any], album: Album) -> list[tuple[str, Markup]]:
    """First and last picture of the scene; one alone when nothing was looked at again."""
    observations = record["planner"]["observations"]
    if not observations:
        return []
    first, last = observations[0], observations[-1]
    if not record["planner"]["executions"]:
        return [("the scene", album.image(main_key(first), "the scene", "wide"))]
    return [
        ("before", album.image(main_key(first), "the scene before", "wide")),
        ("after", album.image(main_key(last), "the scene after", "wide")),
    ]


def story(record: dict[str, Any], asked: Sequence[Asked]) -> list[dict[str, str]]:
    """3: one line per stage with its time and cost."""
    events = [*_stage_events(record, asked), *_motion_events(record)]
    lines = [
        {"at": f"{at_s:.1f} s", "name": name, "text": text, "cost": paid}
        for at_s, name, text, paid in sorted(events, key=lambda event: event[0])
    ]
    end = _outcome(record)
    words, reason = ending_words(str(end["outcome"]), end["reason"])
    text = words + (f": {brief(reason)}" if reason else "")
    at = f"{record['clock']['seconds']:.1f} s" if "seconds" in record["clock"] else ""
    return [*lines, {"at": at, "name": "end", "text": text, "cost": ""}]


def _stage_events(record: dict[str, Any], asked: Sequence[Asked]) -> list[tuple[float, str, str, str]]:
    events = []
    last_s = 0.0
    told = {"gate", "execute"}  # these have lines of their own
    for stage, at_s in zip(record["planner"]["stages"], record["clock"]["stages"], strict=True):
        if stage["name"] in told:
            continue
        during = [one for one in asked if one.answered_s is not None and last_s < one.answered_s <= at_s]
        usages = [one.answer["usage"] for one in during if one.answer is not None]
        tokens = sum(usage["tokens_in"] + usage["tokens_out"] + usage["tokens_thinking"] for usage in usages)
        during = [one for one in during if one.sent]
        paid = counted(len(during), "call") + (f", {tokens:,} tokens" if tokens else "") if during else ""
        events.append((at_s, stage["name"], re.sub(r" {2,}", " · ", stage["text"]), paid))
        last_s = at_s
    return events


def _motion_events(record: dict[str, Any]) -> list[tuple[float, str, str, str]]:
    planner, clock = record["planner"], record["clock"]
    events = []
    for gate, at_s in zip(planner["gates"], clock["gates"], strict=True):
        if not gate["admitted"]:
            events.append((at_s, "gate", f"{gate['where']}: {_refusals([gate])}", ""))
        elif gate["where"] == "before motion":
            events.append((at_s, "gate", f"admitted: {counted(len(gate['checks']), 'check')} passed", ""))
    position = 0
    for run in planner["subgoals"]:
        last = position + run["actions"] - 1
        if last < position:
            continue
        text = f"{run['subgoal']}: {run['executed']} of {counted(run['actions'], 'action')} ran"
        events.append((clock["executions"][last], "execute", text, ""))
        position = last + 1
    return events


def _refusals(refused: Sequence[dict[str, Any]]) -> str:
    failed = (check for gate in refused for check in gate["checks"] if not check["ok"])
    reasons = [refusal_words(check["name"], check["value"], check["limit"]) for check in failed]
    return "refused: " + "; ".join(reasons)


def warnings(record: dict[str, Any], asked: Sequence[Asked]) -> list[str]:
    """10: everything that a reader should know before trusting the result."""
    found = [
        f"{name} of this run could not be written: it is missing or not up to date"
        for name in record.get("unwritten", ())
    ]
    found += record["planner"]["warnings"]
    for data in record["planner"]["plans"]:
        found += data["plan"]["warnings"]
    current = last_plan(record)
    if current is not None and current["status"] == "planned" and not current["verified"]:
        found.append(
            "Verification did not approve this plan; it went on because a bound was reached or the member is off."
        )
    scene = scene_of(record, grounded_plan(record))
    if scene is not None and not scene["camera"] and current is not None and current["actions"]:
        found.append("No camera was given: the plan is in pixels only, and heights and workspace could not be checked.")
    for one in asked:
        if one.entry["invalid"] is not None:
            found.append(
                f"request {one.number} ({one.label}) was answered outside its contract: {one.entry['invalid']['error']}"
            )
        if one.answer is not None:
            found += [f"request {one.number} ({one.label}): {repair}" for repair in one.answer["repairs"]]
    # A note of Memory that was still being written when the run ended is no loss: it works beside the main line.
    unanswered = [one.number for one in asked if one.answered_s is None and one.entry["role"] != "memory"]
    if unanswered:
        found.append(f"no answer came to request {', '.join(map(str, unanswered))}")
    total = cost.per_role(asked)
    if total and total[-1].usd is None:
        found.append("The price of this model is not known: no cost is shown, and a cap on money could not be kept.")
    if record["state"] != "finished":
        found.append(f"This run was not finished (state: {record['state']}).")
    return list(dict.fromkeys(found))


def reproduce(record: dict[str, Any]) -> dict[str, Any]:
    """12: the command, versions, hashes."""
    settings = record["configuration"]
    current = last_plan(record)
    facts = [("started", record["clock"]["started"])]
    parent = settings.get("parent")
    facts += [("branched off", f"{parent['run']} at {parent['from']}")] if parent else []
    facts += [("plan", current["id"])] if current else []
    facts += [("scene", current["scene_hash"])] if current and current["scene_hash"] else []
    facts += [("prompts", settings["prompts"])] if settings.get("prompts") else []
    facts += [(name, version) for name, version in record["versions"].items() if version is not None]
    return {"command": record["command"], "facts": facts, "configuration": settings}
