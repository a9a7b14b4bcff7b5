"""Numbers that cannot be computed go back to the Supervisor with what was measured, within the bound."""

from __future__ import annotations

from functools import partial

from tests.planning import helpers
from tests.planning.helpers import AS_LARGE, Tape, asked, draft, scripted, subgoal
from wonderful_team.planning import Bounds, TeamConfig

plan_with = partial(helpers.plan_with, size=AS_LARGE)

LEAN = TeamConfig(mode="lean")
MEASURED = "no room for T1 left of 'T2': "


def steps(side):
    def answer(request):
        return {
            "reasoning": "",
            "steps": [
                {
                    "subgoal": item.id, "kind": "pick_place", "pick": "T1",
                    "place": {"target": "T2", "how": "beside", "side": side(item.text)}, "rotate_deg": 0,
                }
                for item in request.question.subgoals
            ],
        }  # fmt: skip

    return answer


def at_the_edge(request):
    """The second thing stands so near to the left edge that the first one does not fit there."""
    boxes = {"T1": (300, 200, 400, 280), "T2": (60, 200, 200, 280)}
    return {
        "reasoning": "",
        "targets": [
            {
                "id": target.id, "found": True,
                "box": dict(zip(("x0", "y0", "x1", "y1"), boxes[target.id], strict=True)),
                "points": [
                    {"role": role, "point": {"x": boxes[target.id][0] + 40, "y": 240}} for role in target.roles
                ],
            }
            for target in request.question.targets
        ],
    }  # fmt: skip


def run(*drafts, bounds=None, tape=None):
    model = scripted(
        DraftPlan=list(drafts), ReadScene=at_the_edge,
        WriteSteps=steps(lambda text: "left" if "left" in text else "below"),
    )  # fmt: skip
    return plan_with(model, TeamConfig(mode="lean", bounds=bounds or Bounds()), tape=tape), model


LEFT = draft(subgoal("G1", "put the spoon to the left of the saucer"))
BELOW = draft(subgoal("G1", "put the spoon below the saucer"))


def test_the_supervisor_is_told_what_was_measured_and_may_plan_otherwise():
    tape = Tape()
    plan, model = run(LEFT, BELOW, tape=tape)
    assert plan.status == "planned"
    assert len(plan.actions) == 1
    (advice,) = asked(model, "DraftPlan")[1].question.advice
    assert MEASURED in advice
    assert "60 px of the picture lie there, 100 px are needed" in advice
    assert "on the other sides lie 1080 px right, 200 px above, 680 px below" in advice
    assert "goes back to the Supervisor" in tape.warnings


def test_the_error_stays_clear_when_the_bound_is_reached():
    drafts = [draft(subgoal("G1", f"put the spoon to the left of the saucer, {way}")) for way in "abcde"]
    tape = Tape()
    plan, model = run(*drafts, bounds=Bounds(returns=1), tape=tape)
    assert plan.status == "failed"
    assert plan.stage == "plan"
    assert plan.message.startswith(f"step 1: {MEASURED}60 px of the picture lie there, 100 px are needed")
    assert len(asked(model, "DraftPlan")) == 2
    assert tape.warnings.count("goes back to the Supervisor") == 1, "nothing goes back once the bound is reached"
    assert set(plan.grounded) == {"T1", "T2"}, "what was found is kept"


def test_the_same_plan_again_is_not_grounded_again():
    plan, model = run(LEFT)
    assert plan.status == "failed"
    assert MEASURED in plan.message
    assert len(asked(model, "DraftPlan")) == 2
    assert len(asked(model, "ReadScene")) == 1
