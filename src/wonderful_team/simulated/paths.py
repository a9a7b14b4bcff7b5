"""WriteFunction and ReviewPath: the path that truth asks for, as a program of the box that it lies in."""

from __future__ import annotations

import math

import numpy as np

from wonderful_team.contracts import FunctionCode, PathReview, ReviewPath, WriteFunction
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import PathMark, Picture
from wonderful_team.core.values import Subgoal
from wonderful_team.errors import UnsupportedQuestion
from wonderful_team.simulated.context import Context
from wonderful_team.simulated.plan import Trace

OFF_SHARE = 0.04
"""How far a point of a path may lie from where it should, as a share of the path's extent."""
LEAST_OFF_PX, OFF_UP_M = 4.0, 0.01
"""It may always lie this far off [px of the picture], and this much too high or low [m]."""


def answer_write_function(context: Context, question: WriteFunction) -> FunctionCode:
    """An earlier function that was asked for in the same words; else the points as shares of the target's box, so that another box
    gives the same shape there.

    Raises:
        UnsupportedQuestion: The path is another's, or its picture shows nothing that is true, or no box was found.
    """
    path, trace = _path(context, question.subgoal, question.view, "WriteFunction")
    if not question.boxes:
        raise UnsupportedQuestion(context.name, "WriteFunction", f"no box of the {trace.thing} was given")
    again = _same_again(question)
    if again is not None:
        return again
    name, box = next(iter(question.boxes.items()))
    shares = (path - np.array([box.x0, box.y0])) / np.array([box.width, box.height])
    rows = shares.tolist() if not trace.up_m else np.column_stack([shares, trace.up_m]).tolist()
    points = ", ".join(f"({', '.join(f'{value:.4f}' for value in row)})" for row in rows)
    up = ", up" if trace.up_m else ""
    code = (
        f"def path(boxes):\n    x0, y0, x1, y1 = boxes[{name!r}]\n    shares = [{points}]\n"
        f"    return [(x0 + a * (x1 - x0), y0 + b * (y1 - y0){up}) for a, b{up} in shares]\n"
    )
    return FunctionCode(reasoning=f"{len(path)} points, as shares of the box of {name}.", code=code)


def _same_again(question: WriteFunction) -> FunctionCode | None:
    """A call of the earlier function that had this purpose; None without one, and once a call of it was refused."""
    for one in question.earlier if not question.error else ():
        if one.purpose == question.subgoal.function and len(one.takes) == len(question.boxes):
            given = ", ".join(f"{old!r}: boxes[{new!r}]" for old, new in zip(one.takes, question.boxes, strict=True))
            code = f"def path(boxes):\n    return {one.name}({{{given}}})\n"
            return FunctionCode(reasoning=f"{one.name} computes just that.", code=code)
    return None


def answer_review_path(context: Context, question: ReviewPath) -> PathReview:
    """Accept a path whose every point lies where truth has one, in that order.

    Raises:
        UnsupportedQuestion: As for the function.
    """
    right, trace = _path(context, question.subgoal, question.view, "ReviewPath")
    drawn = [mark for mark in question.view.marks if isinstance(mark, PathMark)]
    points = np.array(drawn[-1].points if drawn else (), dtype=np.float64).reshape(-1, 2)
    limit = max(LEAST_OFF_PX, OFF_SHARE * float(np.ptp(right, axis=0).max()))
    if len(points) != len(right):
        problem = f"the path has {len(points)} points and should have {len(right)}"
    elif len(question.up_m) != len(trace.up_m):
        problem = f"{len(question.up_m)} of its points say how far up they are, and {len(trace.up_m)} should"
    elif any(abs(up - wanted) > OFF_UP_M for up, wanted in zip(question.up_m, trace.up_m, strict=True)):
        problem = f"its points should lie {', '.join(f'{up:.2f}' for up in trace.up_m)} m up"
    else:
        off = float(np.hypot(*(points - right).T).max())
        problem = (
            "" if off <= limit else f"a point of the path lies {off:.0f} px from where it should (limit {limit:.0f} px)"
        )
    return PathReview(reasoning=problem or "Every point lies where it should.", accepted=not problem, problem=problem)


def _path(context: Context, subgoal: Subgoal, picture: Picture, contract: str) -> tuple[Array, Trace]:
    """The points of the path in pixels of a picture, shape (N, 2)."""
    seen = context.see(picture)
    camera = None if seen is None else seen.sight.view.camera
    if seen is None or camera is None:
        raise UnsupportedQuestion(context.name, contract, "the picture shows nothing that was ever there")
    # A plan with a mistake that was corrected is the right one from then on.
    trace = next((plan.paths[subgoal.text] for plan in context.plans(seen) if subgoal.text in plan.paths), None)
    if trace is None:
        raise UnsupportedQuestion(context.name, contract, "it writes and judges paths of its own plan only")
    thing = seen.thing(trace.thing)
    height = 0.0 if thing is None or not math.isfinite(thing.height_m) else thing.height_m
    metres = np.column_stack([np.array(trace.path_m), np.full(len(trace.path_m), height)])
    view_px = camera.project(metres)
    return np.array([picture.frame.point_to_picture((float(x), float(y))) for x, y in view_px]), trace
