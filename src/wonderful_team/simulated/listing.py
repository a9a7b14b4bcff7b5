"""ListObjects and PlanFromList: the scene put into words, and a plan from words."""

from __future__ import annotations

import math
from collections.abc import Sequence

from wonderful_team.contracts import (
    ListedObject,
    ListedPlan,
    ListObjects,
    NamedPoint,
    ObjectList,
    PlanFromList,
    PointPx,
    ShownSlot,
    ShownTask,
    SlotDescription,
    SlotWords,
    listed_plan,
)
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.core.values import PointRole
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.images import whole
from wonderful_team.images.cut import MARKED_SIDE_PX
from wonderful_team.simulated.appearance import known, tokens
from wonderful_team.simulated.context import Context
from wonderful_team.simulated.draft import Meaning, Written
from wonderful_team.simulated.places import place_of, point_of
from wonderful_team.simulated.seeing import Seen

SCENES = frozenset({"scene", "frame", "before", "after"})


def answer_list_objects(context: Context, question: ListObjects) -> ObjectList:
    """Everything that shows, by its words, and what the instruction's pictures show."""
    seen = context.see(question.view)
    objects = []
    if seen is not None and seen.current:
        placed = [(_words(seen, name), seen.position(name)) for name in seen.names]
        objects = [NamedPoint(name=said, point=PointPx.of(at, question.view)) for said, at in placed if at is not None]
    pictures = []
    for slot in question.slots:
        pictures.append(SlotDescription(picture=slot.name, words=slot_words(context, slot)))
    return ObjectList(reasoning=f"{len(objects)} things show", objects=objects, pictures=pictures)


def slot_words(context: Context, slot: ShownSlot) -> str:
    """What one of the instruction's pictures really shows; of a whole scene, what stands where."""
    shown = context.see(slot.pictures[0]) if slot.pictures else None
    lines = [] if shown is None else [_line(shown, name, slot.kind in SCENES) for name in shown.names]
    return "; ".join(lines) or "nothing that was ever there"


def check_told(context: Context, slot_words: Sequence[SlotWords], shown: Sequence[str] = ()) -> None:
    """Raises NotUnderstoodError where a picture of the instruction is not shown, and no words say what it really shows:
    some word of each thing in it.
    """
    every = set() if context.instruction is None else set(context.instruction.slots)
    missing = every - set(shown) - {one.slot for one in slot_words if _says(context, one)}
    if missing:
        raise NotUnderstoodError(f"nobody says what {', '.join(sorted(missing))} really shows")


def _says(context: Context, told: SlotWords) -> bool:
    slot = None if context.instruction is None else context.instruction.slots.get(told.slot)
    view = None if slot is None else next(iter(slot.views.values()))
    seen = None if view is None else context.see(whole(view, told.slot))
    if seen is None:
        return True
    said = tokens(told.words)
    shown = ((name, seen.thing(name)) for name in seen.names)
    return all(known(said, name, thing, seen) > 0 for name, thing in shown if thing is not None)


def answer_plan_from_list(context: Context, question: PlanFromList) -> ListedPlan:
    """The plan that truth asks for, with the coordinates that the list gives its things.

    Raises:
        NotUnderstoodError: A picture that is shown is not true, or the list lacks a thing that has to be moved.
    """
    seen = _main(context, question)
    plan, _ = context.plans(seen)
    check_told(context, question.slot_words, [slot.name for slot in question.slots])
    points: dict[str, dict[str, Point]] = {}
    for draft in plan.targets:
        meaning = plan.meanings[draft.id]
        target = draft.to_target()
        points[draft.id] = {role: _at(context, meaning, role, seen, question.objects) for role in target.roles}
    return listed_plan(question, _parts(plan), points)


def _main(context: Context, question: PlanFromList) -> Seen:
    """The main view as it is now: the one that is shown, else the one whose pixels the list names."""
    if question.views:
        task = context.task(ShownTask(question.instruction, question.views, question.slots))
        if task is None:
            raise NotUnderstoodError("one of the pictures of this task shows nothing that was ever there")
        return task.main
    context.check_words(ShownTask(question.instruction, ()))
    return main_of(context, question.picture, question.size_px)


def main_of(context: Context, name: str, size_px: tuple[int, int]) -> Seen:
    """The main view as it is now, for a question that names it and shows nothing.

    Raises:
        NotUnderstoodError: There is no such view.
    """
    log = context.truth.observation_log(name.removesuffix(" view"))
    picture: Picture | None = whole(log[0].view, name, long_side_px=MARKED_SIDE_PX) if log else None
    seen = None if picture is None or picture.size_px != size_px else context.see(picture)
    if seen is None:
        raise NotUnderstoodError(f"positions are pixels of {name!r}, which is not known")
    return seen


def _at(context: Context, meaning: Meaning, role: PointRole, seen: Seen, objects: Sequence[ListedObject]) -> Point:
    """Where the list has a thing: the nearest line of its name, or of what is taken for it. A spot is reckoned from where it is."""
    place = place_of(meaning, seen)
    if meaning.thing is None:
        if place is None:
            raise NotUnderstoodError("a place lies outside of the view")
        return point_of(place, role, seen)
    thing = context.taken_for(meaning.thing, seen)
    said, near = _words(seen, thing), seen.position(thing) or (0.0, 0.0)
    named = [item for item in objects if item.name == said]
    if not named:
        raise NotUnderstoodError(
            f"the list names no {said!r}; it names {', '.join(item.name for item in objects) or 'nothing'}"
        )
    best = min(named, key=lambda item: math.dist((item.x, item.y), near))
    return float(best.x), float(best.y)


def _parts(plan: Written) -> dict[str, object]:
    goals = [draft.model_dump(include={"id", "text", "after", "targets"}) for draft in plan.subgoals]
    return {
        "reasoning": f"{len(goals)} moves lead from this table to what is asked.",
        "subgoals": goals,
        "targets": [draft.model_dump() for draft in plan.targets],
        "steps": plan.steps,
    }


def _words(seen: Seen, name: str) -> str:
    thing = seen.thing(name)
    return name if thing is None else thing.words


def _line(seen: Seen, name: str, placed: bool) -> str:
    point = seen.position(name) if placed else None
    return _words(seen, name) + ("" if point is None else f" at x {point[0]:.0f}, y {point[1]:.0f}")
