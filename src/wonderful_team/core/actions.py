"""Steps (what a planner writes: target ids and stated quantities) and actions (what a robot runs: numbers).

A step never holds a coordinate; `motion` turns it into actions. Angles stated to or by people are degrees, clockwise
seen from above; inside an action they are radians, counter-clockwise about the vertical axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias

import numpy as np

from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array, frozen_array

Side: TypeAlias = Literal["left", "right", "above", "below"]
"""A side of an object as the picture shows it: above is towards the picture's top edge."""
Height: TypeAlias = Literal["above", "at", "clear"]
GRIPPER_STATES: tuple[Literal["open", "close", "tight"], ...] = ("open", "close", "tight")
SIDES: tuple[Side, ...] = ("left", "right", "above", "below")


@dataclass(frozen=True)
class At:
    """At the chosen point of a target."""

    target: str


@dataclass(frozen=True)
class Beside:
    """Next to a target, on the named side as the picture shows it."""

    target: str
    side: Side


@dataclass(frozen=True)
class OriginOf:
    """Where the target stood when the plan was made."""

    target: str


Place: TypeAlias = At | Beside | OriginOf


@dataclass(frozen=True)
class PickPlaceStep:
    """Pick a target and put it at a place, turned clockwise by `rotate_deg`."""

    kind: ClassVar[str] = "pick_place"
    subgoal: str
    pick: str
    place: Place
    rotate_deg: float = 0.0


@dataclass(frozen=True)
class PushStep:
    """Push along the table from one place to another."""

    kind: ClassVar[str] = "push"
    subgoal: str
    start: Place
    end: Place


@dataclass(frozen=True)
class MoveStep:
    """Move the tool to a place: above it, at it, or clear of everything."""

    kind: ClassVar[str] = "move"
    subgoal: str
    to: Place
    height: Height = "above"


@dataclass(frozen=True)
class OpenStep:
    """Open the gripper."""

    kind: ClassVar[str] = "open"
    subgoal: str


@dataclass(frozen=True)
class CloseStep:
    """Close the gripper; `tight` keeps squeezing."""

    kind: ClassVar[str] = "close"
    subgoal: str
    tight: bool = False


@dataclass(frozen=True)
class RotateGripperStep:
    """Turn the gripper clockwise seen from above."""

    kind: ClassVar[str] = "rotate_gripper"
    subgoal: str
    rotate_deg: float


@dataclass(frozen=True)
class FollowStep:
    """Follow the points of a helper function; `target` is what it moves along or round."""

    kind: ClassVar[str] = "follow"
    subgoal: str
    function: str


@dataclass(frozen=True)
class HomeStep:
    """Go to the home pose."""

    kind: ClassVar[str] = "home"
    subgoal: str


@dataclass(frozen=True)
class NavigateStep:
    """Drive a mobile base to a place."""

    kind: ClassVar[str] = "navigate"
    subgoal: str
    to: Place


Step: TypeAlias = (
    PickPlaceStep
    | PushStep
    | MoveStep
    | OpenStep
    | CloseStep
    | RotateGripperStep
    | FollowStep
    | HomeStep
    | NavigateStep
)
STEP_TYPES: tuple[type[Step], ...] = (
    PickPlaceStep,
    PushStep,
    MoveStep,
    OpenStep,
    CloseStep,
    RotateGripperStep,
    FollowStep,
    HomeStep,
    NavigateStep,
)


def places_of(step: Step) -> tuple[tuple[str, Place], ...]:
    """Every place a step refers to, as (role, place); roles name the points of a grounded target."""
    match step:
        case PickPlaceStep():
            return ("pick", At(step.pick)), ("place", step.place)
        case PushStep():
            return ("push_start", step.start), ("push_end", step.end)
        case MoveStep() | NavigateStep():
            return (("place", step.to),)
        case _:
            return ()


@dataclass(frozen=True, eq=False)
class PickPlace:
    """Pick at one point, put down at another, turning the object on the way.

    Attributes:
        pick_m, place_m: Shape (3,) [m], base frame; z is the surface that is touched.
        yaw_rad: How far the object turns, counter-clockwise from above.
    """

    kind: ClassVar[str] = "pick_place"
    pick_m: Array
    place_m: Array
    yaw_rad: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "pick_m", frozen_array(self.pick_m, (3,), "pick_m"))
        object.__setattr__(self, "place_m", frozen_array(self.place_m, (3,), "place_m"))
        _finite(self.yaw_rad, "yaw_rad")


@dataclass(frozen=True, eq=False)
class Push:
    """Push along the table, start to end, shape (3,) [m] each."""

    kind: ClassVar[str] = "push"
    start_m: Array
    end_m: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "start_m", frozen_array(self.start_m, (3,), "start_m"))
        object.__setattr__(self, "end_m", frozen_array(self.end_m, (3,), "end_m"))


@dataclass(frozen=True, eq=False)
class MoveTo:
    """Move the tool to a pose in the base frame."""

    kind: ClassVar[str] = "move_to"
    pose: Pose


@dataclass(frozen=True)
class Gripper:
    """Open, close, or close and keep squeezing."""

    kind: ClassVar[str] = "gripper"
    state: Literal["open", "close", "tight"]

    def __post_init__(self) -> None:
        if self.state not in GRIPPER_STATES:
            raise ValueError(f"state: expected {', '.join(GRIPPER_STATES)}, got {self.state!r}")


@dataclass(frozen=True)
class RotateGripper:
    """Turn the gripper about the vertical, counter-clockwise from above [rad]."""

    kind: ClassVar[str] = "rotate_gripper"
    yaw_rad: float

    def __post_init__(self) -> None:
        _finite(self.yaw_rad, "yaw_rad")


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Move the tool through waypoints, shape (N, 3) [m], base frame."""

    kind: ClassVar[str] = "trajectory"
    waypoints_m: Array

    def __post_init__(self) -> None:
        waypoints = frozen_array(self.waypoints_m, (None, 3), "waypoints_m")
        if len(waypoints) == 0:
            raise ValueError("waypoints_m: at least one waypoint is needed")
        object.__setattr__(self, "waypoints_m", waypoints)


@dataclass(frozen=True)
class Home:
    """Go to the home pose."""

    kind: ClassVar[str] = "home"


@dataclass(frozen=True, eq=False)
class Navigate:
    """Drive a mobile base along a path on the floor, shape (N, 2) [m]."""

    kind: ClassVar[str] = "navigate"
    path_m: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "path_m", frozen_array(self.path_m, (None, 2), "path_m"))


@dataclass(frozen=True, eq=False)
class EndEffectorDelta:
    """One step of a learned policy: (dx, dy, dz [m], droll, dpitch, dyaw [rad], gripper 0..1), shape (7,)."""

    kind: ClassVar[str] = "end_effector_delta"
    v7: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "v7", frozen_array(self.v7, (7,), "v7"))


Action: TypeAlias = (
    PickPlace | Push | MoveTo | Gripper | RotateGripper | Trajectory | Home | Navigate | EndEffectorDelta
)
ACTION_TYPES: tuple[type[Action], ...] = (
    PickPlace,
    Push,
    MoveTo,
    Gripper,
    RotateGripper,
    Trajectory,
    Home,
    Navigate,
    EndEffectorDelta,
)

_STEPS_FOR_ACTION: dict[str, tuple[str, ...]] = {
    "pick_place": ("pick_place",),
    "push": ("push",),
    "move_to": ("move",),
    "gripper": ("open", "close"),
    "rotate_gripper": ("rotate_gripper",),
    "trajectory": ("follow",),
    "home": ("home",),
    "navigate": ("navigate",),
    "end_effector_delta": (),
}


def steps_for(action_kind: str) -> tuple[str, ...]:
    """The kinds of step that an action of that kind carries out; none where a learned policy acts without steps."""
    # A method of one's own may make a move of many waypoints; a planner's move has one.
    also = ("move",) if action_kind == "trajectory" else ()
    return (*_STEPS_FOR_ACTION.get(action_kind, ()), *also)


@dataclass(frozen=True)
class Vocabulary:
    """Which kinds of action a world runs; the Supervisor's output type is built from it.

    Raises:
        ValueError: A kind that does not exist, or none at all.
    """

    kinds: tuple[str, ...]

    def __post_init__(self) -> None:
        unknown = [kind for kind in self.kinds if kind not in _STEPS_FOR_ACTION]
        if unknown or not self.kinds:
            raise ValueError(f"vocabulary {self.kinds}: valid kinds are {', '.join(_STEPS_FOR_ACTION)}")

    @property
    def step_kinds(self) -> tuple[str, ...]:
        """The kinds of step that a planner may write for these actions."""
        return tuple(step for kind in self.kinds for step in _STEPS_FOR_ACTION[kind])


PICK_PLACE = Vocabulary(("pick_place",))
ARM = Vocabulary(("move_to", "gripper", "rotate_gripper", "trajectory", "home"))
VOCABULARIES: dict[str, Vocabulary] = {"pick_place": PICK_PLACE, "push": Vocabulary(("push",)), "arm": ARM}


def _finite(value: float, name: str) -> None:
    if not np.isfinite(value):
        raise ValueError(f"{name}: must be finite, got {value}")
