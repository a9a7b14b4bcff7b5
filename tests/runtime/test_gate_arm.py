"""The gate follows what an arm's fingers take and let go of."""

from __future__ import annotations

from tests.motion.block_scenes import LIMITS, Block, affine_top, area, found, scene
from tests.runtime.carrying import gate_of_carrying
from wonderful_team.core.values import GateReport

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
