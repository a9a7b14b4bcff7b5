"""Writes the run folder as things happen, so that an interrupted run leaves a readable record too."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from wonderful_team.core.deadline import for_record
from wonderful_team.core.filesystem import write_private
from wonderful_team.core.interrupts import held
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.pictures import Picture
from wonderful_team.core.protocols import CHECK, Event
from wonderful_team.core.text import counted, ending_words, picture_names, spoken, visible
from wonderful_team.core.values import GateCheck, GateReport, Instruction, Limits, Observation, Plan, Request, Trial
from wonderful_team.errors import ActionRefusedError, BudgetReached, FileNotWrittenError, WonderfulTeamError
from wonderful_team.images import Ticks
from wonderful_team.images.keep_out import outlines
from wonderful_team.images.png import fast_png
from wonderful_team.record import entries
from wonderful_team.record.detections import detector_entry
from wonderful_team.record.growing import LINES_NAME, GrowingRecord, as_lines, empty_record, time_of_day
from wonderful_team.record.picture_store import DRAWING, PictureStore
from wonderful_team.record.plan_file import plan_to_json
from wonderful_team.record.plan_picture import plan_picture
from wonderful_team.record.run_files import RunFiles
from wonderful_team.record.run_folders import RECORD_NAME
from wonderful_team.redaction import redact, redact_all


class Recorder:
    """A subscriber that keeps a run: every event is a line in `record.jsonl`; `record.json` is written whole at the end.

    The record's key "planner" holds what the planner was asked, answered and did, without clock times and in an
    order that no race changes: removing the scorer leaves it bit-identical. Times stand under "clock".

    Args:
        folder: Where to write; made when missing.
        command: The command that reproduces the run, for the page.
        clock: What time it is as `time.monotonic` counts; earlier for a run that is written down afterwards.
    """

    def __init__(
        self, folder: Path, *, command: str | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.folder = Path(folder)
        self._files = RunFiles(self.folder)
        self._store = PictureStore(self._files, self._named)
        self.at_hand = self._store.at_hand
        self._lock = threading.RLock()
        self._clock, self._zero = clock, clock()
        self._asked: set[str] = set()
        self._undrawn: dict[str, Request] = {}
        self._observations: dict[str, Observation] = {}
        self._seen: Observation | None = None
        self._limits: Limits | None = None
        self._pictures: dict[str, str] = {}
        self._growing = GrowingRecord(empty_record(command, self._time_of_day()))
        self._record = self._growing.held
        self._planner = self._record["planner"]
        self._handlers: dict[str, Callable[[Event], None]] = {
            "run": self._on_run,
            "observe": self._on_observe,
            "plan_scene": self._on_plan_scene,
            "stage": self._on_stage,
            "request": self._on_request,
            "sent": self._on_sent,
            "drawn": self._on_drawn,
            "answer": self._on_answer,
            "invalid": self._on_invalid,
            "failed": self._on_failed,
            "plan": self._on_plan,
            "asking": self._on_asking,
            "clarified": self._on_clarified,
            "decision": self._on_decision,
            "gate": self._on_gate,
            "execute": self._on_execute,
            "subgoal": self._on_subgoal,
            "verdicts": self._on_verdicts,
            "warning": self._on_warning,
            "crash": self._on_crash,
            "detector": self._on_detector,
            "done": self._on_done,
        }
        # Before anything has happened a folder that cannot be written to ends the run.
        write_private(self.folder / "log.txt", b"")
        write_private(self.folder / RECORD_NAME, self._whole())

    def on_event(self, event: Event) -> None:
        """Keep one event. Kinds that are not known are left out."""
        handle = self._handlers.get(event.kind)
        if handle is None:
            return
        # An interrupt that came in the middle would leave half an entry.
        with held(), self._lock:
            handle(event)
            lines = self._growing.lines()
            if lines:
                self._files.append(LINES_NAME, lines)

    def close(self) -> None:
        """Write what is left. A run that was never finished is marked as interrupted."""
        with held(), self._lock:
            for request in list(self._undrawn.values()):
                self._draw(request, Ticks.PIXELS)
            if self._record["state"] == "running":
                self._growing.set("interrupted", "state")
            self._files.try_again()
            if self._files.write(RECORD_NAME, self._whole()):
                self._files.remove(LINES_NAME)

    @property
    def unwritten(self) -> tuple[str, ...]:
        """What of the run could not be written, and why; all else is kept."""
        return self._files.unwritten

    def note_unwritten(self, error: FileNotWrittenError) -> None:
        """Note a file of the folder that somebody else could not write."""
        self._files.failed(error)

    @property
    def ended(self) -> bool:
        """Whether the run's end was told."""
        return str(self._record["state"]) == "finished"

    @property
    def warnings(self) -> tuple[str, ...]:
        """Every warning that was told so far, each once."""
        return tuple(dict.fromkeys(self._planner["warnings"]))

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    # -- what happens ------------------------------------------------------------------------------------------------

    def _on_run(self, event: Event) -> None:
        grow, content = self._growing, dict(event.content or {})
        task, limits = content.pop("task", None), content.pop("limits", None)
        if isinstance(task, Instruction):
            grow.set(entries.instruction_entry(task, self._store), "planner", "instruction")
            self._pictures = picture_names(task.text, task.slots)
        if isinstance(limits, Limits):
            self._limits = limits
            grow.set(to_jsonable(limits), "planner", "limits")
        grow.set(content.pop("command", None) or self._record["command"], "command")
        for key in ("setup", "words"):
            if key in content:
                grow.set(content.pop(key), key)
        for key, value in entries.plain(content).items():
            grow.set(value, "configuration", key)
        if event.name and "scene" not in self._record["configuration"]:
            grow.set(event.name, "configuration", "scene")

    def _on_observe(self, event: Event) -> None:
        observation: Observation = event.content
        self._seen = observation
        self._observations[observation.hash] = observation
        while len(self._observations) > 8:
            self._observations.pop(next(iter(self._observations)))
        self._add("observations", entries.observation_entry(event.name, observation, self._store))

    def _on_plan_scene(self, event: Event) -> None:
        """What a plan that was read was made from: it stays with the plan, so that the plan can be read from here too."""
        entry = entries.observation_entry("plan", event.content, self._store)
        self._growing.set(entry, "planner", "plan_scene")

    def _on_stage(self, event: Event) -> None:
        content = event.content
        text = content.get("text", "") if isinstance(content, Mapping) else str(content or "")
        attempt = content.get("attempt", 0) if isinstance(content, Mapping) else 0
        self._add("stages", {"name": event.name, "text": text, "attempt": attempt})
        self._stamp("stages")
        self._log(event.name, text)

    def _on_request(self, event: Event) -> None:
        request: Request = event.content
        entry = entries.request_entry(request)
        key = entry["key"]
        self._asked.add(key)
        if request.pictures:
            self._undrawn[key] = request
        self._growing.set(entry, "planner", "requests", key)
        sent = {"sent_s": round(self._elapsed_s(), 4), "answered_s": None}
        self._growing.set(sent, "clock", "requests", key)

    def _on_sent(self, event: Event) -> None:
        """The pictures of a request as they went out: the very files are kept."""
        request, files = event.content
        places = [number for number, part in enumerate(request.parts) if isinstance(part, Picture)]
        sheet = len(files) < len(places)
        for count, number in enumerate(places):
            file = files[0 if sheet else count]
            name = "sheet" if sheet else request.parts[number].name
            told = entries.sent_entry(file, self._store.keep_file(file, name), count + 1 if sheet else None)
            self._tell_part(request, number, told)

    def _on_drawn(self, event: Event) -> None:
        """The pictures of a request that went nowhere: to a model that is handed the request itself, or kept answers."""
        request, ticks = event.content
        self._draw(request, ticks)

    def _draw(self, request: Request, ticks: Ticks) -> None:
        # What could not be drawn in time is not tried again: the rest of the record is written.
        self._undrawn.pop(self._key_of(request), None)
        for number, part in enumerate(request.parts):
            if isinstance(part, Picture):
                self._tell_part(request, number, {"drawn": self._store.keep_drawn(part, ticks)})

    def _tell_part(self, request: Request, number: int, told: Mapping[str, Any]) -> None:
        key = self._key_of(request)
        self._undrawn.pop(key, None)
        for name, value in told.items():
            self._growing.set(value, "planner", "requests", key, "parts", number, name)

    def _on_answer(self, event: Event) -> None:
        request, answer = event.content
        self._answered(request, "answer", entries.answer_entry(answer))

    def _on_invalid(self, event: Event) -> None:
        request, raw, error = event.content
        self._answered(request, "invalid", {"raw": str(raw), "error": str(error)})
        self._log("invalid", f"{request.id}: {error}")

    def _on_failed(self, event: Event) -> None:
        request, error = event.content
        self._answered(request, "failed", entries.error_entry(error))

    def _key_of(self, request: Request) -> str:
        key = entries.request_key(request)
        if key not in self._asked:
            # Answered without being sent (a cache): it is part of the story all the same.
            self._on_request(Event("request", request.id, request))
        return key

    def _answered(self, request: Request, how: str, entry: Mapping[str, Any]) -> None:
        key = self._key_of(request)
        if key in self._undrawn:
            self._draw(request, Ticks.PIXELS)
        self._growing.set(entry, "planner", "requests", key, how)
        self._growing.set(round(self._elapsed_s(), 4), "clock", "requests", key, "answered_s")

    def _on_plan(self, event: Event) -> None:
        plan: Plan = event.content
        data = redact_all(plan_to_json(plan))
        # The instruction's pictures stand once, as files, under "instruction".
        words_only = {**data["plan"]["instruction"], "slots": {}}
        kept = {**data, "plan": {**data["plan"], "instruction": words_only}}
        if kept in self._planner["plans"]:
            return
        self._add("plans", kept)
        if self._planner["instruction"] is None:
            self._growing.set(entries.instruction_entry(plan.instruction, self._store), "planner", "instruction")
        self._files.write("plan.json", _text(json.dumps(data, indent=1, ensure_ascii=False)))
        self._draw_final(plan)

    def _draw_final(self, plan: Plan) -> None:
        observation = self._observations.get(plan.scene_hash, self._seen)
        if observation is None:
            return
        view = observation.main
        regions = (*plan.keep_out, *(self._limits.keep_out if self._limits is not None else ()))
        self._growing.set(outlines(dict.fromkeys(regions), self._limits, view.camera), "planner", "outlines")
        try:
            rgb = for_record(DRAWING, plan_picture, plan, view, self._limits)
        except BudgetReached as error:
            self._log("warning", f"the picture of the plan is missing: {error}")
            return
        self._files.write("final.png", fast_png(rgb))

    def _on_asking(self, event: Event) -> None:
        self._add("asked", {**event.content, "so_far": self._so_far()})

    def _on_clarified(self, event: Event) -> None:
        """What the user answered: a replay gives the same answers."""
        self._add("clarified", to_jsonable(event.content))

    def _on_decision(self, event: Event) -> None:
        self._add("decisions", {**entries.plain(event.content), "so_far": self._so_far()})

    def _so_far(self) -> dict[str, int]:
        """How much has happened: what a method is told is what happened since its last decision."""
        return {key: len(self._planner[key]) for key in ("observations", "gates", "executions", "subgoals")}

    def _on_gate(self, event: Event) -> None:
        report: GateReport = event.content
        self._add("gates", {"plan": self._plan_number, **entries.gate_entry(event.name, report)})
        self._stamp("gates")
        checks = counted(len(report.checks), "check")
        self._log("gate", f"{event.name}: " + gate_words(report.admitted, checks, report.reasons))

    def _on_subgoal(self, event: Event) -> None:
        self._add("subgoals", {"plan": self._plan_number, **entries.subgoal_entry(event.content, self._store)})

    def _on_execute(self, event: Event) -> None:
        planned, report = event.content
        number = len(self._planner["executions"]) + 1
        self._add("executions", entries.execution_entry(number, planned, report))
        self._stamp("executions")
        self._log("execute", f"action {number} {report.action.kind}: " + report.words)

    def _on_verdicts(self, event: Event) -> None:
        verdicts = redact_all(to_jsonable(tuple(event.content)))
        entry = {"after_subgoals": len(self._planner["subgoals"]), "verdicts": verdicts}
        if event.name == CHECK:
            self._add("verdicts", {**entry, "check": True})
        elif not self._planner["verdicts"] or self._planner["verdicts"][-1]["verdicts"] != verdicts:
            self._add("verdicts", entry)

    def _on_warning(self, event: Event) -> None:
        text = str(event.content)
        self._add("warnings", text)
        self._log("warning", text)

    def _on_detector(self, event: Event) -> None:
        self._add("detections", detector_entry(event.content, self._store))
        self._growing.add(round(event.content.seconds, 4), "clock", "detections")

    def _on_crash(self, event: Event) -> None:
        """The user's own code raised: its traceback is kept, line by line in the log."""
        error: WonderfulTeamError = event.content
        self._add("crashes", {"error": event.name, "message": str(error), "trace": error.trace})
        self._log("crash", str(error))
        for line in error.trace.splitlines():
            self._log("", line)

    def _on_done(self, event: Event) -> None:
        self._growing.set("finished", "state")
        self._growing.set(self._time_of_day(), "clock", "ended")
        self._growing.set(round(self._elapsed_s(), 4), "clock", "seconds")
        if isinstance(event.content, Plan):
            self._on_plan(Event("plan", event.content.id, event.content))
        elif isinstance(event.content, Trial):
            # The score comes after the trial and stays out of the planner's part.
            usage = {role: entries.usage_entry(one) for role, one in event.content.usage_by_role.items()}
            self._growing.set(usage, "clock", "usage_by_role")
        outcome = entries.outcome_entry(event.name, event.content, self._refusal())
        self._growing.set(outcome, "outcome")
        self._log("done", "  ".join(ending_words(str(outcome["outcome"]), str(outcome["reason"]))).strip())

    def _refusal(self) -> dict[str, Any] | None:
        """The outcome of a plan that the gate refused last; None when it admitted it or was not asked."""
        if not self._planner["gates"] or self._planner["gates"][-1]["admitted"]:
            return None
        failed = [check for check in self._planner["gates"][-1]["checks"] if not check["ok"]]
        reasons = GateReport(tuple(GateCheck(**check) for check in failed)).reasons
        return {"outcome": "refused", "stage": "gate", "reason": str(ActionRefusedError(reasons))}

    @property
    def _plan_number(self) -> int | None:
        """Which of the plans is current, from 0; None for a method that acts without one."""
        return len(self._planner["plans"]) - 1 if self._planner["plans"] else None

    def _stamp(self, kind: str) -> None:
        self._growing.add(round(self._elapsed_s(), 4), "clock", kind)

    def _add(self, kind: str, entry: Any) -> None:
        self._growing.add(entry, "planner", kind)

    # -- files -------------------------------------------------------------------------------------------------------

    def _elapsed_s(self) -> float:
        return self._clock() - self._zero

    def _time_of_day(self) -> str:
        return time_of_day(time.monotonic() - self._clock())

    def _named(self, key: str, file: str) -> None:
        self._growing.set(file, "files", key)

    def _log(self, name: str, text: str) -> None:
        line = redact(f"{self._elapsed_s():6.1f} s  {name:10s} {text}")
        self._files.append("log.txt", visible(spoken(line.replace("\n", " "), self._pictures)) + "\n")

    def _whole(self) -> bytes:
        record = self._growing.laid_out()
        # This is what the lines say.
        missing = [name for name in self._files.missing if name != LINES_NAME]
        if missing:
            record["unwritten"] = missing
        return _text(as_lines(record))


def _text(text: str) -> bytes:
    # Half of a character (a lone surrogate) becomes its JSON escape, which reads back as what it was.
    return text.encode("utf-8", errors="backslashreplace")


def gate_words(admitted: bool, checks: str, reasons: Sequence[str]) -> str:
    """One passage through the gate in a line."""
    return f"admitted ({checks})" if admitted else f"refused ({checks}): " + "; ".join(reasons)
