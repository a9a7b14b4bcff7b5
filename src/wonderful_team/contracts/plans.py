"""Pieces of a plan as models write them, and their way into the frozen types."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import fields
from typing import Any, Literal, TypeVar

from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from wonderful_team.contracts.shown import AnswerModel, Reasoning, ShownSlot, Unsure, fits, known, unique
from wonderful_team.contracts.steps import PlaceDraft
from wonderful_team.core.steps import PickPlaceStep
from wonderful_team.core.values import Alike, PointRole, Subgoal, Target


class TargetDraft(AnswerModel):
    """Something the plan needs to find in the main view."""

    id: str = Field(description="T1, T2, ... in order of use.")
    kind: Literal["object", "area"] = Field(description="object: has an outline; area: free space or a region.")
    words: str = Field(description="What it is, so that somebody who sees only the picture finds it.", min_length=1)
    part: str | None = Field(description="The part that matters, such as the handle; null for the whole.")
    where: str = Field(description="How it stands to other things; empty when the words suffice.")
    like: list[str] = Field(description="Names of the instruction's pictures that show it; empty for none.")
    alike: Alike = Field("both", description="What it has in common with these pictures; both when there are none.")
    use: list[PointRole] = Field(description="What its points are for.")

    def to_target(self) -> Target:
        source: Literal["scene", "slot"] = "slot" if self.like else "scene"
        return Target(
            self.id,
            self.kind,
            self.words,
            self.part,
            self.where,
            source,
            tuple(self.like),
            tuple(dict.fromkeys(self.use)),
            self.alike,
        )


_TURN: dict[str, Any] = dict(next(item.metadata for item in fields(PickPlaceStep) if item.name == "rotate_deg"))
"""A turn is limited and described here as in the steps that models write."""


class MoveDraft(AnswerModel):
    """One pick and one place that carry out a whole subgoal."""

    pick: str = Field(description="Id of the target that is picked up.")
    place: PlaceDraft
    rotate_deg: float = Field(**_TURN)

    def to_step(self, subgoal: str) -> PickPlaceStep:
        """The step that says the same. Raises ValueError for a place beside a target without a side."""
        return PickPlaceStep(subgoal, self.pick, self.place.to_place(), self.rotate_deg)


class GoalDraft(AnswerModel):
    """One qualitative goal: no coordinates."""

    id: str = Field(description="G1, G2, ... in order of execution.")
    text: str = Field(min_length=1)
    after: list[str] = Field(description="Ids of subgoals that must be reached first.")
    targets: list[str] = Field(description="Ids of the targets it needs.")

    def to_subgoal(self) -> Subgoal:
        return Subgoal(self.id, self.text, tuple(self.after), tuple(self.targets))


class SubgoalDraft(GoalDraft):
    """One qualitative goal, and how it is carried out where that is simple."""

    targets: list[str] = Field(description="Ids of the targets it needs; empty when targets are extracted later.")
    function: str | None = Field(description="What a helper function should compute (a path), or null.")
    move: MoveDraft | None = Field(
        None, description="The one pick and place that carries it out; null where it takes more."
    )

    def to_subgoal(self) -> Subgoal:
        return Subgoal(self.id, self.text, tuple(self.after), tuple(self.targets), self.function)


class ClarificationDraft(AnswerModel):
    """Asked only when neither picture nor instruction settles what is meant."""

    question: str = Field(min_length=1)
    choices: list[str]


class PlanDraft(AnswerModel):
    """A plan as the Supervisor writes it."""

    reasoning: str = Reasoning
    subgoals: list[SubgoalDraft] = Field(description="Empty only when the instruction is already fulfilled.")
    targets: list[TargetDraft]
    mode: Literal["full", "one_step"] = Field(
        description="How it should be checked. full: subgoal after subgoal; one_step: the whole plan at once."
    )
    clarification: ClarificationDraft | None
    unsure: str = Unsure

    def to_subgoals(self) -> tuple[Subgoal, ...]:
        return tuple(draft.to_subgoal() for draft in self.subgoals)

    def to_targets(self) -> tuple[Target, ...]:
        return tuple(draft.to_target() for draft in self.targets)

    def to_moves(self) -> tuple[PickPlaceStep, ...]:
        """The picks and places that the subgoals state, in order."""
        return tuple(draft.move.to_step(draft.id) for draft in self.subgoals if draft.move is not None)


class GoalWithoutTargets(SubgoalDraft):
    """A subgoal whose targets are listed later."""

    targets: SkipJsonSchema[list[str]] = Field(default_factory=list)
    move: SkipJsonSchema[MoveDraft | None] = None


class PlanWithoutTargets(PlanDraft):
    """A plan whose targets are listed later."""

    subgoals: list[GoalWithoutTargets] = Field(description="Empty only when the instruction is already fulfilled.")  # type: ignore[assignment]
    targets: SkipJsonSchema[list[TargetDraft]] = Field(default_factory=list)


class PlainPlan(AnswerModel):
    """Subgoals, and the targets that they need."""

    reasoning: str = Reasoning
    subgoals: list[GoalDraft] = Field(description="Empty only when the instruction is already fulfilled.")
    targets: list[TargetDraft]

    def to_subgoals(self) -> tuple[Subgoal, ...]:
        return tuple(draft.to_subgoal() for draft in self.subgoals)

    def to_targets(self) -> tuple[Target, ...]:
        return tuple(draft.to_target() for draft in self.targets)


Draft = TypeVar("Draft", PlanDraft, PlainPlan)


def check_subgoals(subgoals: Sequence[GoalDraft], target_ids: Sequence[str] | None) -> None:
    """Raise ValueError when ids repeat, refer to nothing, or order themselves in a circle."""
    ids = [draft.id for draft in subgoals]
    unique(ids, "subgoal ids")
    for position, draft in enumerate(subgoals):
        known(draft.after, ids, f"subgoal in 'after' of {draft.id}")
        late = [name for name in draft.after if ids.index(name) >= position]
        if late:
            raise ValueError(f"subgoal {draft.id} stands before {', '.join(late)}, which it says must come first")
        if target_ids is not None:
            known(draft.targets, target_ids, f"target of subgoal {draft.id}")
        move = draft.move if isinstance(draft, SubgoalDraft) else None
        if target_ids is not None and move is not None:
            known([move.pick, move.place.target], target_ids, f"target in the move of {draft.id}")
            move.to_step(draft.id)


def settle_targets(
    targets: Sequence[TargetDraft], slots: Sequence[ShownSlot]
) -> tuple[list[TargetDraft], tuple[str, ...]]:
    """Bring the names of pictures into one form; give areas the scenes that define them, and objects none.

    A name may be written in braces or as a caption has it. A whole scene shows where things are, never what one thing
    looks like.

    Returns:
        The targets, and what was changed, in words.

    Raises:
        ValueError: Ids repeat, or a picture is named that the instruction does not have.
    """
    unique([draft.id for draft in targets], "target ids")
    settled, repairs = [], []
    for draft in targets:
        names = list(dict.fromkeys(_slot_name(name, slots) for name in draft.like))
        known(names, [slot.name for slot in slots], f"picture in 'like' of {draft.id}")
        scenes = [slot.name for slot in slots if slot.whole_scene]
        if draft.kind == "object" and set(names) & set(scenes):
            lost = [name for name in names if name in scenes]
            names = [name for name in names if name not in scenes]
            repairs.append(f"'like' of {draft.id}: {', '.join(lost)} dropped, a whole scene describes no object")
        if draft.kind == "area":
            names += [name for name in scenes if name not in names and _speaks_of(draft, name)]
        settled.append(draft.model_copy(update={"like": names}))
    return settled, tuple(repairs)


def _slot_name(written: str, slots: Iterable[ShownSlot]) -> str:
    """The slot that `name`, `{name}` or a caption such as `{name} top` stands for; else what was written."""
    text = written.strip().strip("'\"")
    inside = re.search(r"\{([^{}]*)\}", text)
    text = inside.group(1).strip() if inside else text
    names = sorted((slot.name for slot in slots), key=len, reverse=True)
    return next((name for name in names if text == name or text.startswith(f"{name} ")), text)


def _speaks_of(draft: TargetDraft, name: str) -> bool:
    return re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", f"{draft.words} {draft.where}") is not None


def settle_plan(draft: Draft, slots: Sequence[ShownSlot], with_targets: bool) -> tuple[Draft, tuple[str, ...]]:
    """A draft with its targets settled, and what was changed, in words.

    Raises:
        ValueError: The draft does not hang together.
    """
    if isinstance(draft, PlanDraft) and draft.clarification is not None:
        return draft, ()
    fits(subgoals=len(draft.subgoals), targets=len(draft.targets))
    targets, repairs = settle_targets(draft.targets, slots)
    check_subgoals(draft.subgoals, [target.id for target in targets] if with_targets else None)
    if with_targets:
        for subgoal in draft.subgoals:
            if not subgoal.targets:
                raise ValueError(f"subgoal {subgoal.id} names no target")
    return draft.model_copy(update={"targets": targets}), repairs
