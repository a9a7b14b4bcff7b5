"""Steps as models write them: target ids and stated quantities, never coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Annotated, Any, Literal, TypeAlias, Union

from pydantic import Field, create_model

from wonderful_team.contracts.shown import AnswerModel, Reasoning, fits, known
from wonderful_team.core import actions
from wonderful_team.core.actions import Beside, OriginOf, Place, Side, Step


class PlaceDraft(AnswerModel):
    """Where something goes."""

    target: str = Field(description="Id of a target.")
    how: Literal["at", "beside", "origin"] = Field(
        description="at: its chosen point; beside: next to it, on `side`; origin: where it stood at the start."
    )
    side: Side | None = Field(description="Only for beside: left, right, above (towards the picture's top), below.")

    def to_place(self) -> Place:
        match self.how:
            case "at":
                return actions.At(self.target)
            case "origin":
                return OriginOf(self.target)
            case "beside":
                if self.side is None:
                    raise ValueError("a place beside a target needs a side: left, right, above or below")
                return Beside(self.target, self.side)


class _StepDraft(AnswerModel):
    subgoal: str = Field(description="Id of the subgoal this step serves.")


class PickPlaceDraft(_StepDraft):
    """Pick a target up, put it down at a place, turned clockwise."""

    kind: Literal["pick_place"]
    pick: str
    place: PlaceDraft
    rotate_deg: float = Field(ge=-360, le=360, description="Clockwise seen from above; 0 when nothing is said.")

    def to_step(self) -> Step:
        return actions.PickPlaceStep(self.subgoal, self.pick, self.place.to_place(), self.rotate_deg)


class PushDraft(_StepDraft):
    """Push along the table."""

    kind: Literal["push"]
    start: PlaceDraft
    end: PlaceDraft

    def to_step(self) -> Step:
        return actions.PushStep(self.subgoal, self.start.to_place(), self.end.to_place())


class MoveDraft(_StepDraft):
    """Move the tool."""

    kind: Literal["move"]
    to: PlaceDraft
    height: Literal["above", "at", "clear"]

    def to_step(self) -> Step:
        return actions.MoveStep(self.subgoal, self.to.to_place(), self.height)


class OpenDraft(_StepDraft):
    """Open the gripper."""

    kind: Literal["open"]

    def to_step(self) -> Step:
        return actions.OpenStep(self.subgoal)


class CloseDraft(_StepDraft):
    """Close the gripper."""

    kind: Literal["close"]
    tight: bool

    def to_step(self) -> Step:
        return actions.CloseStep(self.subgoal, self.tight)


class RotateGripperDraft(_StepDraft):
    """Turn the gripper."""

    kind: Literal["rotate_gripper"]
    rotate_deg: float = Field(ge=-360, le=360, description="Clockwise seen from above.")

    def to_step(self) -> Step:
        return actions.RotateGripperStep(self.subgoal, self.rotate_deg)


class FollowDraft(_StepDraft):
    """Follow the path of the subgoal's helper function."""

    kind: Literal["follow"]
    function: str = Field(description="Id of the subgoal that asked for the function.")

    def to_step(self) -> Step:
        return actions.FollowStep(self.subgoal, self.function)


class HomeDraft(_StepDraft):
    """Go to the home pose."""

    kind: Literal["home"]

    def to_step(self) -> Step:
        return actions.HomeStep(self.subgoal)


class NavigateDraft(_StepDraft):
    """Drive to a place."""

    kind: Literal["navigate"]
    to: PlaceDraft

    def to_step(self) -> Step:
        return actions.NavigateStep(self.subgoal, self.to.to_place())


StepDraft: TypeAlias = (
    PickPlaceDraft
    | PushDraft
    | MoveDraft
    | OpenDraft
    | CloseDraft
    | RotateGripperDraft
    | FollowDraft
    | HomeDraft
    | NavigateDraft
)
_DRAFTS: dict[str, type[Any]] = {
    "pick_place": PickPlaceDraft,
    "push": PushDraft,
    "move": MoveDraft,
    "open": OpenDraft,
    "close": CloseDraft,
    "rotate_gripper": RotateGripperDraft,
    "follow": FollowDraft,
    "home": HomeDraft,
    "navigate": NavigateDraft,
}


class StepList(AnswerModel):
    """Steps in order of execution; the concrete type allows only what the world can run."""

    reasoning: str = Reasoning
    steps: list[Any]

    def to_steps(self) -> tuple[Step, ...]:
        return tuple(step.to_step() for step in self.steps)


@cache
def step_list_type(step_kinds: tuple[str, ...]) -> type[StepList]:
    """The answer type for a vocabulary: a StepList whose steps may be of these kinds only."""
    drafts = [_DRAFTS[kind] for kind in step_kinds]
    # typing.Union over a list built at run time has no `|` spelling.
    item: Any = drafts[0] if len(drafts) == 1 else Annotated[Union[tuple(drafts)], Field(discriminator="kind")]  # noqa: UP007
    return create_model("StepList", __base__=StepList, steps=(list[item], ...))


def check_steps(
    steps: Sequence[Step], subgoals: Sequence[str], targets: Sequence[str], functions: Sequence[str]
) -> None:
    """Raise ValueError when a step refers to a subgoal, target or function that does not exist, or serves none."""
    fits(actions=len(steps))
    if subgoals and not steps:
        raise ValueError("the plan has subgoals but no steps")
    known([step.subgoal for step in steps], subgoals, "subgoal")
    for number, step in enumerate(steps, start=1):
        known([place.target for _, place in actions.places_of(step)], targets, f"target in step {number}")
        if isinstance(step, actions.FollowStep):
            known([step.function], functions, f"function in step {number}")
    unserved = [name for name in subgoals if name not in {step.subgoal for step in steps}]
    if unserved:
        raise ValueError(f"no step serves subgoal {', '.join(unserved)}")
