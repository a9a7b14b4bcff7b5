"""What a record holds: the model that every record is checked against, and the JSON Schema made of it.

Only what readers rely on is stated; other fields may stand beside it. Fields with a default are those that records of earlier
releases lack.
"""

from __future__ import annotations

import json
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from wonderful_team.core.jsonable import read_json
from wonderful_team.errors import ConfigError
from wonderful_team.record.growing import LINES_NAME, RECORD_SCHEMA_VERSION, grown

SCHEMA_FILE = Path(__file__).with_name("record-v1.schema.json")


def _inside(path: str) -> str:
    parts = PurePosixPath(path)
    if parts.is_absolute() or ".." in parts.parts or "\\" in path or "\0" in path:
        raise ValueError(f"{path!r} leads out of the run folder")
    return path


FileInside = Annotated[str, AfterValidator(_inside), Field(description="Relative to the run folder, and inside it.")]


class _Part(BaseModel):
    model_config = ConfigDict(extra="allow", defer_build=True)


class Outcome(_Part):
    """How the run ended."""

    outcome: str
    stage: str | None = None
    reason: str = ""


class StoredView(_Part):
    """What a view is beside its pixels."""

    id: str
    camera_name: str
    time_s: float
    depth: FileInside | None
    camera: dict[str, Any] | None


class SlotEntry(_Part):
    """A picture of the instruction."""

    kind: str
    index: int | None
    views: dict[str, str]
    stored: dict[str, StoredView] = {}


class InstructionEntry(_Part):
    """The instruction; its pictures as keys of `files`."""

    text: str
    slots: dict[str, SlotEntry]


class ObservationEntry(_Part):
    """What was seen; every view as a key of `files`."""

    where: str
    hash: str
    time_s: float
    size_px: tuple[int, int]
    main: str
    camera: bool
    depth: bool
    views: dict[str, str] = Field(min_length=1)
    cameras: dict[str, str]
    stored: dict[str, StoredView] = {}
    robot: dict[str, Any] | None = None


class StageEntry(_Part):
    """One line of the story."""

    name: str
    text: str
    attempt: int = 0


class PlanEntry(_Part):
    """A plan, as plan.json holds it."""

    format: str
    schema_version: int
    id: str
    plan: dict[str, Any]


class SoFar(_Part):
    """How many of each there were by then."""

    observations: int = Field(ge=1)
    gates: int = Field(ge=0)
    executions: int = Field(ge=0)
    subgoals: int = Field(ge=0)


class Asked(_Part):
    """What the method was told of attempts and looks when it was asked what to do, or after a subgoal whether to go on."""

    attempt: int
    replans_left: int
    looks_left: int
    so_far: SoFar
    check: bool = False
    doubts: list[str] = []


class ClarifiedEntry(_Part):
    """What the user was asked while planning, and answered."""

    question: str
    choices: list[str]
    answer: str


class DecisionEntry(_Part):
    """What the method decided."""

    decision: str
    reason: str
    so_far: SoFar
    again: bool = False
    """It gave up on this plan, and said that a new look may mend it."""


class ProfileEntry(_Part):
    """The tool's way in one action over what depth shows, point by point [m, base frame]; null where no height is known.

    `low_m` is the lowest point of what passes, `surface_m` what it has to clear, `goal_m` what the action is meant to touch.
    `clearance_m` is the smallest distance between, at the point numbered `nearest`, and `least_m` how small it may be.
    """

    action: int = Field(ge=0)
    points_m: list[tuple[float, float, float]] = Field(min_length=1, max_length=4000)
    low_m: list[float] = Field(max_length=4000)
    surface_m: list[float | None] = Field(max_length=4000)
    goal_m: list[float | None] = Field(max_length=4000)
    clearance_m: float | None = None
    least_m: float | None = None
    nearest: int | None = None
    stays: bool = False


class GateEntry(_Part):
    """One passage through the safety gate."""

    plan: int | None
    where: str
    admitted: bool
    checks: list[dict[str, Any]]
    profiles: list[ProfileEntry] = []


class ExecutionEntry(_Part):
    """One action, and what the robot reported."""

    number: int
    step: dict[str, Any]
    action: dict[str, Any]
    executed: bool
    measured: dict[str, Any]
    fault: str | None


class SubgoalEntry(_Part):
    """One executed subgoal; the views before and after as keys of `files`."""

    plan: int | None
    subgoal: str
    before: dict[str, str]
    after: dict[str, str]
    main: str
    actions: int
    executed: int


class VerdictsEntry(_Part):
    """The judge's word on every subgoal; `check` is one on the subgoal that ran last, while others were still to run."""

    after_subgoals: int
    verdicts: list[dict[str, Any]]
    check: bool = False


class CrashEntry(_Part):
    """An exception of the user's own code, with its traceback."""

    error: str
    message: str
    trace: str


class AnswerEntry(_Part):
    """A right answer; its duration stands under `clock`."""

    parsed: Any
    raw: str
    repairs: list[str]
    provenance: str
    model_id: str
    tries: int
    usage: dict[str, Any]


class InvalidEntry(_Part):
    """An answer outside the contract, and the text that went back to the model."""

    raw: str
    error: str


class FailedEntry(_Part):
    """An error that came instead of an answer; `sent` is false where the request was refused before it was sent."""

    error: str
    message: str
    stage: str | None
    sent: bool = True


class RequestEntry(_Part):
    """One try at one request: the words and pictures as they were sent, and what came back."""

    key: str
    id: str
    stage: str
    role: str
    contract: str
    targets: list[str]
    system: str
    notes: list[dict[str, Any]]
    parts: list[dict[str, Any]]
    output: str
    sample: int
    attempt: int
    feedback: str
    answer: AnswerEntry | None
    invalid: InvalidEntry | None
    failed: FailedEntry | None = None


class DetectionEntry(_Part):
    """One thing that a detector found [px of the view]; the mask as COCO's uncompressed run lengths."""

    words: str
    box: tuple[float, float, float, float]
    score: float = Field(ge=0, le=1)
    mask: list[int] | None


class DetectorEntry(_Part):
    """One look of a detector at a view: who, at what (a key of `files`), for which words, what it found, drawn (another key), or why it refused or how it broke."""

    detector: dict[str, str]
    view: str
    view_id: str
    size_px: tuple[int, int]
    words: list[str]
    found: list[DetectionEntry]
    drawn: str
    refused: str = ""
    failed: str = ""


class Planner(_Part):
    """All that the planner was asked, answered and did, without clock times."""

    instruction: InstructionEntry | None
    outlines: list[dict[str, Any]]
    observations: list[ObservationEntry]
    plan_scene: ObservationEntry | None = None
    stages: list[StageEntry]
    plans: list[PlanEntry]
    asked: list[Asked] | None = None
    clarified: list[ClarifiedEntry] = []
    decisions: list[DecisionEntry]
    gates: list[GateEntry]
    executions: list[ExecutionEntry]
    subgoals: list[SubgoalEntry]
    verdicts: list[VerdictsEntry]
    warnings: list[str]
    crashes: list[CrashEntry] = []
    detections: list[DetectorEntry] = []
    limits: dict[str, Any] | None = None
    requests: list[RequestEntry]


class SentAt(_Part):
    """When a request was sent and answered [s since the start]."""

    sent_s: float
    answered_s: float | None


class Clock(_Part):
    """Times [s since the start] and durations."""

    started: str
    requests: dict[str, SentAt]
    stages: list[float]
    gates: list[float]
    executions: list[float]
    detections: list[float] = []
    ended: str | None = None
    seconds: float | None = None
    usage_by_role: dict[str, dict[str, Any]] = {}


class RecordFile(_Part):
    """record.json of one run."""

    schema_version: Literal[1]
    state: Literal["running", "finished", "interrupted"]
    command: str | None
    configuration: dict[str, Any]
    versions: dict[str, Any]
    outcome: Outcome | None
    setup: dict[str, Any] | None = None
    words: dict[str, str] = {}
    files: dict[str, FileInside]
    planner: Planner
    clock: Clock


def record_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of record.json."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **RecordFile.model_json_schema()}


def grown_record(folder: Path) -> Any:
    """What a run folder's record.json holds; while the run goes on, and after it was killed, with all that happened since.

    Raises:
        ConfigError: Missing, or not JSON.
    """
    for _ in range(2):
        record = read_json(folder / "record.json", "record", "the folder of a run")
        if not isinstance(record, dict) or record.get("state") != "running":
            return record
        if (folder / LINES_NAME).is_file():
            return grown(folder, record)
    # Of an earlier release; or the run ended between two looks, and then the second finds it whole.
    return record


def read_record(folder: Path) -> dict[str, Any]:
    """The record of a run folder, checked.

    Raises:
        ConfigError: Missing, not JSON, of another schema version, or not what the schema says; names the place.
    """
    file = Path(folder) / "record.json"
    record = grown_record(Path(folder))
    version = record.get("schema_version") if isinstance(record, dict) else None
    if version != RECORD_SCHEMA_VERSION:
        raise ConfigError(f"{file}: record schema version {version!r}; this release reads {RECORD_SCHEMA_VERSION}")
    try:
        RecordFile.model_validate(record)
    except (ValidationError, RecursionError) as error:
        first = error.errors(include_url=False)[0] if isinstance(error, ValidationError) else None
        where = "" if first is None else ".".join(map(str, first["loc"]))
        said = "nested too deeply" if first is None else f"{where}: {first['msg'].removeprefix('Value error, ')}"
        raise ConfigError(f"{file}: broken record: {said}") from error
    assert isinstance(record, dict)
    return record


if __name__ == "__main__":
    SCHEMA_FILE.write_text(json.dumps(record_schema(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
