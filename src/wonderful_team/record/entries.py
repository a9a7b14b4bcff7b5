"""What a record says of each thing that happened: plain JSON values, no clock times, no pixels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import (
    Answer,
    GateReport,
    HeightProfile,
    Instruction,
    Observation,
    Plan,
    PlannedAction,
    Request,
    SentPicture,
    StepReport,
    SubgoalRun,
    Target,
    Trial,
    Usage,
)
from wonderful_team.errors import WonderfulTeamError
from wonderful_team.record.picture_store import PictureStore
from wonderful_team.record.stored import view_entry
from wonderful_team.record.values_file import encode


def request_key(request: Request) -> str:
    """Names one attempt at one request."""
    return f"{request.id} try {request.attempt + 1}"


def request_entry(request: Request) -> dict[str, Any]:
    """One request: words, pictures (what was drawn or sent of them is told later), and what a right answer is."""
    return {
        "key": request_key(request),
        "id": request.id,
        "stage": request.stage,
        "role": request.role,
        "contract": request.contract,
        "targets": _targets(request.question),
        "system": request.system,
        "notes": to_jsonable(request.notes),
        "parts": [_part(part) for part in request.parts],
        "output": request.output.__name__,
        "sample": request.sample,
        "attempt": request.attempt,
        "feedback": request.feedback,
        "answer": None,
        "invalid": None,
    }


def sent_entry(file: SentPicture, key: str, number: int | None) -> dict[str, Any]:
    """How a picture went out: its file's key and size; its number on the sheet where all went out as one."""
    told = {"drawn": key, "sent_px": list(file.size_px)}
    return told if number is None else {**told, "on_sheet": number}


def _part(part: Any) -> dict[str, Any]:
    if isinstance(part, Picture):
        return {
            "picture": part.name,
            "drawn": None,
            "clean": part.source_hash,
            "size_px": list(part.size_px),
            "view": part.frame.view_id,
            "marks": to_jsonable(part.marks),
        }
    return {"words": part.text}


def _targets(question: Any) -> list[str]:
    one, many = getattr(question, "target", None), getattr(question, "targets", ())
    found = [one] if isinstance(one, Target) else [item for item in many if isinstance(item, Target)]
    return [target.id for target in found]


def answer_entry(answer: Answer) -> dict[str, Any]:
    """One answer without its duration, which belongs to the clock."""
    usage = usage_entry(answer.usage)
    usage.pop("seconds")
    return {
        "parsed": plain(answer.value),
        "raw": answer.raw,
        "repairs": list(answer.repairs),
        "provenance": answer.provenance,
        "model_id": answer.model_id,
        "tries": answer.tries,
        "usage": usage,
    }


def error_entry(error: WonderfulTeamError) -> dict[str, Any]:
    """What came instead of an answer; enough to raise it again."""
    shown: dict[str, Any] = {"error": type(error).__name__, "message": str(error), "stage": error.stage}
    if error.trace:
        shown["trace"] = error.trace
    if not error.sent:
        shown["sent"] = False
    for name in ("question", "choices", "contract", "reasons"):
        if hasattr(error, name):
            shown[name] = to_jsonable(getattr(error, name))
    return shown


def outcome_entry(name: str, ended: Any, refusal: Mapping[str, Any] | None) -> Mapping[str, Any]:
    """How a run ended.

    Args:
        name: What its last event was called.
        ended: Its plan, its trial, or the error that ended it.
        refusal: The outcome of a plan that the gate refused: it is refused, however well it was made.
    """
    match ended:
        case Plan():
            return refusal or {"outcome": ended.status, "stage": ended.stage, "reason": ended.message}
        case Trial():
            told = {"outcome": ended.ending, "stage": ended.stage, "reason": ended.reason}
            return {**told, "seed": ended.seed, "method": ended.method, "model": ended.model}
        case WonderfulTeamError():
            return {"outcome": name, "stage": ended.stage, "reason": str(ended)}
    return {"outcome": name, "stage": None, "reason": ""}


def usage_entry(usage: Usage) -> dict[str, Any]:
    """What calls cost."""
    return {name: value for name, value in to_jsonable(usage).items() if name != "type"}


def observation_entry(where: str, observation: Observation, store: PictureStore) -> dict[str, Any]:
    """What was seen, as hashes of the clean views."""
    return {
        "where": where,
        "hash": observation.hash,
        "time_s": observation.main.time_s,
        "size_px": list(observation.main.size_px),
        "main": observation.main.id,
        "camera": observation.main.camera is not None,
        "depth": observation.main.depth_m is not None,
        "views": store.keep_observation(observation, where),
        "cameras": {name: view.camera_name for name, view in observation.views.items()},
        "stored": {name: view_entry(view, where, store) for name, view in observation.views.items()},
        "robot": None if observation.robot is None else encode(observation.robot),
    }


def instruction_entry(instruction: Instruction, store: PictureStore) -> dict[str, Any]:
    """The instruction with the hashes of its pictures."""
    slots = {
        name: {
            "kind": slot.kind,
            "index": slot.index,
            "views": {key: store.keep_view(view, name) for key, view in slot.views.items()},
            "stored": {key: view_entry(view, name, store) for key, view in slot.views.items()},
        }
        for name, slot in instruction.slots.items()
    }
    return {"text": instruction.text, "slots": slots}


def gate_entry(where: str, report: GateReport) -> dict[str, Any]:
    """One passage through the gate."""
    checks = [{key: value for key, value in to_jsonable(check).items() if key != "type"} for check in report.checks]
    entry = {"where": where, "admitted": report.admitted, "checks": checks}
    return {**entry, "profiles": [profile_entry(one) for one in report.profiles]} if report.profiles else entry


def profile_entry(profile: HeightProfile) -> dict[str, Any]:
    """The tool's way in one action, to a tenth of a millimetre; null where no height is known."""
    heights = {name: _tenths(getattr(profile, name)) for name in ("low_m", "surface_m", "goal_m")}
    points = [_tenths(point) for point in profile.points_m]
    nearest = {"clearance_m": profile.clearance_m, "least_m": profile.least_m, "nearest": profile.nearest}
    return {"action": profile.action, "points_m": points, **heights, **nearest, "stays": profile.stays}


def _tenths(values: Array) -> list[float | None]:
    return [round(float(value), 4) if math.isfinite(value) else None for value in values]


def execution_entry(number: int, planned: PlannedAction, report: StepReport) -> dict[str, Any]:
    """One executed action with what the robot measured."""
    return {
        "number": number,
        "step": to_jsonable(planned.step),
        "action": to_jsonable(report.action),
        "executed": report.executed,
        "measured": plain(report.measured),
        "fault": report.fault,
    }


def subgoal_entry(run: SubgoalRun, store: PictureStore) -> dict[str, Any]:
    """One executed subgoal, as hashes of the views before and after."""
    return {
        "subgoal": run.subgoal,
        "before": store.keep_observation(run.before, f"before {run.subgoal}"),
        "after": store.keep_observation(run.after, f"after {run.subgoal}"),
        "main": run.after.main.id,
        "actions": len(run.reports),
        "executed": sum(report.executed for report in run.reports),
    }


def plain(value: Any) -> Any:
    """JSON values of anything: what has no JSON form is shown as text."""
    match value:
        case Mapping():
            return {str(key): plain(item) for key, item in value.items()}
        case list() | tuple():
            return [plain(item) for item in value]
    try:
        return to_jsonable(value)
    except TypeError:
        return str(value)
