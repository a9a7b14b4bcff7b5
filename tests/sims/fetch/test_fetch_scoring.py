"""What counts as done: the right thing in the box, the lid lifted off and on the table, the box upright."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest

from wonderful_team.core.geometry import Pose
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.sims.fetch.scene import FetchScene, set_table
from wonderful_team.sims.fetch.scoring import Track, inside, lid_on, pushed_off, score_of
from wonderful_team.sims.fetch.things import BOX_INSIDE_M, FLOOR_M, KINDS, RIM_M

SCENE = set_table(1000, 1)
(WANTED,) = SCENE.wanted
AWAY = (0.3, 0.2)


def starting(scene: FetchScene = SCENE) -> dict[str, Pose]:
    return {name: Pose.at((one.x_m, one.y_m, one.z_m), one.yaw_rad) for name, one in scene.things.items()}


def in_box(name: str, poses: Mapping[str, Pose], aside_m: float = 0.0) -> Pose:
    x, y, _ = poses["box"].position_m
    return Pose.at((x, y + aside_m, FLOOR_M))


def done() -> dict[str, Pose]:
    poses = starting()
    return poses | {"lid": Pose.at((*AWAY, 0.0)), WANTED: in_box(WANTED, poses)}


def lift(*, held: bool = True, high_m: float = 0.1, box_follows: bool = False) -> Track:
    """The lid goes up, across, and down; everything else stays, but for a box that is taken along."""
    poses = starting()
    lid, box = poses["lid"].position_m, poses["box"].position_m
    ways = [lid, lid + (0, 0, high_m), lid + (0, 0.1, high_m), np.array([*AWAY, high_m]), np.array([*AWAY, 0.0])]
    rows: dict[str, Array] = {}
    for name, pose in poses.items():
        at = np.tile(pose.position_m, (len(ways), 1))
        if name == "lid":
            at = np.array(ways)
        if name == "box" and box_follows:
            at = box + np.array(ways) - lid
        rows[name] = np.column_stack([at, np.tile(pose.quaternion_wxyz, (len(ways), 1))])
    flags = {name: np.zeros(len(ways), dtype=bool) for name in poses}
    flags["lid"] = np.array([True, True, True, True, False]) & held
    flags[WANTED] = np.array([False, False, False, False, True])
    return Track(rows, flags)


def score(poses: Mapping[str, Pose], track: Track | None = None, touched: tuple[str, ...] = (), closings: int = 2) -> tuple[bool | None, str | None, str]:  # fmt: skip
    found = score_of(SCENE, poses, touched, track or lift(), closings)
    return found.success, found.stage, found.reason


def test_done_is_done() -> None:
    assert score(done())[0] is True


@pytest.mark.parametrize(("held", "high_m"), [(False, 0.1), (True, 0.001), (False, 0.0)])
def test_a_lid_that_was_pushed_off_is_a_failure_though_everything_lies_right(held: bool, high_m: float) -> None:
    track = lift(held=held, high_m=high_m)
    assert pushed_off(track)
    success, _, reason = score(done(), track)
    assert success is False
    assert "pushed off, not lifted" in reason


def test_a_box_that_moves_with_its_lid_is_not_pushed_out_from_under_it() -> None:
    assert not pushed_off(lift(box_follows=True, held=False))


def test_a_lid_must_lie_flat_on_the_table() -> None:
    leaning = Pose(np.array([*AWAY, 0.02]), np.array([math.cos(0.2), math.sin(0.2), 0.0, 0.0]))
    on_something = Pose.at((*AWAY, 0.04))
    gone = Pose.at((0.7, 0.0, -0.4))
    for pose, words in (
        (leaning, "does not lie flat"), (on_something, "does not lie flat"), (gone, "not on the table"),
        (starting()["lid"], "on the box"),
    ):  # fmt: skip
        success, _, reason = score(done() | {"lid": pose})
        assert success is False
        assert words in reason


def test_what_lies_on_the_lid_or_over_the_rim_is_not_in_the_box() -> None:
    poses = starting()
    x, y, _ = poses["box"].position_m
    block = KINDS["block"]
    assert inside(block, Pose.at((x, y, FLOOR_M)), poses["box"])
    assert not inside(block, Pose.at((x, y, RIM_M + 0.008)), poses["box"])
    assert not inside(block, Pose.at((x, y, RIM_M - 0.005)), poses["box"])
    assert not inside(block, Pose.at((x, y + BOX_INSIDE_M[1] / 2 + 0.01, 0.0)), poses["box"])
    tilted = Pose(np.array([x, y, 0.03]), np.array([math.cos(0.4), math.sin(0.4), 0.0, 0.0]))
    assert inside(KINDS["candle"], tilted, poses["box"])


def test_the_wrong_thing_in_the_box_a_fallen_box_and_what_is_still_held_are_failures() -> None:
    other = next(name for name in SCENE.things if name in KINDS and name != WANTED)
    poses = done()
    fallen = Pose(poses["box"].position_m, np.array([math.cos(0.3), math.sin(0.3), 0.0, 0.0]))
    for changed, touched, words in (
        ({other: in_box(other, poses, 0.03)}, (), "is in the box too"),
        ({other: Pose.at((0.7, 0.0, -0.4))}, (), "fell off the table"),
        ({"box": fallen}, (), "does not stand upright"),
        ({}, (WANTED,), "not let go"),
        ({}, ("lid",), "the lid was not let go"),
        ({WANTED: starting()[WANTED]}, (), "is not in the box"),
    ):
        success, _, reason = score(poses | changed, touched=touched)
        assert success is False
        assert words in reason


def test_the_stage_says_what_went_wrong() -> None:
    start = starting()
    still = lift()
    nothing = Track(still.poses, {name: np.zeros(5, dtype=bool) for name in still.held})
    other = next(name for name in SCENE.things if name in KINDS and name != WANTED)
    taken = Track(still.poses, {**nothing.held, other: np.ones(5, dtype=bool)})
    no_lid = Track(still.poses, {**nothing.held, WANTED: np.ones(5, dtype=bool)})
    assert score(start, nothing, closings=0)[1] == "plan"
    assert score(start, nothing, closings=1)[1] == "grounding"
    assert score(start, taken)[1] == "wrong object"
    assert score(start, no_lid)[1] == "plan"
    assert score(start, still)[1] == "execution"


def test_the_lid_lies_on_its_box_at_the_start() -> None:
    poses = starting()
    assert lid_on(poses)
    assert not lid_on(poses | {"lid": Pose.at((*AWAY, 0.0))})
