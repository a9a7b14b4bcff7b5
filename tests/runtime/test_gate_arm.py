"""The gate follows what an arm's fingers take and let go of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.motion.block_scenes import LIMITS, Block, affine_top, area, found, scene
from tests.runtime.carrying import gate_of_carrying
from wonderful_team.core.actions import ARM, At, CloseStep, MoveStep, OpenStep, RotateGripperStep
from wonderful_team.core.geometry import Box
from wonderful_team.core.values import GateReport, Observation
from wonderful_team.motion import ground_actions
from wonderful_team.runtime.gate import check_gate
from wonderful_team.runtime.stage import Stage

CAMERA = affine_top()
RED, BLUE = Block(0.38, -0.34, 0.48, -0.24), Block(0.48, 0.06, 0.58, 0.16)


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
    return gate_of_carrying(view, grounded, moves, LIMITS)


def test_a_place_that_an_arm_has_emptied_is_free() -> None:
    report = judged(("T1", "A1"), ("T2", "A2"))
    assert report.admitted, report.reasons


def test_a_place_that_the_arm_itself_has_filled_is_refused() -> None:
    report = judged(("T1", "A1"), ("T2", "A1"))
    assert not report.admitted
    assert any("under the way" in reason for reason in report.reasons)


def test_what_is_let_go_of_where_it_stands_has_not_moved() -> None:
    view = scene(CAMERA, RED, BLUE)
    target = found(CAMERA, "T1", RED)
    assert target.box is not None
    # Gripped beside its middle, as a cap is of which a box shows one side, too.
    x, y = target.box.centre
    target = replace(target, box=Box(target.box.x0, target.box.y0, x + 1, target.box.y1), points={"pick": (x - 4, y)})
    steps = (
        MoveStep("G1", At("T1"), "at"),
        CloseStep("G1"),
        OpenStep("G1"),
        RotateGripperStep("G1", 90.0),
        CloseStep("G1"),
    )
    stages: list[Stage] = []
    check_gate(
        ground_actions(steps, {"T1": target}, view, LIMITS),
        vocabulary=ARM,
        limits=LIMITS,
        plan=None,
        then=None,
        now=Observation({"top": view}),
        stages=stages,
    )
    before, *_, after = stages
    assert before.relief is not None
    assert after.relief is not None
    high = [np.sort(np.round(one[one[:, 2] > 0.03], 4), axis=0) for one in (before.relief.xyz_m, after.relief.xyz_m)]
    assert np.array_equal(*high)
