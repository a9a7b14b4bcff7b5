"""What counts as a wiped plate: half wiped, wiped in the air, shoved."""

from __future__ import annotations

import numpy as np
import pytest

from tests.sims.arms.needed import needs_arms
from tests.sims.arms.playing import by_team
from wonderful_team.core.actions import Trajectory
from wonderful_team.core.geometry import Pose
from wonderful_team.sims.arms import make_world
from wonderful_team.sims.arms.wiping import OVER_M, SPONGE_HALF_M, Wiping, lanes
from wonderful_team.sims.arms.world import TRACED
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.shapes import WELL_M

PLATE = Thing("plate", "plate", "red", 0.48, 0.05, 0.0)
POSES = {"plate": Pose.at((0.48, 0.05, 0.0))}


def wiped(share: float) -> Wiping:
    work = Wiping(PLATE, WELL_M)
    work.clean[: round(share * len(work.clean))] = True
    return work


@pytest.mark.parametrize(("share", "success"), [(0.0, False), (0.5, False), (0.89, False), (0.91, True), (1.0, True)])
def test_coverage_decides(share: float, success: bool) -> None:
    score = wiped(share).score(POSES)
    assert score.success is success
    assert f"{100 * share:.0f} % of the plate" in score.reason
    assert score.stage == (None if success else "execution" if share else "plan")


def test_a_plate_that_was_shoved_does_not_count() -> None:
    score = wiped(1.0).score({"plate": Pose.at((0.53, 0.05, 0.0))})
    assert score.success is False
    assert "pushed 50 mm" in score.reason


def test_the_oracles_lanes_cover_the_plate() -> None:
    path = lanes((0.48, 0.05), WELL_M)
    assert len(path) <= 20
    work = Wiping(PLATE, WELL_M)
    cells = work._cells + np.array([0.48, 0.05])
    seen = np.zeros(len(cells), dtype=bool)
    for one, other in zip(path[:-1], path[1:], strict=True):
        for share in np.linspace(0, 1, 40):
            away = np.abs(cells - (one + share * (other - one)))
            seen |= (away <= np.array(SPONGE_HALF_M[:2])).all(axis=1)
    assert seen.mean() > 0.99


@needs_arms
def test_only_a_sponge_that_presses_on_the_plate_cleans_it() -> None:
    world = make_world("wipe", seed=3)
    try:
        work = world._table.work
        assert isinstance(work, Wiping)
        x, y, _ = world.privileged.truth()["things"][work.plate.name]["position_m"]
        air = np.array([[x, y - 0.03, OVER_M], [x, y + 0.03, OVER_M]])
        assert world.execute(Trajectory(air)).executed
        assert work.covered == 0.0
        low = air - np.array([0.0, 0.0, OVER_M - 0.006])
        report = world.execute(Trajectory(np.vstack([air[:1], low, air[1:]])))
        way = np.array(report.measured["path_m"])
        assert 10 < len(way) <= TRACED
        assert way[0] == pytest.approx(air[0], abs=0.01), "measured from where the path itself begins"
        assert way[-1] == pytest.approx(report.measured["tool_m"], abs=0.005)
        assert way[:, 2].min() < 0.05 < way[:, 2].max()
        assert report.executed, report.fault
        assert report.measured["contact"]
        assert 0.15 < work.covered < 0.5
        assert world.privileged.score().success is False
        assert report.measured["holding"]
    finally:
        world.close()


def test_a_simulated_model_writes_the_path_of_a_plan_that_was_corrected() -> None:
    """Its first plan leaves out the only move; the right one, which a doubt brings, has a path too."""
    trial = by_team("arms/wipe", 1001, model="simulated:perfect:wrong_plan=1")
    assert trial.outcome == "success", trial.reason
