"""Things at rest are left out of the computation, and nothing is drawn that nobody looks at: the outcomes stay what they are."""

from __future__ import annotations

import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team import registry
from wonderful_team.core.actions import PickPlace
from wonderful_team.sims.tabletop.engine import mj

HIGH_M = 0.1


@wt.task("test/rest_stack", instruction="Put the {block} block away.")
def stack(scene: wt.Scene, rng: np.random.Generator) -> None:
    low = scene.add("block", "red", at=(0.5, 0.0), yaw_rad=0.0, name="low")
    scene.add("block", "blue", at=(0.5, 0.0), yaw_rad=0.0, name="high", lifted_m=low.body.height_m + 0.001)
    scene.add("block", "green", at=(0.5, 0.3), yaw_rad=0.0, name="apart")
    scene.say(block="red")
    scene.goal(low, at=(0.5, -0.3))


def resting() -> object:
    """The stack a second later, when physics has put all of it to rest."""
    world = registry.make_world("tabletop/test/rest_stack", 1)
    state = world._table._state
    for _ in range(500):
        mj.mj_step(world._table.built.model, state)
    assert state.ntree_awake == 0
    return world


def height_m(world, name: str) -> float:
    return float(world._table.poses()[name].position_m[2])


def test_what_stood_on_a_thing_that_is_taken_away_falls():
    world = resting()
    before = height_m(world, "high")
    assert before > height_m(world, "apart") + 0.01
    world._table.put("low", np.array([0.5, -0.3, height_m(world, "apart")]), 0.0)
    assert height_m(world, "high") == pytest.approx(height_m(world, "apart"), abs=0.002)


def test_a_thing_that_is_picked_wakes_and_what_it_is_put_on_holds_it():
    world = resting()
    poses = world._table.poses()
    pick, place = poses["apart"].position_m, poses["high"].position_m
    report = world.execute(PickPlace(np.array([*pick[:2], pick[2]]), np.array([*place[:2], HIGH_M]), 0.0))
    assert report.measured["held"]
    assert height_m(world, "apart") > height_m(world, "high") + 0.01


def test_making_a_world_draws_nothing():
    world = registry.make_world("tabletop/rearrange", 3)
    assert world._table._opened is None
    assert world.instruction.slots
    assert world._table._opened is not None
    world.close()
