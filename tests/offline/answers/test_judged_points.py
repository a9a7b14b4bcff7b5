"""Points that go with a box, judged from pixels; and pushes that begin where an arrow says."""

from __future__ import annotations

import pytest

from tests.offline.answers.tables import ask, table
from wonderful_team.contracts import ChoosePoint, JudgeBox
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, Candidates, PathMark, PointMark
from wonderful_team.core.values import Target
from wonderful_team.images import beside_points, crop

SCENE = table(("square", "red", 80, 80, 26), ("ring", "blue", 300, 160, 52), ("star", "green", 500, 80, 36))
RING = Target("T1", "object", "blue ring", use=("pick", "place"))
RING_BOX = Box(248, 108, 353, 213)


@pytest.mark.parametrize(("x", "wrong"), [(300, ["pick"]), (340, [])], ids=["in the hole", "on the rim"])
def test_a_pick_point_has_to_lie_on_the_material(x: float, wrong: list[str]) -> None:
    shown = crop(SCENE, RING_BOX, "crop")
    at = {"pick": (x, 160.0), "place": (300.0, 160.0)}
    marks = [PointMark(shown.frame.point_to_picture(point), use) for use, point in at.items()]
    marked = shown.marked(BoxMark(shown.frame.box_to_picture(RING_BOX)), *marks)
    verdict = ask(JudgeBox(RING, marked, uses=("pick", "place")))
    assert verdict.decision == "accept", "the box is right all the same"
    assert [item.use for item in verdict.wrong_points] == wrong
    # Where no point is drawn, none is judged.
    assert ask(JudgeBox(RING, marked)).wrong_points == []


@pytest.mark.parametrize(("ahead", "side"), [((1, 0), "left"), ((-1, 0), "right"), ((0, 1), "above")])
def test_a_push_begins_opposite_to_the_arrow(ahead: tuple[int, int], side: str) -> None:
    """The words say nothing of where it goes: only the arrow does."""
    box = Box(54, 54, 106, 106)
    shown = crop(SCENE, box, "crop")
    drawn = shown.frame.box_to_picture(box)
    x, y = drawn.centre
    arrow = PathMark(((x, y), (x + 150 * ahead[0], y + 150 * ahead[1])), "on to where it goes")
    around = tuple(point for point in beside_points(drawn, 20) if shown.frame.valid.contains(point))
    target = Target("T1", "object", "red square", use=("push_start",))
    answer = ask(ChoosePoint(target, "push_start", (), shown.marked(BoxMark(drawn), arrow, Candidates(around))))
    px, py = around[answer.number - 1]
    assert {"left": px < drawn.x0, "right": px > drawn.x1, "above": py < drawn.y0}[side]
