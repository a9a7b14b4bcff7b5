"""The gate follows what an arm's fingers take and let go of."""

from __future__ import annotations

from tests.motion.block_scenes import LIMITS, Block, affine_top, area, found, scene
from wonderful_team.core.actions import ARM, At, CloseStep, HomeStep, MoveStep, OpenStep, Step
from wonderful_team.core.values import GateReport, Instruction, Observation, Plan
from wonderful_team.motion import ground_actions
from wonderful_team.runtime import check_gate

CAMERA = affine_top()
RED, BLUE = Block(0.38, -0.34, 0.48, -0.24), Block(0.48, 0.06, 0.58, 0.16)


def carried(thing: str, place: str) -> tuple[Step, ...]:
    return (
        OpenStep("G1"),
        MoveStep("G1", At(thing), "clear"),
        MoveStep("G1", At(thing), "at"),
        CloseStep("G1"),
        MoveStep("G1", At(thing), "clear"),
        MoveStep("G1", At(place), "clear"),
        MoveStep("G1", At(place), "at"),
        OpenStep("G1"),
        MoveStep("G1", At(place), "clear"),
        HomeStep("G1"),
    )


def judged(*moves: tuple[str, str]) -> GateReport:
    """The gate's word on carrying things to places; of the blocks only the tops are seen, as of fruits that bulge over their feet."""
    view = scene(CAMERA, RED, BLUE)
    (was_red,) = (tuple(float(v) for v in CAMERA.project([(*RED.centre, 0.0)])[0]),)
    grounded = {
        "T1": found(CAMERA, "T1", RED),
        "T2": found(CAMERA, "T2", BLUE),
        "A1": area("A1", (220.0, 100.0)),
        "A2": area("A2", (was_red[0], was_red[1])),
    }
    steps = tuple(step for thing, place in moves for step in carried(thing, place))
    actions = ground_actions(steps, grounded, view, LIMITS)
    now = Observation({"top": view})
    plan = Plan(Instruction("tidy up"), "planned", actions=actions, grounded=grounded, scene_hash=now.hash)
    return check_gate(plan.actions, vocabulary=ARM, limits=LIMITS, plan=plan, then=now, now=now)


def test_a_place_that_an_arm_has_emptied_is_free() -> None:
    report = judged(("T1", "A1"), ("T2", "A2"))
    assert report.admitted, report.reasons


def test_a_place_that_the_arm_itself_has_filled_is_refused() -> None:
    report = judged(("T1", "A1"), ("T2", "A1"))
    assert not report.admitted
    assert any("under the way" in reason for reason in report.reasons)
