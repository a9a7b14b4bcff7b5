"""What rivals that look with a detector share: looks by name, a model's program over host functions, and the tool's path as steps.

Nothing of a program runs in this process, and nothing it asks for moves anything: its motions become steps of a plan, which passes
the same gate as every other plan.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from wonderful_team.agents.common import PLAIN_GREY
from wonderful_team.agents.rendering import ability_parts, fenced, listed, words
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import JudgeFromBoxes, WriteProgram
from wonderful_team.core.actions import (
    At,
    CloseStep,
    MoveStep,
    OpenStep,
    PickPlaceStep,
    PushStep,
    RotateGripperStep,
    Step,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.core.protocols import Detector
from wonderful_team.core.steps import Height
from wonderful_team.core.values import Detection, GroundedTarget, Part, PointRole, Provenance, Subgoal, Target, View
from wonderful_team.core.values.plan_size import size_problem
from wonderful_team.detectors import found_words, look, name_of
from wonderful_team.errors import NotUnderstoodError, PlanError
from wonderful_team.models.client import ModelClient
from wonderful_team.planning.baselines.open_loop import pointed
from wonderful_team.sandbox import HostCall, ProgramRun, run_program


@dataclass
class Looks:
    """A detector's looks at one view, each name once; told to subscribers.

    Attributes:
        view: What it looks at.
        found: By name, in the order in which they were asked for.
    """

    detector: Detector
    client: ModelClient
    view: View
    attempt: int
    found: dict[str, tuple[Detection, ...]] = field(default_factory=dict)

    async def at(self, name: str) -> tuple[Detection, ...]:
        """What is found of a name, the surest first; boxes in pixels of the view.

        Raises:
            NotUnderstoodError: The detector refuses these words.
        """
        if name not in self.found:
            self.found[name] = await look(self.detector, self.view, [name], self.client.budget, self.client.tell)
            said = f"{name_of(self.detector)}: {found_words(self.found[name], [name])}"
            self.client.tell("stage", "detected", {"text": said, "attempt": self.attempt})
        return self.found[name]

    def around(self, point: Point) -> Detection | None:
        """What was found round a point of the view: the smallest box; None where there is none."""
        inside = [one for several in self.found.values() for one in several if one.box.contains(point)]
        return min(inside, key=lambda one: one.box.area, default=None)


@dataclass(frozen=True)
class HostFunction:
    """A function that a model's program may call.

    Attributes:
        parameters: As in a `def`.
        words: What it does, for the program's author.
        answer: Gives a plain JSON value, or raises a ValueError whose text the program gets; None for what is only kept.
    """

    parameters: str
    words: str
    answer: Callable[..., Awaitable[Any]] | None = None


async def run_with(code: str, functions: Mapping[str, HostFunction]) -> ProgramRun:
    """Run a program in the sandbox, its calls answered as they come.

    Raises:
        SandboxError: Anything that went wrong with it; the text is for its author.
    """
    parameters = {name: one.parameters for name, one in functions.items()}
    unanswered = frozenset(name for name, one in functions.items() if one.answer is None)
    answers: list[Mapping[str, Any]] = []
    while True:
        run = await asyncio.to_thread(run_program, code, parameters, tuple(answers), unanswered=unanswered)
        if not run.waits:
            return run
        answers.append(await _answered(functions, run.calls[-1]))


async def _answered(functions: Mapping[str, HostFunction], call: HostCall) -> Mapping[str, Any]:
    answer = functions[call.function].answer
    assert answer is not None, "only a call that needs an answer is waited for"
    try:
        return {"value": await answer(*call.arguments)}
    except (ValueError, NotUnderstoodError) as error:
        return {"error": str(error)}


@dataclass(frozen=True)
class Waypoint:
    """Where the tool goes.

    Attributes:
        point: In pixels of the view.
        height: at: down to what lies there; above, clear: over it.
        clockwise_deg: How far the tool is turned from its pose at the start.
    """

    point: Point
    height: Height
    clockwise_deg: float = 0.0


ToolMotion: TypeAlias = Waypoint | Literal["open", "close"]
SAME_PX = 2.0
"""Nearer than this two points are the same place [px of the view]."""


@dataclass
class ToolPath:
    """A path of the tool, written as steps that this robot can run.

    Attributes:
        kinds: What the robot can do. One that picks and places does so from where the gripper closes to where it opens; one
            that pushes does so along every stretch on the surface; an arm goes through all points.
        around: What was found round a point of the view, None where nobody knows.
        how: Where the points come from, for their story.
    """

    shown: Picture
    kinds: Sequence[str]
    around: Callable[[Point], Detection | None]
    how: str
    provenance: Provenance
    subgoals: list[Subgoal] = field(default_factory=list)
    grounded: dict[str, GroundedTarget] = field(default_factory=dict)
    steps: list[Step] = field(default_factory=list)
    _lies: list[tuple[Point, str]] = field(default_factory=list)
    _turned_deg: float = 0.0

    def write(self, motions: Sequence[ToolMotion], said: str = "") -> None:
        """Add the steps of these motions; `said` is what they are for, where that is known.

        Raises:
            PlanError: They do nothing that this robot can do, end with something held, or are too many.
        """
        if "pick_place" in self.kinds or "push" in self.kinds:
            self._primitives(motions, said)
        else:
            self._arm(motions, said)
        problem = size_problem(subgoals=len(self.subgoals), targets=len(self.grounded), actions=len(self.steps))
        if problem:
            raise PlanError(f"the plan has {problem}")

    def _primitives(self, motions: Sequence[ToolMotion], said: str) -> None:
        before = len(self.steps)
        at: Waypoint | None = None
        held: Waypoint | None = None
        for motion in motions:
            if isinstance(motion, Waypoint):
                low = at is not None and at.height == motion.height == "at"
                if low and held is None and "push" in self.kinds and at is not None and _apart(at, motion):
                    self._push(at.point, motion.point, said)
                at = motion
            elif motion == "close":
                # A gripper that closes in the air holds nothing, and one that only pushes never does.
                grips = "pick_place" in self.kinds and at is not None and at.height == "at"
                held = held or (at if grips else None)
            elif held is not None and at is not None:
                self._carry(held, at, said)
                held = None
        if held is not None:
            raise PlanError("the gripper closes on something and never opens again")
        if motions and len(self.steps) == before:
            does = (
                "close the gripper on a thing, and open it elsewhere"
                if "pick_place" in self.kinds
                else "touch the surface"
            )
            raise PlanError(f"the motions never {does}, which is all that this robot can do ({', '.join(self.kinds)})")

    def _carry(self, held: Waypoint, end: Waypoint, said: str) -> None:
        turn = _turn_deg(end.clockwise_deg - held.clockwise_deg)
        thing = self._thing(held.point, "pick")
        place = self._place(end.point)
        said = said or f"the {self._words(thing)} lies at the {self._words(place)}" + (
            f", turned {turn:g} degrees" if turn else ""
        )
        goal = self._goal(said, thing, place)
        self.steps.append(PickPlaceStep(goal, thing, At(place), turn))
        self._lies.append((end.point, thing))

    def _push(self, start: Point, end: Point, said: str) -> None:
        one, other = self._target(start, "push_start"), self._target(end, "push_end")
        said = said or f"the tool has pushed from the {self._words(one)} to the {self._words(other)}"
        goal = self._goal(said, one, other)
        self.steps.append(PushStep(goal, At(one), At(other)))

    def _arm(self, motions: Sequence[ToolMotion], said: str) -> None:
        goal, turned = self._goal(said or "the tool has followed its path"), self._turned_deg
        for number, motion in enumerate(motions):
            if motion == "close":
                self.steps.append(CloseStep(goal))
            elif motion == "open":
                self.steps.append(OpenStep(goal))
            else:
                turn = _turn_deg(motion.clockwise_deg - turned)
                if turn:
                    self.steps.append(RotateGripperStep(goal, turn))
                self._turned_deg = turned = motion.clockwise_deg
                grips = motion.height == "at" and motions[number + 1 : number + 2] == ["close"]
                target = self._thing(motion.point, "grasp") if grips else self._target(motion.point, "place")
                self.steps.append(MoveStep(goal, At(target), motion.height))

    def _thing(self, point: Point, role: PointRole) -> str:
        """The target at a point: one that was put there before, else a new one."""
        for place, name in reversed(self._lies):
            if math.dist(place, point) <= SAME_PX:
                return name
        found = self.around(point)
        # Its outline tells what it stands on. The tool goes where the path says, so only where it holds the thing in the middle.
        held_in_the_middle = found is not None and math.dist(found.box.centre, point) <= SAME_PX
        return self._target(point, role, found.box if found is not None and held_in_the_middle else None)

    def _place(self, point: Point) -> str:
        """Where something is put: the target of what was put on the same thing before, so that it comes to lie on that."""
        for name, one in self.grounded.items():
            there = one.points.get("place")
            if one.target.kind == "object" and there is not None and math.dist(there, point) <= SAME_PX:
                return name
        return self._target(point, "place")

    def _target(self, point: Point, role: PointRole, box: Box | None = None) -> str:
        found, name = self.around(point), f"T{len(self.grounded) + 1}"
        kind: Literal["object", "area"] = "area" if found is None else "object"
        words = f"spot at ({point[0]:.0f}, {point[1]:.0f}) px" if found is None else found.words
        target, frame = Target(name, kind, words, use=(role,)), self.shown.frame
        shown: dict[str, Point] = {role: frame.point_to_picture(point)}
        outline = None if box is None else frame.box_to_picture(box)
        self.grounded[name] = pointed(target, shown, self.shown, self.how, self.provenance, outline)
        return name

    def _words(self, name: str) -> str:
        return self.grounded[name].target.words

    def _goal(self, text: str, *targets: str) -> str:
        before = (self.subgoals[-1].id,) if self.subgoals else ()
        self.subgoals.append(Subgoal(f"G{len(self.subgoals) + 1}", text, before, targets))
        return self.subgoals[-1].id


def _apart(one: Waypoint, other: Waypoint) -> bool:
    return math.dist(one.point, other.point) > SAME_PX


def _turn_deg(degrees: float) -> float:
    """The same turn, more than -180 and at most 180."""
    turn = -((-degrees + 180.0) % 360.0 - 180.0)
    return round(turn, 3) + 0.0


def finite(value: Any, what: str) -> float:
    """A number that a program gave.

    Raises:
        ValueError: It gave something else.
    """
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{what} must be a number, it is {_short(value)}")
    return float(value)


def point_in(value: Any, picture: Picture, what: str) -> Point:
    """A point that a program gave in pixels of a picture, in pixels of its view.

    Raises:
        ValueError: It is none, or lies outside the picture.
    """
    if not isinstance(value, list) or len(value) != 2:  # noqa: PLR2004  x and y
        raise ValueError(f"{what} must be (x, y), it is {_short(value)}")
    x, y = (finite(part, f"{axis} of {what}") for axis, part in zip("xy", value, strict=True))
    width, height = picture.size_px
    if not (0 <= x <= width and 0 <= y <= height):
        raise ValueError(
            f"{what} is ({x:.0f}, {y:.0f}), outside of the view, which spans x 0 to {width} and y 0 to {height}"
        )
    return picture.frame.point_to_view((x, y))


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."  # noqa: PLR2004  enough to be recognised


def task_words(question: WriteProgram | JudgeFromBoxes) -> list[Part]:
    """The instruction and the unit of positions, for a model that sees no picture."""
    width, height = question.size_px
    return [
        *words("The user's instruction:", fenced("instruction", question.instruction)),
        *listed("What its names in braces stand for", [f"{{{one.slot}}}: {one.words}" for one in question.slot_words]),
        *(words(PLAIN_GREY) if question.slot_words else []),
        *words(
            f'Positions are pixels of "{question.picture}", {width} wide and {height} high, from its top-left corner: x grows to the '
            "right, y grows downwards."
        ),
    ]


def render_program(question: WriteProgram) -> list[Part]:
    """All of a question for a program, for every method that asks for one."""
    rounds = [
        part
        for number, one in enumerate(question.rounds, start=1)
        for part in words(
            f"Your program {number}:", fenced("program", one.code), "What came of it:", fenced("output", one.said)
        )
    ]
    return [
        *task_words(question),
        *listed("Functions that a program can call", [f"{one.signature}: {one.words}" for one in question.functions]),
        *ability_parts(question.step_kinds),
        *listed("What is known of the robot and its place", question.facts),
        *(words("An example, of another table:", question.example) if question.example else []),
        *listed("What went wrong before, to be avoided now", question.advice),
        *rounds,
    ]


def kinds_of(scene: SceneShown) -> tuple[str, ...]:
    """What the robot can do, but for paths of helper functions, which only the team writes."""
    return tuple(kind for kind in scene.vocabulary.step_kinds if kind != "follow")
