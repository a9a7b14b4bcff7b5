"""Steps: what a planner writes, target ids and stated quantities. A kind of step brings its words with it.

A step never holds a coordinate; `motion` turns it into actions. Angles stated to or by people are degrees, clockwise
seen from above.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal, TypeAlias, get_args

from wonderful_team.core.later import later

Side: TypeAlias = Literal["left", "right", "above", "below"]
"""A side of an object as the picture shows it: above is towards the picture's top edge."""
Height: TypeAlias = Literal["above", "at", "clear"]
Contact: TypeAlias = Literal["surface", "air"]
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
class StepWords:
    """A kind of step in words; {field} stands for a field, {turned} and {at} for what goes before or behind one.

    Attributes:
        does: What a planner is told that the robot can do.
        told: A step of that kind as a model reads it.
        shown: As a page shows it; the same when left out.
        line: Its beginning in a terminal; the kind when left out.
        planned: What a plan for it has to say, for whoever writes one; nothing more when left out.
        written: How such a step is written, beyond what its fields say; likewise.
    """

    does: str
    told: str
    shown: str = ""
    line: str = "{kind}"
    planned: str = ""
    written: str = ""


@dataclass(frozen=True)
class _Step:
    """What every kind of step has. Its first line and the metadata of its fields are what a model reads of its schema.

    Attributes:
        roles: Which point of a grounded target each field stands for, as (role, field).
        points: Without a point of the picture it means nothing.
    """

    kind: ClassVar[str]
    words: ClassVar[StepWords]
    roles: ClassVar[tuple[tuple[str, str], ...]] = ()
    points: ClassVar[bool] = True
    subgoal: str


_TURN = {"ge": -360, "le": 360}
"""Limits of a turn [degrees]."""


@dataclass(frozen=True)
class PickPlaceStep(_Step):
    """Pick a target up, put it down at a place, turned clockwise."""

    kind: ClassVar[str] = "pick_place"
    words: ClassVar[StepWords] = StepWords(
        "pick one target up, carry it, and put it down at a place, turned by an angle if one is stated",
        told="pick {pick}, put it at {place}{turned}",
        shown="pick {pick}, place {at}{place}{turned}",
    )
    roles: ClassVar[tuple[tuple[str, str], ...]] = (("pick", "pick"), ("place", "place"))
    pick: str
    place: Place
    rotate_deg: float = field(
        default=0.0, metadata={**_TURN, "description": "Clockwise seen from above; 0 when nothing is said."}
    )


@dataclass(frozen=True)
class PushStep(_Step):
    """Push along the table."""

    kind: ClassVar[str] = "push"
    words: ClassVar[StepWords] = StepWords(
        "lower the tool beside a thing, push the thing straight along the surface to a place, and lift the tool there",
        told="push from {start} to {end}",
        planned="A subgoal that pushes says where the thing should end and what it must keep away from. Where friction leaves a thing is not "
        "certain: what a second push of it needs is a guess until there is a new picture, so give it room. A second push needs no start of its "
        "own: code computes it, behind the thing where the first push should leave it.",
        written="start is the thing to be pushed. end is where its middle should arrive; only at a target with a push_end point, it is where the "
        "front of the tool stops.",
    )
    roles: ClassVar[tuple[tuple[str, str], ...]] = (("push_start", "start"), ("push_end", "end"))
    start: Place
    end: Place


@dataclass(frozen=True)
class MoveStep(_Step):
    """Move the tool.

    To a place: above it, at it, or clear of everything.
    """

    kind: ClassVar[str] = "move"
    words: ClassVar[StepWords] = StepWords(
        "move the tool above a place, down to it (at), or up until it is clear of everything",
        told="move the tool {height} {to}",
        shown="move {height} {to}",
        line="move {height}",
    )
    roles: ClassVar[tuple[tuple[str, str], ...]] = (("place", "to"),)
    to: Place
    height: Height = "above"


@dataclass(frozen=True)
class OpenStep(_Step):
    """Open the gripper."""

    kind: ClassVar[str] = "open"
    words: ClassVar[StepWords] = StepWords("open the gripper", told="open the gripper", line="open gripper")
    points: ClassVar[bool] = False


@dataclass(frozen=True)
class CloseStep(_Step):
    """Close the gripper.

    `tight` keeps squeezing.
    """

    kind: ClassVar[str] = "close"
    words: ClassVar[StepWords] = StepWords(
        "close the gripper; tight keeps squeezing",
        told="close the gripper{tight}",
        line="close gripper{tight}",
        written="To carry a thing: open, move above it, move at, close, move clear, then move above the place, move at, open, move clear. What "
        "is screwed on is gripped tightly and turned before it is lifted; without room for the whole turn: open, turn back, grip again.",
    )
    points: ClassVar[bool] = False
    tight: bool = False


@dataclass(frozen=True)
class RotateGripperStep(_Step):
    """Turn the gripper."""

    kind: ClassVar[str] = "rotate_gripper"
    words: ClassVar[StepWords] = StepWords(
        "turn the gripper by an angle, clockwise seen from above", told="turn the gripper {rotate_deg}"
    )
    points: ClassVar[bool] = False
    rotate_deg: float = field(metadata={**_TURN, "description": "Clockwise seen from above."})


@dataclass(frozen=True)
class FollowStep(_Step):
    """Follow the path of the subgoal's helper function.

    Steps of earlier releases do not say whether they touch: they follow at the height at which the tool is.
    """

    kind: ClassVar[str] = "follow"
    words: ClassVar[StepWords] = StepWords(
        "move the tool along the path that a helper function computed: on the surface (it is lowered at the first point and "
        "lifted after the last) or in the air",
        told="follow the path of {function}{contact}",
        line="follow {function}{contact}",
        written="A subgoal with a helper function is carried out with a follow step that names it. contact surface: the tool is lowered to the "
        "surface at the first point and lifted after the last, as for drawing or wiping; air: it stays clear, with what it holds, as for shaking.",
    )
    function: str = field(metadata={"description": "Id of the subgoal that asked for the function."})
    contact: Contact | None = later(
        None,
        description="surface: the tool (or what it holds) touches what lies there, as for drawing or wiping; air: it stays "
        "clear above everything.",
    )


@dataclass(frozen=True)
class HomeStep(_Step):
    """Go to the home pose."""

    kind: ClassVar[str] = "home"
    words: ClassVar[StepWords] = StepWords("go to the home pose", told="go to the home pose", shown="go home")
    points: ClassVar[bool] = False


@dataclass(frozen=True)
class NavigateStep(_Step):
    """Drive to a place."""

    kind: ClassVar[str] = "navigate"
    words: ClassVar[StepWords] = StepWords("drive the mobile base to a place", told="drive to {to}")
    roles: ClassVar[tuple[tuple[str, str], ...]] = (("place", "to"),)
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
STEPS: dict[str, type[Step]] = {step.kind: step for step in get_args(Step)}
"""Every kind of step that a planner may write."""


def places_of(step: Step) -> tuple[tuple[str, Place], ...]:
    """Every place a step refers to, as (role, place); roles name the points of a grounded target."""
    found = ((role, getattr(step, name)) for role, name in step.roles)
    return tuple((role, At(place) if isinstance(place, str) else place) for role, place in found)


def carried_by(steps: Sequence[Step]) -> str | None:
    """The target that the steps of one subgoal carry: what is picked, or where the tool goes before the gripper closes; None for nothing."""
    name: str | None = None
    at: str | None = None
    for step in steps:
        match step:
            case PickPlaceStep():
                return step.pick
            case CloseStep():
                name = at
            case OpenStep() if name is not None:
                return name
            case MoveStep() if name is None:
                at = step.to.target
    return name
