"""Answers on crops and strips: Presence, JudgeBox, JudgeRevision, MoveBox, ChoosePoint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

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
    ShownSlot,
    TargetVerdict,
    WrongPoint,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, PathMark, Picture, Point, PointMark
from wonderful_team.core.values import PointRole, Target
from wonderful_team.offline.answers.areas import judge_area, judge_place, nearest_free
from wonderful_team.offline.answers.finding import held_by, middle_of, push_goal
from wonderful_team.offline.eyes import examples_of, eyes_of, is_free_area, shape_alone, target_description
from wonderful_team.offline.vision import BoxFit, fit_box, see, strip_presence
from wonderful_team.offline.vision.changes import gap_px
from wonderful_team.offline.vision.measure import SIDES, Side

SAME_SIZE = 0.2
"""A box whose sides differ from the target's by less than this share is moved as a whole, else its edges are set."""
HOLDING: tuple[PointRole, ...] = ("pick", "grasp")
"""Uses of points at which a thing is taken hold of."""
WIDEN = 0.3
"""How far a box is widened where its target does not show, in shares of its sides."""


def marked_box(crop: Picture) -> Box:
    """The box drawn on a crop.

    Raises:
        ValueError: There is none.
    """
    boxes = [mark.box for mark in crop.marks if isinstance(mark, BoxMark)]
    if not boxes:
        raise ValueError(f"picture {crop.name!r} carries no box to judge")
    return boxes[0]


def measure(target: Target, crop: Picture, box: Box, examples: Sequence[ShownSlot]) -> BoxFit:
    """How a box stands to what the crop shows of the target; a free area is judged by what lies in the box."""
    description = target_description(target)
    if is_free_area(description) or description.way is not None:
        return judge_area(crop, box)
    if description.placed is not None:
        return judge_place(description, crop, box, examples)
    known = examples_of(examples)
    return fit_box(crop, box, shape_alone(description, known), known)


def answer_presence(question: Presence) -> PresenceAnswer:
    """Per edge, whether the target's colours show in the strips."""
    examples = examples_of(question.examples)
    description = shape_alone(target_description(question.target), examples)
    fits = {(strip.edge, strip.side): strip_presence(strip.picture, description, examples) for strip in question.strips}
    showing = {place for place, fit in fits.items() if fit.shows}
    edges = [
        EdgePresence(edge=edge, inside=(edge, "inside") in showing, outside=(edge, "outside") in showing)
        for edge in EDGES
    ]
    shares = ", ".join(f"{edge} {side} {fit.share:.2f}" for (edge, side), fit in fits.items())
    return PresenceAnswer(reasoning=f"share of pixels with the target's colours: {shares or 'no strips'}", edges=edges)


def answer_judge_box(question: JudgeBox) -> BoxVerdict:
    """Accept what is tight, send back what can be moved onto the target, reject what is on another thing."""
    box = marked_box(question.crop)
    fit = measure(question.target, question.crop, box, question.examples)
    wrong = _wrong_points(question, fit)
    if fit.verdict == "tight":
        return BoxVerdict(reasoning=fit.why, decision="accept", problem="", wrong_points=wrong)
    if fit.verdict == "loose" or (fit.verdict == "empty" and fit.best is not None):
        return BoxVerdict(reasoning=fit.why, decision="revise", problem=_problem(fit, box), wrong_points=wrong)
    return BoxVerdict(reasoning=fit.why, decision="reject", problem=f"the box is not on the target: {fit.why}")


def _wrong_points(question: JudgeBox, fit: BoxFit) -> list[WrongPoint]:
    """Points to take hold at that do not lie on the target's material."""
    if fit.target is None:
        return []
    points = {mark.label: mark.point for mark in question.crop.marks if isinstance(mark, PointMark)}
    held = held_by(fit.target, target_description(question.target), see(question.crop))
    why = f"it does not lie on the material of the {fit.target.look.words}"
    return [
        WrongPoint(use=use, why=why)
        for use in question.uses
        if use in HOLDING and (point := points.get(use)) is not None and not held.holds(point)
    ]


def answer_judge_boxes(question: JudgeBoxes) -> BoxVerdicts:
    """Every box as if it were asked about alone."""
    return BoxVerdicts(
        boxes=[TargetVerdict(target=item.target.id, verdict=answer_judge_box(item)) for item in question.boxes]
    )


def _problem(fit: BoxFit, box: Box) -> str:
    if fit.cut:
        return f"the target reaches past the {' and '.join(fit.cut)} edge"
    if fit.loose and fit.iou > 0:
        return f"the {' and '.join(fit.loose)} edge leaves room round the target"
    if fit.best is None:
        return fit.why
    dx, dy = fit.best.centre[0] - box.centre[0], fit.best.centre[1] - box.centre[1]
    return f"the target lies {abs(dx):.0f} px {'right' if dx > 0 else 'left'} and {abs(dy):.0f} px {'down' if dy > 0 else 'up'}"


def answer_judge_revision(question: JudgeRevision) -> RevisionVerdict:
    """Compare both boxes with the outline measured in their crops; without the one before, judge the one after."""
    after_box = marked_box(question.after)
    after = measure(question.target, question.after, after_box, question.examples)
    if question.before is None:
        if after.verdict == "tight":
            return RevisionVerdict(reasoning=after.why, decision="take_after_stop")
        return RevisionVerdict(reasoning=after.why, decision="take_after_go_on" if after.iou > 0 else "keep_before")
    before_box = marked_box(question.before)
    before = measure(question.target, question.before, before_box, question.examples)
    decision: Literal["keep_before", "take_after_go_on", "take_after_stop"] = "keep_before"
    if after.verdict == "tight" and after.iou >= before.iou:
        decision = "take_after_stop"
    elif after.best is not None and (after.verdict != "other" or before.verdict == "other"):
        away = gap_px(after_box.centre, after.best.centre)
        nearer = away < gap_px(before_box.centre, (before.best or after.best).centre)
        if after.iou > before.iou or (after.iou == before.iou and nearer):
            decision = "take_after_go_on"
    return RevisionVerdict(reasoning=f"before: {before.why}; after: {after.why}", decision=decision)


def answer_move_box(question: MoveBox) -> BoxMove:
    """Put the box where the target was measured, in one revision."""
    box = question.box
    fit = measure(question.target, question.crop, box, question.examples)
    if fit.verdict == "tight" and question.may_stop:
        return _moved(f"{fit.why}; nothing to change", "stop")
    if fit.best is None:
        if question.may_stop:
            return _moved(f"{fit.why}; the target does not show here", "stop")
        wider = (WIDEN * box.width, WIDEN * box.height) * 2
        return _moved(f"{fit.why}; widened to look further", "resize", grow=wider)
    best = fit.best
    alike = abs(best.width / box.width - 1) < SAME_SIZE and abs(best.height / box.height - 1) < SAME_SIZE
    dx, dy = best.centre[0] - box.centre[0], best.centre[1] - box.centre[1]
    if alike and max(abs(dx) / box.width, abs(dy) / box.height) > 0.1:
        return _moved(f"{fit.why}; its middle lies {dx:+.0f}, {dy:+.0f} px away", "move", (dx, dy), cut=fit.cut)
    grow = (box.x0 - best.x0, box.y0 - best.y0, best.x1 - box.x1, best.y1 - box.y1)
    if max(abs(value) for value in grow) < 1e-3:
        grow = (0.5, 0.5, 0.5, 0.5)
    return _moved(f"{fit.why}; edges set to its outline", "resize", grow=grow, cut=fit.cut)


def _moved(
    reasoning: str,
    action: Literal["move", "resize", "stop"],
    by: Point = (0.0, 0.0),
    grow: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    cut: Sequence[Side] = (),
) -> BoxMove:
    shift = dict(zip(("right_px", "down_px"), by, strict=True))
    edges = {f"grow_{side}_px": value for side, value in zip(SIDES, grow, strict=True)}
    return BoxMove(reasoning=reasoning, action=action, cut_edges=list(cut), **shift, **edges)


def answer_choose_point(question: ChoosePoint) -> PointChoice:
    """The candidate nearest to where the role wants it, on material for a pick."""
    points = question.candidates.points
    description = target_description(question.target)
    box = marked_box(question.crop)
    if is_free_area(description) or description.way is not None:
        return _nearest(points, nearest_free(see(question.crop), box), "the freest place in the box")
    fit = measure(question.target, question.crop, box, question.examples)
    if description.placed is not None:
        return _nearest(points, (fit.best or box).centre, fit.why)
    if fit.target is None:
        return _nearest(points, box.centre, f"{fit.why}; nearest to the middle of the box")
    if question.role in HOLDING:
        held = held_by(fit.target, description, see(question.crop))
        on = [number for number, point in enumerate(points, start=1) if held.holds(point)]
        return _nearest(points, held.steady_point(), f"on the material of a {fit.target.look.words}", on)
    if question.role == "push_start":
        return _push_start(question, box, points)
    middle = middle_of(fit.target, description, see(question.crop))
    return _nearest(points, middle, f"the middle of a {fit.target.look.words}")


def _push_start(question: ChoosePoint, box: Box, points: Sequence[Point]) -> PointChoice:
    """Beside the box, on the side away from where the push goes: where the arrow points, else what the plan's words say."""
    arrow = next((mark.points for mark in question.crop.marks if isinstance(mark, PathMark)), None)
    goal = arrow[-1] if arrow is not None else _goal_of_words(question)
    cx, cy = box.centre
    dx, dy = (goal[0] - cx, goal[1] - cy) if goal is not None else (1.0, 0.0)
    beside = [number for number, point in enumerate(points, start=1) if not box.contains(point)]
    best = max(
        beside or range(1, len(points) + 1), key=lambda k: -(points[k - 1][0] - cx) * dx - (points[k - 1][1] - cy) * dy
    )
    why = "away from where it goes" if goal is not None else "left of it: nothing shows where it goes"
    return PointChoice(reasoning=f"beside the box, {why}", number=best)


def _goal_of_words(question: ChoosePoint) -> Point | None:
    """Where the plan's words say that a thing is pushed, in pixels of the crop, as far as one of the pictures shows it."""
    shown = question.crop if question.whole is None else question.whole
    goal = push_goal(question.plan, question.target, eyes_of(shown, question.examples))
    return None if goal is None else question.crop.frame.point_to_picture(shown.frame.point_to_view(goal))


def _nearest(points: Sequence[Point], wanted: Point, why: str, allowed: Sequence[int] = ()) -> PointChoice:
    """The number of the point nearest to where it is wanted; of the allowed ones where there are any."""
    best = min(allowed or range(1, len(points) + 1), key=lambda k: gap_px(points[k - 1], wanted))
    return PointChoice(reasoning=f"nearest to ({wanted[0]:.0f}, {wanted[1]:.0f}): {why}", number=best)
