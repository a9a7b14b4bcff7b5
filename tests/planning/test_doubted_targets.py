"""What Verification or the Checker finds wrong with a point or a box sends the target back to grounding, told why."""

from __future__ import annotations

from functools import partial

import pytest

from tests.planning import helpers
from tests.planning.helpers import APPROVED, AS_LARGE, Tape, asked, draft, scripted, subgoal
from wonderful_team.contracts import ReviewPlan
from wonderful_team.core.pictures import PathMark, PointMark
from wonderful_team.planning import Bounds, TeamConfig

plan_with = partial(helpers.plan_with, size=AS_LARGE)

LEAN = TeamConfig(mode="lean", thorough=True)
HOLE = "The point lies in the hole of the ring; it should be on its rim."


def wrong(kind="wrong_point", about="T1", question=HOLE):
    return {"reasoning": "", "approved": False, "doubt": {"about": about, "kind": kind, "question": question}}


def verdict(decision="accept", problem="", **points):
    wrong_points = [{"use": use, "why": why} for use, why in points.items()]
    return {"reasoning": "", "decision": decision, "problem": problem, "wrong_points": wrong_points}


def of_target(name, mine, others):
    turns, last = iter(mine), mine[-1]
    return lambda request: next(turns, last) if request.question.target.id == name else others


def chosen(number):
    return {"reasoning": "", "number": number}


def rejected(picture):
    return [mark for mark in picture.marks if isinstance(mark, PointMark) and mark.label.startswith("rejected")]


def test_a_point_in_a_hole_is_chosen_anew_and_the_plan_succeeds():
    """The pick point was read in the middle of a ring: Verification sees it in the drawing and says so."""
    model = scripted(ReviewSteps=[wrong(), APPROVED], ChoosePoint=chosen(4))
    tape = Tape()
    plan = plan_with(model, LEAN, tape=tape)
    assert plan.status == "planned"
    assert plan.verified
    ring = plan.grounded["T1"]
    first = next(event for event in ring.history if event.what == "box").points[0]
    assert ring.points["pick"] != first
    assert ring.box.contains(ring.points["pick"])
    assert plan.actions[0].sources[0].point_px == ring.points["pick"], "the numbers follow the new point"
    # The Manager saw the old point and was told what is wrong with it.
    question = asked(model, "ChoosePoint")[0].question
    (mark,) = rejected(question.crop)
    assert question.crop.frame.point_to_view(mark.point) == pytest.approx(first)
    assert question.rejected == (f"rejected: by Verification: {HOLE}",)
    # Verification looked again, at the new arrow, and knew what came of its doubt.
    looks = [request.question for request in asked(model, "ReviewSteps")]
    starts = [next(m for m in q.overview.marks if isinstance(m, PathMark)).points[0] for q in looks]
    assert len(looks) == 2
    assert starts[0] != starts[1]
    assert "asked about T1" in looks[1].checked[0]
    assert "chosen anew" in looks[1].checked[0]
    # Told: in the plan's questions, in the target's story, among the stages.
    assert [(q.about, q.kind, q.changed) for q in plan.questions] == [("T1", "wrong_point", True)]
    assert any(event.text == f"Verification: reject the point - {HOLE}" for event in ring.history)
    assert any("doubted by Verification" in event.content["text"] for event in tape.kinds("stage"))
    assert len(asked(model, "WriteSteps")) == 1, "steps name targets: a new point needs no new steps"


def test_without_a_grounding_team_the_supervisor_points_again():
    found = [{"reasoning": "", "found": True, "points": [{"x": x, "y": 240}]} for x in (180, 215)]
    model = scripted(ReviewSteps=[wrong(), APPROVED], LocatePoints=of_target("T1", found, found[0]))
    plan = plan_with(model, TeamConfig(mode="lean", thorough=True, ablation="s6"))
    assert plan.grounded["T1"].points["pick"] == (215, 240)
    last = asked(model, "LocatePoints")[-1]
    assert last.role == "supervisor"
    assert len(rejected(last.question.view)) == 1
    assert HOLE in last.question.rejected[0]


def test_a_doubted_box_is_looked_for_anew_and_one_that_is_not_there_goes_back_to_the_supervisor():
    nowhere = {"reasoning": "", "found": False, "points": []}
    somewhere = {"reasoning": "", "found": True, "points": [{"x": 400, "y": 300}]}
    box = {"reasoning": "", "box": {"x0": 380, "y0": 280, "x1": 420, "y1": 320}}
    other = "That is the striped hexagon."
    model = scripted(ReviewSteps=[wrong("wrong_box", question=other), APPROVED], LocatePoints=somewhere, GiveBox=box)
    plan = plan_with(model, LEAN)
    assert plan.verified
    assert plan.grounded["T1"].box.as_tuple == (380, 280, 420, 320)
    assert all(
        request.question.rejected == (f"rejected: by Verification: {other}",)
        for request in asked(model, "LocatePoints")
    )
    # Not there any more: as for anything that is not found.
    model = scripted(
        ReviewSteps=[wrong("wrong_box"), APPROVED], LocatePoints=nowhere,
        DraftPlan=[draft(subgoal("G1")), draft(subgoal("G1"), words="the thing on the left")],
    )  # fmt: skip
    assert plan_with(model, LEAN).status == "planned"
    assert asked(model, "DraftPlan")[1].question.advice == (
        "T1 (the first thing) was not found in the picture: 3 of 3 samples say it is not there.",
    )


@pytest.mark.parametrize("strict", [False, True])
def test_endless_doubt_about_a_point_ends_at_the_bound_and_says_so(strict):
    model = scripted(ReviewSteps=wrong(), ChoosePoint=lambda request: chosen(1 + len(request.question.rejected)))
    tape = Tape()
    plan = plan_with(
        model, TeamConfig(mode="lean", thorough=True, strict=strict, bounds=Bounds(regrounds=2)), tape=tape
    )
    assert plan.status == ("refused" if strict else "planned")
    assert not plan.verified
    assert [q.kind for q in plan.questions] == ["wrong_point"] * 2
    assert len(asked(model, "ReviewSteps")) == 3
    assert f"Verification still doubts T1 after it was looked for 2 times more: {HOLE}" in tape.warnings
    coarse = [r.question for r in asked(model, "ChoosePoint") if not r.question.fine]
    assert [len(rejected(question.crop)) for question in coarse] == [1, 2], "every rejected point stays marked"


def test_a_doubt_about_a_point_names_a_target_and_comes_when_points_are_drawn():
    model = scripted(ReviewSteps=[wrong(about="1"), wrong(about="T1"), APPROVED])
    assert plan_with(model, LEAN).verified
    assert "unknown target for a doubt of kind wrong_point '1'; valid: T1, T2" in "".join(
        request.feedback for request in asked(model, "ReviewSteps")
    )
    early = scripted(ReviewPlan=[wrong(about="G1"), APPROVED])
    assert plan_with(early, LEAN).verified
    told = "".join(request.feedback for request in asked(early, ReviewPlan.__name__))
    assert "wrong_point is for drawn points and boxes; none are drawn yet: use wrong_target" in told


def test_a_point_that_the_checker_rejects_is_asked_again_without_redoing_the_box():
    reads = lambda request: {  # noqa: E731
        "reasoning": "",
        "targets": [
            {
                "id": target.id, "found": True, "box": {"x0": 150, "y0": 200, "x1": 230, "y1": 280},
                "points": [{"role": role, "point": {"x": 190, "y": 240}} for role in target.roles],
            }
            for target in request.question.targets
        ],
    }  # fmt: skip
    both = draft(subgoal("G1"))
    both["targets"][0]["use"] = ["pick", "place"]
    why = "It lies in the hole; take the rim."
    model = scripted(
        DraftPlan=both, ReadScene=reads, ChoosePoint=chosen(2),
        JudgeBox=of_target("T1", [verdict(pick=why)], verdict()),
    )  # fmt: skip
    plan = plan_with(model, LEAN)
    ring = plan.grounded["T1"]
    assert ring.box.as_tuple == (150, 200, 230, 280)
    assert ring.points["place"] == (190, 240), "the other point stands"
    assert ring.points["pick"] != (190, 240)
    assert not asked(model, "MoveBox")
    assert not asked(model, "LocatePoints")
    assert {(r.question.target.id, r.question.role) for r in asked(model, "ChoosePoint")} == {("T1", "pick")}
    assert asked(model, "ChoosePoint")[0].question.rejected == (f"rejected: as the pick point, by the Checker: {why}",)
    assert any(event.text == f"Checker: reject the pick point - {why}" for event in ring.history)


def test_the_manager_is_told_why_the_checker_rejected_a_box():
    """In the lean way as in the paper's: the mark alone does not say what was wrong there."""
    for mode in ("lean", "paper"):
        model = scripted(
            JudgeBox=of_target("T1", [verdict("reject", "It is the striped hexagon."), verdict()], verdict())
        )
        assert plan_with(model, TeamConfig(mode=mode, thorough=True)).status == "planned"
        told = ("rejected: the Checker refused the box there: It is the striped hexagon.",)
        looked = [r.question for r in asked(model, "LocatePoints") if r.question.target.id == "T1"][-1]
        boxed = [r.question for r in asked(model, "GiveBox") if r.question.target.id == "T1"][-1]
        assert looked.rejected == boxed.rejected == told
