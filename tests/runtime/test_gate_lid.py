"""The gate and a closed box: the lid goes first, what is put in before that is refused, and so is a lid let down onto other things."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.motion.block_scenes import LIMITS, Block, area, found, looking_down, scene
from tests.runtime.carrying import gate_of_carrying
from wonderful_team.core.values import Fingers, GateReport

SIZE = (640, 400)
CAMERA = replace(looking_down(1.1), K=looking_down().K * 0 + [[620.0, 0, 320], [0, 620.0, 200], [0, 0, 1]])
LIMITS_OF_ARM = replace(LIMITS, fingers=Fingers(0.085, 0.022, 0.022))
BOX, LID = Block(0.4, -0.1, 0.6, 0.1, 0.055), Block(0.425, -0.075, 0.575, 0.075, 0.063)
HANDLE, BLOCK = Block(0.49, -0.03, 0.51, 0.03, 0.095), Block(0.48, -0.345, 0.525, -0.3, 0.045)
FREE_M, ON_BLOCK_M, OVER_ITS_EDGE_M = (0.5, 0.25), (0.47, -0.33), (0.5, -0.235)


def judged(*moves: tuple[str, str], aside: tuple[float, float] = FREE_M) -> GateReport:
    """The gate's word on carrying things to places: T1 is the lid, T2 the block, T3 the box, A1 where the lid may go."""
    view = scene(CAMERA, BOX, LID, HANDLE, BLOCK, size=SIZE)
    (x, y) = CAMERA.project([(*aside, 0.0)])[0]
    handle = CAMERA.project([(*HANDLE.centre, HANDLE.height)])[0]
    on_handle = (float(handle[0]), float(handle[1]))
    grounded = {
        "T1": replace(found(CAMERA, "T1", LID), points={"pick": on_handle}),
        "T2": found(CAMERA, "T2", BLOCK),
        "T3": replace(found(CAMERA, "T3", BOX), points={"place": on_handle}),
        "A1": area("A1", (float(x), float(y))),
    }
    return gate_of_carrying(view, grounded, moves, LIMITS_OF_ARM)


def test_the_lid_goes_to_a_free_place_and_the_block_into_the_box() -> None:
    report = judged(("T1", "A1"), ("T2", "T3"))
    assert report.admitted, report.reasons


def test_nothing_goes_into_the_box_before_the_lid_is_off() -> None:
    report = judged(("T2", "T3"), ("T1", "A1"))
    assert not report.admitted
    assert any("place is open: the block T1 lies there" in reason for reason in report.reasons), report.reasons


@pytest.mark.parametrize(("aside", "admitted"), [(ON_BLOCK_M, False), (OVER_ITS_EDGE_M, False), (FREE_M, True)])
def test_a_lid_is_not_let_down_onto_another_thing(aside: tuple[float, float], admitted: bool) -> None:
    report = judged(("T1", "A1"), aside=aside)
    assert report.admitted is admitted, report.reasons
    assert admitted or any("under the way" in reason for reason in report.reasons)


def test_a_lid_may_lie_close_beside_another_thing() -> None:
    # Its corners reach farther than its sides; only where it really comes down counts.
    beside = (0.5, BLOCK.y1 + 0.075 + 0.01)
    assert beside[1] + 0.075 < BOX.y0
    report = judged(("T1", "A1"), aside=beside)
    assert report.admitted, report.reasons
