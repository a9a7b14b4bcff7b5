"""The Python face: plans, rollouts, run folders, notebooks."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team.core.protocols import Event
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.record.run_folders import all_runs, find_run

WANTED = "put the red square to the left of the blue square"


@pytest.fixture
def desk() -> wt.Observation:
    rgb = np.full((300, 400, 3), 200, np.uint8)
    rgb[120:170, 80:130], rgb[120:170, 260:310] = (200, 30, 30), (30, 60, 200)
    return wt.Observation({"photo": wt.View("photo", "photo", 0.0, rgb)})


def test_a_plan_says_what_was_found_what_it_cost_and_where_its_page_is(desk: wt.Observation, runs_folder: Path) -> None:
    plan = wt.Team().plan(desk, WANTED)
    assert plan.status == "planned"
    assert plan.verified
    red = plan.targets[0]
    assert red.words == "red square"
    assert red.point_px is not None
    assert red.box_px == pytest.approx((80, 120, 130, 170), abs=3)
    assert plan.usage.calls == sum(usage.calls for usage in plan.usage_by_role.values())
    assert plan.usage.usd == 0
    assert plan.page == runs_folder / plan.page.parent.name / "page.html"  # type: ignore[union-attr]
    assert plan.page.is_file()
    assert plan.gate is not None
    assert plan.gate.admitted


def test_every_call_is_a_run_of_its_own(desk: wt.Observation) -> None:
    team = wt.Team(max_calls=60)
    first, second = team.plan(desk, WANTED), team.plan(desk, WANTED)
    assert first.id == second.id
    assert first.usage.calls == second.usage.calls
    assert first.folder != second.folder
    assert len(all_runs()) == 2
    assert find_run("latest").resolve() == second.folder


def test_it_works_inside_a_running_event_loop(desk: wt.Observation) -> None:
    async def notebook() -> str:
        return wt.Team().plan(desk, WANTED).status

    assert asyncio.run(notebook()) == "planned"


def test_events_arrive_while_the_team_works(desk: wt.Observation) -> None:
    class Seen:
        def __init__(self) -> None:
            self.stages: list[str] = []

        def on_event(self, event: Event) -> None:
            if event.kind == "stage":
                self.stages.append(event.name)

    seen = Seen()
    wt.Team(subscribers=[seen]).plan(desk, WANTED)
    assert seen.stages == ["draft", "grounded", "checked", "actions", "not asked"]


def test_grounding_alone(desk: wt.Observation) -> None:
    for method in ("team", "team:paper", "team:s7"):
        found = wt.Team(method=method).ground(desk, ["red square"], areas=["free area left of the red square"])
        assert [target.status for target in found.targets] == ["found", "found"]
        x, y = found.targets[0].point_px or (0, 0)
        assert 80 <= x <= 130
        assert 120 <= y <= 170
        assert (found.targets[1].point_px or (999, 0))[0] < 80
    with pytest.raises(ConfigError, match="at least one description"):
        wt.Team().ground(desk)


def test_strict_refuses_what_nobody_verified(desk: wt.Observation) -> None:
    assert wt.Team(method="team:s1").plan(desk, WANTED).status == "planned"
    assert wt.Team(method="team:s1", strict=True).plan(desk, WANTED).status == "refused"


def test_a_rollout_runs_the_plan_that_was_read() -> None:
    world = wt.make_world("tabletop/rotate", seed=3)
    team = wt.Team()
    plan = team.plan(world.observe(), world.instruction, limits=world.limits)
    trial = wt.rollout(team, world, plan=plan, seed=3, scene="rotate")
    world.close()
    assert trial.outcome == "success"
    assert [made.id for made in trial.plans] == [plan.id]
    assert trial.page is not None
    assert trial.page.is_file()
    record = json.loads((trial.page.parent / "record.json").read_text(encoding="utf-8"))
    assert record["configuration"]["method"] == "team"
    assert record["planner"]["limits"]["low_m"] == list(world.limits.low_m)


def test_a_plan_of_another_scene_is_refused_by_the_gate() -> None:
    world, other = wt.make_world("tabletop/rotate", seed=3), wt.make_world("tabletop/rotate", seed=4)
    team = wt.Team()
    plan = team.plan(world.observe(), world.instruction)
    trial = wt.rollout(team, other, plan=plan)
    world.close()
    other.close()
    assert trial.stage == "gate"
    assert trial.reports == ()


def test_an_unscored_trial_is_not_a_success() -> None:
    world = wt.make_world("tabletop/rotate", seed=3)
    trial = wt.rollout(wt.Team(), world, scored=False)
    world.close()
    assert trial.outcome == "unscored"


def test_metres_without_a_workspace_are_told_as_a_warning() -> None:
    world = wt.make_world("tabletop/rotate", seed=3)
    plan = wt.Team().plan(world.observe(), world.instruction)
    world.close()
    assert plan.folder is not None
    record = json.loads((plan.folder / "record.json").read_text(encoding="utf-8"))
    assert any("no workspace is stated" in text for text in record["planner"]["warnings"])


def test_wrong_names_are_told_before_anything_is_made(desk: wt.Observation, runs_folder: Path) -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'team:paper'"):
        wt.Team(method="team:papr")
    with pytest.raises(UnknownNameError, match="vocabulary"):
        wt.Team().plan(desk, WANTED, vocabulary="pickplace")
    with pytest.raises(ConfigError, match="must be positive"):
        wt.Team(max_calls=0)
    with pytest.raises(ConfigError, match="is empty"):
        wt.Team().plan(desk, "  ")
    assert all_runs(runs_folder) == []


def test_runs_are_found_by_part_of_their_name(desk: wt.Observation, runs_folder: Path) -> None:
    made = wt.Team().plan(desk, WANTED, until="draft")
    assert made.folder is not None
    assert find_run("red-square") == made.folder
    assert find_run(str(made.folder / "page.html")) == made.folder
    (runs_folder / "other").mkdir()
    with pytest.raises(ConfigError, match=r"it has no record\.json"):
        find_run("other")
