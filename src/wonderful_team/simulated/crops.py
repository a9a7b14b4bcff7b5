"""Answers on crops and strips: Presence, JudgeBox, JudgeRevision, MoveBox, ChoosePoint."""

from __future__ import annotations

import math

from wonderful_team.contracts import (
    EDGES,
    BoxMove,
    BoxVerdict,
    BoxVerdicts,
    ChoosePoint,
    EdgePresence,
    JudgeBox,
    JudgeBoxes,
    JudgeRevision,
    MoveBox,
    PointChoice,
    Presence,
    PresenceAnswer,
    RevisionVerdict,
    TargetVerdict,
    Tolerance,
    WrongPoint,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Picture, Point, PointMark
from wonderful_team.simulated.context import Context
from wonderful_team.simulated.grounding import find
from wonderful_team.simulated.places import Place, point_of
from wonderful_team.simulated.profile import Judged
from wonderful_team.simulated.seeing import Seen

SLACK = 0.08
"""How far an edge of a good box may lie off, as a share of the target's side across it."""
SLACK_PX = 2.5
"""The same in pixels of the view, whichever is more."""
WIDEN = 0.3
"""How far a box is widened where the target reaches past the picture, as a share of its sides."""
LEAST_MOVE_PX = 0.5


def box_of(picture: Picture) -> Box | None:
    """The box that is marked on a picture."""
    return next((mark.box for mark in picture.marks if isinstance(mark, BoxMark)), None)


def fits(box: Box, place: Place, seen: Seen, tolerance: Tolerance | None = None) -> bool:
    """Whether a box is tight on a target, by the tolerance that the question states."""
    if not place.whole and place.meaning.thing is not None:
        return False
    right, scale = place.box, seen.picture.frame.scale
    if tolerance is not None:
        off = (right.x0 - box.x0, right.y0 - box.y0, box.x1 - right.x1, box.y1 - right.y1)
        return all(-tolerance.inward_px <= outward <= tolerance.outward_px for outward in off)
    across = max(SLACK * right.width, SLACK_PX * scale)
    down = max(SLACK * right.height, SLACK_PX * scale)
    return (
        max(abs(box.x0 - right.x0), abs(box.x1 - right.x1)) <= across
        and max(abs(box.y0 - right.y0), abs(box.y1 - right.y1)) <= down
    )


def answer_judge_box(context: Context, question: JudgeBox) -> BoxVerdict:
    """Accept what is tight, send back what touches the target, reject what is elsewhere; judged wrongly as often as the profile says."""
    state, verdict = _judged(context, question)
    return verdict if context.sampler is None else context.sampler.verdict(verdict, state, question.target.id)


def _judged(context: Context, question: JudgeBox) -> tuple[Judged, BoxVerdict]:
    """What is the matter with the box, and what is right to say of it."""
    box = box_of(question.crop)
    found = find(context, question.target, question.crop, question.examples, box)
    if found is None or box is None:
        why = f"the {question.target.words} does not show in this picture"
        return "elsewhere", BoxVerdict(reasoning=why, decision="reject", problem=why, wrong_points=[])
    seen, place = found
    wrong = _wrong_points(question, seen, place)
    if fits(box, place, seen, Tolerance.on(question.crop)):
        return "tight", BoxVerdict(reasoning="the box is tight", decision="accept", problem="", wrong_points=wrong)
    if box.intersection(place.box) is None:
        why = f"the {question.target.words} lies elsewhere"
        state: Judged = "beside" if seen.at(box.centre) is None else "elsewhere"
        return state, BoxVerdict(reasoning=why, decision="reject", problem=why, wrong_points=[])
    why = f"it should reach from ({place.box.x0:.0f}, {place.box.y0:.0f}) to ({place.box.x1:.0f}, {place.box.y1:.0f})"
    return "off", BoxVerdict(reasoning=why, decision="revise", problem=why, wrong_points=wrong)


def _wrong_points(question: JudgeBox, seen: Seen, place: Place) -> list[WrongPoint]:
    """Points to take hold at that are not on the thing, and points to put something at that are not in its place."""
    points = {mark.label: mark.point for mark in question.crop.marks if isinstance(mark, PointMark)}
    name, wrong = place.meaning.thing, []
    for use in question.uses:
        point = points.get(use)
        if point is None:
            continue
        if use in ("pick", "grasp") and name is not None and seen.at(point, (name,)) is None:
            wrong.append(WrongPoint(use=use, why=f"it is not on the {question.target.words} itself"))
        elif use == "place" and not place.box.contains(point):
            wrong.append(WrongPoint(use=use, why=f"it lies outside of the {question.target.words}"))
    return wrong


def answer_judge_boxes(context: Context, question: JudgeBoxes) -> BoxVerdicts:
    """Every box as if it were asked about alone."""
    return BoxVerdicts(
        boxes=[TargetVerdict(target=item.target.id, verdict=answer_judge_box(context, item)) for item in question.boxes]
    )


def answer_judge_revision(context: Context, question: JudgeRevision) -> RevisionVerdict:
    """Keep the one nearer to the truth. Where the one before is not shown, nothing can be compared: what touches the target is taken."""
    before = None if question.before is None else box_of(question.before)
    after = box_of(question.after)
    found = find(context, question.target, question.after, question.examples, after)
    if found is None or after is None or (before is None and question.before is not None):
        return RevisionVerdict(reasoning="the target does not show in this picture", decision="keep_before")
    seen, place = found
    if fits(after, place, seen, Tolerance.on(question.after)):
        return RevisionVerdict(reasoning="the box after is tight", decision="take_after_stop")
    if before is None:
        if after.intersection(place.box) is not None:
            return RevisionVerdict(reasoning="it is on the target and not tight", decision="take_after_go_on")
        return RevisionVerdict(reasoning="it is not on the target", decision="keep_before")
    if _off(after, place.box) < _off(before, place.box):
        return RevisionVerdict(reasoning="the box after is nearer", decision="take_after_go_on")
    return RevisionVerdict(reasoning="the box after is no nearer", decision="keep_before")


def _off(box: Box, right: Box) -> float:
    return sum(abs(a - b) for a, b in zip(box.as_tuple, right.as_tuple, strict=True))


def answer_move_box(context: Context, question: MoveBox) -> BoxMove:
    """Put every edge where it belongs; widen where the target reaches past the picture or does not show."""
    box = question.box
    found = find(context, question.target, question.crop, question.examples, box)
    if found is None:
        if question.may_stop:
            return _move("stop", "the target does not show here")
        return _move("resize", "widened to look further", *(WIDEN * side for side in (box.width, box.height) * 2))
    seen, place = found
    if question.may_stop and fits(box, place, seen):
        return _move("stop", "the box is tight")
    right = place.box
    grow = [box.x0 - right.x0, box.y0 - right.y0, right.x1 - box.x1, right.y1 - box.y1]
    if not place.whole:
        shown = question.crop.frame.valid
        for k, (edge, end) in enumerate(zip(right.as_tuple, shown.as_tuple, strict=True)):
            if abs(edge - end) < 1.5 * question.crop.frame.scale:
                grow[k] += WIDEN * (right.height if k % 2 else right.width)
    if max(abs(amount) for amount in grow) < LEAST_MOVE_PX:
        grow[0] = LEAST_MOVE_PX if grow[0] >= 0 else -LEAST_MOVE_PX
    return _move("resize", "edges set to the target", *grow)


def _move(
    action: str, reasoning: str, left: float = 0.0, top: float = 0.0, right: float = 0.0, bottom: float = 0.0
) -> BoxMove:
    cut = [edge for edge, amount in zip(EDGES, (left, top, right, bottom), strict=True) if amount > 0]
    return BoxMove.model_validate(
        {
            "reasoning": reasoning, "action": action, "right_px": 0.0, "down_px": 0.0, "grow_left_px": left,
            "grow_top_px": top, "grow_right_px": right, "grow_bottom_px": bottom, "cut_edges": cut,
        }
    )  # fmt: skip


def answer_presence(context: Context, question: Presence) -> PresenceAnswer:
    """Whether any of the target shows in each strip."""
    shows = {
        (strip.edge, strip.side): find(context, question.target, strip.picture, question.examples) is not None
        for strip in question.strips
    }
    edges = [
        EdgePresence(edge=edge, inside=shows.get((edge, "inside"), False), outside=shows.get((edge, "outside"), False))
        for edge in EDGES
    ]
    return PresenceAnswer(reasoning=f"it shows in {sum(shows.values())} of {len(shows)} strips", edges=edges)


def answer_choose_point(context: Context, question: ChoosePoint) -> PointChoice:
    """The candidate nearest to where the point belongs, on the target where it must be on it; the first one when blind."""
    points = question.candidates.points
    found = find(context, question.target, question.crop, question.examples, box_of(question.crop))
    if found is None:
        return PointChoice(reasoning="the target does not show in this picture", number=1)
    seen, place = found
    wanted = point_of(place, question.role, seen)
    name = place.meaning.thing

    def off(number: int) -> tuple[bool, float]:
        point: Point = points[number - 1]
        held = question.role in ("pick", "grasp") and question.fine and name is not None
        return held and seen.at(point, (name,)) is None if name is not None else False, math.dist(point, wanted)

    return PointChoice(reasoning="nearest to where it belongs", number=min(range(1, len(points) + 1), key=off))
