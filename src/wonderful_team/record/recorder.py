"""Writes the run folder as things happen, so that an interrupted run leaves a readable record too."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any

from wonderful_team.core.deadline import for_record
from wonderful_team.core.filesystem import write_private
from wonderful_team.core.interrupts import held
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.protocols import Event
from wonderful_team.core.text import counted, ending_words, picture_names, spoken, visible
from wonderful_team.core.values import GateCheck, GateReport, Instruction, Limits, Observation, Plan, Request, Trial
from wonderful_team.errors import ActionRefusedError, BudgetReached, FileNotWrittenError, WonderfulTeamError
from wonderful_team.images import action_arrows, action_turns, overview, swept_widths, to_png
from wonderful_team.images.keep_out import outlines
from wonderful_team.record import entries
from wonderful_team.record.detections import detector_entry
from wonderful_team.record.picture_store import DRAWING, PictureStore
from wonderful_team.record.plan_file import plan_to_json
from wonderful_team.record.record_schema import RECORD_SCHEMA_VERSION
from wonderful_team.record.run_files import RunFiles
from wonderful_team.record.run_folders import RECORD_NAME
from wonderful_team.record.versions import versions
from wonderful_team.redaction import redact, redact_all

_REWRITE_EVERY_S = 0.3
"""Least time between two rewrites of record.json; important events are written at once."""
_AT_ONCE = frozenset({"run", "stage", "plan", "gate", "execute", "subgoal", "warning", "crash", "done"})


class Recorder:
    """A subscriber that keeps a run.

    The record's key "planner" holds what the planner was asked, answered and did, without clock times and in an
    order that no race changes: removing the scorer leaves it bit-identical. Times stand under "clock".

    Args:
        folder: Where to write; made when missing.
        command: The command that reproduces the run, for the page.
    """

    def __init__(self, folder: Path, *, command: str | None = None) -> None:
        self.folder = Path(folder)
        self._files = RunFiles(self.folder)
        self._store = PictureStore(self._files)
        self._lock = threading.RLock()
        self._zero = time.monotonic()
        self._last_write = -1.0
        self._requests: dict[str, dict[str, Any]] = {}
        self._observations: dict[str, Observation] = {}
        self._seen: Observation | None = None
        self._limits: Limits | None = None
        self._pictures: dict[str, str] = {}
        self._planner: dict[str, Any] = {"instruction": None, "outlines": []}
        for key in ("observations", "stages", "plans", "decisions", "gates", "executions", "subgoals", "verdicts"):
            self._planner[key] = []
        self._planner["warnings"] = []
        self._clock: dict[str, Any] = {"started": _now(), "requests": {}, "stages": [], "gates": [], "executions": []}
        self._record: dict[str, Any] = {
            "schema_version": RECORD_SCHEMA_VERSION,
            "state": "running",
            "command": command,
            "configuration": {},
            "versions": versions(),
            "outcome": None,
        }
        self._handlers: dict[str, Callable[[Event], None]] = {
            "run": self._on_run,
            "observe": self._on_observe,
            "plan_scene": self._on_plan_scene,
            "stage": self._on_stage,
            "request": self._on_request,
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
            if event.kind in _AT_ONCE or self._elapsed_s() - self._last_write >= _REWRITE_EVERY_S:
                self._write()

    def close(self) -> None:
        """Write what is left. A run that was never finished is marked as interrupted."""
        with held(), self._lock:
            if self._record["state"] == "running":
                self._record["state"] = "interrupted"
            self._files.try_again()
            self._write()

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
        content = dict(event.content or {})
        task, limits = content.pop("task", None), content.pop("limits", None)
        if isinstance(task, Instruction):
            self._planner["instruction"] = entries.instruction_entry(task, self._store)
            self._pictures = picture_names(task.text, task.slots)
        if isinstance(limits, Limits):
            self._limits = limits
            self._planner["limits"] = to_jsonable(limits)
        self._record["command"] = content.pop("command", None) or self._record["command"]
        for key in ("setup", "words"):
            if key in content:
                self._record[key] = content.pop(key)
        self._record["configuration"].update(entries.plain(content))
        if event.name:
            self._record["configuration"].setdefault("scene", event.name)

    def _on_observe(self, event: Event) -> None:
        observation: Observation = event.content
        self._seen = observation
        self._observations[observation.hash] = observation
        while len(self._observations) > 8:
            self._observations.pop(next(iter(self._observations)))
        self._planner["observations"].append(entries.observation_entry(event.name, observation, self._store))

    def _on_plan_scene(self, event: Event) -> None:
        """What a plan that was read was made from: it stays with the plan, so that the plan can be read from here too."""
        self._planner["plan_scene"] = entries.observation_entry("plan", event.content, self._store)

    def _on_stage(self, event: Event) -> None:
        content = event.content
        text = content.get("text", "") if isinstance(content, Mapping) else str(content or "")
        attempt = content.get("attempt", 0) if isinstance(content, Mapping) else 0
        self._planner["stages"].append({"name": event.name, "text": text, "attempt": attempt})
        self._stamp("stages")
        self._log(event.name, text)

    def _on_request(self, event: Event) -> None:
        request: Request = event.content
        entry = entries.request_entry(request, self._store)
        self._requests[entry["key"]] = entry
        self._clock["requests"][entry["key"]] = {"sent_s": round(self._elapsed_s(), 4), "answered_s": None}

    def _on_answer(self, event: Event) -> None:
        request, answer = event.content
        entry = self._entry_of(request)
        entry["answer"] = entries.answer_entry(answer)
        self._answered(entry["key"])

    def _on_invalid(self, event: Event) -> None:
        request, raw, error = event.content
        entry = self._entry_of(request)
        entry["invalid"] = {"raw": str(raw), "error": str(error)}
        self._answered(entry["key"])
        self._log("invalid", f"{request.id}: {error}")

    def _on_failed(self, event: Event) -> None:
        request, error = event.content
        entry = self._entry_of(request)
        entry["failed"] = entries.error_entry(error)
        self._answered(entry["key"])

    def _entry_of(self, request: Request) -> dict[str, Any]:
        key = entries.request_key(request)
        if key not in self._requests:
            # Answered without being sent (a cache): it is part of the story all the same.
            self._on_request(Event("request", request.id, request))
        return self._requests[key]

    def _answered(self, key: str) -> None:
        self._clock["requests"][key]["answered_s"] = round(self._elapsed_s(), 4)

    def _on_plan(self, event: Event) -> None:
        plan: Plan = event.content
        data = plan_to_json(plan)
        # The instruction's pictures stand once, as files, under "instruction".
        words_only = {**data["plan"]["instruction"], "slots": {}}
        kept = {**data, "plan": {**data["plan"], "instruction": words_only}}
        if kept in self._planner["plans"]:
            return
        self._planner["plans"].append(kept)
        if self._planner["instruction"] is None:
            self._planner["instruction"] = entries.instruction_entry(plan.instruction, self._store)
        self._files.write("plan.json", _text(json.dumps(redact_all(data), indent=1, ensure_ascii=False)))
        self._draw_final(plan)

    def _draw_final(self, plan: Plan) -> None:
        observation = self._observations.get(plan.scene_hash, self._seen)
        if observation is None:
            return
        view = observation.main
        regions = (*plan.keep_out, *(self._limits.keep_out if self._limits is not None else ()))
        self._planner["outlines"] = outlines(dict.fromkeys(regions), self._limits, view.camera)
        said = plan.instruction
        drawing = partial(
            overview,
            view,
            plan.grounded,
            names=picture_names(said.text, said.slots),
            arrows=action_arrows(plan.actions),
            turns=action_turns(plan.actions, plan.grounded, view),
            widths=swept_widths(plan.actions, self._limits.blade_m if self._limits else None, view.camera),
            keep_out=plan.keep_out,
            workspace=self._limits,
        )
        try:
            rgb = for_record(DRAWING, drawing)
        except BudgetReached as error:
            self._log("warning", f"the picture of the plan is missing: {error}")
            return
        self._files.write("final.png", to_png(rgb))

    def _on_asking(self, event: Event) -> None:
        self._planner.setdefault("asked", []).append({**event.content, "so_far": self._so_far()})

    def _on_clarified(self, event: Event) -> None:
        """What the user answered: a replay gives the same answers."""
        self._planner.setdefault("clarified", []).append(to_jsonable(event.content))

    def _on_decision(self, event: Event) -> None:
        self._planner["decisions"].append({**entries.plain(event.content), "so_far": self._so_far()})

    def _so_far(self) -> dict[str, int]:
        """How much has happened: what a method is told is what happened since its last decision."""
        return {key: len(self._planner[key]) for key in ("observations", "gates", "executions", "subgoals")}

    def _on_gate(self, event: Event) -> None:
        report: GateReport = event.content
        self._planner["gates"].append({"plan": self._plan_number, **entries.gate_entry(event.name, report)})
        self._stamp("gates")
        checks = counted(len(report.checks), "check")
        self._log("gate", f"{event.name}: " + gate_words(report.admitted, checks, report.reasons))

    def _on_subgoal(self, event: Event) -> None:
        entry = entries.subgoal_entry(event.content, self._store)
        self._planner["subgoals"].append({"plan": self._plan_number, **entry})

    def _on_execute(self, event: Event) -> None:
        planned, report = event.content
        number = len(self._planner["executions"]) + 1
        self._planner["executions"].append(entries.execution_entry(number, planned, report))
        self._stamp("executions")
        self._log("execute", f"action {number} {report.action.kind}: " + report.words)

    def _on_verdicts(self, event: Event) -> None:
        verdicts = to_jsonable(tuple(event.content))
        if not self._planner["verdicts"] or self._planner["verdicts"][-1]["verdicts"] != verdicts:
            after = len(self._planner["subgoals"])
            self._planner["verdicts"].append({"after_subgoals": after, "verdicts": verdicts})

    def _on_warning(self, event: Event) -> None:
        text = str(event.content)
        self._planner["warnings"].append(text)
        self._log("warning", text)

    def _on_detector(self, event: Event) -> None:
        self._planner.setdefault("detections", []).append(detector_entry(event.content, self._store))
        self._clock.setdefault("detections", []).append(round(event.content.seconds, 4))

    def _on_crash(self, event: Event) -> None:
        """The user's own code raised: its traceback is kept, line by line in the log."""
        error: WonderfulTeamError = event.content
        entry = {"error": event.name, "message": str(error), "trace": error.trace}
        self._planner.setdefault("crashes", []).append(entry)
        self._log("crash", str(error))
        for line in error.trace.splitlines():
            self._log("", line)

    def _on_done(self, event: Event) -> None:
        self._record["state"] = "finished"
        self._clock["ended"] = _now()
        self._clock["seconds"] = round(self._elapsed_s(), 4)
        match event.content:
            case Plan() as plan:
                self._on_plan(Event("plan", plan.id, plan))
                # A plan that the gate refuses is refused, however well it was made.
                made = {"outcome": plan.status, "stage": plan.stage, "reason": plan.message}
                self._record["outcome"] = self._refusal() or made
            case Trial() as trial:
                self._record["outcome"] = {
                    "outcome": trial.ending,
                    "stage": trial.stage,
                    "reason": trial.reason,
                    "seed": trial.seed,
                    "method": trial.method,
                    "model": trial.model,
                }
                # The score comes after the trial and stays out of the planner's part.
                usage = {role: entries.usage_entry(one) for role, one in trial.usage_by_role.items()}
                self._clock["usage_by_role"] = usage
            case WonderfulTeamError() as error:
                self._record["outcome"] = {"outcome": event.name, "stage": error.stage, "reason": str(error)}
            case _:
                self._record["outcome"] = {"outcome": event.name, "stage": None, "reason": ""}
        outcome = self._record["outcome"]
        self._log("done", "  ".join(ending_words(outcome["outcome"], outcome["reason"])).strip())

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
        self._clock[kind].append(round(self._elapsed_s(), 4))

    # -- files -------------------------------------------------------------------------------------------------------

    def _elapsed_s(self) -> float:
        return time.monotonic() - self._zero

    def _log(self, name: str, text: str) -> None:
        line = redact(f"{self._elapsed_s():6.1f} s  {name:10s} {text}")
        self._files.append("log.txt", visible(spoken(line.replace("\n", " "), self._pictures)) + "\n")

    def _write(self) -> None:
        self._files.write(RECORD_NAME, self._whole())
        self._last_write = self._elapsed_s()

    def _whole(self) -> bytes:
        planner = {**self._planner, "requests": [self._requests[key] for key in sorted(self._requests)]}
        record = {**self._record, "files": self._store.files, "planner": planner, "clock": self._clock}
        if self._files.missing:
            record["unwritten"] = list(self._files.missing)
        # Indenting takes ten times as long: only the finished record is laid out for reading.
        indent = None if record["state"] == "running" else 1
        return _text(json.dumps(redact_all(record), indent=indent, ensure_ascii=False))


def _text(text: str) -> bytes:
    # Half of a character (a lone surrogate) becomes its JSON escape, which reads back as what it was.
    return text.encode("utf-8", errors="backslashreplace")


def gate_words(admitted: bool, checks: str, reasons: Sequence[str]) -> str:
    """One passage through the gate in a line."""
    return f"admitted ({checks})" if admitted else f"refused ({checks}): " + "; ".join(reasons)


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
