"""A rival and an arm's simulator that this file defines and adds as one row each: every way in finds them by name."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import wonderful_team as wt
from wonderful_team import registry
from wonderful_team.agents import build_request
from wonderful_team.agents.rendering import picture_parts, target_parts
from wonderful_team.agents.role import Ask, role
from wonderful_team.cli import main
from wonderful_team.contracts import ReadScene, SceneReading
from wonderful_team.core.actions import ARM, Action, Gripper, MoveStep, MoveTo, OpenStep, Trajectory
from wonderful_team.core.geometry import Pose
from wonderful_team.core.protocols import Score
from wonderful_team.core.values import RobotState, Target, Verdict
from wonderful_team.errors import ConfigError
from wonderful_team.images import whole
from wonderful_team.registry.methods import METHODS, MethodRow, MethodSetup
from wonderful_team.registry.worlds import WORLDS, WorldRow

SOLO = role(
    "solo",
    "You find things for a robot, alone.",
    Ask(ReadScene, "Where is each target?", lambda q: [*picture_parts(q.view, "the scene"), *target_parts(q.targets)]),
)


class Solo:
    """A rival: one question for each thing, in its own words, then it says what it found."""

    name = "solo"

    def __init__(self, setup: MethodSetup) -> None:
        self.client = setup.client()

    async def decide(self, situation: wt.Situation) -> wt.Done:
        found = 0
        for number, thing in enumerate(("the red circle", "the blue square"), start=1):
            asked = ReadScene((Target("T1", "object", thing),), (), whole(situation.observation.main, "top view"))
            request = build_request(asked, id=f"0/ground/{number}", stage="ground", role=SOLO)
            reading: SceneReading = (await self.client.ask(request)).value
            found += reading.targets[0].found
        return wt.Done(f"found {found} of 2")


class Listening:
    """A model that finds nothing and remembers who asked in which words."""

    name = "listening"

    def __init__(self) -> None:
        self.asked: list[tuple[str, str, str]] = []

    def answer(self, request: wt.Request) -> dict[str, Any]:
        self.asked.append((request.role, request.system, request.parts[-1].text))
        missing = [{"id": t.id, "found": False, "box": None, "points": []} for t in request.question.targets]
        return {"reasoning": "", "targets": missing}


class LiftTable:
    """An arm that has to raise its tool: what it stands for is the row, not the physics."""

    vocabulary = ARM
    limits = wt.Limits(low_m=(0.0, 0.0, 0.0), high_m=(0.5, 0.8, 0.4))
    instruction = wt.Instruction("raise the tool")

    def __init__(self, task: str, seed: int = 0, **tiers: int) -> None:
        self.tool_m = np.array([0.1, 0.2, 0.1])
        self.task, self.privileged = task, self

    def observe(self) -> wt.Observation:
        rgb = np.full((80, 100, 3), 150, np.uint8)
        rgb[20:40, 20:40] = (200, 30, 30)
        return wt.Observation({"top": wt.View("top", "top", 0.0, rgb)}, RobotState(self.tool_m))

    def execute(self, action: Action) -> wt.StepReport:
        if isinstance(action, MoveTo):
            self.tool_m = action.pose.position_m
        return wt.StepReport(action, executed=True)

    def stop(self) -> None: ...

    def close(self) -> None: ...

    def score(self) -> Score:
        return Score(bool(self.tool_m[2] > 0.2))

    def truth(self) -> dict[str, Any]:
        return {}

    def oracle(self) -> Sequence[Action]:
        up = MoveTo(Pose.at((0.1, 0.2, 0.3)))
        return () if self.tool_m[2] > 0.2 else (up, Gripper("open"), Trajectory(np.array([[0.1, 0.2, 0.3]])))


class Raising:
    """A method for it."""

    name = "raising"

    def decide(self, situation: wt.Situation) -> wt.Act | wt.Done:
        if situation.executed:
            return wt.Done("raised", (Verdict("G1", "done"),))
        up = wt.PlannedAction(MoveStep("G1", wt.At("T1")), MoveTo(Pose.at((0.1, 0.2, 0.35))))
        return wt.Act((up, wt.PlannedAction(OpenStep("G1"), Gripper("open"))))


@pytest.fixture
def rows(monkeypatch: pytest.MonkeyPatch) -> None:
    simulator = SimpleNamespace(
        make_world=LiftTable,
        task_names=lambda: {"lift": "Raise the tool."},
        partitions=lambda name: (),
        TIERS=("clutter",),
    )
    monkeypatch.setitem(WORLDS, "armtable", WorldRow("an arm over a table", lambda: simulator))
    monkeypatch.setitem(METHODS, "solo", MethodRow("two questions, no team", Solo))
    monkeypatch.setitem(METHODS, "raising", MethodRow("raises the tool", lambda setup: Raising()))


def exit_code(arguments: list[str]) -> object:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    return ended.value.code


def listed(kind: str, capsys: pytest.CaptureFixture[str]) -> dict[str, str]:
    assert exit_code(["list", kind, "--json"]) == 0
    found: dict[str, str] = json.loads(capsys.readouterr().out)["result"][kind]
    return found


def test_new_rows_are_listed(rows: None, capsys: pytest.CaptureFixture[str]) -> None:
    assert listed("methods", capsys)["solo"] == "two questions, no team"
    assert listed("worlds", capsys)["armtable"] == "an arm over a table"
    assert listed("tasks", capsys)["armtable/lift"] == "Raise the tool."


def test_a_rival_asks_in_a_role_of_its_own_and_its_questions_are_recorded_and_capped(
    rows: None, tmp_path: Path
) -> None:
    model = Listening()
    world = wt.make_world("armtable/lift")
    trial = wt.rollout(wt.Method(method="solo", model={"checker": "offline", "*": model}), world, out=tmp_path)
    assert trial.reason == "found 0 of 2"
    assert model.asked == [("solo", "You find things for a robot, alone.", "Where is each target?")] * 2
    record = json.loads((trial.folder / "record.json").read_text(encoding="utf-8"))
    assert [entry["role"] for entry in record["planner"]["requests"]] == ["solo", "solo"]
    capped = wt.rollout(wt.Method(method="solo", model=Listening(), max_calls=1), wt.make_world("armtable/lift"))
    assert capped.outcome == "failure"
    assert capped.stage == "budget"


def test_a_rival_is_no_team(rows: None, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="is not the team"):
        wt.Team(method="solo")


def test_an_arm_in_a_simulator_runs_and_is_scored(
    rows: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exit_code(["run", "armtable/lift", "--method", "raising", "--out", str(tmp_path)]) == 0
    assert "SUCCESS" in capsys.readouterr().out
    assert registry.own_tiers("armtable/lift") == ("clutter",)
    assert registry.own_tiers("armtable/other") == ("clutter",)
    with pytest.raises(ConfigError, match="unknown task"):
        wt.make_world("armtable/drop")


def test_a_study_runs_new_methods_in_new_worlds_between_its_controls(rows: None, tmp_path: Path) -> None:
    study = wt.Study(
        "armtable/lift", methods=("raising",), controls=("oracle", "no-op"), seeds=(1000,), store=tmp_path / "s.db",
        jobs=1, record="none",
    )  # fmt: skip
    assert study.run().status.outcomes == {"success": 2, "failure": 1}


@pytest.mark.parametrize("name", sorted(WORLDS))
def test_every_simulator_offers_what_the_table_asks_for(name: str) -> None:
    package = WORLDS[name].load()
    assert WORLDS[name].words
    tasks = package.task_names()
    assert tasks
    assert all(isinstance(package.partitions(task), tuple) for task in tasks)
    assert callable(package.make_world)
