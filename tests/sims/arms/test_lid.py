"""The box with a lid: right and wrong ends as the scorer sees them, and how the lid came off. Physics runs where it matters."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import wonderful_team as wt
from tests.sims.arms.needed import needs_arms
from tests.sims.arms.playing import by_team
from wonderful_team.core.actions import Gripper, Home, MoveTo
from wonderful_team.core.geometry import Pose
from wonderful_team.core.pictures import Frame, Picture
from wonderful_team.sims.arms import ArmWorld, make_world
from wonderful_team.sims.arms.lid import ClosedBox
from wonderful_team.sims.tabletop.engine import mj
from wonderful_team.sims.tabletop.moving import put_body
from wonderful_team.simulated.draft import Meaning
from wonderful_team.simulated.places import place_of, point_of
from wonderful_team.simulated.seeing import Eyes

pytestmark = needs_arms
IN_BOX, ON_LID, AGAINST_RIM = (0.0, 0.0, 0.006), (0.03, 0.04, 0.066), (0.0, 0.13, 0.0)


@pytest.fixture
def world() -> Iterator[ArmWorld]:
    made = make_world("lid_box/one", seed=3)
    yield made
    made.close()


def work_of(world: ArmWorld) -> ClosedBox:
    work = world._table.work
    assert isinstance(work, ClosedBox)
    return work


def box_m(world: ArmWorld) -> np.ndarray[Any, Any]:
    return np.asarray(world._table.poses()["box"].position_m)


def set_down(world: ArmWorld, name: str, at_m: Any, turn: Pose | None = None) -> None:
    """Where something is, without any physics afterwards."""
    table = world._table
    put_body(table.built, table._state, name, turn or Pose.at(np.asarray(at_m), 0.0))
    mj.mj_forward(table.built.model, table._state)


def opened(world: ArmWorld, wanted_at: tuple[float, float, float] = IN_BOX) -> ClosedBox:
    """The lid as if lifted and put aside, the wanted block somewhere by the box's middle."""
    work = work_of(world)
    work.lifted = True
    spot = work._free(work.lid, world._table.poses())
    assert spot is not None
    set_down(world, "lid", (*spot, 0.0))
    set_down(world, work.wanted[0].name, box_m(world) + wanted_at)
    return work


def reason(world: ArmWorld) -> str:
    score = world.privileged.score()
    return "" if score.success else score.reason


def test_the_box_is_closed_and_nothing_is_said_of_it(world: ArmWorld) -> None:
    truth = world.privileged.truth()
    assert "lid" not in world.instruction.text
    assert "lid" not in world.facts.lower()
    blocks = [one["height_m"] for name, one in truth["things"].items() if name.endswith("block")]
    assert len(blocks) == 4
    assert min(b - a for a, b in zip(sorted(blocks), sorted(blocks)[1:], strict=False)) > 0.01
    assert "still on the box" in reason(world)


def test_in_the_box_with_the_lid_beside_it_is_done(world: ArmWorld) -> None:
    opened(world)
    assert reason(world) == ""
    assert list(world.privileged.oracle()) == []


def test_a_lid_that_was_not_lifted_is_not_off(world: ArmWorld) -> None:
    opened(world).lifted = False
    assert "pushed off the box, not lifted" in reason(world)


@pytest.mark.parametrize(
    ("wanted_at", "why"),
    [((0.0, 0.0, 0.064), "leans on it"), ((0.06, 0.0, 0.02), "leans on it"), ((0.0, 0.2, 0.0), "not in the box")],
    ids=["on top", "in a wall", "beside"],
)
def test_a_thing_that_is_not_wholly_inside_is_not_in(
    world: ArmWorld, wanted_at: tuple[float, float, float], why: str
) -> None:
    opened(world, wanted_at)
    assert why in reason(world)


def test_a_thing_left_leaning_on_the_rim_is_not_in(world: ArmWorld) -> None:
    work = opened(world)
    turn = math.radians(-40)
    leaning = Pose(box_m(world) + (0.0, 0.05, 0.03), np.array([math.cos(turn / 2), math.sin(turn / 2), 0.0, 0.0]))
    set_down(world, work.wanted[0].name, None, leaning)
    assert "leans on it" in reason(world)


def test_things_on_top_of_the_closed_lid_are_not_in(world: ArmWorld) -> None:
    work = work_of(world)
    set_down(world, work.wanted[0].name, box_m(world) + ON_LID)
    assert "still on the box" in reason(world)
    assert f"{work.wanted[0].name} is on the box" in reason(world)
    # The oracle clears the lid before it lifts it.
    first = next(action for action in world.privileged.oracle() if isinstance(action, MoveTo))
    assert np.linalg.norm(first.pose.position_m[:2] - (box_m(world) + ON_LID)[:2]) < 0.01


def test_a_wrong_thing_in_the_box_is_the_wrong_object(world: ArmWorld) -> None:
    work = opened(world)
    work.held.add(work.others[0].name)
    set_down(world, work.others[0].name, box_m(world) + (0.0, 0.03, 0.05))
    score = world.privileged.score()
    assert (score.success, score.stage) == (False, "wrong object")
    assert f"{work.others[0].name} is in or on the box" in score.reason


def test_a_toppled_box_and_a_lid_on_something_are_refused(world: ArmWorld) -> None:
    work = opened(world)
    set_down(world, "lid", world._table.poses()[work.others[1].name].position_m + (0.0, 0.0, 0.05))
    assert "does not lie flat" in reason(world)
    turn = math.radians(90)
    fallen = Pose(box_m(world) + (0.0, 0.0, 0.08), np.array([math.cos(turn / 2), math.sin(turn / 2), 0.0, 0.0]))
    set_down(world, "box", None, fallen)
    assert "the box leans over by 90 degrees" in reason(world)
    assert list(world.privileged.oracle()) == []


def test_a_lid_pushed_off_by_the_closed_fingers_does_not_count(world: ArmWorld) -> None:
    x, y, _ = box_m(world)
    for action in (
        Gripper("close"),
        MoveTo(Pose.at((x, y - 0.13, 0.2), 0.0)),
        MoveTo(Pose.at((x, y - 0.13, 0.075), 0.0)),
        MoveTo(Pose.at((x, y + 0.06, 0.075), 0.0)),
        MoveTo(Pose.at((x, y + 0.2, 0.075), 0.0)),
        Home(),
    ):
        world.execute(action)
    assert work_of(world).pushed
    set_down(world, "lid", (*(work_of(world)._free(work_of(world).lid, world._table.poses()) or (0, 0)), 0.0))
    set_down(world, work_of(world).wanted[0].name, box_m(world) + IN_BOX)
    assert "pushed off the box, not lifted" in reason(world)


@pytest.mark.parametrize("seed", [3, pytest.param(8, marks=pytest.mark.slow)])
def test_the_lid_hangs_level_from_its_handle_and_the_block_falls_in(seed: int) -> None:
    world = make_world("lid_box/one", seed=seed)
    try:
        level = []
        for action in world.privileged.oracle():
            report = world.execute(action)
            assert report.executed, report.fault
            if world._table.held() == ("lid",):
                assert report.measured["held_width_m"] == pytest.approx(0.02, abs=0.002)
                axis = world._table.poses()["lid"].apply([(0.0, 0.0, 1.0)])[0] - world._table.poses()["lid"].position_m
                level.append(float(axis[2]))
        assert len(level) > 2
        assert min(level) > math.cos(math.radians(3))
        assert reason(world) == ""
    finally:
        world.close()


@pytest.mark.parametrize(("tilt_deg", "aside_m"), [(0.0, 0.0), (3.0, 0.001), (-4.0, -0.001)])
def test_a_lid_that_falls_back_on_its_box_lies_on_the_rim_and_does_not_stick_in_it(
    world: ArmWorld, tilt_deg: float, aside_m: float
) -> None:
    rest_m = float(world._table.poses()["lid"].position_m[2])
    box = box_m(world)
    half = math.radians(tilt_deg) / 2
    fall = Pose((box[0] + aside_m, box[1], rest_m + 0.15), (math.cos(half), math.sin(half), 0.0, 0.0))
    set_down(world, "lid", fall.position_m, fall)
    world._table.robot.rest(1.5)
    lies = world._table.poses()["lid"].position_m
    assert float(lies[2]) > rest_m - 0.002
    assert np.hypot(*(lies - box)[:2]) < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("task", ["lid_box/one", "lid_box/two"])
def test_the_whole_team_lifts_the_lid_first(task: str) -> None:
    trial = by_team(f"arms/{task}", 3)
    assert trial.outcome == "success", trial.reason
    assert "lid" in trial.plans[-1].subgoals[0].text


def test_offline_takes_off_what_closes_the_box_though_no_word_speaks_of_it() -> None:
    world = wt.make_world("arms/lid_box/one", seed=3)
    try:
        plan = wt.Team(model="offline").plan(
            world.observe(), world.instruction, vocabulary=world.vocabulary, limits=world.limits, facts=world.facts
        )
    finally:
        world.close()
    assert plan.status == "planned", plan.message
    assert [subgoal.text.split(" into ")[0] for subgoal in plan.subgoals] == [
        "put the cyan lid",
        "put the yellow block",
    ]
    assert plan.subgoals[1].after == ("G1",)


def test_a_block_that_leans_in_the_box_is_taken_by_its_middle(world: ArmWorld) -> None:
    work = opened(world)
    name = work.wanted[0].name
    c, s = math.cos(math.radians(25)), math.sin(math.radians(25))
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]], box_m(world) + (-0.02, 0.05, 0.03)
    set_down(world, name, (), Pose.from_matrix(T))
    poses = world._table.poses()
    assert not work.score(poses).success
    middle = poses[name].apply([(0.0, 0.0, work.wanted[0].body.height_m / 2)])[0]
    first = next(action for action in world.privileged.oracle() if isinstance(action, MoveTo))
    assert first.pose.position_m[:2] == pytest.approx(middle[:2], abs=0.002)


def test_a_place_under_the_lid_is_pointed_at_where_the_lid_shows(world: ArmWorld) -> None:
    view = world.observe().main
    assert view.camera is not None
    assert view.depth_m is not None
    seen = Eyes(world.privileged).see(Picture("top", view.rgb, Frame.whole("top", view.size_px), view.depth_m))
    assert seen is not None
    at_m = box_m(world)[:2] + (0.0, 0.05)
    place = place_of(Meaning(at_m=(float(at_m[0]), float(at_m[1])), on="box"), seen)
    assert place is not None
    x, y = point_of(place, "place", seen)
    there = view.camera.deproject([(x, y)], [view.depth_m[int(y), int(x)]])[0]
    assert there[:2] == pytest.approx(at_m, abs=0.002)
