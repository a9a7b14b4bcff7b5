"""What is drawn of a plan: boxes, arrows, the one way of what a gripper carries, and where a thing is held that is turned."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from wonderful_team.agents.plan_drawn import gripped_ways, plan_drawn
from wonderful_team.agents.rendering import caption
from wonderful_team.agents.scene import SceneShown
from wonderful_team.core.actions import (
    ARM,
    At,
    CloseStep,
    HomeStep,
    MoveStep,
    OpenStep,
    OriginOf,
    PickPlaceStep,
    Step,
)
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import PathMark, Point, TurnMark
from wonderful_team.core.values import (
    NO_WORKSPACE,
    GroundedTarget,
    Instruction,
    NumberSource,
    Observation,
    PlannedAction,
    Target,
    View,
)

A, B, C = (100.0, 60.0), (220.0, 90.0), (40.0, 120.0)


def scene() -> SceneShown:
    view = View("top", "top", 0.0, np.full((160, 320, 3), 150, np.uint8))
    return SceneShown(Observation({"top": view}), Instruction("do it"), ARM, NO_WORKSPACE)


def done(step: Step, *points: Point) -> PlannedAction:
    return PlannedAction(step, None, tuple(NumberSource("place", "T1", point, None, "") for point in points))


def to(point: Point, height: str = "at") -> PlannedAction:
    return done(MoveStep("G1", At("T1"), height), point)  # type: ignore[arg-type]


def ways(actions: Sequence[PlannedAction]) -> list[tuple[str, tuple[Point, ...]]]:
    shown = scene()
    frame = shown.views[0].frame
    return [
        (mark.label, tuple(frame.point_to_view(point) for point in mark.points))
        for mark in gripped_ways(shown.views[0], actions)
    ]


OPEN, CLOSE, HOME = done(OpenStep("G1")), done(CloseStep("G1", False)), done(HomeStep("G1"))


def test_what_a_gripper_carries_is_one_arrow_between_the_steps_that_go_down() -> None:
    first = [OPEN, to(A, "above"), to(A), CLOSE, to(A, "clear"), to(B, "above"), to(B), OPEN, to(B, "clear")]
    assert ways(first) == [("3 to 7", (pytest.approx(A), pytest.approx(B)))]
    both = [*first, to(C, "above"), to(C), CLOSE, to(A, "above"), to(A), OPEN, HOME]
    assert [label for label, _ in ways(both)] == ["3 to 7", "11 to 14"]


def test_what_is_put_back_or_held_to_the_end_is_a_dot_where_it_is_held() -> None:
    assert ways([OPEN, to(A), CLOSE, to(A, "clear"), to(A), OPEN]) == [("2", (pytest.approx(A),))]
    assert ways([to(A), CLOSE, HOME]) == [("1", (pytest.approx(A),))]
    # A tool that is held from the start is never closed, and nothing is carried.
    assert ways([to(A), HOME]) == []
    assert ways([OPEN, CLOSE, OPEN]) == []


def test_the_drawn_plan_of_an_arm_shows_its_way_and_says_so() -> None:
    shown = plan_drawn(scene(), {}, [OPEN, to(A), CLOSE, to(B), OPEN])
    (way,) = [mark for mark in shown.marks if isinstance(mark, PathMark)]
    assert way.bowed
    assert "a path labelled 2 to 4" in caption(shown)


def test_a_thing_that_is_turned_where_it_lies_shows_where_it_is_held() -> None:
    held = Target("T1", "object", "ring", use=("pick",))
    grounded = {"T1": GroundedTarget(held, "found", "top", Box(80, 40, 120, 80), {"pick": (90.0, 45.0)}, ())}
    turned = done(PickPlaceStep("G1", "T1", OriginOf("T1"), 90.0), (90.0, 45.0), (100.0, 60.0))
    shown = plan_drawn(scene(), grounded, [turned])
    (dot,) = [mark for mark in shown.marks if isinstance(mark, PathMark)]
    assert shown.frame.point_to_view(dot.points[0]) == pytest.approx((90.0, 45.0))
    assert len(dot.points) == 1
    assert any(isinstance(mark, TurnMark) for mark in shown.marks)
    words = caption(shown)
    assert "a dot where a thing is held" in words
    assert "the box of the thing as it is turned then" in words
