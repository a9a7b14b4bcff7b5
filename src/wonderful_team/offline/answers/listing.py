"""ListObjects and PlanFromList: the scene put into words, and a plan from pictures with the coordinates of a list."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from wonderful_team.contracts import (
    ListedPlan,
    ListObjects,
    NamedPoint,
    ObjectList,
    PlanFromList,
    PointPx,
    SlotDescription,
    listed_plan,
)
from wonderful_team.contracts.shown import ShownSlot
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture, Point
from wonderful_team.errors import UnsupportedQuestion
from wonderful_team.offline.description import SHAPES, Description
from wonderful_team.offline.eyes import eyes_of, unique_words
from wonderful_team.offline.language import render
from wonderful_team.offline.vision import NotSeen, study_example


def answer_list_objects(question: ListObjects) -> ObjectList:
    """Everything that is seen, in words that tell it apart."""
    objects = [NamedPoint(name=words, point=PointPx.of(point, question.view)) for words, point in _named(question.view)]
    pictures = [SlotDescription(picture=slot.name, words=_described(slot)) for slot in question.slots]
    return ObjectList(reasoning=f"{len(objects)} things are seen", objects=objects, pictures=pictures)


def answer_plan_from_list(question: PlanFromList, parts: dict[str, Any]) -> ListedPlan:
    """The plan that the pictures ask for, a thing's coordinates taken from the line of the list that lies on it.

    Args:
        question: What is asked.
        parts: The fields of a direct plan for the pictures.
    """
    points: dict[str, dict[str, Point]] = {}
    for target in parts["targets"]:
        own = {entry["role"]: (entry["point"]["x"], entry["point"]["y"]) for entry in target["points"]}
        box = None if target["box"] is None or target["kind"] == "area" else Box(*target["box"].values())
        on = [(float(item.x), float(item.y)) for item in question.objects if box and box.contains((item.x, item.y))]
        points[target["id"]] = {use: on[0] if len(on) == 1 else point for use, point in own.items()}
    return listed_plan(question, parts, points)


def check_pictures(question: PlanFromList) -> None:
    """Raises UnsupportedQuestion where nothing is shown."""
    if not question.views:
        raise UnsupportedQuestion("offline", "PlanFromList", "it plans from pictures, and words alone show it none")


def _named(picture: Picture) -> list[tuple[str, Point]]:
    """Everything in a picture, and where it is."""
    try:
        eyes = eyes_of(picture, ())
    except NotSeen:
        return []
    return [(unique_words(eyes, thing, "object").text, thing.steady_point()) for thing in eyes.scene.things]


def _described(slot: ShownSlot) -> str:
    named = _named(slot.pictures[0]) if slot.pictures else []
    lines = [words + (f" at x {x:.0f}, y {y:.0f}" if slot.whole_scene else "") for words, (x, y) in named]
    return "; ".join(lines) or "nothing that is seen"


def shown_words(slot: ShownSlot) -> str:
    """What one of the instruction's pictures shows, in words by which the thing is found on a table; of a scene, what lies where."""
    if slot.whole_scene or not slot.pictures:
        return _described(slot)
    try:
        look = study_example(slot.pictures[0]).look
    except NotSeen:
        return "nothing that is seen"
    colours = tuple(colour.name for colour in look.colours[: 1 if look.pattern == "plain" else 2])
    pattern = None if look.pattern == "plain" else look.pattern
    described = Description("object", "", colours=colours, pattern=pattern)
    if look.shape == "letter":
        described = replace(described, noun="letter", name=max(look.letters, key=lambda name: look.letters[name]))
    elif look.shape in SHAPES:
        described = replace(described, shape=look.shape)
    return render(described)
