"""The values that flow through the system: frozen, checked once when built, arrays read-only."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, Literal, TypeAlias

from wonderful_team.actions import Action, Step
from wonderful_team.errors import ConfigError
from wonderful_team.geometry import Box, Camera
from wonderful_team.geometry.arrays import Array
from wonderful_team.jsonable import to_jsonable
from wonderful_team.pictures import Picture, Point, checked_depth, checked_rgb, picture_hash

Provenance: TypeAlias = Literal["model", "offline", "simulated", "scripted", "cached", "injected", "replayed", "user"]
SlotKind: TypeAlias = Literal["object", "scene", "frame", "before", "after"]
PointRole: TypeAlias = Literal["pick", "place", "push_start", "push_end", "grasp"]


@dataclass(frozen=True, eq=False)
class View:
    """One camera's view at one instant.

    Attributes:
        id: Unique within an observation or an instruction, such as "top" or "slot:base_obj:top".
        camera_name: Which camera took it.
        time_s: When, in the world's own time [s].
        rgb: Image, shape (H, W, 3), uint8, row 0 at the top.
        depth_m: Distance along the optical axis [m], shape (H, W); NaN where unknown; None without depth.
        camera: Model and pose of the camera in the robot base frame; None for a photo.
    """

    id: str
    camera_name: str
    time_s: float
    rgb: Array
    depth_m: Array | None = None
    camera: Camera | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "rgb", checked_rgb(self.rgb))
        object.__setattr__(self, "depth_m", checked_depth(self.depth_m, self.rgb.shape[:2]))

    @property
    def size_px(self) -> tuple[int, int]:
        """Width, height."""
        return self.rgb.shape[1], self.rgb.shape[0]

    @cached_property
    def hash(self) -> str:
        return picture_hash(self.rgb)


@dataclass(frozen=True, eq=False)
class RobotState:
    """What the robot says of itself: tool position (3,) [m], gripper opening 0..1 or None, holding something or not."""

    tool_m: Array | None = None
    gripper: float | None = None
    holding: bool | None = None


@dataclass(frozen=True, eq=False)
class Observation:
    """All views at one instant; the first is the one that targets are grounded in."""

    views: Mapping[str, View]
    robot: RobotState | None = None

    def __post_init__(self) -> None:
        if not self.views:
            raise ConfigError("an observation needs at least one view")
        object.__setattr__(self, "views", MappingProxyType(dict(self.views)))

    @property
    def main(self) -> View:
        """The view that targets are grounded in."""
        return next(iter(self.views.values()))

    @cached_property
    def hash(self) -> str:
        """Hash over all views, in order."""
        return hashlib.sha256("".join(view.hash for view in self.views.values()).encode()).hexdigest()[:16]


@dataclass(frozen=True, eq=False)
class Slot:
    """A picture inside an instruction: `{name}` in the text stands for it.

    Attributes:
        kind: object (one thing alone), scene (a whole table), frame (of a sequence), before / after (of a pair).
        index: Place in a sequence of frames or pairs; None otherwise.
        views: By camera name, such as top and front.
    """

    name: str
    kind: SlotKind
    views: Mapping[str, View]
    index: int | None = None

    def __post_init__(self) -> None:
        if not self.views:
            raise ConfigError(f"instruction slot {self.name!r} holds no picture")
        object.__setattr__(self, "views", MappingProxyType(dict(self.views)))


@dataclass(frozen=True, eq=False)
class Instruction:
    """What the human wants: words with `{slot}` marks, and the pictures for them. A slot may occur twice.

    Raises:
        ConfigError: The text is empty, or a slot's picture is never mentioned.
    """

    text: str
    slots: Mapping[str, Slot] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.text.strip():
            raise ConfigError("the instruction is empty")
        for name in self.slots:
            if f"{{{name}}}" not in self.text:
                raise ConfigError(
                    f"the instruction has a picture {name!r} but its text never says {{{name}}}: {self.text!r}"
                )
        object.__setattr__(self, "slots", MappingProxyType(dict(self.slots)))


@dataclass(frozen=True)
class Target:
    """Something to be found in the picture.

    Attributes:
        id: Short and unique in a plan: T1, T2, …
        kind: object (has an outline) or area (free space or a region, found by points).
        words: What it is, in words.
        part: Which part of it matters ("handle"), or None.
        where: How it stands to other things ("left of the blue bowl"), or "".
        source: scene, or slot when it is described by the instruction's pictures.
        like: Names of the instruction's slots that show what it looks like.
        use: What its points are for; an object is picked and an area placed on unless the plan says otherwise.
    """

    id: str
    kind: Literal["object", "area"]
    words: str
    part: str | None = None
    where: str = ""
    source: Literal["scene", "slot"] = "scene"
    like: tuple[str, ...] = ()
    use: tuple[PointRole, ...] = ()

    @property
    def roles(self) -> tuple[PointRole, ...]:
        """The points to be found, never empty."""
        return self.use or (("pick",) if self.kind == "object" else ("place",))


@dataclass(frozen=True)
class GroundingEvent:
    """One line of a target's grounding story: a candidate, a box, a verdict, a point.

    Attributes:
        what: centre | chosen | box | presence | verdict | move | point | absent | clamped.
        text: What was said, in one line.
        box, points: In pixels of the main view.
    """

    what: str
    text: str
    box: Box | None = None
    points: tuple[Point, ...] = ()
    provenance: Provenance = "model"


@dataclass(frozen=True, eq=False)
class GroundedTarget:
    """A target with its place in the main view; coordinates are pixels of that view.

    Attributes:
        status: found | absent | gave_up (the bounds were reached; box holds the best so far, if any).
        points: Action points by role.
        history: How it came about, in order.
    """

    target: Target
    status: Literal["found", "absent", "gave_up"]
    view_id: str
    box: Box | None = None
    points: Mapping[str, Point] = field(default_factory=dict)
    history: tuple[GroundingEvent, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", MappingProxyType(dict(self.points)))


@dataclass(frozen=True)
class Subgoal:
    """One qualitative goal of a plan; `after` names the subgoals that must come first."""

    id: str
    text: str
    after: tuple[str, ...] = ()
    targets: tuple[str, ...] = ()
    function: str | None = None


@dataclass(frozen=True)
class Doubt:
    """One question that Verification raised about one subgoal (or step), and what came of it."""

    about: str
    kind: str
    question: str
    answer: str = ""
    changed: bool = False
    provenance: Provenance = "model"


@dataclass(frozen=True)
class NumberSource:
    """Where one point of an action came from: every number can be traced to a pixel and a rule.

    Attributes:
        role: pick | place | push_start | push_end | waypoint.
        target: Target id.
        point_px: Pixel of the main view.
        position_m: What it became, base frame; None without a camera.
        how: The rule, in words ("T1 point, depth 0.482 m"; "origin of T1").
    """

    role: str
    target: str
    point_px: Point
    position_m: tuple[float, float, float] | None
    how: str


@dataclass(frozen=True, eq=False)
class PlannedAction:
    """A step with its action; `action` is None when no camera gives metres (a plan in pixels)."""

    step: Step
    action: Action | None
    sources: tuple[NumberSource, ...] = ()


@dataclass(frozen=True, eq=False)
class Plan:
    """What the team made: checked, grounded, written as actions.

    Attributes:
        id: Hash of what would run: steps, points and actions.
        status: planned | draft | checked | grounded (stopped early on request) | not_found | not_understood |
            needs_clarification | refused | budget | failed.
        verified: Verification approved the plan and the steps.
        scene_hash: Hash of the observation it was made from.
        first_draft: Subgoals as first drafted, for the page's diff.
        message, stage: Why it did not come to be planned, and where it failed; "" and None otherwise.
        parent: Id of the plan it replaces after a replan.
    """

    instruction: Instruction
    status: str
    subgoals: tuple[Subgoal, ...] = ()
    targets: tuple[Target, ...] = ()
    mode: Literal["full", "one_step"] = "one_step"
    verified: bool = False
    steps: tuple[Step, ...] = ()
    grounded: Mapping[str, GroundedTarget] = field(default_factory=dict)
    actions: tuple[PlannedAction, ...] = ()
    keep_out: tuple[KeepOut, ...] = ()
    questions: tuple[Doubt, ...] = ()
    first_draft: tuple[Subgoal, ...] = ()
    scene_hash: str = ""
    parent: str | None = None
    message: str = ""
    stage: str | None = None
    choices: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "grounded", MappingProxyType(dict(self.grounded)))

    @cached_property
    def id(self) -> str:
        """Hash of everything that decides what runs: 12 hex digits."""
        runs = {
            "scene": self.scene_hash,
            "steps": to_jsonable(self.steps),
            "actions": to_jsonable(self.actions),
            "points": {key: to_jsonable(dict(value.points)) for key, value in sorted(self.grounded.items())},
            "keep_out": to_jsonable(self.keep_out),
        }
        return hashlib.sha256(json.dumps(runs, sort_keys=True).encode()).hexdigest()[:12]

    def with_status(self, status: str, message: str = "") -> Plan:
        return replace(self, status=status, message=message)


@dataclass(frozen=True)
class KeepOut:
    """A region nothing may enter: a box in pixels of the main view, or in metres on the table (x0, y0, x1, y1)."""

    name: str
    box: Box
    unit: Literal["px", "m"] = "px"


@dataclass(frozen=True, eq=False)
class Limits:
    """What a world allows.

    Attributes:
        low_m, high_m: Corners of the workspace, shape (3,) [m], base frame.
        keep_out: Regions nothing may enter.
        clearance_m: Height at which things are carried over the table [m].
    """

    low_m: tuple[float, float, float]
    high_m: tuple[float, float, float]
    keep_out: tuple[KeepOut, ...] = ()
    clearance_m: float = 0.2

    def __post_init__(self) -> None:
        if any(low >= high for low, high in zip(self.low_m, self.high_m, strict=True)):
            raise ValueError(f"workspace: every low must be below its high, got {self.low_m} and {self.high_m} m")


NO_WORKSPACE = Limits((-100.0, -100.0, -100.0), (100.0, 100.0, 100.0))
"""Limits of a photo without a robot: nobody has said where the workspace ends."""


@dataclass(frozen=True, eq=False)
class StepReport:
    """What a robot knows of one executed action: what it measured and any fault; never the score."""

    action: Action
    executed: bool
    measured: Mapping[str, Any] = field(default_factory=dict)
    fault: str | None = None


@dataclass(frozen=True)
class Verdict:
    """The Replanner's word on one subgoal after execution."""

    subgoal: str
    status: Literal["done", "not_done", "undone", "unclear"]
    cause: str | None = None
    evidence: str = ""


@dataclass(frozen=True)
class Usage:
    """What calls cost. `usd` is None when any price is unknown."""

    calls: int = 0
    tokens_in: int = 0
    tokens_cached: int = 0
    tokens_thinking: int = 0
    tokens_out: int = 0
    pictures: int = 0
    seconds: float = 0.0
    usd: float | None = 0.0

    def __add__(self, other: Usage) -> Usage:
        return Usage(
            self.calls + other.calls,
            self.tokens_in + other.tokens_in,
            self.tokens_cached + other.tokens_cached,
            self.tokens_thinking + other.tokens_thinking,
            self.tokens_out + other.tokens_out,
            self.pictures + other.pictures,
            self.seconds + other.seconds,
            None if self.usd is None or other.usd is None else self.usd + other.usd,
        )

    @property
    def tokens(self) -> int:
        return self.tokens_in + self.tokens_thinking + self.tokens_out


@dataclass(frozen=True)
class Note:
    """One entry of a role's notebook or of the system memory."""

    key: str
    text: str
    source: str = ""


@dataclass(frozen=True, eq=False)
class Words:
    """A part of a request: text.

    Attributes:
        says: caption (it announces `picture`, its size and its tick labels) or positions (it says how to give positions
            in `picture`): a provider may write these in its model's own unit. "" for all other text.
    """

    text: str
    says: Literal["", "caption", "positions"] = ""
    picture: Picture | None = None


Part: TypeAlias = Words | Picture


@dataclass(frozen=True, eq=False)
class Request:
    """One question on its way to a model.

    Attributes:
        id: Deterministic: stage, target and count, never a clock or a race.
        stage: plan | ground | act | memory | replan | other.
        role: Which agent asks.
        question: The contract's input; holds nothing that the parts do not show.
        parts: Words and pictures in the order they are shown.
        system: The role's standing words (the same prefix for every request of the role).
        output: Type of a right answer (a pydantic model).
        sample: Number of this independent sample, from 0.
        attempt: Number of the try after an invalid answer, from 0.
        feedback: The validation text that the last attempt earned.
    """

    id: str
    stage: str
    role: str
    question: Any
    parts: tuple[Part, ...]
    output: type[Any]
    system: str = ""
    notes: tuple[Note, ...] = ()
    sample: int = 0
    attempt: int = 0
    feedback: str = ""
    previous: Any = None

    @property
    def contract(self) -> str:
        """Name of the kind of question."""
        return type(self.question).__name__

    @property
    def pictures(self) -> tuple[Picture, ...]:
        return tuple(part for part in self.parts if isinstance(part, Picture))


@dataclass(frozen=True, eq=False)
class Answer:
    """What came back: the validated value and what it cost.

    Attributes:
        value: An instance of the request's output type.
        repairs: What was clamped or mended, in words.
    """

    value: Any
    usage: Usage = Usage()
    model_id: str = ""
    raw: str = ""
    tries: int = 1
    provenance: Provenance = "model"
    repairs: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class GateCheck:
    """One check of the safety gate with its margin; `ok` False refuses the action."""

    action: int | None
    name: str
    ok: bool
    value: str
    limit: str
    margin: str = ""


@dataclass(frozen=True, eq=False)
class GateReport:
    """All checks of one passage through the gate."""

    checks: tuple[GateCheck, ...]

    @property
    def admitted(self) -> bool:
        return all(check.ok for check in self.checks)

    @property
    def reasons(self) -> tuple[str, ...]:
        """Every reason for a refusal, all at once, each once."""
        failed = (check for check in self.checks if not check.ok)
        return tuple(dict.fromkeys(_refusal(check) for check in failed))


def _refusal(check: GateCheck) -> str:
    where = f"action {check.action + 1}: " if check.action is not None else ""
    return f"{where}{check.name}: {check.value} (limit {check.limit})"


@dataclass(frozen=True, eq=False)
class SubgoalRun:
    """Execution of one subgoal: pictures before and after, what the robot reported."""

    subgoal: str
    before: Observation
    after: Observation
    reports: tuple[StepReport, ...]


@dataclass(frozen=True, eq=False)
class Trial:
    """One attempt at one scene, whole.

    Attributes:
        outcome: success | failure | error | unscored.
        stage: Where it failed: plan | grounding | wrong object | gate | execution | budget | … ; None on success.
        seed: Of the scene; None for a photo or a real robot.
    """

    scene: str
    seed: int | None
    method: str
    model: str
    plans: tuple[Plan, ...]
    gates: tuple[GateReport, ...]
    runs: tuple[SubgoalRun, ...]
    verdicts: tuple[Verdict, ...]
    outcome: Literal["success", "failure", "error", "unscored"]
    stage: str | None
    reason: str
    usage_by_role: Mapping[str, Usage] = field(default_factory=dict)
    provenance: tuple[Provenance, ...] = ()
    setting: Mapping[str, Any] = field(default_factory=dict)

    @property
    def usage(self) -> Usage:
        return sum(self.usage_by_role.values(), Usage())

    @property
    def reports(self) -> tuple[StepReport, ...]:
        return tuple(report for run in self.runs for report in run.reports)
