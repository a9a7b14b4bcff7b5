"""The Fetch world over the real pipe, with a stand-in for the simulator at the other end."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from wonderful_team import registry
from wonderful_team.core.actions import Action, Gripper, Home, MoveTo, Push
from wonderful_team.core.geometry import Pose
from wonderful_team.core.protocols import Filmed, SceneTruth, World, offers
from wonderful_team.errors import ConfigError, UnknownNameError, WorldUnavailableError
from wonderful_team.planning import TeamConfig, TeamPolicy
from wonderful_team.runtime import rollout
from wonderful_team.sims.fetch import FetchWorld
from wonderful_team.sims.fetch.cameras import lenses
from wonderful_team.sims.fetch.finding import find_python, start
from wonderful_team.sims.fetch.scene import body_name, model_xml, set_table

Open = Callable[..., FetchWorld]


def to(x: float, y: float, z: float, yaw_rad: float = 0.0) -> MoveTo:
    return MoveTo(Pose.at(np.array([x, y, z]), yaw_rad))


def solve(world: FetchWorld) -> None:
    for action in world.privileged.oracle():
        report = world.execute(action)
        assert report.executed, report.words


def test_a_world_looks_like_every_other_world(open_world: Open) -> None:
    world = open_world()
    assert isinstance(world, World)
    assert offers(world, Filmed)
    assert offers(world.privileged, SceneTruth)
    observation = world.observe()
    assert list(observation.views) == ["top", "front"]
    assert observation.main.size_px == (640, 480)
    assert observation.main.depth_m is not None
    assert observation.robot is not None
    assert observation.robot.holding is False
    assert world.vocabulary.kinds == ("move_to", "gripper", "home")
    assert world.limits.fingers is not None
    assert not world.limits.fingers.turns
    assert world.observe().hash == observation.hash
    assert world.execute(to(0.2, 0.1, 0.3)).executed
    assert world.time_s > 0


def test_the_oracle_takes_the_lid_off_first_and_the_scorer_agrees(open_world: Open) -> None:
    for task in ("lid", "lid_two"):
        world = open_world(task, seed=3)
        assert world.privileged.score().success is False
        solve(world)
        score = world.privileged.score()
        assert score.success is True, score
        assert world.privileged.oracle() == []


def test_the_planner_drives_it_from_the_words_alone(open_world: Open) -> None:
    """The instruction names no lid; nothing is told but pictures, and truth through them."""
    world = open_world("lid", seed=3)
    team = TeamPolicy({"*": registry.make_model("simulated:perfect", world=world)}, TeamConfig())
    trial = rollout(team, world, replans=0, scorer=world.privileged, seed=3, max_age_s=None)
    assert trial.outcome == "success", trial.reason


def test_reports_say_what_a_robot_measures(open_world: Open) -> None:
    world = open_world()
    report = world.execute(to(0.3, -0.2, 0.25))
    assert report.measured["tool_m"] == pytest.approx((0.3, -0.2, 0.25), abs=0.002)
    assert report.measured["pose_error_m"] < 0.002
    assert (report.measured["holding"], report.measured["contact"]) == (False, False)
    lid = world.privileged.oracle()[:5]
    held = [world.execute(action) for action in lid][-1].measured
    assert held["holding"] is True
    assert held["held_width_m"] == pytest.approx(0.0238, abs=0.001)


def test_fingers_that_close_on_nothing_have_not_done_what_was_asked(open_world: Open) -> None:
    world = open_world()
    world.execute(to(0.3, -0.2, 0.25))
    empty = world.execute(Gripper("close"))
    assert (empty.executed, empty.measured["holding"]) == (False, False)
    assert "closed on nothing" in (empty.fault or "")
    assert world.execute(Gripper("open")).executed


@pytest.mark.parametrize(
    ("action", "fault"),
    [
        (to(0.5, 0.0, 0.2), "x = 0.500 m is out of reach [0.03, 0.38] m"),
        (to(0.2, 0.0, 0.2, yaw_rad=0.5), "turned by 29 degrees; this gripper does not turn"),
        (MoveTo(Pose(np.array([0.2, 0.0, 0.2]), np.array([0.9, 0.4, 0.0, 0.0]))), "leans over"),
    ],
)
def test_what_the_arm_cannot_do_is_a_fault_and_moves_nothing(open_world: Open, action: Action, fault: str) -> None:
    world = open_world()
    before = world.privileged.track().poses["lid"]
    report = world.execute(action)
    assert not report.executed
    assert fault in (report.fault or "")
    assert len(world.privileged.track().poses["lid"]) == len(before)


def test_what_a_world_does_not_run_is_an_error(open_world: Open) -> None:
    world = open_world()
    with pytest.raises(ConfigError, match="runs move_to, gripper, home; got push"):
        world.execute(Push(np.zeros(3), np.ones(3)))
    world.close()
    world.close()
    with pytest.raises(ConfigError, match="closed"):
        world.execute(Home())


def test_stopping_in_mid_motion_holds_and_what_is_held_stays_held(open_world: Open) -> None:
    world = open_world()
    for action in world.privileged.oracle()[:5]:
        world.execute(action)
    assert world.observe().robot.holding  # type: ignore[union-attr]
    seen: list[float] = []

    def stop_soon(pictures: Any) -> None:
        assert {"top", "front"} == set(pictures)
        seen.append(world.time_s)
        if len(seen) == 3:
            world.stop()

    world.film(stop_soon, every_s=0.05)
    report = world.execute(to(0.3, 0.3, 0.35))
    assert (report.executed, report.fault) == (False, "the world was stopped")
    assert report.measured["holding"] is True
    assert report.measured["pose_error_m"] > 0.05
    at = len(world.privileged.track().poses["lid"])
    assert not world.execute(Gripper("open")).executed
    assert len(world.privileged.track().poses["lid"]) == at
    assert world.observe().robot.holding  # type: ignore[union-attr]


def test_a_motion_that_goes_nowhere_ends_and_says_how_far_off(
    open_world: Open, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FETCH_STAND_IN", "stuck")
    world = open_world()
    steps = len(world.privileged.track().poses["lid"])
    report = world.execute(to(0.3, 0.0, 0.2))
    assert not report.executed
    assert "mm from its goal (limit 12 mm)" in (report.fault or "")
    assert len(world.privileged.track().poses["lid"]) - steps < 200


def test_a_touch_on_the_way_down_stops_an_empty_tool(open_world: Open, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FETCH_STAND_IN", "touch")
    world = open_world()
    world.execute(to(0.3, 0.3, 0.3))
    report = world.execute(to(0.3, 0.3, 0.05))
    assert not report.executed
    assert "touched something on its way down" in (report.fault or "")
    assert report.measured["tool_m"][2] > 0.1
    assert report.measured["contact"] is True


def test_what_slips_out_of_the_fingers_is_a_fault(open_world: Open, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FETCH_STAND_IN", "slip")
    world = open_world("lid", seed=3)
    reports = [world.execute(action) for action in world.privileged.oracle()[:5]]
    assert all(report.executed for report in reports[:4])
    assert "slipped" in (reports[4].fault or "")
    assert reports[4].measured["held_width_m"] is None


@pytest.mark.parametrize(
    ("broken", "words"),
    [
        ("crash", "ended while it was asked 'step'"),
        ("hang", "did not answer 'step' within"),
        ("nothing", "means nothing"),
    ],
)
def test_a_simulator_that_breaks_is_the_worlds_error(
    open_world: Open, monkeypatch: pytest.MonkeyPatch, broken: str, words: str
) -> None:
    monkeypatch.setenv("FETCH_STAND_IN", broken)
    monkeypatch.setattr("wonderful_team.sims.fetch.world.STEP_TIMEOUT_S", 1.0 if broken == "hang" else 60.0)

    def use() -> None:
        world = open_world()
        for _ in range(3):
            world.execute(to(0.3, 0.2, 0.3))
            world.execute(Home())

    with pytest.raises(WorldUnavailableError, match=words):
        use()


def test_no_name_and_no_pose_of_a_thing_comes_with_what_an_agent_may_see() -> None:
    simulator = start(find_python())
    scene, cameras = set_table(3, 2), lenses()
    names = [body_name(scene, name) for name in scene.things]
    try:
        opened = simulator.ask("open", xml=model_xml(scene, cameras, "@"), bodies=names, size_px=[640, 480])
        stepped = simulator.ask("step", {"action": np.zeros(4, np.float32)})
        looked = simulator.ask("look", cameras=list(cameras))
    finally:
        simulator.close()
    for said, arrays in (opened, stepped, looked):
        assert not [name for name in (*names, *scene.things) if name in json.dumps(said)]
        assert {name.partition(":")[0] for name in arrays} <= {"rgb", "depth"}


def test_what_was_seen_is_known_newest_first_and_the_lid_is_the_boxs_until_it_is_off(open_world: Open) -> None:
    world = open_world("lid", seed=3)
    before = world.observe()
    solve(world)
    after = world.observe()
    log = world.privileged.observation_log("top")
    assert [sight.view.hash for sight in log][:: len(log) - 1] == [after.main.hash, before.main.hash]
    newest, oldest = log[0], log[-1]
    assert "lid" not in oldest.things
    assert "lid" in newest.things
    assert oldest.things["box"].height_m > newest.things["box"].height_m
    covered = before.main.camera.project([oldest.things["box"].position_m + (0.05, 0.0, 0.093)])[0]  # type: ignore[union-attr]
    assert oldest.masks["box"][int(covered[1]), int(covered[0])]
    for sight in (newest, oldest):
        for name, thing in sight.things.items():
            u, v = sight.view.camera.project([thing.grasp_m])[0]  # type: ignore[union-attr]
            assert name == "box" or sight.masks[name][int(v), int(u)], name
    assert world.privileged.observation_log("elsewhere") == ()


def test_depth_has_its_faults_where_they_are_asked_for(open_world: Open) -> None:
    exact = open_world("lid", seed=3).observe().main.depth_m
    one, same = (open_world("lid@depth=2", seed=3).observe().main.depth_m for _ in range(2))
    assert exact is not None
    assert one is not None
    assert np.isfinite(exact).all()
    assert np.isnan(one).any()
    np.testing.assert_array_equal(one, same)


def test_names_that_mean_nothing_are_refused_before_anything_starts() -> None:
    with pytest.raises(UnknownNameError, match="lid_two"):
        FetchWorld("lidd")
    with pytest.raises(ConfigError, match="after @ comes depth=1"):
        FetchWorld("lid@xarm7")
    with pytest.raises(ConfigError, match="from 0 .none. to 3"):
        FetchWorld("lid@depth=7")
    with pytest.raises(ConfigError, match="say it once"):
        FetchWorld("lid@depth=2", depth=1)
    with pytest.raises(ConfigError, match="0 or more"):
        FetchWorld("lid", -1)
