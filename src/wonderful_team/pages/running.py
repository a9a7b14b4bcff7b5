"""6 and 7: actions with the source of every number, the gate's checks, and what execution brought."""

from __future__ import annotations

from typing import Any

from wonderful_team.core.text import counted
from wonderful_team.pages.look_up import chapters, target_words
from wonderful_team.pages.pictures import Album
from wonderful_team.pages.words import step_words


def actions(record: dict[str, Any]) -> list[dict[str, Any]]:
    """For every plan its actions and its passages through the gate; gates alone for a method without plans."""
    found = [
        {"name": name, "rows": _rows(content), "gates": gates(record, number)}
        for number, name, content in chapters(record)
    ]
    alone = gates(record, None)
    return [*found, {"name": "", "rows": [], "gates": alone}] if alone else found


def _rows(current: dict[str, Any]) -> list[dict[str, Any]]:
    """One row per action, one line per number."""
    rows = []
    for number, planned in enumerate(current["actions"], start=1):
        action = planned["action"]
        sources = [
            {
                "role": source["role"].replace("_", " "),
                "target": source["target"],
                "px": "({:.1f}, {:.1f})".format(*source["point_px"]),
                "tool": "({:.1f}, {:.1f})".format(*source["tool_px"]) if source.get("tool_px") else "",
                "m": "({:.3f}, {:.3f}, {:.3f})".format(*source["position_m"])
                if source["position_m"]
                else "pixels only",
                "how": source["how"],
            }
            for source in planned["sources"]
        ]
        rows.append(
            {
                "number": number,
                "subgoal": planned["step"]["subgoal"],
                "words": step_words(planned["step"], target_words(current)),
                "yaw": action.get("yaw_rad") if action else None,
                "sources": sources,
            }
        )
    return rows


def gates(record: dict[str, Any], plan: int | None) -> list[dict[str, Any]]:
    """Each passage of one plan through the gate; failed checks first."""
    return [
        {
            "where": gate["where"],
            "admitted": gate["admitted"],
            "checks": sorted(gate["checks"], key=lambda check: bool(check["ok"])),
            "failed": sum(not check["ok"] for check in gate["checks"]),
        }
        for gate in record["planner"]["gates"]
        if gate["plan"] == plan
    ]


def execution(record: dict[str, Any], album: Album) -> list[dict[str, Any]]:
    """One entry per executed subgoal: before, after, what was measured, and the verdict that followed."""
    planner = record["planner"]
    found, used = [], 0
    for position, run in enumerate(planner["subgoals"], start=1):
        reports = planner["executions"][used : used + run["actions"]]
        used += run["actions"]
        name = run["subgoal"]
        plan = planner["plans"][run["plan"]]["plan"] if run["plan"] is not None else None
        goals = plan["subgoals"] if plan is not None else []
        found.append(
            {
                "subgoal": name,
                "text": next((goal["text"] for goal in goals if goal["id"] == name), ""),
                "replan": run["plan"] or 0,
                "before": album.image(_view(run, "before"), f"before {name}", "wide"),
                "after": album.image(_view(run, "after"), f"after {name}", "wide"),
                "reports": [_report(report, target_words(plan)) for report in reports],
                "verdict": _verdict(planner["verdicts"], position, name),
            }
        )
    return found


def _report(report: dict[str, Any], names: dict[str, str]) -> dict[str, Any]:
    """One report; of a measured path, which is drawn elsewhere, only how many points it has."""
    measured = {
        name: counted(len(value), "point") if name == "path_m" and isinstance(value, list) else value
        for name, value in report["measured"].items()
    }
    return {**report, "measured": measured, "words": step_words(report["step"], names)}


def _view(run: dict[str, Any], when: str) -> str:
    views: dict[str, str] = run[when]
    return views.get(run["main"]) or next(iter(views.values()))


def _verdict(judged: list[dict[str, Any]], position: int, subgoal: str) -> dict[str, Any] | None:
    for one in judged:
        if one["after_subgoals"] >= position:
            for verdict in one["verdicts"]:
                if verdict["subgoal"] == subgoal:
                    return dict(verdict)
            return None
    return None
