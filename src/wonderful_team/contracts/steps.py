"""Steps as models write them: target ids and stated quantities, never coordinates."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import fields
from functools import cache, reduce
from operator import or_
from typing import Annotated, Any, ClassVar, Literal, Union, cast, get_args, get_type_hints

from pydantic import Field, create_model
from pydantic.json_schema import SkipJsonSchema

from wonderful_team.contracts.shown import AnswerModel, Reasoning, fits, known
from wonderful_team.core import actions
from wonderful_team.core.actions import Beside, OriginOf, Place, Side, Step
from wonderful_team.core.later import LATER, is_later


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


class SpotDraft(PlaceDraft):
    """Where something goes."""

    # What no outline is known of has no side to lie beside. Models are not offered it; who answers so all the same ends with the steps.
    how: Literal["at", "origin"] | SkipJsonSchema[Literal["beside"]] = Field(
        description="at: its chosen point; origin: where it stood at the start."
    )
    side: SkipJsonSchema[Side | None] = None


class StepDraft(AnswerModel):
    """A step of one kind; the concrete types have the fields of that kind's step."""

    told: ClassVar[bool] = True
    subgoal: str = Field(description="Id of the subgoal this step serves.")
    kind: str

    def to_step(self) -> Step:
        step: Any = actions.STEPS[self.kind]
        given = {item.name: getattr(self, item.name) for item in fields(step)}
        return cast(
            Step,
            step(
                **{name: value.to_place() if isinstance(value, PlaceDraft) else value for name, value in given.items()}
            ),
        )


def _draft_of(step: type[Step], place: type[PlaceDraft]) -> type[StepDraft]:
    """How a model writes a kind of step: its first line, its fields with their metadata, none of them left out."""
    hints = get_type_hints(step)
    given: dict[str, Any] = {
        item.name: (place if hints[item.name] == Place else _hint_of(item, hints[item.name]), _field_of(item))
        for item in fields(step)
        if item.name != "subgoal"
    }
    given["kind"] = (Literal[step.kind], ...)
    name, words = f"{step.__name__.removesuffix('Step')}Draft", (step.__doc__ or "").partition("\n")[0]
    return create_model(name, __base__=StepDraft, __doc__=words, **given)


def _hint_of(item: dataclasses.Field[Any], hint: Any) -> Any:
    """The type of a field as a model is asked for it: one that came later has no null, which stands for "not said then"."""
    if not is_later(item) or item.default is not None:
        return hint
    solid: tuple[Any, ...] = tuple(kind for kind in get_args(hint) if kind is not type(None))
    hidden: Any = Annotated[None, cast(Any, SkipJsonSchema)()]
    return reduce(or_, (*solid, hidden))


def _field_of(item: dataclasses.Field[Any]) -> Any:
    """A field with its metadata; a later one keeps its default, for answers that were given before it was there."""
    told = {key: value for key, value in item.metadata.items() if key != LATER}
    return Field(**{"default": item.default, **told} if is_later(item) else told)


class StepList(AnswerModel):
    """Steps in order of execution; the concrete type allows only what the world can run."""

    reasoning: str = Reasoning
    steps: list[Any]

    def to_steps(self) -> tuple[Step, ...]:
        return tuple(step.to_step() for step in self.steps)


@cache
def step_list_type(step_kinds: tuple[str, ...], outlines: bool = True) -> type[StepList]:
    """The answer type for a vocabulary: a StepList whose steps may be of these kinds only.

    Args:
        step_kinds: What the robot can do.
        outlines: Of targets more is known than points, so that steps can put things beside them.
    """
    place = PlaceDraft if outlines else SpotDraft
    drafts = [_draft_of(actions.STEPS[kind], place) for kind in step_kinds]
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
