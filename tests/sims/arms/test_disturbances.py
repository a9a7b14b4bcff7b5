"""Things are pushed, put elsewhere, taken away or slip: what happens follows from the seed, and a closed loop makes up for it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import wonderful_team as wt
from tests.sims.arms.needed import needs_arms
from wonderful_team.api.replay import replay
from wonderful_team.errors import ConfigError
from wonderful_team.sims.arms import make_world
from wonderful_team.sims.arms.options import asked

pytestmark = needs_arms
Ran = tuple[wt.TrialResult, list[dict[str, object]]]


def ran(task: str, replans: int, seed: int = 1001) -> Ran:
    world = wt.make_world(f"arms/{task}", seed=seed)
    try:
        trial = wt.rollout(wt.Team(model="simulated:perfect"), world, replans=replans)
        return trial, list(world.privileged.truth()["disturbances"])  # type: ignore[attr-defined]
    finally:
        world.close()


@pytest.mark.parametrize(
    "kind", ["nudge", *(pytest.param(kind, marks=pytest.mark.slow) for kind in ("hand", "slip", "wrongbox"))]
)
def test_with_replans_the_loop_makes_up_for_it_and_without_it_fails(kind: str) -> None:
    trial, happened = ran(f"lid_box/one@{kind}=1", replans=0)
    assert [one["kind"] for one in happened] == [kind]
    assert trial.outcome == "failure"
    trial, happened = ran(f"lid_box/one@{kind}=1", replans=3)
    assert [one["kind"] for one in happened] == [kind]
    assert trial.outcome == "success", trial.reason
    assert len(trial.plans) > 1


@pytest.mark.slow
def test_what_is_gone_stays_gone_and_that_is_said() -> None:
    trial, happened = ran("lid_box/one@remove=1", replans=3)
    assert [one["kind"] for one in happened] == ["remove"]
    assert trial.outcome == "failure"
    assert "not found" in trial.reason or "fell off the table" in trial.reason


def test_what_happens_follows_from_the_seed_and_hits_what_still_has_to_go_somewhere() -> None:
    found = []
    for _ in range(2):
        world = make_world("block_in_bowl@hand=1@nudge=1", seed=4)
        try:
            wanted = f"{world.privileged.truth()['words']['colour']} block"
            world._table.disturbances.let_go((wanted,))
            found.append(world._table.disturbances.happened)
            world._table.disturbances.let_go((wanted,))
            assert len(world._table.disturbances.happened) == 2
        finally:
            world.close()
    assert found[0] == found[1]
    nudged, moved = found[0]
    assert (nudged.kind, nudged.thing, moved.kind, moved.thing) == ("nudge", wanted, "hand", wanted)
    assert 0.03 <= math.dist(nudged.from_m, nudged.to_m) <= 0.06
    assert math.dist(moved.from_m, moved.to_m) >= 0.1


def test_disturbances_are_asked_for_by_name() -> None:
    found = asked("star@depth=2@slip=3@nudge=1", None, 0, 0)
    assert (found.depth, dict(found.disturbances)) == (2, {"slip": 3, "nudge": 1})
    with pytest.raises(ConfigError, match="said twice"):
        asked("star@slip=1@slip=2", None, 0, 0)
    with pytest.raises(ConfigError, match="nudge=1 to nudge=3"):
        asked("star@shove=1", None, 0, 0)
    with pytest.raises(ConfigError, match="is no option"):
        asked("star@slip=4", None, 0, 0)


def test_a_thing_in_the_box_is_put_onto_the_plate_by_a_hand_and_the_oracle_brings_it_back() -> None:
    world = make_world("lid_box/one@wrongbox=1", seed=1001)
    try:
        table, truth = world._table, world.privileged
        wanted = f"{truth.truth()['words']['colour']} block"
        table.disturbances.let_go((wanted,))
        assert table.disturbances.happened == []  # it is not where it belongs yet
        box, plate = table.poses()["box"], table.poses()["plate"]
        table.put("lid", np.array([*table.work._free(table.things["lid"], table.poses()), 0.0]), 0.0)
        table.put(wanted, box.position_m, 0.0)
        assert table.arrived(wanted)
        table.disturbances.let_go((wanted,))
        (one,) = table.disturbances.happened
        assert (one.kind, one.thing) == ("wrongbox", wanted)
        assert math.dist(table.poses()[wanted].position_m[:2], plate.position_m[:2]) < 0.03
        assert f"the {wanted} is not in the box" in truth.score().reason
        assert truth.oracle()
        table.disturbances.let_go((wanted,))
        assert len(table.disturbances.happened) == 1
    finally:
        world.close()


def test_only_where_it_is_asked_for_there_is_another_container_and_the_rest_stands_as_without() -> None:
    worlds = [make_world(f"lid_box/one{option}", seed=1001) for option in ("", "@wrongbox=1")]
    try:
        plain, other = (dict(world.privileged.start()) for world in worlds)
        assert set(other) - set(plain) == {"plate"}
        assert all(math.dist(plain[name].position_m, other[name].position_m) < 0.002 for name in plain)
    finally:
        for world in worlds:
            world.close()


@pytest.mark.slow
def test_a_plan_that_is_lost_stops_after_the_subgoal_and_the_record_replays(tmp_path: Path) -> None:
    world = wt.make_world("arms/lid_box/one@nudge=1", seed=1001)
    try:
        trial = wt.rollout(wt.Team(model="simulated:perfect", out=tmp_path), world, replans=1)
    finally:
        world.close()
    assert trial.outcome == "success", trial.reason
    first, second = trial.plans
    assert len(trial.reports) == len(first.actions) // 2 + len(second.actions)
    assert [verdict.status for verdict in trial.verdicts] == ["done", "done"]
    assert trial.folder is not None
    assert replay(trial.folder).same


@pytest.mark.slow
def test_a_trial_whose_arm_went_home_by_itself_replays(tmp_path: Path) -> None:
    world = wt.make_world("arms/lid_box/one@slip=1", seed=1001)
    try:
        trial = wt.rollout(wt.Team(model="simulated:perfect", out=tmp_path), world, replans=1)
    finally:
        world.close()
    assert any(not report.executed for report in trial.reports)
    assert trial.folder is not None
    assert replay(trial.folder).same


def test_what_rests_falls_when_what_it_stood_on_is_taken_away() -> None:
    # Physics leaves out what rests until something touches it, or it is put elsewhere.
    world = make_world("block_in_bowl", seed=4)
    try:
        table = world._table
        block, bowl = f"{world.privileged.truth()['words']['colour']} block", "bowl"
        x, y, _ = table.poses()[bowl].position_m
        table.put(block, np.array([x, y, 0.1]), 0.0)
        table.robot.rest(2.0)
        in_bowl_m = table.poses()[block].position_m[2]
        table.put(bowl, np.array([x, -y, 0.0]), 0.0)
        table.robot.rest(2.0)
        assert table.poses()[block].position_m[2] < in_bowl_m - 0.003
    finally:
        world.close()
