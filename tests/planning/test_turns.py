"""Angles that only pictures show: read from strips, unless the pixels agree with what was stated."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest

from tests.images.test_turned import letter
from tests.planning.helpers import Tape, asked, draft, scripted, subgoal
from wonderful_team.contracts import BoxPx
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import PathMark, TurnMark
from wonderful_team.core.values import Instruction, Observation, Slot, View
from wonderful_team.planning import TeamConfig, TeamPolicy

LEAN = TeamConfig(mode="lean")
TWISTED = "Twist means to go from {before_1} to {after_1}. Twist the letter."


def pair(turn=150, text=TWISTED):
    views = {name: letter(angle, name=f"slot:{name}:top") for name, angle in (("before_1", 10), ("after_1", 10 + turn))}
    return Instruction(text, {name: Slot(name, name.split("_")[0], {"top": view}, 1) for name, view in views.items()})


def arranged(turn=150):
    view = letter(turn, at=(220.0, 100.0), name="slot:scene:top")
    return Instruction("Rearrange to this {scene}.", {"scene": Slot("scene", "scene", {"top": view})})


def plan_for(instruction, stated, config=LEAN, area=False, tape=None, **answers):
    def steps(_):
        place = {"target": "T2" if area else "T1", "how": "at" if area else "origin", "side": None}
        step = {"subgoal": "G1", "kind": "pick_place", "pick": "T1", "place": place, "rotate_deg": stated}
        return {"reasoning": "", "steps": [step]}

    def reading(request):
        view = request.question.view.frame
        boxes = {"T1": Box(128, 88, 174, 152), "T2": Box(180, 60, 260, 140)}
        points = {"T1": (138, 120), "T2": (220, 100)}
        return {
            "reasoning": "",
            "targets": [
                {
                    "id": target.id, "found": True,
                    "box": BoxPx.of(view.box_to_picture(boxes[target.id]), request.question.view).model_dump(),
                    "points": [
                        {"role": role, "point": dict(zip("xy", view.point_to_picture(points[target.id]), strict=True))}
                        for role in target.roles
                    ],
                }
                for target in request.question.targets
            ],
        }  # fmt: skip

    drafted = draft(subgoal("G1", "turn the letter"))
    if area:
        drafted["targets"][1].update(kind="area", words="place of the letter in {scene}", like=["scene"])
    model = scripted(DraftPlan=drafted, WriteSteps=steps, ReadScene=reading, **answers)
    team = TeamPolicy(model, config, subscribers=[tape] if tape else ())
    seen = Observation({"top": letter(0)})
    return asyncio.run(team.make_plan(seen, instruction, PICK_PLACE)), model


def by_sight(request):
    """What somebody answers who sees which cut-out lies 150 degrees further."""
    turns = request.question.turns
    number = min(range(len(turns)), key=lambda k: abs((turns[k] - 150 + 180) % 360 - 180)) + 1
    return {"reasoning": "", "number": number}


def turned(plan):
    return plan.steps[0].rotate_deg


def test_a_wrong_angle_is_read_anew_from_a_coarse_and_a_fine_strip():
    tape = Tape()
    plan, model = plan_for(pair(), 60, tape=tape, ReadTurn=by_sight)
    assert turned(plan) == 150
    coarse, fine = (request.question for request in asked(model, "ReadTurn"))
    assert coarse.turns == tuple(range(0, 360, 30))
    assert fine.turns == tuple(range(130, 171, 5))
    assert fine.fine
    assert len(asked(model, "ReadTurn")[0].pictures) == 1, "one picture holds the goal and all cut-outs"
    said = "T1 turned 150 degrees clockwise, as read from {before_1} and {after_1}; stated was 60 degrees clockwise"
    assert plan.grounded["T1"].history[-1].text == said
    assert said in asked(model, "ReviewSteps")[0].question.checked, "Verification knows why the step says otherwise"
    assert any(event.name == "turns" for event in tape.kinds("stage"))


def test_an_angle_that_the_pixels_agree_with_costs_no_question():
    for stated in (150, 152, -210):
        plan, model = plan_for(pair(), stated, ReadTurn=by_sight)
        assert turned(plan) == stated
        assert not asked(model, "ReadTurn")


def test_nothing_is_asked_where_no_picture_has_to_say_it():
    told = pair(text="Turn the letter by 60 degrees, {before_1} and {after_1} show how.")
    for instruction, stated, config in (
        (told, 60, LEAN),
        (Instruction("turn the letter"), 60, LEAN),
        (pair(), 0, LEAN),
        (pair(), 60, TeamConfig(mode="lean", ablation="s7")),
    ):
        plan, model = plan_for(instruction, stated, config)
        assert turned(plan) == stated
        assert not asked(model, "ReadTurn")


def test_the_papers_way_asks_the_published_questions_alone():
    needs = [{"subgoal": "G1", "targets": ["T1", "T2"]}]
    targets = draft(subgoal("G1"))["targets"]
    plan, model = plan_for(
        pair(), 60, TeamConfig(mode="paper"), ExtractTargets={"reasoning": "", "targets": targets, "needs": needs}
    )
    assert plan.status == "planned"
    assert turned(plan) == 60
    assert not asked(model, "ReadTurn")


def test_no_answer_and_a_near_one_leave_the_stated_angle():
    plan, model = plan_for(pair(), 60, ReadTurn={"reasoning": "", "number": None})
    assert turned(plan) == 60
    assert len(asked(model, "ReadTurn")) == 1
    assert "no turn of T1 lies as" in plan.grounded["T1"].history[-1].text
    # 135 is read as 135, since the model errs; 138 was stated and stands.
    near = lambda request: {"reasoning": "", "number": 2 if request.question.fine else 6}  # noqa: E731
    plan, _ = plan_for(pair(), 138, ReadTurn=near)
    assert turned(plan) == 138


def test_a_turn_that_a_scene_shows_is_read_where_the_thing_is_to_lie():
    plan, model = plan_for(arranged(), -60, area=True, ReadTurn=by_sight)
    assert turned(plan) == 150
    question = asked(model, "ReadTurn")[0].question
    assert question.shows == "T1 now and its place in {scene}"
    assert question.strip.frame.view_id == "slot:scene:top"
    assert question.strip.frame.box_to_view(question.strip.frame.valid).contains((220, 100))
    plan, model = plan_for(arranged(), 150, area=True, ReadTurn=by_sight)
    assert turned(plan) == 150
    assert not asked(model, "ReadTurn")


def test_the_drawn_plan_shows_a_turn_as_an_arc_and_the_turned_outline():
    plan, model = plan_for(pair(90), 90)
    shown = asked(model, "ReviewSteps")[0].question.overview
    (mark,) = (mark for mark in shown.marks if isinstance(mark, TurnMark))
    assert (mark.label, mark.clockwise_deg) == ("1", 90)
    box = plan.grounded["T1"].box
    ends = [shown.frame.point_to_view(corner) for corner in mark.corners]
    # A quarter about its middle: sides swapped, the top left corner at the top right.
    assert ends[0] == pytest.approx((box.centre[0] + box.height / 2, box.centre[1] - box.width / 2), abs=0.6)
    assert np.mean(ends, axis=0) == pytest.approx(box.centre, abs=0.6)
    (held,) = (mark for mark in shown.marks if isinstance(mark, PathMark))
    assert len(held.points) == 1, "no arrow for what stays where it is, a dot where it is held"
    assert shown.frame.point_to_view(held.points[0]) == pytest.approx(plan.grounded["T1"].points["pick"], abs=0.6)
    # What is carried and turned has both.
    plan, model = plan_for(arranged(90), 90, area=True)
    shown = asked(model, "ReviewSteps")[0].question.overview
    (mark,) = (mark for mark in shown.marks if isinstance(mark, TurnMark))
    assert any(isinstance(mark, PathMark) for mark in shown.marks)
    assert shown.frame.point_to_view(mark.centre) == pytest.approx((220, 100), abs=0.6)


def test_a_view_at_a_slant_is_not_measured():
    slanted = pair()
    views = {
        name: View(view.id, "top", 0.0, view.rgb, camera=_Slanted())
        for name, slot in slanted.slots.items()
        for view in slot.views.values()
    }
    instruction = Instruction(
        TWISTED, {name: Slot(name, name.split("_")[0], {"top": view}, 1) for name, view in views.items()}
    )
    plan, model = plan_for(instruction, 60)
    assert turned(plan) == 60
    assert not asked(model, "ReadTurn")


class _Slanted:
    """A camera that stretches the table."""

    def project(self, points_m):
        return np.asarray(points_m)[:, :2]

    def deproject(self, points_px, depth_m):
        return np.column_stack([points_px, depth_m])

    def on_plane(self, points_px, z_m):
        points = np.asarray(points_px, float)
        return np.column_stack([points[:, 0], -0.4 * points[:, 1], np.full(len(points), z_m)])
