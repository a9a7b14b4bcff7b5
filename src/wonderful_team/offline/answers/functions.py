"""WriteFunction: the path that a subgoal's words ask for, as a program of the box of the thing that it lies on."""

from __future__ import annotations

from wonderful_team.contracts import FunctionCode, WriteFunction
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import Picture
from wonderful_team.core.values import Subgoal
from wonderful_team.errors import UnsupportedQuestion
from wonderful_team.offline.description import Figure
from wonderful_team.offline.eyes import eyes_of
from wonderful_team.offline.language import try_understand
from wonderful_team.offline.language.vocabulary import FIGURES
from wonderful_team.offline.vision.kinds import is_round

REACH = 0.65
"""How far a figure reaches from the middle of what it is drawn on, as a share of half its shorter side: it fits however that is turned."""
UP_M, LEAST_UP_M, TIMES = 0.08, 0.05, 4
"""How far a thing is lifted when it is shaken, at least [m], and how often where nothing is said."""
_FIGURES = {
    "star": "star((x, y), reach, {n})",
    "square": "polygon((x, y), reach, 4, 45.0)",
    "rectangle": "[(x - reach, y - 0.6 * reach), (x + reach, y - 0.6 * reach), (x + reach, y + 0.6 * reach), (x - reach, y + 0.6 * reach), (x - reach, y - 0.6 * reach)]",
    "circle": "circle((x, y), reach, 20)",
    "spiral": "spiral((x, y), reach, 2.0, 20)",
    "line": "[(x - reach, y), (x + reach, y)]",
    "zigzag": "[(x - reach + reach * k / 3, y + (0.4 if k % 2 else -0.4) * reach) for k in range(7)]",
}
"""How each figure is written; all others are regular polygons."""
_POLYGON = "polygon((x, y), reach, {n})"
_RASTER = "    return raster(boxes[{name!r}], 8, 0.12 * min(x1 - x0, y1 - y0))\n"
"""Lanes over a thing with corners."""
_ROUND = """    points = []
    for lane in range(8):
        share = 0.7 * (2 * lane / 7 - 1)
        half = (0.75 * 0.75 - share * share) ** 0.5
        ends = [(x - half * (x1 - x0) / 2, y + share * (y1 - y0) / 2), (x + half * (x1 - x0) / 2, y + share * (y1 - y0) / 2)]
        points += ends if lane % 2 == 0 else [ends[1], ends[0]]
    return points
"""
"""Lanes over a round thing, as long as it is wide there; its rim keeps the tool's half."""


def answer_write_function(question: WriteFunction) -> FunctionCode:
    """The code for the one figure that the words name.

    Raises:
        UnsupportedQuestion: They name none, no box was found, or there is no room for shaking.
    """
    figure = figure_of(question.subgoal)
    if figure is None or not question.boxes:
        why = (
            "no box of what it lies on was given"
            if figure is not None
            else f"it reads no path in {question.subgoal.text!r}"
        )
        raise UnsupportedQuestion("offline", "WriteFunction", why)
    name, box = next(iter(question.boxes.items()))
    head = f"def path(boxes):\n    x0, y0, x1, y1 = boxes[{name!r}]\n    x, y = (x0 + x1) / 2, (y0 + y1) / 2\n"
    if figure.name == "shake":
        body = _shake(figure, question.most_up_m)
    elif figure.name == "area":
        body = _ROUND if _shows_round(question.view, box) else _RASTER.format(name=name)
    else:
        reach = f"    reach = {REACH * figure.size:.3g} * min(x1 - x0, y1 - y0) / 2\n"
        call = _FIGURES.get(figure.name, _POLYGON).format(n=figure.count or FIGURES[figure.name])
        body = f"{reach}    return {call}\n"
    return FunctionCode(reasoning=f"{figure.name}, in shares of the box of {name}.", code=head + body)


def figure_of(subgoal: Subgoal) -> Figure | None:
    """What a subgoal's words say is led along; None where they cannot be read or say nothing of it."""
    understood = try_understand(subgoal.text)
    found = [command.figure for command in understood.commands if command.figure] if understood is not None else []
    return found[0] if len(found) == 1 else None


def _shake(figure: Figure, most_up_m: float) -> str:
    if most_up_m < LEAST_UP_M:
        why = f"there is room for {most_up_m:.3f} m of lifting; shaking takes {LEAST_UP_M:.2f} m"
        raise UnsupportedQuestion("offline", "WriteFunction", why)
    return f"    return shake((x, y), {min(UP_M, most_up_m):.3f}, {figure.count or TIMES})\n"


def _shows_round(picture: Picture, box: Box) -> bool:
    """Whether the thing in a box is round, as seen."""
    things = eyes_of(picture, ()).scene.things
    best = max(things, key=lambda thing: thing.box.iou(box), default=None)
    return best is not None and is_round(best)
