"""Where a push begins is chosen on pictures that show where the thing has to go."""

from __future__ import annotations

import math
from functools import partial

import pytest

from tests.planning import helpers
from tests.planning.helpers import AS_LARGE, asked, draft, scripted, subgoal
from tests.planning.test_doubted_targets import of_target, verdict
from wonderful_team.core.actions import VOCABULARIES
from wonderful_team.core.pictures import BoxMark, PathMark
from wonderful_team.planning import TeamConfig

plan_with = partial(helpers.plan_with, size=AS_LARGE)

BLOCK, PLACE = (180, 230, 200, 250), (440, 120, 520, 200)
GOAL = (480, 160)


def pushing():
    plan = draft(subgoal("G1", "push the block into the frame"))
    plan["targets"][0].update(words="small block", use=["push_start"])
    plan["targets"][1].update(words="frame", kind="area", use=["push_end"])
    return plan


def reading(start):
    boxes = {"T1": BLOCK, "T2": PLACE}
    points = {"T1": ("push_start", start), "T2": ("push_end", GOAL)}

    def answer(_):
        return {
            "reasoning": "",
            "targets": [
                {
                    "id": name, "found": True, "box": dict(zip(("x0", "y0", "x1", "y1"), box, strict=True)),
                    "points": [{"role": points[name][0], "point": {"x": points[name][1][0], "y": points[name][1][1]}}],
                }
                for name, box in boxes.items()
            ],
        }  # fmt: skip

    return answer


def push_steps(_):
    place = {"how": "at", "side": None}
    step = {"subgoal": "G1", "kind": "push", "start": {"target": "T1", **place}, "end": {"target": "T2", **place}}
    return {"reasoning": "", "steps": [step]}


def run(mode="lean", start=(186, 240), **changes):
    answers = dict(DraftPlan=pushing(), ReadScene=reading(start), WriteSteps=push_steps) | changes
    model = scripted(**answers)
    plan = plan_with(model, TeamConfig(mode=mode), vocabulary=VOCABULARIES["push"])
    return plan, model


def path(picture):
    return next((mark for mark in picture.marks if isinstance(mark, PathMark)), None)


def test_the_start_is_chosen_where_an_arrow_shows_the_way():
    wrong = verdict(push_start="It is on the block; it should be on the far side of where the block goes.")
    plan, model = run(JudgeBox=of_target("T1", [wrong], verdict()))
    assert plan.status == "planned"
    coarse, fine = (request.question for request in asked(model, "ChoosePoint"))
    shown = path(coarse.whole)
    ends = [coarse.whole.frame.point_to_view(point) for point in shown.points]
    assert ends[1] == pytest.approx(GOAL), "the whole view shows where it goes"
    assert next(m for m in coarse.whole.marks if isinstance(m, BoxMark)).label == "T1"
    wanted = math.atan2(GOAL[1] - 240, GOAL[0] - 190)
    for question in (coarse, fine):
        (x0, y0), (x1, y1) = path(question.crop).points
        assert math.atan2(y1 - y0, x1 - x0) == pytest.approx(wanted, abs=0.02)
        assert question.crop.frame.valid.contains((x1, y1))
        assert path(question.crop).label == "on to where it goes"
    assert fine.whole is None, "one whole view settles the side"


def test_all_fine_points_beside_a_small_thing_show():
    wrong = verdict(push_start="It is on the block.")
    # Number 16 is the middle of the left side, on the ring beside the box.
    _, model = run(
        JudgeBox=of_target("T1", [wrong], verdict()),
        ChoosePoint=lambda request: {"reasoning": "", "number": 5 if request.question.fine else 16},
    )
    fine = asked(model, "ChoosePoint")[1].question
    points = fine.candidates.points
    assert len(points) == 9
    assert all(fine.crop.frame.valid.contains(point) for point in points)
    width = fine.crop.size_px[0]
    assert min(x for x, _ in points) > 0.05 * width, "none is cut off at the edge"
    assert min(math.dist(a, b) for a in points for b in points if a != b) > 20


def test_a_start_that_stands_off_a_small_thing_is_used():
    """A tool wider than the thing starts well beside it: that is no reason to drop the answer and ask again."""
    plan, model = run(start=(150, 252))
    assert plan.grounded["T1"].points["push_start"] == (150, 252)
    assert not asked(model, "ChoosePoint")


def test_in_the_papers_way_the_whole_view_comes_without_an_arrow():
    needs = [{"subgoal": "G1", "targets": ["T1", "T2"]}]
    targets = pushing()["targets"]
    plan, model = run(
        "paper",
        DraftPlan={**pushing(), "targets": []},
        ExtractTargets={"reasoning": "", "targets": targets, "needs": needs},
    )
    assert plan.grounded["T1"].status == "found"
    coarse = next(request.question for request in asked(model, "ChoosePoint") if request.question.target.id == "T1")
    assert path(coarse.whole) is None
    assert path(coarse.crop) is None
    assert coarse.whole.size_px == AS_LARGE
