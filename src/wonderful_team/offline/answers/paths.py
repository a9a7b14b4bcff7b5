"""ReviewPath: what can be checked of a drawn path by eye."""

from __future__ import annotations

import numpy as np

from wonderful_team.contracts import PathReview, ReviewPath
from wonderful_team.core.geometry import Box
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import BoxMark, PathMark, Point
from wonderful_team.offline.answers.functions import figure_of
from wonderful_team.offline.description import Figure
from wonderful_team.offline.eyes import eyes_of
from wonderful_team.offline.language import try_understand
from wonderful_team.offline.language.vocabulary import FIGURES

COVERED, CLOSED, CORNER_DEG = 0.5, 0.05, 25.0
"""A surface is led over along at least this share of its sides; ends nearer than this share of a figure meet; a clear turn [degrees]."""
OPEN = ("line", "zigzag", "spiral")
"""Figures that do not end where they begin."""
NEAR = 1.6
"""A path reaches a thing when its end lies in the thing's box, grown by this factor."""


def answer_review_path(question: ReviewPath) -> PathReview:
    """The path must lie in the picture, have a length, and be the figure that the subgoal names, or join what it names."""
    paths = [mark for mark in question.view.marks if isinstance(mark, PathMark)]
    problem = _problem(question, paths[-1].points if paths else ())
    if problem:
        return PathReview(reasoning=problem, accepted=False, problem=problem)
    return PathReview(
        reasoning=f"The path of {len(paths[-1].points)} points lies in the picture and does what the subgoal says.",
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
    figure = figure_of(question.subgoal)
    thing, place = _boxes(question)
    if figure is not None:
        return _misdrawn(figure, points, question.up_m, thing)
    if thing is not None and place is not None and not place.scaled(NEAR).contains(points[-1]):
        return f"the path ends at ({points[-1][0]:.0f}, {points[-1][1]:.0f}), away from where the subgoal leads"
    ends = [box for box in (thing, place) if box is not None]
    if ends and not any(box.scaled(NEAR).contains(point) for box in ends for point in (points[0], points[-1])):
        return "the path neither begins nor ends at what the subgoal names"
    return ""


def _misdrawn(figure: Figure, points: tuple[Point, ...], up_m: tuple[float, ...], box: Box | None) -> str:
    """What is wrong with a path that should be this figure, on what lies in a box; "" when nothing is."""
    off = [number for number, point in enumerate(points, start=1) if box is not None and not box.contains(point)]
    if off:
        return f"point {off[0]} of the path lies beside what it should lie on"
    if figure.name == "shake":
        turns = sum((b - a) * (c - b) < 0 for a, b, c in zip(up_m, up_m[1:], up_m[2:], strict=False))
        return (
            "" if turns + 1 >= 2 * max(figure.count, 2) else f"it goes up and down too seldom: it turns {turns} times"
        )
    path = np.array(points)
    if figure.name == "area":
        small = box is not None and (np.ptp(path, axis=0) < COVERED * np.array([box.width, box.height])).any()
        return "the path leaves a good part of the surface out" if small else ""
    size = float(np.ptp(path, axis=0).max())
    if figure.name not in OPEN and np.hypot(*(path[-1] - path[0])) > CLOSED * size:
        return "the figure is not closed"
    wanted = figure.count or FIGURES[figure.name]
    found = _corners(path)
    if wanted and found not in ((wanted, 2 * wanted) if figure.name == "star" else (wanted,)):
        return f"the figure has {found} corners; a {figure.name} with {wanted} is asked for"
    return ""


def _corners(path: Array) -> int:
    """How often a closed path changes its direction clearly."""
    edges = np.diff(path, axis=0)
    edges = edges[np.hypot(*edges.T) > 1e-6]
    headings = np.arctan2(edges[:, 1], edges[:, 0])
    turns = np.degrees(np.angle(np.exp(1j * np.diff(np.append(headings, headings[0])))))
    return int((np.abs(turns) > CORNER_DEG).sum())


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
