"""What the Checker is shown: the points, how exact is exact enough, and what tells one look-alike from another."""

from __future__ import annotations

import numpy as np
import pytest

from tests.planning.helpers import asked, draft, plan_with, scripted, subgoal
from tests.planning.rounds import photo
from tests.planning.stub_model import stub_model
from tests.planning.test_doubted_targets import of_target, verdict
from wonderful_team.agents import build_request
from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts import JudgeBox, JudgeBoxes, Tolerance
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.geometry import Box
from wonderful_team.core.pictures import BoxMark, PointMark
from wonderful_team.core.values import NO_WORKSPACE, Instruction, Slot, Target, View, Words
from wonderful_team.images import crop, line_width_px
from wonderful_team.models.client import ModelClient
from wonderful_team.planning import TeamConfig
from wonderful_team.planning.grounding import make_jobs
from wonderful_team.planning.judged import judge_box
from wonderful_team.planning.session import AgentSession

LEAN = TeamConfig(mode="lean")


def said(question):
    parts = build_request(question, id="q", stage="ground").parts
    return "\n".join(part.text for part in parts if isinstance(part, Words))


def job_of(target, instruction=None):
    scene = SceneShown(photo(), instruction or Instruction("put it there"), PICK_PLACE, NO_WORKSPACE)
    session = AgentSession(ModelClient(stub_model()), LEAN, "put it there")
    return make_jobs(session, scene, [target], ())[0]


def test_the_crop_shows_the_points_that_were_chosen_with_the_box():
    model = scripted()
    plan = plan_with(model, LEAN)
    for request in asked(model, "JudgeBox"):
        question, grounded = request.question, plan.grounded[request.question.target.id]
        points = {mark.label: mark.point for mark in question.crop.marks if isinstance(mark, PointMark)}
        assert set(points) == {use.replace("_", " ") for use in question.uses} == set(grounded.points)
        for use, point in points.items():
            assert question.crop.frame.point_to_view(point) == pytest.approx(grounded.points[use])
        assert f"Points drawn, by their use: {', '.join(question.uses)}." in said(question)
    # In the paper's way points are chosen after the box: none is drawn and none can be called wrong.
    paper = scripted(JudgeBox=[verdict(pick="hole"), verdict()])
    assert plan_with(paper, TeamConfig(mode="paper")).status == "planned"
    assert all(request.question.uses == () for request in asked(paper, "JudgeBox"))
    assert "unknown use of a point on the crop 'pick'" in "".join(r.feedback for r in asked(paper, "JudgeBox"))


def test_a_point_far_from_the_box_leaves_the_crop_as_it_is():
    job = job_of(Target("T1", "object", "block", use=("push_start", "push_end")))
    box = Box(150, 200, 190, 240)
    near = judge_box(job, box, {"push_start": (140, 220)})
    far = judge_box(job, box, {"push_start": (140, 220), "push_end": (600, 220)})
    assert far.uses == ("push_start",)
    assert far.crop.size_px == near.crop.size_px


@pytest.mark.parametrize(
    ("box", "inward", "outward"), [(Box(100, 100, 140, 180), 2.0, 4.0), (Box(100, 100, 110, 180), 1.5, 2.5)]
)
def test_how_exact_a_box_has_to_be_is_said_in_pixels_of_the_crop(box, inward, outward):
    shown = crop(photo().main, box, "crop")
    marked = shown.marked(BoxMark(shown.frame.box_to_picture(box)))
    tolerance, scale = Tolerance.on(marked), shown.frame.scale
    assert (tolerance.inward_px, tolerance.outward_px) == (round(inward * scale), round(outward * scale))
    words = said(JudgeBox(Target("T1", "object", "block"), marked))
    assert f"the box's whole line is {line_width_px(marked)} px wide" in words
    assert f"at most {tolerance.inward_px} px of the target" in words
    assert f"at most {tolerance.outward_px} px away from it" in words


def test_one_of_several_look_alikes_comes_with_the_whole_view():
    box = Box(150, 200, 230, 280)
    plain = judge_box(job_of(Target("T1", "object", "red block")), box, {})
    assert plain.whole is None
    question = judge_box(job_of(Target("T1", "object", "red block", where="the left one")), box, {})
    (mark,) = question.whole.marks
    assert question.whole.frame.box_to_view(mark.box).as_tuple == pytest.approx(box.as_tuple)
    assert question.whole.frame.box_to_view(question.whole.frame.whole_box).as_tuple == pytest.approx((0, 0, 640, 480))
    assert max(question.whole.size_px) <= 640


def test_an_accepted_look_alike_is_the_example_of_a_worded_target():
    two = draft(subgoal("G1"))
    for target, where in zip(two["targets"], ("the left one", "the right one"), strict=True):
        target.update(words="red block", where=where)
    model = scripted(DraftPlan=two, JudgeBox=of_target("T1", [verdict("reject", "Another one."), verdict()], verdict()))
    plan = plan_with(model, LEAN)
    first, again = [r.question for r in asked(model, "JudgeBox") if r.question.target.id == "T1"]
    assert first.alike is None, "nothing was accepted yet: no example is better than one that nobody checked"
    shown = again.alike.frame.box_to_view(again.alike.frame.whole_box)
    accepted = plan.grounded["T2"].box
    assert shown.x0 <= accepted.x0
    assert shown.y1 >= accepted.y1
    assert "another thing of the same description, whose box was accepted" in said(again)
    # Other words: no look-alike.
    model = scripted(JudgeBox=of_target("T1", [verdict("reject", "Another one."), verdict()], verdict()))
    plan_with(model, LEAN)
    assert all(request.question.alike is None for request in asked(model, "JudgeBox"))


def arranged(size=(640, 480), kind="scene"):
    rgb = np.full((size[1], size[0], 3), 90, np.uint8)
    rgb[200:280, 400:480] = (190, 60, 50)
    view = View("slot:goal:photo", "photo", 0.0, rgb)
    return Instruction("arrange it like {goal}", {"goal": Slot("goal", kind, {"photo": view})})


def test_a_place_that_a_scene_defines_comes_with_the_same_crop_of_that_scene():
    box = Box(400, 200, 480, 280)
    target = Target("T1", "area", "place of the block in {goal}", source="slot", like=("goal",), use=("place",))
    question = judge_box(job_of(target, arranged()), box, {"place": (440, 240)})
    assert question.goal.size_px == question.crop.size_px
    assert np.array_equal(question.goal.frame.T_view_picture, question.crop.frame.T_view_picture)
    boxes = [next(m.box for m in p.marks if isinstance(m, BoxMark)) for p in (question.crop, question.goal)]
    assert boxes[0] == boxes[1]
    x, y = (round(value) for value in question.goal.frame.point_to_picture((440, 240)))
    assert tuple(question.goal.rgb[y, x]) == (190, 60, 50), "what the scene shows there"
    # A picture of one thing, a scene of another size and an object of the scene have no such crop.
    assert judge_box(job_of(target, arranged(kind="object")), box, {}).goal is None
    assert judge_box(job_of(target, arranged(size=(320, 240 + 40))), Box(40, 20, 80, 60), {}).goal is None
    thing = Target("T1", "object", "block", source="slot", like=("goal",))
    assert judge_box(job_of(thing, arranged()), box, {}).goal is None


def test_of_a_scene_whose_part_is_shown_nothing_else_is_sent_and_the_point_stands_on_it_too():
    box, seen = Box(400, 200, 480, 280), arranged()
    there = Target("T1", "area", "place of the block in {goal}", source="slot", like=("goal",), use=("place",))
    question = judge_box(job_of(there, seen), box, {"place": (440, 240)})
    points = [[mark for mark in shown.marks if isinstance(mark, PointMark)] for shown in (question.crop, question.goal)]
    assert points[0] == points[1] != []
    request = build_request(question, id="q", stage="ground")
    assert [picture.name for picture in request.pictures] == [question.goal.name, question.crop.name]
    both = build_request(JudgeBoxes((question,)), id="q", stage="ground")
    assert [picture.name for picture in both.pictures] == [question.goal.name, question.crop.name]
    # Where no part of it can be shown, the scene itself is the only thing to judge by.
    small = judge_box(job_of(there, arranged(size=(320, 280))), Box(40, 20, 80, 60), {})
    names = [picture.name for picture in build_request(small, id="q", stage="ground").pictures]
    assert names == ["{goal} photo", "crop"]


def test_only_what_has_edges_is_judged_by_them():
    box, free = Box(400, 200, 480, 280), Target("T1", "area", "free table beside the bowl", use=("place",))
    assert "Good enough on this crop" not in said(judge_box(job_of(free), box, {}))
    assert "any box that lies in what is described will do" in said(judge_box(job_of(free), box, {}))
    there = Target("T1", "area", "place of the block in {goal}", source="slot", like=("goal",), use=("place",))
    assert "Good enough on this crop" in said(judge_box(job_of(there, arranged()), box, {}))
