"""ReviewPath: what can be checked of a drawn path by eye."""

from __future__ import annotations

from wonderful_team.contracts import PathReview, ReviewPath
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, PathMark, Point
from wonderful_team.offline.eyes import eyes_of
from wonderful_team.offline.language import try_understand

NEAR = 1.6
"""A path reaches a thing when its end lies in the thing's box, grown by this factor."""


def answer_review_path(question: ReviewPath) -> PathReview:
    """The path must lie in the picture, have a length, and begin and end at what the subgoal names."""
    paths = [mark for mark in question.view.marks if isinstance(mark, PathMark)]
    problem = _problem(question, paths[-1].points if paths else ())
    if problem:
        return PathReview(reasoning=problem, accepted=False, problem=problem)
    return PathReview(
        reasoning=f"The path of {len(paths[-1].points)} points lies in the picture and joins what the subgoal names.",
        accepted=True,
        problem="",
    )


def _problem(question: ReviewPath, points: tuple[Point, ...]) -> str:
    if len(points) < 2:
        return f"the path has {len(points)} points; it needs at least 2"
    valid = question.view.frame.valid
    outside = [number for number, point in enumerate(points, start=1) if not valid.contains(point)]
    if outside:
        return f"point {outside[0]} of the path lies outside the picture"
    if not any(question.up_m) and all(abs(x - points[0][0]) + abs(y - points[0][1]) < 2 for x, y in points):
        return "all points of the path are the same place"
    thing, place = _boxes(question)
    if thing is not None and place is not None and not place.scaled(NEAR).contains(points[-1]):
        return f"the path ends at ({points[-1][0]:.0f}, {points[-1][1]:.0f}), away from where the subgoal leads"
    ends = [box for box in (thing, place) if box is not None]
    if ends and not any(box.scaled(NEAR).contains(point) for box in ends for point in (points[0], points[-1])):
        return "the path neither begins nor ends at what the subgoal names"
    return ""


def _boxes(question: ReviewPath) -> tuple[Box | None, Box | None]:
    """Boxes of the thing and the place that the subgoal names, by the drawn labels, else by sight."""
    drawn = {
        mark.label.split()[0]: mark.box for mark in question.view.marks if isinstance(mark, BoxMark) and mark.label
    }
    named = [drawn[name] for name in question.subgoal.targets if name in drawn]
    if named:
        return named[0], named[1] if len(named) > 1 else None
    understood = try_understand(question.subgoal.text)
    if understood is None or not understood.commands:
        return None, None
    command = understood.commands[0]
    eyes = eyes_of(question.view, ())
    thing = eyes.best(command.thing)
    place = eyes.best(command.to.what) if command.to is not None and command.to.what is not None else None
    return thing.box if thing else None, place.box if place else None
