"""What outsiders implement: models, worlds, methods, detectors. Plain protocols: nothing to inherit from."""

from __future__ import annotations

import inspect
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias, TypeGuard, TypeVar, cast, runtime_checkable

from wonderful_team.core.actions import Action, Vocabulary
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Picture
from wonderful_team.core.renamed import renamed_arguments, renamed_attribute
from wonderful_team.core.values import (
    Answer,
    Detection,
    GateReport,
    GroundTruthView,
    Instruction,
    Limits,
    Observation,
    Plan,
    PlannedAction,
    Request,
    StepReport,
    SubgoalRun,
    TrueThing,
    Verdict,
)

T = TypeVar("T")


def offers(thing: object, protocol: Callable[..., T]) -> TypeGuard[T]:
    """Whether a thing has what a protocol asks for, forwarded by `__getattr__` or not.

    From Python 3.12 on, isinstance with a protocol does not see what a wrapper forwards, so the protocols of what is
    optional are not made for it.
    """
    members = {
        name: vars(home).get(name)
        for home in inspect.getmro(cast(type, protocol))
        for name in (*inspect.get_annotations(home), *vars(home))
        if not name.startswith("_")
    }
    # What has a value in the protocol itself may be left out: that value then holds.
    return all(
        callable(getattr(thing, name, None)) if inspect.isfunction(member) else hasattr(thing, name)
        for name, member in members.items()
        if member is None or callable(member) or isinstance(member, property)
    )


@runtime_checkable
class Model(Protocol):
    """Anything that answers requests. May return an Answer, a value of `request.output`, a dict, or JSON text;
    may be a plain or an async function.
    """

    def answer(self, request: Request) -> Any | Awaitable[Any]: ...


@runtime_checkable
class Detector(Protocol):
    """Anything that finds things in a picture by words: an open-vocabulary detector, or eyes of one's own.

    `detect` may be plain or async. What it is asked for may be there once, several times or not at all: it returns one
    Detection for each thing it found, in any order, and none for what is not there.

    Attributes:
        name: For records and pages.
    """

    name: str

    def detect(self, rgb: Array, words: Sequence[str]) -> Sequence[Detection] | Awaitable[Sequence[Detection]]:
        """What of these is in a picture.

        Args:
            rgb: Shape (H, W, 3), uint8, row 0 at the top, read-only.
            words: One description of a thing each, such as "red block".
        """
        ...


class Classifier(Protocol):
    """Says how like a description, or a picture of one thing, each of some regions of a picture is: what CLIP is used for."""

    name: str

    def similar(self, rgb: Array, masks: Sequence[Array], query: str | Picture) -> Sequence[float]:
        """A likeness of each region, 0 to 1.

        Args:
            rgb: Shape (H, W, 3), uint8.
            masks: The regions, shape (H, W) each, bool.
            query: Words, or a picture.
        """
        ...


@runtime_checkable
class World(Protocol):
    """A robot or a simulator with one task set up in it.

    Attributes:
        facts: What planners are told of the robot and its place in plain words, one fact a line: the tool and what it can
            hold, how wide a blade is, the reach, where the cameras look from, which way is north, what a turn without a
            direction means, whether things are lifted over others. May be left out; "" says nothing. Read it with `facts_of`.
    """

    vocabulary: Vocabulary
    limits: Limits
    instruction: Instruction
    facts: str = ""

    def observe(self) -> Observation: ...

    def execute(self, action: Action) -> StepReport: ...

    def stop(self) -> None: ...

    def close(self) -> None: ...


class Filmed(Protocol):
    """A world that can show its motion while an action runs: for people's films only, never for a planner."""

    def film(self, each: Callable[[Mapping[str, Array]], None] | None, every_s: float = 0.1) -> None:
        """Hand pictures by camera name, shape (H, W, 3), uint8, to `each`; None stops it."""
        ...


@dataclass(frozen=True)
class Score:
    """A scorer's word: success, failure, or None when it could not judge."""

    success: bool | None
    stage: str | None = None
    reason: str = ""


class Privileged(Protocol):
    """Truth of a simulator. Handed by the registry to scorers and simulated models only, never to a planner."""

    def score(self) -> Score: ...

    def truth(self) -> Mapping[str, Any]:
        """True state for scorers, simulated models and the stage of a failure."""
        ...

    def oracle(self) -> Sequence[Action]:
        """Actions that solve the scene from here."""
        ...


class SceneTruth(Privileged, Protocol):
    """Truth that a simulated model can answer from: what stands where, and what each picture really shows."""

    def things(self) -> Mapping[str, TrueThing]:
        """Everything on the table as it stands now, by name."""
        ...

    def start(self) -> Mapping[str, TrueThing]:
        """The same, as it stood when the world was made: where a thing is restored to."""
        ...

    def observation_log(self, view_id: str) -> Sequence[GroundTruthView]:
        """What really was in every look at a view so far, newest first; one for an instruction's picture; () for an unknown id."""
        ...


class SubgoalTruth(Protocol):
    """Truth that also says how far a trial came, whether or not it succeeded."""

    def subgoals_reached(self) -> int:
        """How many goals held after some action that did not hold at the start."""
        ...


@dataclass(frozen=True, eq=False)
class Situation:
    """What a method is told each time it is asked what to do.

    Attributes:
        attempt: 0 for the first plan, then one more each time that the method is asked to go on.
        replans_left: How many replans may still be made, one in answer to this question included.
        executed: What ran since the last question, subgoal by subgoal.
        reobserve_left: How often the method may still run a part of its plan and be asked again with a new picture.
        refused: The gate's report when the last answer was refused.
        plan: A plan that was read and approved beforehand and must be run as it is.
        advice: Why a person declined the last plan; one new plan may heed it, and that is no replan.
        facts: What the world says of the robot and its place, in words.
        doubts: After a subgoal, while others are still to run: what a comparison of the pictures shows, or the robot reports, that
            the plan does not expect; one line each, () where all is as expected.
    """

    observation: Observation
    instruction: Instruction
    vocabulary: Vocabulary
    limits: Limits
    attempt: int = 0
    replans_left: int = 0
    executed: tuple[SubgoalRun, ...] = ()
    refused: GateReport | None = None
    plan: Plan | None = None
    reobserve_left: int = 0

    looks_left = renamed_attribute("looks_left", "reobserve_left")
    advice: str = ""
    facts: str = ""
    doubts: tuple[str, ...] = ()


@renamed_arguments(look="reobserve")
@dataclass(frozen=True, eq=False)
class Act:
    """Run these actions. `plan` lets the gate check hash, picture and approval, and the page tell the story.

    `reobserve`: they are only the first of what is to be done; the method asks to be shown a new picture after them. That uses
    one of the new pictures that the situation grants, not a replan; without any left it is a last attempt like any other.
    """

    actions: tuple[PlannedAction, ...]
    plan: Plan | None = None
    verdicts: tuple[Verdict, ...] = ()
    reobserve: bool = False

    look = renamed_attribute("look", "reobserve")


@dataclass(frozen=True)
class Done:
    """The method believes the instruction is fulfilled."""

    reason: str = ""
    verdicts: tuple[Verdict, ...] = ()


@dataclass(frozen=True)
class GaveUp:
    """The method stops without success, with the stage at which it failed.

    Attributes:
        again: A new look may mend it, as where something was not found. While replans are left it is then asked for another plan, which is a
            replan: with a new picture, and neither `executed` nor `refused`.
    """

    reason: str
    stage: str
    plan: Plan | None = None
    verdicts: tuple[Verdict, ...] = ()
    again: bool = False


Decision: TypeAlias = Act | Done | GaveUp
JUDGE, CHECK = "judge", "check"
"""Names of the events that tell verdicts: of a whole attempt, with a decision; of the subgoal that ran last."""


@dataclass(frozen=True)
class Checked:
    """What a method says of the subgoal that ran last, while others of its plan are still to run.

    Attributes:
        verdicts: On that subgoal; () where nobody judged it.
        stop: Why the rest of the plan must not run any more; "" to go on. The method is asked for a new plan then, which is a replan.
    """

    verdicts: tuple[Verdict, ...] = ()
    stop: str = ""


@runtime_checkable
class Policy(Protocol):
    """A method: observation and instruction to actions. The Team is one; rivals and learned policies are others.

    `decide` may be plain or async.
    """

    name: str

    def decide(self, situation: Situation) -> Decision | Awaitable[Decision]: ...


class ChecksSubgoals(Protocol):
    """A method that is asked after each subgoal of its plan but the last, for as long as it may still plan anew. May be left out.

    `check` may be plain or async.
    """

    checks_subgoals: bool

    def check(self, situation: Situation) -> Checked | Awaitable[Checked]:
        """Whether the rest of the plan still makes sense: `situation.executed` ends with the subgoal that ran last."""
        ...


class Subscriber(Protocol):
    """Told of everything that happens, in order; the recorder and the progress line are two."""

    def on_event(self, event: Event) -> None: ...


@dataclass(frozen=True, eq=False)
class Event:
    """Something that happened.

    Attributes:
        kind: request | sent | drawn | answer | invalid | stage | decision | observe | gate | execute | verdict | warning |
            crash | done. `sent` brings the files of a request's pictures as they go out; `drawn` says with which ticks
            the pictures of a request are drawn that no file goes out for.
        name: Which one, such as the request's id or the stage's name.
        content: The value itself (a Request, an Answer, a Plan, a GateReport, …) or a small mapping.
    """

    kind: str
    name: str
    content: Any = None


def facts_of(world: World) -> str:
    """A world's facts; "" where it says none."""
    return getattr(world, "facts", World.facts)


def privileged(world: World) -> Privileged | None:
    """The truth behind a simulator, for its scorer; None for real robots, own worlds without one, and changed instructions."""
    truth = getattr(world, "privileged", None)
    return truth if offers(truth, Privileged) else None


__all__ = [
    "Act",
    "Answer",
    "Checked",
    "ChecksSubgoals",
    "Classifier",
    "Decision",
    "Detection",
    "Detector",
    "Done",
    "Event",
    "GaveUp",
    "Model",
    "Policy",
    "Privileged",
    "SceneTruth",
    "Score",
    "Situation",
    "Subscriber",
    "World",
    "facts_of",
]
