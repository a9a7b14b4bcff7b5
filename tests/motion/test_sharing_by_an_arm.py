"""Several things that an arm brings to one place do not land on each other, nor on what stood in the middle of it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.motion.block_scenes import LIMITS, Block, cameras, found, scene
from wonderful_team.core.actions import At, CloseStep, MoveStep, MoveTo, OpenStep, Step
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.motion import ground_actions
from wonderful_team.motion.sharing import shared_places

CAMERA = cameras()["pinhole"]
RED, BLUE = Block(0.38, -0.30, 0.43, -0.25, 0.05), Block(0.38, -0.20, 0.43, -0.15, 0.05)
TRAY, KNOB = Block(0.42, 0.02, 0.68, 0.28, 0.02), Block(0.535, 0.135, 0.565, 0.165, 0.06)


def carry(thing: str, place: str) -> list[Step]:
    """As an arm does it."""
    return [
        OpenStep("G1"), MoveStep("G1", At(thing), "at"), CloseStep("G1"), MoveStep("G1", At(thing), "clear"),
        MoveStep("G1", At(place), "clear"), MoveStep("G1", At(place), "at"), OpenStep("G1"), MoveStep("G1", At(place), "clear"),
    ]  # fmt: skip


def ends(steps: list[Step], *more: Block) -> list[Array]:
    """Where the tool lets go [m]."""
    targets = {
        "T1": found(CAMERA, "T1", RED, {"pick": (0.5, 0.5)}),
        "T2": found(CAMERA, "T2", BLUE, {"pick": (0.5, 0.5)}),
        "T3": found(CAMERA, "T3", TRAY, {"place": (0.5, 0.5)}),
        "T4": found(CAMERA, "T4", KNOB, {"pick": (0.5, 0.5)}),
    }
    planned = ground_actions(steps, targets, scene(CAMERA, RED, BLUE, TRAY, *more), LIMITS)
    return [
        one.action.pose.position_m
        for k, one in enumerate(planned)
        if isinstance(one.action, MoveTo)
        and k + 1 < len(steps)
        and steps[k + 1].kind == "open"
        and getattr(one.step, "height", "") == "at"
    ]


def test_two_things_in_one_tray_lie_beside_each_other() -> None:
    first, second = ends([*carry("T1", "T3"), *carry("T2", "T3")])
    assert np.linalg.norm((first - second)[:2]) > 0.05
    for end in (first, second):
        assert TRAY.x0 + 0.02 < end[0] < TRAY.x1 - 0.02
        assert TRAY.y0 + 0.02 < end[1] < TRAY.y1 - 0.02
    alone = ends(carry("T1", "T3"))[0]
    assert alone[:2] == pytest.approx((0.55, 0.15), abs=0.01)


def test_the_way_there_and_the_place_are_one_share_and_the_way_back_is_none() -> None:
    shares = shared_places([*carry("T1", "T3"), *carry("T2", "T3")])
    assert {number: share.index for number, share in shares.items()} == {5: 0, 6: 0, 13: 1, 14: 1}


def test_what_stands_on_the_middle_of_a_place_and_leaves_it_makes_no_pile_there() -> None:
    """A handle on a lid: seen in the middle of the place, and higher than what things are put on."""
    steps = [*carry("T4", "T1"), *carry("T1", "T3"), *carry("T2", "T3")]
    _, first, second = ends(steps, KNOB)
    assert np.linalg.norm((first - second)[:2]) > 0.05
    held_m = RED.height / 2
    for end in (first, second):
        assert end[2] == pytest.approx(TRAY.height + held_m, abs=0.006)
