"""A thing that was put where the place point showed a gap between slats is picked up where it rests."""

from __future__ import annotations

from itertools import product

import numpy as np

from tests.motion.block_scenes import Block, affine_top, found, scene
from tests.runtime.test_gate_seen import RED, gate, planned
from wonderful_team.core.actions import At, OriginOf, PickPlaceStep

BOARD = Block(0.47, 0.07, 0.59, 0.19, 0.014)
SLATS = (Block(0.47, 0.07, 0.512, 0.19, 0.03), Block(0.548, 0.07, 0.59, 0.19, 0.03))


def test_it_is_picked_up_again_over_a_slat() -> None:
    camera = affine_top()
    view = scene(camera, RED, BOARD, *SLATS)
    place = found(camera, "T2", BOARD, {"place": (0.5, 0.5)})
    there_and_back = (PickPlaceStep("G1", "T1", At("T2")), PickPlaceStep("G2", "T1", OriginOf("T1")))
    for across, along in product(np.linspace(0.05, 0.95, 10), np.linspace(0.1, 0.9, 9)):
        grounded = {"T1": found(camera, "T1", RED, {"pick": (across, along)}), "T2": place}
        checks = gate(planned(view, grounded, *there_and_back), view).checks
        assert all(check.ok for check in checks if check.name == "pick height"), (across, along)
