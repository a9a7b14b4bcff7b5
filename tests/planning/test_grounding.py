"""Boxes, centres, points: corrections, fresh starts, "not here", and every bound."""

from __future__ import annotations

import asyncio
import re
from dataclasses import replace

import pytest

from tests.planning.helpers import Tape, asked, draft, plan_with, scripted, subgoal
from tests.planning.rounds import photo
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.protocols import Act, GaveUp, Situation
from wonderful_team.core.values import NO_WORKSPACE, Instruction
from wonderful_team.planning import Bounds, TeamConfig, TeamPolicy

REVISE = {"reasoning": "", "decision": "revise", "problem": "too far right", "wrong_points": []}
REJECT = {"reasoning": "", "decision": "reject", "problem": "another thing", "wrong_points": []}
ACCEPT = {"reasoning": "", "decision": "accept", "problem": "", "wrong_points": []}
NOT_HERE = {"reasoning": "", "found": False, "points": []}


def for_target(name, mine, others):
    """Answer one target differently from the rest."""
    turns = iter(mine)
    last = mine[-1]
    return lambda request: next(turns, last) if request.question.target.id == name else others


def shift(right_px):
    return {
        "reasoning": "", "action": "move", "right_px": right_px, "down_px": 0, "grow_left_px": 0, "grow_top_px": 0,
        "grow_right_px": 0, "grow_bottom_px": 0, "cut_edges": [],
    }  # fmt: skip


@pytest.mark.parametrize("mode", ["lean", "paper"])
def test_a_box_is_moved_until_the_checker_stops(mode):
    model = scripted(
        JudgeBox=for_target("T1", [REVISE], ACCEPT),
        JudgeRevision=[
            {"reasoning": "", "decision": "keep_before"},
            {"reasoning": "", "decision": "take_after_go_on"},
            {"reasoning": "", "decision": "take_after_stop"},
        ],
        MoveBox=[shift(100), shift(-20), shift(-20)],
    )
    plan = plan_with(model, TeamConfig(mode=mode, thorough=True))
    moved, still = plan.grounded["T1"], plan.grounded["T2"]
    assert moved.status == still.status == "found"
    first = next(event.box for event in moved.history if event.what == "box")
    assert moved.box.centre[0] < first.centre[0], "the refused revision must not count, the other two must"
    assert moved.box.width == pytest.approx(first.width)
    assert len(asked(model, "MoveBox")) == 3
    assert any("keep_before" in line for line in asked(model, "MoveBox")[1].question.history)
    assert any(moved.box.scaled(1.01).contains(point) for point in moved.points.values())


@pytest.mark.parametrize("right_px", [60, -60])
def test_a_move_is_told_in_the_pixels_in_which_boxes_are_told(right_px):
    """The Mover speaks of its enlarged crop; people read of the view."""
    model = scripted(
        JudgeBox=for_target("T1", [REVISE], ACCEPT),
        JudgeRevision=[{"reasoning": "", "decision": "take_after_stop"}],
        MoveBox=[shift(right_px)],
    )
    history = plan_with(model).grounded["T1"].history
    before, after = (next(event for event in history if event.what == what) for what in ("box", "move"))
    moved_px = after.box.centre[0] - before.box.centre[0]
    assert abs(moved_px) < 55, "the crop is enlarged, so that the units differ"
    told = re.fullmatch(r"Mover: moved (\d+) px (left|right)", after.text)  # no word of a way on which nothing moved
    assert told is not None, after.text
    assert float(told[1]) == pytest.approx(abs(moved_px), abs=1)
    assert told[2] == ("right" if right_px > 0 else "left")


def test_a_rejected_box_starts_again_from_new_centres_that_avoid_the_old_one():
    model = scripted(JudgeBox=for_target("T1", [REJECT, ACCEPT], ACCEPT))
    plan = plan_with(model)
    assert plan.status == "planned"
    mine = [r for r in asked(model, "LocatePoints") if r.question.target.id == "T1"]
    assert len(mine) == 6
    marks = [mark for mark in mine[-1].question.view.marks if getattr(mark, "label", "") == "rejected"]
    assert len(marks) == 1


def test_a_box_that_always_fails_ends_as_not_found_within_the_bounds():
    bounds = Bounds(refinements=2, new_centres=1, returns=0)
    model = scripted(
        JudgeBox=for_target("T1", [REVISE], ACCEPT), JudgeRevision={"reasoning": "", "decision": "keep_before"}
    )
    plan = plan_with(model, TeamConfig(mode="paper", bounds=bounds))
    assert plan.status == "not_found"
    assert plan.stage == "grounding"
    assert plan.grounded["T1"].status == "gave_up"
    assert plan.grounded["T1"].box is not None, "the best so far is kept"
    assert len(asked(model, "MoveBox")) == 2 * 2


def test_absent_goes_back_to_the_supervisor_who_may_describe_it_anew():
    model = scripted(
        DraftPlan=[draft(subgoal("G1"), words="the first thing"), draft(subgoal("G1"), words="the other thing")],
        ReadScene=lambda request: {
            "reasoning": "",
            "targets": [
                {"id": t.id, "found": False, "box": None, "points": []}
                if t.words == "the first thing"
                else {
                    "id": t.id, "found": True, "box": {"x0": 10, "y0": 10, "x1": 90, "y1": 90},
                    "points": [{"role": role, "point": {"x": 50, "y": 50}} for role in t.roles],
                }
                for t in request.question.targets
            ],
        },
    )  # fmt: skip
    plan = plan_with(model, TeamConfig(mode="lean"))
    assert plan.status == "planned"
    advice = asked(model, "DraftPlan")[1].question.advice
    assert advice == ("T1 (the first thing) was not found in the picture: the Manager says it is not in the picture.",)


def test_what_was_not_found_is_looked_for_once_more_where_a_replan_is_left():
    def seen(request):
        late = len(asked(model, "ReadScene")) > 1
        point = {"role": "pick", "point": {"x": 50, "y": 50}}
        found = {"found": True, "box": {"x0": 10, "y0": 10, "x1": 90, "y1": 90}}
        absent = {"found": False, "box": None, "points": []}
        targets = [
            {"id": t.id, **(found | {"points": [point | {"role": r} for r in t.roles]} if late else absent)}
            for t in request.question.targets
        ]
        return {"reasoning": "", "targets": targets}

    model = scripted(ReadScene=seen, LocatePoints=NOT_HERE)
    team = TeamPolicy(model, TeamConfig(mode="lean"))
    told = Instruction("put the first thing into the second thing")
    now = Situation(photo(), told, PICK_PLACE, NO_WORKSPACE, attempt=0, replans_left=1)
    first = asyncio.run(team.decide(now))
    assert isinstance(first, GaveUp)
    assert first.again
    second = asyncio.run(team.decide(replace(now, attempt=1)))
    assert isinstance(second, Act)
    assert second.plan is not None
    assert second.plan.parent == first.plan.id
    advice = asked(model, "DraftPlan")[-1].question.advice
    assert advice == (
        "The last plan could not be made ready: T1 not found: the first thing; T2 not found: the second thing.",
    )


def test_absent_for_good_is_not_found_and_names_the_target():
    model = scripted(LocatePoints=lambda r: NOT_HERE if r.question.target.id == "T1" else {
        "reasoning": "", "found": True, "points": [{"x": 100, "y": 100}]})  # fmt: skip
    plan = plan_with(model)
    assert plan.status == "not_found"
    assert "the first thing" in plan.message
    assert plan.grounded["T1"].status == "absent"
    assert plan.grounded["T2"].status == "found"
    assert not asked(model, "WriteSteps"), "nothing is written for a target that is not there"


def test_one_sample_of_three_that_sees_nothing_is_outvoted():
    turns = iter([NOT_HERE])
    found = {"reasoning": "", "found": True, "points": [{"x": 100, "y": 100}]}
    model = scripted(LocatePoints=lambda request: next(turns, found))
    assert plan_with(model).status == "planned"


def test_areas_are_found_by_points_alone():
    area = draft(subgoal("G1"))
    area["targets"][1]["kind"] = "area"
    needs = [{"subgoal": "G1", "targets": ["T1", "T2"]}]
    model = scripted(
        DraftPlan={**area, "targets": []},
        ExtractTargets={"reasoning": "", "targets": area["targets"], "needs": needs},
    )
    plan = plan_with(model)
    assert plan.grounded["T2"].status == "found"
    assert plan.grounded["T2"].box is None
    assert set(plan.grounded["T2"].points) == {"place"}
    assert {r.question.purpose for r in asked(model, "LocatePoints") if r.question.target.id == "T2"} == {"place"}
    assert not [r for r in asked(model, "GiveBox") if r.question.target.id == "T2"]


def test_push_candidates_lie_beside_the_box_too():
    pushed = draft(subgoal("G1"))
    pushed["targets"][0]["use"] = ["push_start"]
    needs = [{"subgoal": "G1", "targets": ["T1", "T2"]}]
    model = scripted(
        DraftPlan={**pushed, "targets": []},
        ExtractTargets={"reasoning": "", "targets": pushed["targets"], "needs": needs},
    )
    plan_with(model, until="grounded")
    question = next(r.question for r in asked(model, "ChoosePoint") if r.question.target.id == "T1")
    box = next(mark.box for mark in question.crop.marks if hasattr(mark, "box"))
    outside = [point for point in question.candidates.points if not box.contains(point)]
    assert len(outside) >= 4
    assert len(question.candidates.points) - len(outside) == 9


def test_a_small_overshoot_is_clamped_and_recorded_and_a_large_one_goes_back():
    tape = Tape()
    model = scripted(
        GiveBox=[
            {"reasoning": "", "box": {"x0": -400, "y0": 0, "x1": 50, "y1": 50}},
            {"reasoning": "", "box": {"x0": -2, "y0": 10, "x1": 50, "y1": 50}},
        ]
    )
    plan = plan_with(model, tape=tape)
    assert plan.status == "planned"
    assert "lies outside" in asked(model, "GiveBox")[-1].feedback or any(
        "lies outside" in r.feedback for r in asked(model, "GiveBox")
    )
    assert "clamped" in tape.warnings


def test_what_one_target_went_through_is_not_told_to_another():
    model = scripted()
    plan_with(model)
    for request in asked(model, "JudgeBox"):
        lines = [note for note in request.notes if note.source == "notebook"]
        assert not lines, "a first judgement has nothing to remember of another target's"
