"""Plans that were read, refused plans and consent, as a user of the command line and of Python meets them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import wonderful_team as wt
from tests.desk import WORDS, draw_desk, read_record
from wonderful_team.cli.app import run
from wonderful_team.errors import ConfigError
from wonderful_team.record import read_run_plan

TASK = "tabletop/everyday/tidy_up"


@pytest.fixture
def world() -> Iterator[Any]:
    made = wt.make_world(TASK, seed=3)
    yield made
    made.close()


def photographed(world: Any, folder: Path) -> list[str]:
    """A photo of a world with its depth and its camera, as `plan` takes them."""
    view = world.observe().main
    cv2.imwrite(str(folder / "photo.png"), view.rgb[..., ::-1])
    np.save(folder / "depth.npy", view.depth_m)
    bounds = {"low": world.limits.low_m, "high": world.limits.high_m}
    camera = {"matrix": view.camera.matrix.tolist(), "size_px": list(view.size_px), "workspace_m": bounds}
    (folder / "camera.json").write_text(json.dumps(camera), encoding="utf-8")
    return [
        str(folder / "photo.png"),
        world.instruction.text,
        *("--camera", str(folder / "camera.json")),
        *("--depth", str(folder / "depth.npy")),
    ]


def outcome(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    return dict(json.loads(capsys.readouterr().out)["result"])


def test_a_plan_for_a_photo_runs_in_the_world_with_that_camera(
    world: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["plan", *photographed(world, tmp_path), "--json"]) == 0
    planned = outcome(capsys)
    assert run(["run", TASK, "--seed", "3", "--plan", planned["folder"], "--json"]) == 0
    done = outcome(capsys)
    assert done["plan_ids"] == [planned["plan_id"]]
    assert done["executed"] == 2
    assert run(["run", TASK, "--seed", "4", "--plan", planned["folder"], "--replans", "3", "--json"]) == 4
    assert outcome(capsys)["executed"] == 0


class Noisy:
    """A world whose camera has noise of its own at every look."""

    def __init__(self, inner: Any) -> None:
        self.inner, self.reobserve = inner, 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)

    def observe(self) -> wt.Observation:
        seen = self.inner.observe()
        self.reobserve += 1
        noise = np.random.default_rng(self.reobserve).normal(0, 3.0, seen.main.rgb.shape)
        rgb = np.clip(seen.main.rgb + noise, 0, 255).astype(np.uint8)
        return replace(seen, views={**seen.views, seen.main.camera_name: replace(seen.main, rgb=rgb)})


@pytest.mark.parametrize("given", ["made", "folder", "read"])
def test_a_plan_that_was_read_runs_under_a_noisy_camera(given: str, world: Any) -> None:
    noisy, team = Noisy(world), wt.Team()
    made = team.plan(noisy.observe(), world.instruction, limits=world.limits)
    assert made.folder is not None
    plan = {"made": made, "folder": made.folder, "read": read_run_plan(made.folder)}[given]
    trial = wt.rollout(team, noisy, plan=plan, approval=made.approve("Ada"))
    assert trial.stage is None, trial.reason
    assert len(trial.reports) == 2
    assert [plan.id for plan in trial.plans] == [made.id]


def test_a_plan_that_was_run_once_can_be_read_from_that_run_too(world: Any) -> None:
    team, noisy = wt.Team(), Noisy(world)
    made = team.plan(noisy.observe(), world.instruction, limits=world.limits)
    first = wt.rollout(team, noisy, plan=made, replans=0)
    again = wt.make_world(TASK, seed=3)
    second = wt.rollout(team, Noisy(again), plan=first.folder, replans=0)
    again.close()
    assert second.stage is None, second.reason
    assert len(second.reports) == 2
    assert [plan.id for plan in second.plans] == [made.id]


def test_consent_does_not_outlive_a_page_that_was_changed(world: Any) -> None:
    team = wt.Team()
    made = team.plan(world.observe(), world.instruction, limits=world.limits)
    consent = made.approve("Ada")
    assert made.page is not None
    made.page.write_text("another page", encoding="utf-8")
    trial = wt.rollout(team, world, plan=made, approval=consent)
    assert (trial.stage, trial.reports) == ("gate", ())
    assert "approved page" in trial.reason


@pytest.mark.parametrize("how", ["seed", "words"])
def test_a_plan_for_another_seed_or_instruction_moves_nothing(
    how: str, capsys: pytest.CaptureFixture[str], runs_folder: Path
) -> None:
    assert run(["run", TASK, "--seed", "3", "--json"]) == 0
    first = outcome(capsys)
    other = ["--seed", "4"] if how == "seed" else ["put the banana into the blue bowl", "--seed", "3"]
    assert run(["run", TASK, *other, "--plan", first["folder"], "--replans", "3"]) == 4
    told = capsys.readouterr()
    record = read_record(runs_folder / "latest")["planner"]
    assert record["executions"] == []
    assert len(record["plans"]) == 1
    page = (runs_folder / "latest" / "page.html").read_text(encoding="utf-8")
    assert "<h3>First plan</h3>" in page, "the plan is drawn on the picture it was made from, beside the scene of now"
    assert "<h3>The scene when it was to run</h3>" in page
    assert record["plan_scene"]["hash"] == record["plans"][0]["plan"]["scene_hash"]
    reason = "unchanged: T1 (pick)" if how == "seed" else "instruction of the plan"
    assert reason in told.err
    assert "executed" in told.out


def test_what_is_no_plan_is_said(world: Any, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="a int is no plan; valid: what team.plan returned"):
        wt.rollout(wt.Team(), world, plan=3)  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match="no-such-run"):
        wt.rollout(wt.Team(), world, plan="no-such-run")


def test_a_refused_plan_is_refused_wherever_it_is_shown(
    tmp_path: Path, runs_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    draw_desk(tmp_path)
    argv = ["plan", str(tmp_path / "desk.png"), WORDS, "--keep-out", "wall=100,0,160,240px"]
    assert run([*argv, "--json"]) == 4
    made = outcome(capsys)
    assert made["status"] == "refused"
    assert "keep-out wall" in made["message"]
    assert run(argv) == 4
    assert capsys.readouterr().out.startswith("REFUSED by the safety gate")
    folder = runs_folder / "latest"
    record = read_record(folder)
    assert (record["outcome"]["outcome"], record["outcome"]["stage"]) == ("refused", "gate")
    assert re.search(r"done +refused .*keep-out wall", (folder / "log.txt").read_text(encoding="utf-8"))
    page = (folder / "page.html").read_text(encoding="utf-8")
    banner = re.search(r'<header class="verdict (.*?)">.*?</header>', page, re.DOTALL)
    assert banner is not None
    assert banner[1] == "bad"
    assert '<strong class="outcome">refused</strong>' in banner[0]
    assert "<title>refused" in page
    assert run(["show", "latest"]) == 0
    told = capsys.readouterr().out
    assert "refused" in told
    assert "keep-out wall" in told
    in_python = wt.Team().plan(
        wt.Observation.from_files(tmp_path / "desk.png"), WORDS, keep_out=[wt.KeepOut("wall", wt.Box(100, 0, 160, 240))]
    )
    assert in_python.status == "refused"


@pytest.mark.parametrize(
    ("said", "code", "questions", "executed"),
    [
        ("n\n", 4, 1, 0),
        ("", 4, 1, 0),
        ("n, because it is the wrong one\nn\n", 4, 2, 0),
        ("n, because it is the wrong one\ny\n", 0, 2, 2),
        ("y\n", 0, 1, 2),
    ],
)
def test_consent_on_the_command_line(
    said: str,
    code: int,
    questions: int,
    executed: int,
    runs_folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    left, pages = said.splitlines(), []

    def answer() -> str:
        pages.append((runs_folder / "latest" / "page.html").is_file())
        if not left:
            raise EOFError
        return left.pop(0)

    monkeypatch.setattr("builtins.input", answer)
    assert run(["run", TASK, "--seed", "3", "--approve"]) == code
    told = capsys.readouterr()
    assert told.err.count("Run this plan?") == len(pages) == questions
    assert all(pages), "the page that the question names exists before it is asked"
    assert len(read_record(runs_folder / "latest")["planner"]["executions"]) == executed
    assert ("you declined" in told.out) == (code == 4)


def test_runs_with_pictures_in_their_instruction_are_compared(capsys: pytest.CaptureFixture[str]) -> None:
    for _ in range(2):
        assert run(["run", "tabletop/rotate", "--seed", "3", "--json"]) == 0
        folder = outcome(capsys)["folder"]
    assert run(["show", "latest", "--diff", folder]) == 0
