"""From aims to a plan in words, and ExtractTargets."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from wonderful_team.contracts import (
    ClarificationDraft,
    ExtractTargets,
    PlanDraft,
    SubgoalDraft,
    SubgoalTargets,
    TargetDraft,
    TargetList,
)
from wonderful_team.contracts.shown import ShownTask
from wonderful_team.core.values import Alike, PointRole, size_problem
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.description import Description
from wonderful_team.offline.eyes import Eyes, eyes_of_task, is_shown_alone, side_words, told_apart
from wonderful_team.offline.goals.aims import Aim, Aims
from wonderful_team.offline.goals.clearing import cleared
from wonderful_team.offline.goals.deriving import derive
from wonderful_team.offline.goals.instruction import read_task
from wonderful_team.offline.goals.sweeps import way_places
from wonderful_team.offline.language import describe, render, understand
from wonderful_team.offline.language.wording import relation_words
from wonderful_team.offline.pushing.sweeping import place_words

_SIDE_WORDS = {"left": "to the left of", "right": "to the right of", "above": "above", "below": "below",
               "near": "next to", "in": "into", "on": "onto"}  # fmt: skip
_ALIKE: Mapping[str | None, Alike] = {None: "both", "texture": "surface", "shape": "shape"}
MOST_NAMED = 8
"""Things of a picture that are named when the words fit none."""


@dataclass
class _Writer:
    """Collects targets, each once."""

    slots: tuple[str, ...]
    targets: list[TargetDraft] = field(default_factory=list)

    def target(self, description: Description, use: PointRole, kind: str | None = None) -> str:
        like = [name for name in (description.since, description.like) if name and name in self.slots]
        if description.way is not None:
            words, where, pictures = place_words(description.way)
            return self._known(words, where, [name for name in pictures if name in self.slots], use, "area")
        words = render(replace(description, related=()))
        if is_shown_alone(description) and "{" not in description.text:
            words = description.text
        if description.placed is not None:
            words = render(replace(description, like=None))
        where = "; ".join(relation_words(related) for related in description.related)
        what = kind or ("area" if description.noun == "area" else "object")
        return self._known(words, where, like, use, what, _ALIKE[description.like_only])

    def _known(self, words: str, where: str, like: list[str], use: PointRole, what: str, alike: Alike = "both") -> str:
        for position, known in enumerate(self.targets):
            if (known.words, known.where, known.like) == (words, where, like):
                if use not in known.use:
                    self.targets[position] = known.model_copy(update={"use": [*known.use, use]})
                return known.id
        name = f"T{len(self.targets) + 1}"
        self.targets.append(
            TargetDraft(id=name, kind=what, words=words, part=None, where=where, like=like, alike=alike, use=[use])
        )
        return name


def aim_text(aim: Aim) -> str:
    """An aim in words that `understand` reads back."""
    thing = f"the {aim.thing.words}"
    if aim.kind == "rotate":
        way = "counterclockwise" if aim.rotate_deg < 0 else "clockwise"
        return f"rotate {thing} by {abs(aim.rotate_deg):g} degrees {way}"
    if aim.figure is not None or aim.kind == "twist":
        return _handled_text(aim, thing)
    verb = "push" if aim.kind == "push" else "put"
    if aim.how == "origin":
        return f"{verb} {thing} " + (f"to where the {aim.to.words} was" if aim.to else "back to its original place")
    if aim.how == "side":
        return f"{verb} {thing} {side_words(aim.side)}"
    assert aim.to is not None  # every other destination has a reference
    if aim.kind == "push" and (aim.off or aim.limit):
        kept = f" without touching the {aim.off.words}" if aim.off else ""
        kept += f" without exceeding the {aim.limit.words}" if aim.limit else ""
        return f"push {thing} into the {aim.to.words}{kept}"
    if aim.how == "between" and aim.other is not None:
        return f"{verb} {thing} between the {aim.to.words} and the {aim.other.words}"
    return f"{verb} {thing} {_SIDE_WORDS[aim.how]} the {aim.to.words}"


def _handled_text(aim: Aim, thing: str) -> str:
    """What is done to a thing where it is, in words that `understand` reads back."""
    if aim.kind == "twist":
        return f"unscrew {thing} by {abs(aim.rotate_deg):g} degrees"
    figure = aim.figure
    assert figure is not None  # all but a twist have one
    if figure.name == "area":
        return f"wipe {thing}"
    if figure.name == "shake":
        return f"shake {thing}" + (f" {figure.count} times" if figure.count else "")
    size = "" if figure.size == 1 else "large " if figure.size > 1 else "small "
    tips = f"{figure.count} pointed " if figure.count else ""
    return f"draw a {size}{tips}{figure.name} on {thing}"


def function_of(aim: Aim) -> str | None:
    """What a helper function computes for an aim; None where none is needed."""
    if aim.figure is None:
        return None
    over = "in the air over" if aim.kind == "shake" else "on"
    return f"the path {over} the {aim.thing.words}, from its box: {aim_text(aim)}"


def write_plan(aims: Sequence[Aim], slots: tuple[str, ...], with_targets: bool, reasoning: str) -> PlanDraft:
    """Subgoals and targets of aims, in order.

    Raises:
        NotUnderstoodError: They are more than a plan may hold.
    """
    writer = _Writer(slots)
    needed = [aim_targets(aim, writer) for aim in aims]
    problem = size_problem(subgoals=len(aims), targets=len(writer.targets))
    if problem:
        raise NotUnderstoodError(
            f"what is asked for takes a plan of {problem}. Name fewer, such as 'put 50 red blocks into the bowl'"
        )
    subgoals = []
    for number, (aim, targets) in enumerate(zip(aims, needed, strict=True), start=1):
        after = [f"G{position + 1}" for position in aim.after]
        parts = {"text": aim_text(aim), "after": after, "targets": targets if with_targets else []}
        subgoals.append(SubgoalDraft.model_validate({"id": f"G{number}", "function": function_of(aim), **parts}))
    return PlanDraft(
        reasoning=reasoning,
        subgoals=subgoals,
        targets=writer.targets if with_targets else [],
        mode="one_step" if len(subgoals) <= 2 else "full",
        clarification=None,
    )


def aim_targets(aim: Aim, writer: _Writer) -> list[str]:
    """Ids of the targets that an aim needs: the thing, then its destination, place after place on its way."""
    if aim.legs:
        # The tool's start is computed behind the thing for each push, so a point on the thing is enough.
        ids = [writer.target(aim.thing.description, "pick")]
        return ids + [writer.target(spot, "place") for spot in way_places(aim)]
    if aim.kind == "trace":
        return [writer.target(aim.thing.description, "place")]
    start: PointRole = "push_start" if aim.kind == "push" else "pick"
    end: PointRole = "push_end" if aim.kind == "push" else "place"
    ids = [writer.target(aim.thing.description, start)]
    if aim.how == "side":
        spot = describe(f"free area {side_words(aim.side)}")
        ids.append(writer.target(spot, end, "area"))
    elif aim.how == "between" and aim.to is not None and aim.other is not None:
        spot = describe(f"free area between the {aim.to.words} and the {aim.other.words}")
        ids.append(writer.target(spot, end, "area"))
    elif aim.to is not None:
        ids.append(writer.target(aim.to.description, end))
    return list(dict.fromkeys(ids))


def draft(task: ShownTask, with_targets: bool, advice: Sequence[str] = ()) -> tuple[PlanDraft, Aims]:
    """Read the instruction, look at the picture, write the plan.

    Raises:
        NotUnderstoodError: The instruction holds unknown words, or names a picture that was not given.
    """
    understood = read_task(task)
    missing = [name for name in re.findall(r"\{([^{}]+)\}", task.instruction) if name not in task.slot_names]
    if missing:
        raise NotUnderstoodError(
            f"the instruction speaks of {{{missing[0]}}}, but no such picture was given; "
            f"pictures: {', '.join(task.slot_names) or 'none'}"
        )
    eyes = eyes_of_task(task)
    result = derive(understood, eyes)
    if result.unfounded:
        result.question = f"{result.unfounded[:1].upper()}{result.unfounded[1:]}. What is meant?"
        result.choices = tuple(told_apart(eyes, thing, "object") for thing in eyes.scene.things[:MOST_NAMED])
    if result.question:
        asked = ClarificationDraft(question=result.question, choices=list(result.choices))
        plan = PlanDraft(reasoning=result.question, subgoals=[], targets=[], mode="one_step", clarification=asked)
        return plan, result
    result.aims = cleared(result.aims, eyes)
    if understood.nothing_else:
        result.notes.append("nothing else is moved, as asked")
    reasoning = _reasoning(understood.used, result, eyes)
    if advice:
        reasoning = f"The advice changes nothing that the words say; the plan follows them. {reasoning}"
    return write_plan(result.aims, task.slot_names, with_targets, reasoning), result


def _reasoning(used: Sequence[str], result: Aims, eyes: Eyes) -> str:
    words = ", ".join(word for word in dict.fromkeys(used) if word not in (",", "and", "."))
    text = f"Words used: {words}. "
    found = [aim for aim in result.aims if aim.thing.number is not None]
    if result.aims:
        text += f"{len(found)} of {len(result.aims)} things to act on were seen among {len(eyes.scene.things)}. "
    else:
        text += "Nothing is left to do. "
    return text + "; ".join((*result.settled, *result.notes))


def answer_extract(question: ExtractTargets) -> TargetList:
    """Targets of approved subgoals, from their words alone."""
    writer = _Writer(question.task.slot_names)
    eyes = eyes_of_task(question.task)
    needs = []
    for subgoal in question.subgoals:
        # Refused by name where it cannot be read: the words of a subgoal are all there is to find its targets by.
        aims = derive(understand(subgoal.text), eyes, strict=False).aims
        ids = [name for aim in aims for name in aim_targets(aim, writer)]
        if not ids:
            raise NotUnderstoodError(f"subgoal {subgoal.id} names nothing that needs to be found: {subgoal.text!r}")
        needs.append(SubgoalTargets(subgoal=subgoal.id, targets=list(dict.fromkeys(ids))))
    return TargetList(
        reasoning="Each noun phrase of a subgoal is one target; the same words are the same target.",
        targets=writer.targets,
        needs=needs,
    )
