"""Actions happen under physics and are reported as a robot would report them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from wonderful_team.core.actions import Home, PickPlace
from wonderful_team.core.protocols import Privileged, World, offers
from wonderful_team.errors import ConfigError
from wonderful_team.sims.tabletop import Scene, TabletopWorld, make_world, task
from wonderful_team.sims.tabletop.suction import Suction


@task("test/suction", instruction="put the letter into the container", horizon=9)
def _suction_scene(scene: Scene, rng: np.random.Generator) -> None:
    letter = scene.add("letter T", "red", at=(0.4, -0.3), yaw_rad=0.4, name="letter")
    scene.add("ring", "blue", at=(0.65, -0.35), name="ring")
    scene.add("block", "green", at=(0.6, 0.0), yaw_rad=0.0, name="block")
    box = scene.add("container", "wooden", at=(0.45, 0.3), yaw_rad=0.0, name="container")
    scene.goal(letter, near=box)


@pytest.fixture
def world() -> TabletopWorld:
    made = make_world("test/suction")
    yield made
    made.close()


def _thing(world: TabletopWorld, name: str) -> dict:
    return world.privileged.truth()["things"][name]


def test_it_is_a_world_with_its_truth_apart(world: TabletopWorld) -> None:
    assert isinstance(world, World)
    assert offers(world.privileged, Privileged)
    assert not offers(world, Privileged)


def test_the_centre_lands_at_place_plus_the_turned_offset(world: TabletopWorld) -> None:
    before, yaw, place = _thing(world, "letter"), -math.radians(70), np.array([0.6, -0.2, 0.0])
    pick = np.array(before["grasp_m"])
    report = world.execute(PickPlace(pick, place, yaw))
    assert report.executed
    assert report.fault is None
    assert report.measured["held"] is True
    assert report.measured["contact_height_m"] == pytest.approx(0.034, abs=0.001)
    touched, let_go = np.array(report.measured["path_m"])
    assert touched == pytest.approx([*pick[:2], report.measured["contact_height_m"]], abs=1e-3)
    assert let_go == pytest.approx([*place[:2], report.measured["release_height_m"]], abs=1e-3)
    turn = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    offset = np.array(before["position_m"])[:2] - pick[:2]
    after = _thing(world, "letter")
    assert np.allclose(after["position_m"][:2], place[:2] + turn @ offset, atol=0.003)
    assert math.remainder(after["yaw_rad"] - before["yaw_rad"] - yaw, 2 * math.pi) == pytest.approx(0, abs=0.03)


@pytest.mark.parametrize(("name", "shift"), [("ring", 0.0), ("container", 0.095)])
def test_a_hole_and_a_fixed_container_do_not_hold(world: TabletopWorld, name: str, shift: float) -> None:
    before = world.privileged.truth()["things"]
    x, y, _ = before[name]["position_m"]
    report = world.execute(PickPlace((x + shift, y, 0.0), (0.7, 0.4, 0.0)))
    assert report.executed
    assert report.measured["held"] is False
    assert report.measured["release_height_m"] is None
    assert len(report.measured["path_m"]) == 1, "it touched, and let nothing go"
    assert world.privileged.truth()["things"] == before


def test_things_lie_inside_walls_and_on_top_of_each_other(world: TabletopWorld) -> None:
    block, letter = _thing(world, "block"), _thing(world, "letter")
    container = _thing(world, "container")["position_m"]
    world.execute(PickPlace(letter["grasp_m"], (block["position_m"][0], block["position_m"][1], 0.0)))
    assert _thing(world, "letter")["position_m"][2] == pytest.approx(0.07, abs=0.004)
    letter = _thing(world, "letter")
    world.execute(PickPlace(letter["grasp_m"], (0.65, 0.35, 0.0)))
    world.execute(PickPlace(block["grasp_m"], container))
    assert _thing(world, "block")["position_m"][2] == pytest.approx(0.005, abs=0.002)


def test_the_same_actions_give_the_same_poses_to_the_bit() -> None:
    ends = []
    for _ in range(2):
        world = make_world("test/suction")
        for action in world.privileged.oracle():
            world.execute(action)
        ends.append((world.privileged.truth()["things"], world.observe().hash))
        world.close()
    assert ends[0] == ends[1]


def test_out_of_reach_stop_and_other_kinds(world: TabletopWorld) -> None:
    far = world.execute(PickPlace((0.9, 0.0, 0.0), (0.5, 0.0, 0.0)))
    assert not far.executed
    assert "pick x = 0.900 m is out of reach [0.25, 0.75] m" in far.fault
    with pytest.raises(ConfigError, match="runs pick_place; got home"):
        world.execute(Home())
    world.stop()
    stopped = world.execute(PickPlace((0.4, -0.3, 0.0), (0.5, 0.0, 0.0)))
    assert (stopped.executed, stopped.fault) == (False, "the world was stopped")
    world.close()
    with pytest.raises(ConfigError, match="closed"):
        world.observe()


@pytest.mark.parametrize("yaw_rad", [10_000.0, 1e300])
def test_a_turn_of_more_than_once_round_is_a_fault_at_once(world: TabletopWorld, yaw_rad: float) -> None:
    before = world.observe().main.time_s
    report = world.execute(PickPlace((0.4, -0.3, 0.0), (0.5, 0.0, 0.0), yaw_rad))
    assert not report.executed
    assert "is more than once round (limit 6.283 rad)" in str(report.fault)
    assert world.observe().main.time_s == before


def test_a_nudge_shows_in_the_next_picture(world: TabletopWorld) -> None:
    before, where = world.observe(), _thing(world, "letter")["position_m"]
    world.privileged.nudge("letter", dx_m=0.03, yaw_rad=0.2)
    assert world.observe().hash != before.hash
    assert _thing(world, "letter")["position_m"][0] == pytest.approx(where[0] + 0.03, abs=0.002)
    world.privileged.nudge("container", dy_m=-0.05)
    assert _thing(world, "container")["position_m"][1] == pytest.approx(0.25, abs=1e-6)


@pytest.mark.parametrize(
    ("task", "seed", "low_m", "high_m"), [("novel_adj", 750006, 0.09, 0.2), ("rotate", 3, 0.0, 0.04)]
)
def test_a_thing_travels_as_high_as_the_world_says(
    task: str, seed: int, low_m: float, high_m: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The gate checks what lies under its way for that height, of a tall thing and of a flat one."""
    goals: list[float] = []
    carry = Suction._carry

    def noting(tool: Suction, goal_m: np.ndarray, yaw_rad: float, speed_m_s: float) -> None:
        goals.append(float(goal_m[2]))
        carry(tool, goal_m, yaw_rad, speed_m_s)

    monkeypatch.setattr(Suction, "_carry", noting)
    made = make_world(task, seed=seed)
    try:
        movable = [thing for thing in made.privileged.truth()["things"].values() if thing["movable"]]
        tallest = max(movable, key=lambda thing: thing["grasp_m"][2])
        pick, place = np.array(tallest["grasp_m"]), np.array([0.6, 0.0, 0.0])
        assert low_m < pick[2] < high_m
        assert made.execute(PickPlace(pick, place, 0.0)).measured["held"] is True
        assert goals == pytest.approx([made.limits.carried_z_m(pick, place)] * 2, abs=0.002)
    finally:
        made.close()
