"""One row per arm: every row is whole, and what needs a checkout of other people's models says so."""

from __future__ import annotations

import os
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from tests.sims.arms.needed import needs_arms
from wonderful_team.core.actions import Gripper, Home, MoveTo
from wonderful_team.core.geometry import Pose
from wonderful_team.errors import ConfigError
from wonderful_team.sims.arms import ARMS, make_world
from wonderful_team.sims.arms.model import upright
from wonderful_team.sims.arms.rows import MENAGERIE_VARIABLE
from wonderful_team.sims.arms.scene import ROOM_M

needs_menagerie = pytest.mark.skipif(
    not os.environ.get(MENAGERIE_VARIABLE), reason=f"{MENAGERIE_VARIABLE} names no checkout of MuJoCo Menagerie"
)
every_arm = pytest.mark.parametrize(
    "arm", ["ur5e", pytest.param("xarm7", marks=needs_menagerie), pytest.param("panda", marks=needs_menagerie)]
)


@needs_arms
def test_an_arm_of_menagerie_names_what_is_missing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv(MENAGERIE_VARIABLE, raising=False)
    with pytest.raises(ConfigError, match=f"{MENAGERIE_VARIABLE} is not set"):
        make_world("block_in_bowl@xarm7", seed=1)
    monkeypatch.setenv(MENAGERIE_VARIABLE, str(tmp_path))
    with pytest.raises(ConfigError, match=r"xarm7\.xml is not there"):
        make_world("block_in_bowl@xarm7", seed=1)


@needs_arms
def test_kinematics_finds_the_same_pose_again_all_over_the_workspace() -> None:
    from wonderful_team.sims.arms.kinematics import Kinematics, downwards

    arm = Kinematics(ARMS["ur5e"])
    rng = np.random.default_rng(3)
    for _ in range(25):
        point = rng.uniform((0.27, -0.35, 0.15), (0.69, 0.35, 0.4))
        turn = downwards(float(rng.uniform(-1.5, 1.5)))
        q = arm.reach(point, turn, arm.parked())
        assert q is not None, point
        at, turned = arm.flange(q)
        assert np.linalg.norm(at - point) < 0.001
        assert np.abs(turned - turn).max() < 0.01
    assert arm.reach(np.array([1.4, 0.0, 0.3]), downwards(0.0), arm.parked()) is None


def menagerie_has(name: str) -> None:
    """Skip where the checkout lacks the model of an arm: the copy for tests may hold one alone."""
    try:
        ARMS[name].load()
    except ConfigError as error:
        pytest.skip(str(error))


@needs_arms
@needs_menagerie
@pytest.mark.parametrize("arm", ["xarm7", "panda"])
def test_an_arm_of_menagerie_wipes_with_a_sponge_that_stays_between_its_fingers(arm: str) -> None:
    menagerie_has(arm)
    world = make_world(f"wipe@{arm}", seed=1000)
    try:
        reports = [world.execute(action) for action in world.privileged.oracle()]
        assert [report.fault for report in reports] == [None, None]
        assert all(report.measured["holding"] for report in reports)
        assert world.privileged.score().success
    finally:
        world.close()


@needs_arms
@needs_menagerie
@pytest.mark.parametrize("arm", ["xarm7", "panda"])
def test_an_arm_of_menagerie_carries_a_block_right_across_the_table_and_it_stays_in_its_fingers(arm: str) -> None:
    menagerie_has(arm)
    with closing(make_world(f"block_in_bowl@{arm}", seed=7709)) as world:
        reports = [world.execute(action) for action in world.privileged.oracle()]
        assert [report.fault for report in reports if not report.executed] == []
        closed = next(r for r in reports if isinstance(r.action, Gripper) and r.action.state == "close")
        assert closed.measured["held_width_m"] == pytest.approx(0.045, abs=0.004)
        assert world.privileged.score().success


@needs_arms
@every_arm
def test_every_arm_reaches_the_farthest_places_where_things_are_put(arm: str) -> None:
    menagerie_has(arm)
    with closing(make_world(f"block_in_bowl@{arm}", seed=1000)) as world:
        for y_m in (ROOM_M[1], ROOM_M[3]):
            for up_m in (0.15, 0.02):
                report = world.execute(MoveTo(Pose.at((ROOM_M[2], y_m, up_m), 0.0)))
                assert report.executed, report.fault
            world.execute(Home())


@needs_arms
@every_arm
def test_a_fruit_that_is_gripped_beside_its_middle_stays_upright_while_it_is_carried(arm: str) -> None:
    menagerie_has(arm)
    with closing(make_world(f"fruit_placement/both@{arm}", seed=7712)) as world:
        x, y, _ = world.privileged.truth()["things"]["lime"]["position_m"]
        # Its long axis lies along y; the fingers close across it.
        grip, across = np.array([x, y + 0.006, 0.026]), -np.pi / 2
        for action in (
            MoveTo(Pose.at(grip + (0.0, 0.0, 0.1), across)),
            MoveTo(Pose.at(grip, across)),
            Gripper("close"),
            MoveTo(Pose.at(grip + (0.0, 0.0, 0.2), across)),
            MoveTo(Pose.at(grip + (0.0, 0.3, 0.2), across)),
        ):
            assert world.execute(action).executed
        assert upright(world._table.poses()["lime"].quaternion_wxyz) < np.radians(15)
