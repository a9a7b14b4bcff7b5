"""Actions: what a robot runs, numbers. A kind of action tells its points and its motion, and nothing else has to know it.

Inside an action angles are radians, counter-clockwise about the vertical axis. The steps that planners write stand in
`core.steps`, and are offered from here too.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias, get_args

import numpy as np

from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array, frozen_array
from wonderful_team.core.motions import Carry, Drive, Leave, Lost, Motion, Reach, Slide, Stay
from wonderful_team.core.steps import (
    SIDES,
    STEPS,
    At,
    Beside,
    CloseStep,
    FollowStep,
    Height,
    HomeStep,
    MoveStep,
    NavigateStep,
    OpenStep,
    OriginOf,
    PickPlaceStep,
    Place,
    PushStep,
    RotateGripperStep,
    Side,
    Step,
    StepWords,
    places_of,
)

GRIPPER_STATES: tuple[Literal["open", "close", "tight"], ...] = ("open", "close", "tight")


class _Action(ABC):
    """What every kind of action has.

    Attributes:
        steps: The kinds of step that it carries out; none where a learned policy acts without steps.
        also: Those that it may carry out too, for a method that writes its own.
    """

    kind: ClassVar[str]
    steps: ClassVar[tuple[str, ...]] = ()
    also: ClassVar[tuple[str, ...]] = ()

    @abstractmethod
    def motion(self, tool_m: Array | None) -> Motion:
        """What it does to the scene, for a tool that stands at `tool_m`, shape (3,) [m] (None: unknown)."""

    @abstractmethod
    def as_step(self, subgoal: str, thing: str) -> Step:
        """A step that says the same as its numbers, about a thing that no picture shows."""

    def points(self) -> tuple[tuple[str, Array], ...]:
        """The points that it names, as (role of the source, point [m]); none where sources are not bound to numbers."""
        return ()

    def turns_rad(self) -> tuple[float, ...]:
        """How far it turns something [rad]."""
        return ()

    def settings(self) -> tuple[tuple[str, bool, str, str], ...]:
        """What else must lie within bounds, as (name, whether it does, value, limit)."""
        return ()


@dataclass(frozen=True, eq=False)
class PickPlace(_Action):
    """Pick at one point, put down at another, turning the object on the way.

    Attributes:
        pick_m, place_m: Shape (3,) [m], base frame; z is the surface that is touched.
        yaw_rad: How far the object turns, counter-clockwise from above.
    """

    kind: ClassVar[str] = "pick_place"
    steps: ClassVar[tuple[str, ...]] = ("pick_place",)
    pick_m: Array
    place_m: Array
    yaw_rad: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "pick_m", frozen_array(self.pick_m, (3,), "pick_m"))
        object.__setattr__(self, "place_m", frozen_array(self.place_m, (3,), "place_m"))
        _finite(self.yaw_rad, "yaw_rad")

    def motion(self, tool_m: Array | None) -> Motion:
        return Carry(self.pick_m, self.place_m, self.yaw_rad)

    def as_step(self, subgoal: str, thing: str) -> Step:
        return PickPlaceStep(subgoal, thing, At(thing), float(np.degrees(-self.yaw_rad)))

    def points(self) -> tuple[tuple[str, Array], ...]:
        return ("pick", self.pick_m), ("place", self.place_m)

    def turns_rad(self) -> tuple[float, ...]:
        return (float(self.yaw_rad),)


@dataclass(frozen=True, eq=False)
class Push(_Action):
    """Push along the table, start to end, shape (3,) [m] each."""

    kind: ClassVar[str] = "push"
    steps: ClassVar[tuple[str, ...]] = ("push",)
    start_m: Array
    end_m: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "start_m", frozen_array(self.start_m, (3,), "start_m"))
        object.__setattr__(self, "end_m", frozen_array(self.end_m, (3,), "end_m"))

    def motion(self, tool_m: Array | None) -> Motion:
        return Slide(self.start_m, self.end_m)

    def as_step(self, subgoal: str, thing: str) -> Step:
        return PushStep(subgoal, Beside(thing, "left"), At(thing))

    def points(self) -> tuple[tuple[str, Array], ...]:
        return ("push_start", self.start_m), ("push_end", self.end_m)


@dataclass(frozen=True, eq=False)
class MoveTo(_Action):
    """Move the tool to a pose in the base frame."""

    kind: ClassVar[str] = "move_to"
    steps: ClassVar[tuple[str, ...]] = ("move",)
    pose: Pose

    def motion(self, tool_m: Array | None) -> Motion:
        return Reach(self.pose.position_m[None])

    def as_step(self, subgoal: str, thing: str) -> Step:
        return MoveStep(subgoal, At(thing))

    def points(self) -> tuple[tuple[str, Array], ...]:
        return (("waypoint", self.pose.position_m),)


@dataclass(frozen=True)
class Gripper(_Action):
    """Open, close, or close and keep squeezing."""

    kind: ClassVar[str] = "gripper"
    steps: ClassVar[tuple[str, ...]] = ("open", "close")
    state: Literal["open", "close", "tight"]

    def __post_init__(self) -> None:
        if self.state not in GRIPPER_STATES:
            raise ValueError(f"state: expected {', '.join(GRIPPER_STATES)}, got {self.state!r}")

    def motion(self, tool_m: Array | None) -> Motion:
        return Stay("open" if self.state == "open" else "close")

    def as_step(self, subgoal: str, thing: str) -> Step:
        return OpenStep(subgoal) if self.state == "open" else CloseStep(subgoal, self.state == "tight")

    def settings(self) -> tuple[tuple[str, bool, str, str], ...]:
        return (("gripper", self.state in GRIPPER_STATES, repr(self.state), ", ".join(GRIPPER_STATES)),)


@dataclass(frozen=True)
class RotateGripper(_Action):
    """Turn the gripper about the vertical, counter-clockwise from above [rad]."""

    kind: ClassVar[str] = "rotate_gripper"
    steps: ClassVar[tuple[str, ...]] = ("rotate_gripper",)
    yaw_rad: float

    def __post_init__(self) -> None:
        _finite(self.yaw_rad, "yaw_rad")

    def motion(self, tool_m: Array | None) -> Motion:
        return Stay()

    def as_step(self, subgoal: str, thing: str) -> Step:
        return RotateGripperStep(subgoal, float(np.degrees(-self.yaw_rad)))

    def turns_rad(self) -> tuple[float, ...]:
        return (float(self.yaw_rad),)


@dataclass(frozen=True, eq=False)
class Trajectory(_Action):
    """Move the tool through waypoints, shape (N, 3) [m], base frame."""

    kind: ClassVar[str] = "trajectory"
    steps: ClassVar[tuple[str, ...]] = ("follow",)
    also: ClassVar[tuple[str, ...]] = ("move",)
    waypoints_m: Array

    def __post_init__(self) -> None:
        waypoints = frozen_array(self.waypoints_m, (None, 3), "waypoints_m")
        if len(waypoints) == 0:
            raise ValueError("waypoints_m: at least one waypoint is needed")
        object.__setattr__(self, "waypoints_m", waypoints)

    def motion(self, tool_m: Array | None) -> Motion:
        return Reach(self.waypoints_m)

    def as_step(self, subgoal: str, thing: str) -> Step:
        return FollowStep(subgoal, thing)

    def points(self) -> tuple[tuple[str, Array], ...]:
        return tuple(("waypoint", point) for point in self.waypoints_m)


@dataclass(frozen=True)
class Home(_Action):
    """Go to the home pose."""

    kind: ClassVar[str] = "home"
    steps: ClassVar[tuple[str, ...]] = ("home",)

    def motion(self, tool_m: Array | None) -> Motion:
        return Leave()

    def as_step(self, subgoal: str, thing: str) -> Step:
        return HomeStep(subgoal)


@dataclass(frozen=True, eq=False)
class Navigate(_Action):
    """Drive a mobile base along a path on the floor, shape (N, 2) [m]."""

    kind: ClassVar[str] = "navigate"
    steps: ClassVar[tuple[str, ...]] = ("navigate",)
    path_m: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "path_m", frozen_array(self.path_m, (None, 2), "path_m"))

    def motion(self, tool_m: Array | None) -> Motion:
        return Drive(self.path_m)

    def as_step(self, subgoal: str, thing: str) -> Step:
        return NavigateStep(subgoal, At(thing))

    def points(self) -> tuple[tuple[str, Array], ...]:
        return tuple(("waypoint", point) for point in self.path_m)


@dataclass(frozen=True, eq=False)
class EndEffectorDelta(_Action):
    """One step of a learned policy: (dx, dy, dz [m], droll, dpitch, dyaw [rad], gripper 0..1), shape (7,)."""

    kind: ClassVar[str] = "end_effector_delta"
    v7: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "v7", frozen_array(self.v7, (7,), "v7"))

    def motion(self, tool_m: Array | None) -> Motion:
        return Lost() if tool_m is None else Reach((tool_m + self.v7[:3])[None], planned=False)

    def as_step(self, subgoal: str, thing: str) -> Step:
        return MoveStep(subgoal, At(thing))

    def turns_rad(self) -> tuple[float, ...]:
        return tuple(float(value) for value in self.v7[3:6])

    def settings(self) -> tuple[tuple[str, bool, str, str], ...]:
        grip = float(self.v7[6])
        return (("gripper", 0.0 <= grip <= 1.0, f"{grip:.3g}", "[0, 1]"),)


Action: TypeAlias = (
    PickPlace | Push | MoveTo | Gripper | RotateGripper | Trajectory | Home | Navigate | EndEffectorDelta
)
ACTIONS: dict[str, type[Action]] = {action.kind: action for action in get_args(Action)}
"""Every kind of action that the gate judges and a world may run."""


def steps_for(action_kind: str) -> tuple[str, ...]:
    """The kinds of step that an action of that kind carries out; none where a learned policy acts without steps."""
    action = ACTIONS.get(action_kind)
    return () if action is None else (*action.steps, *action.also)


@dataclass(frozen=True)
class Vocabulary:
    """Which kinds of action a world runs; the Supervisor's output type is built from it.

    Raises:
        ValueError: A kind that does not exist, or none at all.
    """

    kinds: tuple[str, ...]

    def __post_init__(self) -> None:
        unknown = [kind for kind in self.kinds if kind not in ACTIONS]
        if unknown or not self.kinds:
            raise ValueError(f"vocabulary {self.kinds}: valid kinds are {', '.join(ACTIONS)}")

    @property
    def step_kinds(self) -> tuple[str, ...]:
        """The kinds of step that a planner may write for these actions."""
        return tuple(step for kind in self.kinds for step in ACTIONS[kind].steps)


PICK_PLACE = Vocabulary(("pick_place",))
ARM = Vocabulary(("move_to", "gripper", "rotate_gripper", "trajectory", "home"))
VOCABULARIES: dict[str, Vocabulary] = {"pick_place": PICK_PLACE, "push": Vocabulary(("push",)), "arm": ARM}


def _finite(value: float, name: str) -> None:
    if not np.isfinite(value):
        raise ValueError(f"{name}: must be finite, got {value}")


__all__ = [
    "ACTIONS", "ARM", "Action", "At", "Beside", "CloseStep", "EndEffectorDelta", "FollowStep", "GRIPPER_STATES",
    "Gripper", "Height", "Home", "HomeStep", "MoveStep", "MoveTo", "Navigate", "NavigateStep", "OpenStep",
    "OriginOf", "PICK_PLACE", "PickPlace", "PickPlaceStep", "Place", "Push", "PushStep", "RotateGripper",
    "RotateGripperStep", "SIDES", "STEPS", "Side", "Step", "StepWords", "Trajectory", "VOCABULARIES",
    "Vocabulary", "places_of", "steps_for",
]  # fmt: skip
