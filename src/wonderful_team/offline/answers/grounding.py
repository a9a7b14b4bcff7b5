"""Answers on the whole view: LocatePoints, ChooseMark, GiveBox, ReadScene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

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
)
from wonderful_team.core.values import PointRole, Target
from wonderful_team.offline.answers.finding import Found, act_at, candidates, push_goal, told, tried, untried, varied
from wonderful_team.offline.eyes import Eyes, eyes_of, is_free_area

YIELDS = 0.75
"""A target gives way to another on the same thing when its next best match scores at least this share."""
ALSO = 0.85
"""Further places are offered while they score at least this share of the best one."""


def answer_locate(question: LocatePoints, sample: int) -> Points:
    """Point at what fits, leaving out what was tried."""
    eyes = eyes_of(question.view, question.examples)
    found = candidates(question.target, eyes, question.plan)
    left = untried(found, tried(question.view))
    if not left:
        why = (
            "everything that fits was tried already" if found else f"nothing among {len(eyes.scene.things)} things fits"
        )
        return Points(reasoning=f"{why}: {question.target.words}", found=False, points=[])
    good = [item for item in left if item.match.score >= ALSO * left[0].match.score][: question.count]
    role: PointRole = "pick" if question.purpose == "centre" else "place"
    points = []
    for item in good:
        point = item.box.centre if role == "pick" and item.thing is None else act_at(item, role, eyes)
        points.append(PointPx.of(varied(point, item, sample), question.view))
    return Points(reasoning=told(left[0]), found=True, points=points)


def answer_choose_mark(question: ChooseMark) -> MarkChoice:
    """The numbered point that is on the target, nearest to where it should be."""
    eyes = eyes_of(question.view, question.examples)
    points = question.candidates.points
    found = candidates(question.target, eyes, question.plan)
    for item in found:
        wanted = act_at(item, "pick" if question.purpose == "centre" else "place", eyes)
        on = [number for number, point in enumerate(points, start=1) if item.box.contains(point)]
        if item.thing is not None and question.purpose == "centre":
            on = [number for number in on if item.thing.holds(points[number - 1])] or on
        if on:
            best = min(on, key=lambda number: np.hypot(*np.subtract(points[number - 1], wanted)))
            return MarkChoice(reasoning=f"{told(item)}; nearest to its point", number=best)
    return MarkChoice(
        reasoning=f"no number lies on {question.target.words}; {len(found)} things fit the words", number=None
    )


def answer_select_marks(question: SelectMarks) -> MarkSelection:
    """The numbered points that are nearest to where the target's point should be, those on it first."""
    eyes = eyes_of(question.view, question.examples)
    found = candidates(question.target, eyes)
    if not found:
        return MarkSelection(reasoning=f"nothing in the picture fits {question.target.words!r}", numbers=[])
    item, points = found[0], question.candidates.points
    wanted = act_at(item, question.role, eyes)
    held = item.thing if question.role in ("pick", "grasp") else None

    def off(number: int) -> tuple[bool, float]:
        point = points[number - 1]
        return held is not None and not held.holds(point), float(np.hypot(*np.subtract(point, wanted)))

    numbers = sorted(range(1, len(points) + 1), key=off)[: question.most]
    return MarkSelection(reasoning=f"{told(item)}; nearest to its point", numbers=numbers)


def answer_give_box(question: GiveBox) -> BoxAnswer:
    """A box round what fits, the marked point deciding between several."""
    eyes = eyes_of(question.view, question.examples)
    found = candidates(question.target, eyes, question.plan)
    if not found:
        return BoxAnswer(reasoning=f"nothing in the picture fits {question.target.words!r}", box=None)
    marks = tried(question.view)
    chosen = next((item for item in found if any(item.box.contains(point) for point in marks)), None)
    if chosen is None:
        return BoxAnswer(reasoning=f"the mark is off; {told(found[0])}", box=BoxPx.of(found[0].box, question.view))
    return BoxAnswer(reasoning=f"at the mark: {told(chosen)}", box=BoxPx.of(chosen.box, question.view))


def answer_read_scene(question: ReadScene) -> SceneReading:
    """Every target at once; a target whose words fit nothing is not here."""
    eyes = eyes_of(question.view, question.examples)
    found_all = [candidates(target, eyes, question.plan) for target in question.targets]
    chosen = _unclaimed(_apart(question.targets, found_all), found_all)
    items, reasons = [], []
    for target, found in zip(question.targets, chosen, strict=True):
        reasons.append(f"{target.id}: {told(found) if found is not None else 'nothing fits'}")
        items.append(_scene_target(target, found, eyes, question))
    return SceneReading(reasoning="; ".join(reasons), targets=items)


def _apart(targets: Sequence[Target], found: Sequence[list[Found]]) -> list[Found | None]:
    """The best match of each target; where two in different words fall on one thing, the less sure one yields."""
    chosen = [items[0] if items else None for items in found]
    for i, one in enumerate(targets):
        for j in range(i + 1, len(targets)):
            first, second = chosen[i], chosen[j]
            other = targets[j]
            if first is None or second is None or first.thing is None or first.thing is not second.thing:
                continue
            if (one.words, one.like) == (other.words, other.like):
                continue
            loser = j if _yields(found[j], second) >= _yields(found[i], first) else i
            others = [item for item in found[loser] if item.thing is not None and item.thing is not first.thing]
            if others and others[0].match.score >= YIELDS * found[loser][0].match.score:
                chosen[loser] = others[0]
    return chosen


def _unclaimed(chosen: Sequence[Found | None], found: Sequence[list[Found]]) -> list[Found | None]:
    """Free areas keep off the places that other targets will need: what is put there would be in the way."""
    places = [
        item.box
        for item in chosen
        if item is not None and (item.description.placed is not None or item.description.way is not None)
    ]

    def clear(item: Found) -> bool:
        return not any(item.box.intersection(place) for place in places)

    return [
        next((other for other in others if clear(other)), item)
        if item is not None and is_free_area(item.description) and not clear(item)
        else item
        for item, others in zip(chosen, found, strict=True)
    ]


def _yields(found: Sequence[Found], chosen: Found) -> float:
    """Score of the next best thing, as a share of the chosen one's."""
    others = [item.match.score for item in found if item is not chosen]
    return max(others, default=0.0) / max(chosen.match.score, 1e-6)


def _scene_target(target: Target, found: Found | None, eyes: Eyes, question: ReadScene) -> SceneTarget:
    if found is None:
        return SceneTarget(id=target.id, found=False, box=None, points=[])
    towards = push_goal(question.plan, target, eyes, question.targets) if "push_start" in target.roles else None
    points = [
        RolePoint(role=role, point=PointPx.of(act_at(found, role, eyes, towards), question.view))
        for role in target.roles
    ]
    return SceneTarget(id=target.id, found=True, box=BoxPx.of(found.box, question.view), points=points)
