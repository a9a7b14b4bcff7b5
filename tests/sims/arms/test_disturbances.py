"""Things are pushed, put elsewhere, taken away or slip: what happens follows from the seed, and a closed loop makes up for it."""

from __future__ import annotations

import math

import pytest

import wonderful_team as wt
from tests.sims.arms.needed import needs_arms
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
    "kind", ["nudge", pytest.param("hand", marks=pytest.mark.slow), pytest.param("slip", marks=pytest.mark.slow)]
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
