"""Numbered points on crops: none is offered whose mark the picture's edge would cut off."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest

from tests.planning.helpers import asked, scripted
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import ChoosePoint
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.geometry import Box
from wonderful_team.core.values import Instruction, Limits, Observation, PointRole, Target, View
from wonderful_team.images.canvas import Canvas
from wonderful_team.images.draw import candidate_radius
from wonderful_team.models.client import ModelClient
from wonderful_team.planning import TeamConfig
from wonderful_team.planning.boxes import Job
from wonderful_team.planning.points import choose_points
from wonderful_team.planning.session import AgentSession

LIMITS = Limits((-1.0, -1.0, 0.0), (1.0, 1.0, 1.0))
LAST = 17
"""Number of the last point of a push's coarse round in open space: nine inside the box and eight round it."""


def questions(box: Box, role: PointRole, number: int) -> list[ChoosePoint]:
    """What is asked when this number is chosen each time (or the last one there is)."""
    view = View("top", "top", 0.0, np.full((320, 640, 3), 200, np.uint8))
    scene = SceneShown(Observation({"top": view}), Instruction("push it"), PICK_PLACE, LIMITS)

    def choose(request):  # type: ignore[no-untyped-def]
        return {"reasoning": "", "number": min(number, len(request.question.candidates.points))}

    model = scripted(ChoosePoint=choose)
    session = AgentSession(ModelClient(model), TeamConfig(), "push it")
    asyncio.run(choose_points(Job(session, scene, Target("T1", "object", "block", use=(role,)), 0, (), ()), box))
    return [request.question for request in asked(model, "ChoosePoint")]


@pytest.mark.parametrize("number", [1, 9, 12, LAST])
@pytest.mark.parametrize(
    "box", [Box(300, 150, 340, 180), Box(2, 2, 40, 30), Box(600, 290, 638, 318), Box(10, 100, 20, 220)]
)
def test_marks_are_whole_in_both_rounds(box: Box, number: int) -> None:
    rounds = questions(box, "push_start", number)
    assert [item.fine for item in rounds] == [False, True]
    for item in rounds:
        width, height = item.crop.size_px
        room = candidate_radius(Canvas.over(item.crop.rgb))
        for x, y in item.candidates.points[9:] if not item.fine else item.candidates.points:
            assert room <= x <= width - room, (item.fine, x, width)
            assert room <= y <= height - room, (item.fine, y, height)


def test_a_point_beside_the_box_is_refined_where_it_lies() -> None:
    coarse, fine = questions(Box(300, 150, 340, 180), "push_start", LAST)
    chosen = coarse.crop.frame.point_to_view(coarse.candidates.points[LAST - 1])
    refined = [fine.crop.frame.point_to_view(point) for point in fine.candidates.points]
    assert len(refined) == 9
    assert np.mean(refined, axis=0) == pytest.approx(chosen, abs=1.0)
