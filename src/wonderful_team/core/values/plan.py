"""A plan and its parts: subgoals, targets with their places, steps with their numbers, regions and limits."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Literal, TypeAlias

from wonderful_team.core.actions import Action, Step
from wonderful_team.core.geometry import Box
from wonderful_team.core.jsonable import to_jsonable
from wonderful_team.core.later import later
from wonderful_team.core.pictures import Point
from wonderful_team.core.values.content import content_hash
from wonderful_team.core.values.function import HelperFunction
from wonderful_team.core.values.limits import KeepOut
from wonderful_team.core.values.observation import Instruction

Provenance: TypeAlias = Literal[
    "model", "offline", "simulated", "scripted", "cached", "injected", "replayed", "user", "detector"
]  # fmt: skip
PointRole: TypeAlias = Literal["pick", "place", "push_start", "push_end", "grasp"]
Alike: TypeAlias = Literal["both", "shape", "surface"]
"""What a thing has in common with the pictures that it is like: shape and surface, or one of the two."""


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
        like: Names of the instruction's slots that show what it looks like; for an area, those that define it.
        use: What its points are for; an object is picked and an area placed on unless the plan says otherwise.
        alike: What it has in common with those pictures; surface is colour and pattern.
        landmark: Others are placed beside it, and nothing else is done with it: only its outline is looked for.
    """

    id: str
    kind: Literal["object", "area"]
    words: str
    part: str | None = None
    where: str = ""
    source: Literal["scene", "slot"] = "scene"
    like: tuple[str, ...] = ()
    use: tuple[PointRole, ...] = ()
    alike: Alike = later("both")
    landmark: bool = later(False)

    @property
    def roles(self) -> tuple[PointRole, ...]:
        """The points to be found; none of a landmark."""
        if self.landmark:
            return ()
        return self.use or (("pick",) if self.kind == "object" else ("place",))


@dataclass(frozen=True)
class GroundingEvent:
    """One line of a target's grounding story: a candidate, a box, a verdict, a point.

    Attributes:
        what: centre | chosen | box | presence | verdict | move | point | absent | clamped | turn.
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
class Critique:
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
        point_px: Pixel of the main view. Of a place, it is where the middle of the thing lands (the middle of its box).
        position_m: What it became, base frame; None without a camera.
        how: The rule, in words ("T1 point, depth 0.482 m"; "origin of T1").
        tool_px: Of a place: where the tool itself ends, which holds the thing at its pick point and not at its middle. A robot
            that is sent to pixels goes here; position_m is the same point in metres. None where both are one.
    """

    role: str
    target: str
    point_px: Point
    position_m: tuple[float, float, float] | None
    how: str
    tool_px: Point | None = later(None)


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
        id: SHA-256 over every field: what is read and what would run, but not who answered.
        status: planned | draft | checked | grounded (stopped early on request) | not_found | not_understood |
            needs_clarification | refused | budget | failed.
        verified: Verification approved the plan and the steps.
        scene_hash: Hash of the observation it was made from.
        first_draft: Subgoals as first drafted, for the page's diff.
        message, stage: Why it did not come to be planned, and where it failed; "" and None otherwise.
        parent: Id of the plan it replaces after a replan.
        functions: The helper functions that its trial had accepted when it was made, its own included: a trial that goes on from
            it goes on with these.
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
    questions: tuple[Critique, ...] = ()
    first_draft: tuple[Subgoal, ...] = ()
    scene_hash: str = ""
    parent: str | None = None
    message: str = ""
    stage: str | None = None
    choices: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    functions: tuple[HelperFunction, ...] = later(())

    def __post_init__(self) -> None:
        object.__setattr__(self, "grounded", MappingProxyType(dict(self.grounded)))

    @cached_property
    def id(self) -> str:
        """SHA-256 over everything that is read or run, in canonical form: 64 hex digits.

        Who answered (provenance) is left out, so that a plan out of a cache or a replay is the same plan; it stands on the
        plan's page, and an approval names the page's hash too.
        """
        return content_hash(self, without=("provenance",))

    def short_id(self, scene_hash: str | None = None) -> str:
        """What earlier releases called the plan: 12 hex digits over its steps, points, actions and regions.

        Args:
            scene_hash: What they called the picture; default as the plan has it.
        """
        runs = {
            "scene": self.scene_hash if scene_hash is None else scene_hash,
            "steps": to_jsonable(self.steps, later=False),
            "actions": to_jsonable(self.actions, later=False),
            "points": {key: to_jsonable(dict(value.points)) for key, value in sorted(self.grounded.items())},
            "keep_out": to_jsonable(self.keep_out),
        }
        return hashlib.sha256(json.dumps(runs, sort_keys=True).encode()).hexdigest()[:12]
