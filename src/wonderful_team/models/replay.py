"""Answers out of a record: the same questions in the same order get the same answers, and nothing is sent anywhere."""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from wonderful_team import errors
from wonderful_team.contracts import BoxPx, PointPx
from wonderful_team.core.caps import Estimate
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.pictures import Picture
from wonderful_team.core.protocols import Model
from wonderful_team.core.values import Answer, Part, Request, Usage
from wonderful_team.errors import (
    BudgetReached,
    ModelOutputError,
    ReplayError,
    UnknownNameError,
    WonderfulTeamError,
    reading,
)
from wonderful_team.models.around import AroundModel
from wonderful_team.models.client import as_answer, call_model
from wonderful_team.models.wire.composing import answer_picture
from wonderful_team.redaction import HIDDEN

STAGES = ("plan", "ground", "act", "replan")
"""Stages of an attempt that a run can branch at; `replan` comes after the first execution."""
_PATIENCE_S = 0.5
"""How long a request that was never answered waits to be cancelled, as it was when it was recorded [s]."""


class ReplayModel:
    """Answers a run's requests from its record, by request id and try.

    What is asked must be what was asked then: words, pictures (pixels and marks), role and kind of answer. Where it may differ,
    positions in a view that was shown in another size mean the same places of it.

    Args:
        record: The content of a record.json.
        tolerant: Take the recorded answer also where words or pictures differ, and note the difference.

    Attributes:
        differences: What differed, in words; empty after an exact replay.
        replayed: How many answers were given.
        failed: The errors of the record that were raised again.
    """

    def __init__(self, record: Mapping[str, Any], *, tolerant: bool = False) -> None:
        with reading("the record"):
            self._read(record)
        self.tolerant = tolerant
        self.differences: list[str] = []
        self.replayed = 0
        self.failed: list[WonderfulTeamError] = []

    def _read(self, record: Mapping[str, Any]) -> None:
        told = record.get("configuration", {}).get("model") or "a model"
        self.name = f"replay of {told}"
        self._entries = {(entry["id"], entry["attempt"]): entry for entry in record["planner"]["requests"]}
        outcome = record.get("outcome") or {}
        plans = record["planner"]["plans"]
        status = plans[-1]["plan"]["status"] if plans else ""
        # The plan's own words: the reason of a trial says more, such as which goals its scorer found unmet.
        said = plans[-1]["plan"].get("message") if status == "budget" else None
        self._budget = (
            str(said or outcome.get("reason") or "") if "budget" in (outcome.get("outcome"), status) else None
        )

    def holds(self, request: Request) -> bool:
        """Whether the record holds this very request, with an end to it."""
        entry = self._entries.get((request.id, request.attempt))
        ended = entry is not None and (entry["answer"] or entry["invalid"] or entry.get("failed"))
        return bool(ended) and not differences(request, entry or {})

    async def answer(self, request: Request) -> Answer:
        """What was answered then; what failed then fails again.

        Raises:
            ReplayError: The request was never asked, never answered, or differs from what was asked.
        """
        # Requests that start together must all have started before the first is answered, as with a real model.
        await asyncio.sleep(0)
        entry = self._entries.get((request.id, request.attempt))
        if entry is None:
            if self._budget is not None:
                raise BudgetReached(self._budget)
            raise ReplayError(f"{_called(request)} is not in the record: this time the run took another way")
        with reading(f"{_called(request)} in the record"):
            found = differences(request, entry)
        if found and not self.tolerant:
            raise ReplayError(f"{_called(request)} is not what was asked then: {'; '.join(found)}")
        self.differences += [f"{_called(request)}: {text}" for text in found]
        self.replayed += bool(entry["answer"] or entry["invalid"] or entry.get("failed"))
        if entry["answer"]:
            return _answer(request, entry)
        if entry["invalid"]:
            raw = entry["invalid"]["raw"]
            return Answer(raw, Usage(calls=0), self.name, raw, provenance="replayed")
        if entry.get("failed"):
            self.failed.append(_revived(entry["failed"]))
            raise self.failed[-1]
        # Sent, but given up before an answer came: something else ended the run, and will again.
        await asyncio.sleep(_PATIENCE_S)
        raise ReplayError(f"{_called(request)} was never answered in the record")


class Branching(AroundModel):
    """Answers from a record up to a stage, from there by a model.

    Args:
        replay: What was answered before.
        model: Who answers from the stage on.
        stage: plan, ground, act or replan.
        as_asked: Stages come in the order in which the method asks, one after the other, as those of rivals do; else in the team's.

    Raises:
        UnknownNameError: Another stage.
    """

    def __init__(self, replay: ReplayModel, model: Model, stage: str, *, as_asked: bool = False) -> None:
        super().__init__(model)
        self.replay, self.name = replay, f"{self.name} from {stage}"
        self._from = _branch_position(stage)
        self._stage, self._as_asked = stage, as_asked
        self._left = False

    def __getattr__(self, name: str) -> Any:
        value = super().__getattr__(name)
        return self._reckon if name == "estimate" else value

    def _replays(self, request: Request) -> bool:
        if self._as_asked:
            attempt, stage = _attempt_and_stage(request.id)
            begins = stage == self._stage or (self._stage == "replan" and attempt > 0)
            return not self._left and not begins
        return _position(request) < self._from and (not self._left or self.replay.holds(request))

    def _reckon(self, request: Request) -> Estimate:
        """What a request may cost: nothing when the record answers it."""
        if self._replays(request):
            return Estimate(0, 0, 0.0, 0.0)
        reckoned: Estimate = self.model.estimate(request)  # type: ignore[attr-defined]
        return reckoned

    async def answer(self, request: Request) -> Answer:
        """The recorded answer before the branch, the model's after it.

        Once the model has answered, requests of an earlier stage that the record does not hold (a plan that goes back
        to the Supervisor) are the model's as well.
        """
        if self._replays(request):
            return await self.replay.answer(request)
        self._left = True
        return as_answer(await call_model(self.model, request), self.model)


def differences(request: Request, entry: Mapping[str, Any]) -> list[str]:
    """In what a request differs from a recorded one, in words; empty when it is the same."""
    found = []
    stated = {
        "kind of question": (request.contract, entry["contract"]),
        "role": (request.role, entry["role"]),
        "kind of answer": (request.output.__name__, entry["output"]),
        "sample": (request.sample, entry["sample"]),
    }
    found += [f"{what} is {now!r}, was {then!r}" for what, (now, then) in stated.items() if now != then]
    if not _same_text(request.system, entry["system"]):
        found.append(f"the role's words differ: {_excerpts(request.system, entry['system'])}")
    parts: Sequence[Mapping[str, Any]] = entry["parts"]
    if len(request.parts) != len(parts):
        found.append(f"it has {len(request.parts)} parts, had {len(parts)}")
    for number, (part, then) in enumerate(zip(request.parts, parts, strict=False), start=1):
        found += [f"part {number}: {text}" for text in _part_differences(part, then)]
    return found


def _part_differences(part: Part, then: Mapping[str, Any]) -> list[str]:
    if not isinstance(part, Picture):
        if "words" not in then:
            return [f"words, was picture {then['picture']!r}"]
        return [] if _same_text(part.text, then["words"]) else [f"words {_excerpts(part.text, then['words'])}"]
    if "picture" not in then:
        return [f"picture {part.name!r}, was words"]
    found = []
    if part.name != then["picture"]:
        found.append(f"picture {part.name!r}, was {then['picture']!r}")
    # Earlier releases named a picture by its pixels alone.
    if then["clean"] != part.source_hash and then["clean"] != part.hash:
        size = "" if list(part.size_px) == then["size_px"] else f" ({part.size_px} px, was {tuple(then['size_px'])} px)"
        found.append(f"picture {part.name!r} has other pixels{size}")
    if json.loads(json.dumps(to_jsonable(part.marks))) != then["marks"]:
        found.append(f"picture {part.name!r} has other marks")
    return found


def _same_text(now: str, then: str) -> bool:
    """Whether the texts agree; what was hidden in the record may have been anything."""
    if now == then:
        return True
    if HIDDEN not in then:
        return False
    return re.fullmatch(".+?".join(map(re.escape, then.split(HIDDEN))), now, re.DOTALL) is not None


def _excerpts(now: str, then: str) -> str:
    """Both texts around the first character that differs."""
    start = next((k for k, (a, b) in enumerate(zip(now, then, strict=False)) if a != b), min(len(now), len(then)))
    low = max(0, start - 20)
    return f"{now[low : start + 40]!r}, was {then[low : start + 40]!r}"


def _answer(request: Request, entry: Mapping[str, Any]) -> Answer:
    told = entry["answer"]
    try:
        value = in_todays_pixels(request.output.model_validate(told["parsed"]), *_zoom(request, entry))
    except ValueError as error:
        raise ReplayError(f"{_called(request)}: the recorded answer no longer fits its type: {error}") from error
    return Answer(
        value,
        Usage(calls=0),
        told["model_id"],
        told["raw"],
        provenance="replayed",
        repairs=tuple(told["repairs"]),
    )


def _zoom(request: Request, entry: Mapping[str, Any]) -> tuple[float, float]:
    """How many pixels of the picture that positions are given in one pixel of it was then, along x and y.

    Releases may show the same view in another size.
    """
    shown = answer_picture(request)
    then = next((part for part in entry["parts"] if shown is not None and part.get("picture") == shown.name), None)
    if shown is None or then is None:
        return 1.0, 1.0
    return shown.size_px[0] / then["size_px"][0], shown.size_px[1] / then["size_px"][1]


def in_todays_pixels(value: Any, across: float, down: float) -> Any:
    """The same answer with its points and boxes in a picture that is so many times as wide and as high."""
    match value:
        case PointPx():
            return PointPx(x=value.x * across, y=value.y * down)
        case BoxPx():
            return BoxPx(x0=value.x0 * across, y0=value.y0 * down, x1=value.x1 * across, y1=value.y1 * down)
        case list():
            return [in_todays_pixels(item, across, down) for item in value]
        case BaseModel() if (across, down) != (1.0, 1.0):
            held = {name: in_todays_pixels(getattr(value, name), across, down) for name in type(value).model_fields}
            return value.model_copy(update=held)
        case _:
            return value


def _revived(told: Mapping[str, Any]) -> WonderfulTeamError:
    """The recorded error, of the class that it was."""
    kind = getattr(errors, str(told["error"]), ModelOutputError)
    if not (isinstance(kind, type) and issubclass(kind, WonderfulTeamError)):
        kind = ModelOutputError
    error: WonderfulTeamError = kind.__new__(kind)
    WonderfulTeamError.__init__(error, told["message"], stage=told["stage"])
    error.trace, error.sent = str(told.get("trace", "")), False
    for name in ("question", "choices", "contract", "reasons"):
        if name in told:
            value = told[name]
            setattr(error, name, tuple(value) if isinstance(value, list) else value)
    return error


def check_asked_at(stage: str, record: Mapping[str, Any]) -> None:
    """Whether a rival's run, which has not all of the team's stages, can branch at one.

    Raises:
        UnknownNameError: It asks nothing there; lists the stages at which it asks.
    """
    asked = {_attempt_and_stage(str(entry["id"]))[1] for entry in record["planner"]["requests"]}
    if stage not in (*asked, "replan"):
        valid = [one for one in STAGES if one in asked or one == "replan"]
        raise UnknownNameError(f"stage at which {record['configuration']['method']!r} asks", stage, valid)


def _branch_position(stage: str) -> tuple[int, int]:
    if stage not in STAGES:
        raise UnknownNameError("stage to branch at", stage, STAGES)
    return (1, 0) if stage == "replan" else (0, 1 + STAGES.index(stage))


def _position(request: Request) -> tuple[int, int]:
    """Where a request stands in the trial; what Memory is asked belongs to the stage that it is asked about."""
    attempt, stage = _attempt_and_stage(request.id)
    return attempt, 0 if stage == "replan" else 1 + STAGES.index(stage)


def _attempt_and_stage(request_id: str) -> tuple[int, str]:
    attempt, stage, branch = (request_id.split("/") + ["", "", ""])[:3]
    if stage == "memory":
        stage = branch.partition(".")[0]
    if not attempt.isdigit() or stage not in STAGES:
        raise ReplayError(f"request {request_id} belongs to no stage to branch at ({', '.join(STAGES)})")
    return int(attempt), stage


def _called(request: Request) -> str:
    return f"request {request.id} (try {request.attempt + 1})"
