"""Finding things in a record."""

from __future__ import annotations

from typing import Any


def _content(data: dict[str, Any]) -> dict[str, Any]:
    """A plan's content, with its id under "id"."""
    return {**data["plan"], "id": data["id"]}


def last_plan(record: dict[str, Any]) -> dict[str, Any] | None:
    """The plan that ran, or the last one that was made: its content, with its id under "id"."""
    plans = record["planner"]["plans"]
    return _content(plans[-1]) if plans else None


def chapters(record: dict[str, Any]) -> list[tuple[int, str, dict[str, Any]]]:
    """The plans that the page tells of: number, name, content with its id. Those with nothing in them are left out."""
    found: list[tuple[int, str, dict[str, Any]]] = []
    for number, data in enumerate(record["planner"]["plans"]):
        content = _content(data)
        if content["subgoals"] or content["grounded"] or content["actions"]:
            found.append((number, f"Replan {len(found)}" if found else "First plan", content))
    return found


def grounded_plan(record: dict[str, Any]) -> dict[str, Any] | None:
    """The last plan that has grounded targets, else the last one."""
    for data in reversed(record["planner"]["plans"]):
        if data["plan"]["grounded"]:
            return _content(data)
    return last_plan(record)


def target_words(plan: dict[str, Any] | None) -> dict[str, str]:
    """What each target of a plan is, by id."""
    return {} if plan is None else {target["id"]: target["words"] for target in plan["targets"]}


def scene_of(record: dict[str, Any], plan: dict[str, Any] | None) -> dict[str, Any] | None:
    """The observation a plan was made from, be it in an earlier run, else the first one."""
    observations: list[dict[str, Any]] = record["planner"]["observations"]
    plan_scene: dict[str, Any] | None = record["planner"].get("plan_scene")
    for observation in [*observations, *([plan_scene] if plan_scene else [])]:
        if plan is not None and observation["hash"] == plan["scene_hash"]:
            return observation
    return observations[0] if observations else None


def main_key(observation: dict[str, Any] | None) -> str | None:
    """Hash of an observation's main view."""
    if observation is None:
        return None
    views: dict[str, str] = observation["views"]
    return views.get(observation["main"]) or next(iter(views.values()))
