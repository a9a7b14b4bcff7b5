"""ReadTurn: the cut-out whose turn is nearest to the one that truth asks for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from wonderful_team.contracts import ReadTurn, TurnChoice
from wonderful_team.core.geometry import Box, Frame
from wonderful_team.core.pictures import Picture
from wonderful_team.simulated.context import Context
from wonderful_team.simulated.seeing import Seen


def answer_read_turn(context: Context, question: ReadTurn) -> TurnChoice:
    """The nearest turn, where the strip shows a true goal and the target is one that the right plan moves; else none."""
    goal = context.see(shown_part(question.strip))
    if goal is None:
        return TurnChoice(reasoning="the goal shows nothing that was ever there", number=None)
    turn = context.turn_of(question.target)
    if turn is None:
        turn = _between(context, question.target.words, goal)
    if turn is None:
        return TurnChoice(reasoning="nothing asks for it to be moved", number=None)

    def off(number: int) -> float:
        return abs(math.remainder(question.turns[number - 1] - turn, 360.0))

    best = min(range(1, len(question.turns) + 1), key=off)
    return TurnChoice(reasoning="the nearest to what is asked for", number=best)


def _between(context: Context, words: str, goal: Seen) -> float | None:
    """How far the thing of these words is turned between now and the goal [degrees clockwise], where no plan says it."""
    now = {thing.words: thing for thing in context.truth.things().values()}
    then = {thing.words: thing for thing in goal.sight.things.values()}
    if words not in now or words not in then:
        return None
    return math.degrees(now[words].yaw_rad - then[words].yaw_rad)


def shown_part(picture: Picture) -> Picture:
    """The part of a picture that shows the view of its frame, as a picture of its own."""
    valid = picture.frame.valid
    x0, y0, x1, y1 = (round(value) for value in valid.as_tuple)
    moved = picture.frame.T_view_picture @ np.array([[1.0, 0, x0], [0, 1.0, y0], [0, 0, 1.0]])
    size = (x1 - x0, y1 - y0)
    frame = Frame(picture.frame.view_id, moved, size, Box(0, 0, *size))
    return replace(picture, rgb=picture.rgb[y0:y1, x0:x1], frame=frame, depth_m=None, marks=())
