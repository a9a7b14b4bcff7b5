"""Pushes into a frame past a line, on drawn tables: who, whither, over which stops, and what came of it."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.offline.answers.tables import COLOURS, ask, picture, table
from wonderful_team.contracts import (
    DraftPlan,
    JudgeOutcome,
    Outcome,
    PlanDraft,
    PlanReview,
    ReadScene,
    ReviewPlan,
    ReviewSteps,
    SceneReading,
    ShownTask,
    StepList,
    WalkedReview,
    WriteSteps,
)
from wonderful_team.core.actions import At, PushStep
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.pictures import Point
from wonderful_team.core.values import View

FRAME = (470, 60, 590, 260)
"""A frame that is open to the left: left end of its arms, top, right, bottom [px]."""
WALL = 12
SIDE = 18
Block = tuple[str, int, int]
AT_MOUTH = (466, 160 - 52, 472, 160 + 52)
INSIDE = (535, 160 - 56, 541, 160 + 56)
PUSH = ("push",)


def drawn(*blocks: Block, line: tuple[int, int, int, int] | None = None, mirrored: bool = False) -> View:
    rgb = np.array(table().rgb)
    x0, y0, x1, y1 = FRAME
    for a, b in (((x0, y0), (x1, y0 + WALL)), ((x0, y1 - WALL), (x1, y1)), ((x1 - WALL, y0), (x1, y1))):
        cv2.rectangle(rgb, a, b, COLOURS["green"], -1)
    if line is not None:
        cv2.rectangle(rgb, line[:2], line[2:], COLOURS["purple"], -1)
    for colour, x, y in blocks:
        corners = cv2.boxPoints(((x, y), (SIDE, SIDE), (7 * x + 3 * y) % 90))
        cv2.fillPoly(rgb, [corners.astype(np.int32)], COLOURS[colour], cv2.LINE_AA)
    return View("top", "top", 0.0, np.ascontiguousarray(rgb[:, ::-1]) if mirrored else rgb)


def shown(text: str, view: View) -> ShownTask:
    return ShownTask(text, (picture(view),), ())


def plan_of(text: str, view: View) -> PlanDraft:
    answer = ask(DraftPlan(shown(text, view), PUSH, True, ()))
    assert isinstance(answer, PlanDraft)
    return answer


def places(text: str, view: View) -> list[list[Point]]:
    """For each subgoal, where its thing rests, push after push [px]."""
    plan = plan_of(text, view)
    lines = tuple(f"{subgoal.id}: {subgoal.text}" for subgoal in plan.subgoals)
    reading = ask(ReadScene(plan_targets(plan), lines, picture(view), (), ()))
    assert isinstance(reading, SceneReading)
    found = {item.id: item for item in reading.targets}
    out = []
    for subgoal in plan.subgoals:
        areas = [name for name in subgoal.targets if "free area" in words_of(plan, name)]
        assert all(found[name].found for name in areas), reading.reasoning
        out.append([found[name].points[0].point.as_tuple for name in areas])
    return out


def plan_targets(plan: PlanDraft) -> tuple:  # type: ignore[type-arg]
    return tuple(target.to_target() for target in plan.targets)


def words_of(plan: PlanDraft, name: str) -> str:
    return next(target.words for target in plan.targets if target.id == name)


TOUCH = "Sweep {} red block{} into the green frame without touching the purple line."
EXCEED = "Sweep {} red block{} into the green frame without exceeding the purple line."
REDS: tuple[Block, ...] = (("red", 250, 90), ("red", 200, 230), ("red", 320, 180))
BLUE: Block = ("blue", 330, 60)


def lane_meets(points: list[Point], line: tuple[int, int, int, int]) -> bool:
    """Whether a block that moves straight from point to point touches the line on its way."""
    half = SIDE / 2
    for (xa, ya), (xb, yb) in zip(points[:-1], points[1:], strict=True):
        for share in np.linspace(0, 1, 200):
            x, y = xa + share * (xb - xa), ya + share * (yb - ya)
            if line[0] - half < x < line[2] + half and line[1] - half < y < line[3] + half:
                return True
    return False


@pytest.mark.parametrize(("count", "number"), [("one", 1), ("any", 1), ("two", 2), ("all", 3)])
def test_exactly_so_many_are_pushed(count: str, number: int) -> None:
    view = drawn(*REDS, BLUE, line=INSIDE)
    plan = plan_of(EXCEED.format(count, "s" if number > 1 else ""), view)
    texts = [subgoal.text for subgoal in plan.subgoals]
    assert len(texts) == number
    assert len(set(texts)) == number
    assert all("red" in text and "without exceeding the purple" in text for text in texts)


def test_those_that_lie_there_already_count() -> None:
    view = drawn(*REDS[:2], ("red", 500, 150), line=INSIDE)
    assert len(plan_of(EXCEED.format("two", "s"), view).subgoals) == 1
    done = plan_of(EXCEED.format("one", ""), view)
    assert done.subgoals == []
    assert "already" in done.reasoning


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_line_inside_is_not_exceeded(mirrored: bool) -> None:
    view = drawn(*REDS, BLUE, line=INSIDE, mirrored=mirrored)
    for stops in places(EXCEED.format("all", "s"), view):
        x, y = stops[-1]
        x = 640 - x if mirrored else x
        assert FRAME[0] + SIDE / 2 < x < INSIDE[0] - SIDE / 2
        assert FRAME[1] + WALL + SIDE / 2 < y < FRAME[3] - WALL - SIDE / 2


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("block", [("red", 250, 160), ("red", 330, 120), ("red", 200, 230)])
def test_a_line_across_the_opening_is_passed_at_its_side(block: Block, mirrored: bool) -> None:
    view = drawn(block, line=AT_MOUTH, mirrored=mirrored)
    (stops,) = places(TOUCH.format("one", ""), view)
    start = (float(block[1]), float(block[2]))
    points = [start, *((640 - x, y) if mirrored else (x, y) for x, y in stops)]
    assert not lane_meets(points, AT_MOUTH)
    x, y = points[-1]
    assert FRAME[0] + SIDE / 2 < x < FRAME[2] - WALL
    assert FRAME[1] + WALL < y < FRAME[3] - WALL


def test_what_bars_every_way_is_pushed_aside_first() -> None:
    wall = [("blue", 300, y) for y in range(30, 300, 32)]
    plan = plan_of(EXCEED.format("one", ""), drawn(("red", 240, 160), *wall, line=INSIDE))
    assert "blue" in plan.subgoals[0].text
    assert "free area" in plan.subgoals[0].text
    assert "red" in plan.subgoals[1].text


def test_no_plan_where_the_line_does_not_show() -> None:
    view = drawn(*REDS[:1])
    plan = plan_of(TOUCH.format("one", ""), view)
    assert plan.subgoals == []
    assert plan.clarification is not None
    assert "is in the picture" in plan.clarification.question


def test_plan_and_steps_are_written_and_pass_their_own_checks() -> None:
    view = drawn(*REDS, BLUE, line=AT_MOUTH)
    text = TOUCH.format("two", "s")
    plan = plan_of(text, view)
    task, subgoals, targets = shown(text, view), plan.to_subgoals(), plan_targets(plan)
    review = ask(ReviewPlan(task, PUSH, subgoals, targets))
    assert isinstance(review, WalkedReview)
    assert review.approved, review.doubt
    question = WriteSteps(task, PUSH, subgoals, targets)
    steps = ask(question)
    assert isinstance(steps, StepList)
    written = steps.to_steps()
    areas = [name for subgoal in subgoals for name in subgoal.targets if "free area" in words_of(plan, name)]
    assert [step.end.target for step in written if isinstance(step, PushStep)] == areas
    assert all(isinstance(step, PushStep) and isinstance(step.start, At) for step in written)
    checked = ask(ReviewSteps(task, subgoals, targets, written, picture(view), ()))
    assert isinstance(checked, PlanReview)
    assert checked.approved, checked.doubt


def test_another_block_that_would_do_as_well_is_no_mistake() -> None:
    view = drawn(*REDS, line=INSIDE)
    text = EXCEED.format("one", "")
    plan = plan_of(text, view)
    chosen = plan.subgoals[0].text
    for other in ("leftmost red block", "rightmost red block"):
        if other in chosen:
            continue
        told = f"push the {other} into the green frame without exceeding the purple line"
        subgoals = tuple(
            subgoal.model_copy(update={"text": told, "targets": []}).to_subgoal() for subgoal in plan.subgoals
        )
        review = ask(ReviewPlan(shown(text, view), PUSH, subgoals, ()))
        assert isinstance(review, WalkedReview)
        assert review.approved, review.doubt


def verdicts(text: str, before: View, after: View) -> list[str]:
    plan = plan_of(text, before)
    answer = ask(JudgeOutcome(shown(text, before), plan.to_subgoals(), plan_targets(plan), (), (picture(after),), ()))
    assert isinstance(answer, Outcome)
    return [item.status for item in answer.verdicts]


@pytest.mark.parametrize(
    ("end", "status"),
    [((505, 150), "done"), ((250, 90), "not_done"), ((470, 150), "not_done"), ((400, 150), "not_done"),
     ((552, 150), "not_done")],
)  # fmt: skip
def test_only_what_lies_wholly_in_the_zone_is_done(end: tuple[int, int], status: str) -> None:
    before = drawn(REDS[0], line=INSIDE)
    assert verdicts(EXCEED.format("one", ""), before, drawn(("red", *end), line=INSIDE)) == [status]


def test_each_of_two_alike_is_judged_once() -> None:
    before = drawn(*REDS[:2], line=INSIDE)
    one_in = drawn(("red", 505, 150), REDS[1], line=INSIDE)
    found = verdicts(EXCEED.format("two", "s"), before, one_in)
    assert sorted(found) == ["done", "not_done"]
    both = drawn(("red", 505, 150), ("red", 505, 200), line=INSIDE)
    assert verdicts(EXCEED.format("two", "s"), before, both) == ["done", "done"]


def noised(view: View) -> View:
    rgb: Array = np.random.default_rng(1).integers(0, 255, view.rgb.shape).astype(np.uint8)
    return View(view.id, view.camera_name, 0.0, rgb)


def test_no_place_on_a_way_is_found_in_noise() -> None:
    plan = plan_of(TOUCH.format("one", ""), drawn(REDS[0], line=AT_MOUTH))
    lines = tuple(f"{subgoal.id}: {subgoal.text}" for subgoal in plan.subgoals)
    reading = ask(ReadScene(plan_targets(plan), lines, picture(noised(drawn())), (), ()))
    assert isinstance(reading, SceneReading)
    assert not any(item.found for item in reading.targets)


THIN = (469, 160 - 52, 471, 160 + 52)
"""A line across the opening that is thinner than a lane is wide by far."""


@pytest.mark.parametrize(("x", "y"), [(250, 105), (310, 105), (310, 215), (250, 245)])
def test_the_end_of_a_thin_line_is_not_passed_over(x: int, y: int) -> None:
    (stops,) = places(TOUCH.format("one", ""), drawn(("red", x, y), line=THIN))
    assert not lane_meets([(float(x), float(y)), *stops], THIN)


@pytest.mark.parametrize("blocks", [((180, 140), (419, 92)), ((240, 160), (420, 102)), ((240, 185), (443, 228))])
def test_nothing_is_to_rest_where_another_stands_in_the_picture(blocks: tuple[tuple[int, int], ...]) -> None:
    view = drawn(*(("red", x, y) for x, y in blocks), line=AT_MOUTH)
    stops = [stop for way in places(TOUCH.format("two", "s"), view) for stop in way]
    assert len(stops) >= len(blocks)
    assert all(np.hypot(stop[0] - x, stop[1] - y) > SIDE / np.sqrt(2) for stop in stops for x, y in blocks)


def pushes_of(block: Block, line: tuple[int, int, int, int]) -> list[Array]:
    """Where a block's middle is before the first and after every push [px]."""
    (stops,) = places(TOUCH.format("one", ""), drawn(block, line=line))
    return [np.array(block[1:], float), *map(np.array, stops)]


def clearance(start: Array, end: Array, line: tuple[int, int, int, int]) -> float:
    """Least distance of a block's middle from a line, in sides of the block."""
    points = start + np.linspace(0, 1, 400)[:, None] * (end - start)
    beyond = np.maximum(np.maximum(np.array(line[:2]) - points, points - np.array(line[2:])), 0)
    return float(np.hypot(*beyond.T).min()) / SIDE


@pytest.mark.parametrize(("x", "y"), [(423, 225), (410, 228)])
def test_a_block_on_its_corner_is_not_taken_for_square_after_a_short_push(x: int, y: int) -> None:
    line = (466, 160 - 56, 472, 160 + 56)
    start, stop, *_, end = pushes_of(("red", x, y), line)
    way = stop - start
    turned = np.degrees(np.arctan2(way[1], way[0])) - (7 * x + 3 * y) % 90
    on_corner = abs((turned + 45) % 90 - 45) > 36
    assert not on_corner or np.hypot(*way) / SIDE > 3 or clearance(stop, end, line) > 0.75


@pytest.mark.parametrize(("x", "y"), [(200, 144), (240, 186), (260, 144), (220, 144)])
def test_a_block_that_was_pushed_before_may_lie_aside_of_its_stop(x: int, y: int) -> None:
    *_, stop, end = pushes_of(("red", x, y), AT_MOUTH)
    assert clearance(stop, end, AT_MOUTH) > 0.5 + 0.3
