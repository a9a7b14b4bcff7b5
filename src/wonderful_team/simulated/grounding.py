"""Answers on the whole view: LocatePoints, ChooseMark, GiveBox, ReadScene."""

from __future__ import annotations

import math

from wonderful_team.contracts import (
    BoxAnswer,
    BoxPx,
    ChooseMark,
    GiveBox,
    LocatePoints,
    MarkChoice,
    MarkSelection,
    PointPx,
    Points,
    ReadScene,
    RolePoint,
    SceneReading,
    SceneTarget,
    SelectMarks,
    ShownSlot,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture, PointMark
from wonderful_team.core.values import PointRole, Target
from wonderful_team.simulated.context import Context
from wonderful_team.simulated.draft import Meaning
from wonderful_team.simulated.places import Place, place_of, point_of
from wonderful_team.simulated.seeing import Seen

POINT_PX = 20.0
"""Side of what a marked point points at [picture px]."""
NOT_HERE = "nothing in this picture is the {words}"


def find(
    context: Context,
    target: Target,
    picture: Picture,
    examples: tuple[ShownSlot, ...],
    at: Box | None = None,
) -> tuple[Seen, Place] | None:
    """A target in a picture; None where it does not show, or nothing true shows."""
    seen = context.see(picture)
    if seen is None or not seen.current:
        return None
    meaning = _erring(context, context.meaning(target, seen, examples, at), seen, target)
    place = None if meaning is None else place_of(meaning, seen)
    return None if place is None else (seen, place)


def _erring(context: Context, right: Meaning | None, seen: Seen, target: Target) -> Meaning | None:
    """What the target is taken for, with the errors of the profile."""
    sampler = context.sampler
    if sampler is None:
        return right
    profile, names = sampler.profile, seen.names
    if right is None or (right.thing is not None and right.thing not in names):
        imagines = bool(names) and sampler.draws(profile.imagined, f"imagined {target.id}")
        return Meaning(sampler.other("", names, f"which {target.id}")) if imagines else right
    if sampler.draws(profile.missed, f"missed {target.id}"):
        return None
    if right.thing is not None and sampler.draws(profile.wrong_thing, f"wrong {target.id}"):
        return Meaning(sampler.other(right.thing, names, f"which {target.id}"))
    return right


def answer_locate(context: Context, question: LocatePoints) -> Points:
    """Its point; not found where it does not show."""
    found = find(context, question.target, question.view, question.examples)
    if found is None:
        return Points(reasoning=NOT_HERE.format(words=question.target.words), found=False, points=[])
    seen, place = found
    role: PointRole = "pick" if question.purpose == "centre" else "place"
    point = point_of(place, role, seen)
    return Points(reasoning=f"the {question.target.words}", found=True, points=[PointPx.of(point, question.view)])


def answer_choose_mark(context: Context, question: ChooseMark) -> MarkChoice:
    """The mark on the target that is nearest to where it should be."""
    found = find(context, question.target, question.view, question.examples)
    none = MarkChoice(reasoning="no mark is on it", number=None)
    if found is None:
        return none
    seen, place = found
    wanted = point_of(place, "pick" if question.purpose == "centre" else "place", seen)
    points = question.candidates.points
    name = place.meaning.thing
    on = [
        number
        for number, point in enumerate(points, start=1)
        if (
            seen.at(point, (name,)) is not None
            if name is not None and question.purpose == "centre"
            else place.box.contains(point)
        )
    ]
    if not on:
        return none
    best = min(on, key=lambda number: math.dist(points[number - 1], wanted))
    return MarkChoice(reasoning=f"the nearest of {len(on)} on it", number=best)


def answer_select_marks(context: Context, question: SelectMarks) -> MarkSelection:
    """The marks nearest to where the target's point should be, those on it first."""
    found = find(context, question.target, question.view, question.examples)
    if found is None:
        return MarkSelection(reasoning=NOT_HERE.format(words=question.target.words), numbers=[])
    seen, place = found
    wanted, points = point_of(place, question.role, seen), question.candidates.points
    name = place.meaning.thing if question.role in ("pick", "grasp") else None

    def off(number: int) -> tuple[bool, float]:
        point = points[number - 1]
        return name is not None and seen.at(point, (name,)) is None, math.dist(point, wanted)

    numbers = sorted(range(1, len(points) + 1), key=off)[: question.most]
    return MarkSelection(reasoning=f"nearest to the {question.target.words}", numbers=numbers)


def answer_give_box(context: Context, question: GiveBox) -> BoxAnswer:
    """Tight round the target."""
    marks = [mark.point for mark in question.view.marks if isinstance(mark, PointMark)]
    at = Box.around(marks[-1], POINT_PX, POINT_PX) if marks else None
    found = find(context, question.target, question.view, question.examples, at)
    if found is None:
        return BoxAnswer(reasoning=NOT_HERE.format(words=question.target.words), box=None)
    return BoxAnswer(reasoning=f"round the {question.target.words}", box=BoxPx.of(found[1].box, question.view))


def answer_read_scene(context: Context, question: ReadScene) -> SceneReading:
    """Every target at once."""
    items = []
    for target in question.targets:
        found = find(context, target, question.view, question.examples)
        if found is None:
            items.append(SceneTarget(id=target.id, found=False, box=None, points=[]))
            continue
        seen, place = found
        points = [
            RolePoint(role=role, point=PointPx.of(point_of(place, role, seen), question.view)) for role in target.roles
        ]
        items.append(SceneTarget(id=target.id, found=True, box=BoxPx.of(place.box, question.view), points=points))
    here = sum(item.found for item in items)
    return SceneReading(reasoning=f"{here} of {len(items)} targets show in this picture", targets=items)
