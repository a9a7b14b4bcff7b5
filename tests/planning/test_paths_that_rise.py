"""A helper function's path in the air: checked, and told to its reviewer with its heights."""

from __future__ import annotations

from tests.planning.helpers import asked, plan_with, scripted
from wonderful_team.core.actions import ARM
from wonderful_team.planning.config import TeamConfig


def test_a_path_that_rises_too_far_goes_back_and_one_that_fits_is_followed() -> None:
    goal = {
        "reasoning": "",
        "subgoals": [
            {"id": "G1", "text": "shake it", "after": [], "targets": ["T1"], "function": "up and down several times"}
        ],
        "targets": [
            {"id": "T1", "kind": "object", "words": "the thing", "part": None, "where": "", "like": [], "use": ["place"]}
        ],
        "mode": "one_step",
        "clarification": None,
    }  # fmt: skip
    code = (
        "def path(boxes):\n    x0, y0, x1, y1 = boxes['T1']\n    return shake(((x0 + x1) / 2, (y0 + y1) / 2), {up}, 3)"
    )
    outside = "def path(boxes):\n    return [(-50, 10, 0), (10, 10, 0)]"
    model = scripted(
        DraftPlan=goal,
        WriteFunction=[
            {"reasoning": "", "code": code.format(up=0.9)},
            {"reasoning": "", "code": outside},
            {"reasoning": "", "code": code.format(up=0.05)},
        ],
        ReviewPath={"reasoning": "", "accepted": True, "problem": ""},
        WriteSteps={
            "reasoning": "",
            "steps": [{"kind": "follow", "subgoal": "G1", "function": "G1", "contact": "air"}],
        },
    )
    plan = plan_with(model, TeamConfig(mode="lean"), vocabulary=ARM)
    assert plan.status == "planned", plan.message
    first, second, third = (request.question for request in asked(model, "WriteFunction"))
    assert 0.05 < first.most_up_m < 0.9
    assert f"point 2 has up = 0.900 m; valid: 0 to {first.most_up_m:.2f} m" in second.error
    assert "point 1 lies outside the picture" in third.error
    (review,) = (request.question for request in asked(model, "ReviewPath"))
    assert review.up_m == (0.0, 0.05) * 3 + (0.0,)
    (planned,) = plan.actions
    assert len(planned.sources) == 7
