"""The command line as a user meets it: exit codes, JSON, messages, interruption."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from tests.interrupting import listen
from wonderful_team.cli.app import COMMANDS, run

OWN = '''
"""Models and worlds for the tests of the command line."""
import time

import numpy as np

import wonderful_team as wt
from wonderful_team.errors import ModelUnavailableError, RobotFaultError


class Down:
    name = "down"

    def answer(self, request):
        raise ModelUnavailableError("no server at the other end")


class Slow:
    name = "slow"

    def answer(self, request):
        print("ASKED", flush=True)
        time.sleep(60)


class Babbling:
    name = "babbling"

    def answer(self, request):
        return "I think that"


class Fixed:
    name = "fixed"

    def decide(self, situation):
        if situation.executed:
            return wt.Done("moved once")
        step = wt.PickPlaceStep("G1", pick="T1", place=wt.At("T2"))
        return wt.Act((wt.PlannedAction(step, wt.PickPlace(np.array([0.5, 0.2, 0.0]), np.array([0.5, -0.2, 0.0]))),))


class Faulty:
    vocabulary = wt.PICK_PLACE
    limits = wt.Limits((0.25, -0.5, -0.01), (0.75, 0.5, 0.5))

    def observe(self):
        return wt.Observation({"top": wt.View("top", "top", 0.0, np.full((64, 128, 3), 90, np.uint8))})

    def execute(self, action):
        raise RobotFaultError("joint 3: torque limit")
'''


@pytest.fixture
def desk(tmp_path: Path) -> Path:
    """A photo: a red and a blue square on a light grey desk."""
    rgb = np.full((300, 400, 3), 200, np.uint8)
    rgb[120:170, 80:130] = (200, 30, 30)
    rgb[120:170, 260:310] = (30, 60, 200)
    path = tmp_path / "desk.png"
    cv2.imwrite(str(path), rgb[:, :, ::-1])
    return path


@pytest.fixture
def own(tmp_path: Path) -> Path:
    path = tmp_path / "own.py"
    path.write_text(OWN, encoding="utf-8")
    return path


def document(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """The one JSON document on stdout."""
    found = json.loads(capsys.readouterr().out)
    assert set(found) == {"schema_version", "command", "exit_code", "result", "error"}
    assert found["schema_version"] == 1
    return dict(found)


def test_help_answers_at_once_and_names_every_command_and_exit_code() -> None:
    fastest = 9.0
    for _ in range(3):
        started = time.monotonic()
        done = subprocess.run([sys.executable, "-m", "wonderful_team", "--help"], capture_output=True, text=True)
        fastest = min(fastest, time.monotonic() - started)
    assert done.returncode == 0
    assert all(command in done.stdout for command in COMMANDS)
    assert "130 interrupted" in " ".join(done.stdout.split())
    assert fastest < 1.0  # about 0.2 s on an idle machine


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([command, "--help"]) == 0
    assert "Options:" in capsys.readouterr().out


def test_a_plan_for_a_photo_in_pixels(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", str(desk), "put the red square to the left of the blue square"]) == 0
    told = capsys.readouterr()
    assert "PLAN  pick_place  T1" in told.out
    assert "red square @ (105, 145) px" in told.out
    assert told.out.splitlines()[-1].startswith("page: ")
    assert Path(told.out.splitlines()[-1].removeprefix("page: ")).is_file()
    for stage in ("draft", "checked", "grounded", "actions"):
        assert f" s  {stage} " in told.err
    assert "0.0000 USD" in told.err


def test_a_plan_with_corners_is_in_metres(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    corners = "0,0 400,0 400,300 0,300=0.8x0.6"
    argv = ["plan", str(desk), "put the red square to the left of the blue square", "--corners", corners, "--json"]
    assert run(argv) == 0
    action = document(capsys)["result"]["actions"][0]["action"]
    assert action["kind"] == "pick_place"
    # Pixel (105, 145) of 400 x 300 on a table of 0.8 x 0.6 m: x runs down the picture, y to the right.
    assert action["pick_m"][:2] == pytest.approx([0.29, 0.21], abs=0.01)


def test_json_is_one_document_with_everything(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", str(desk), "put the red square to the left of the blue square", "--json"]) == 0
    result = document(capsys)["result"]
    assert result["status"] == "planned"
    assert result["targets"][0]["status"] == "found"
    assert result["targets"][0]["box_px"] == pytest.approx([80, 120, 130, 170], abs=3)
    assert result["usage"]["calls"] == sum(role["calls"] for role in result["usage_by_role"].values()) > 3
    assert Path(result["page"]).is_file()


@pytest.mark.parametrize(("until", "has_boxes"), [("draft", False), ("checked", False), ("grounded", True)])
def test_until_stops_early(desk: Path, until: str, has_boxes: bool, capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        run(["plan", str(desk), "put the red square to the left of the blue square", "--until", until, "--json"]) == 0
    )
    result = document(capsys)["result"]
    assert result["status"] == until
    assert result["actions"] == []
    assert any(target["box_px"] is not None for target in result["targets"]) == has_boxes


def test_ground_finds_and_writes_coco(desk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    coco = tmp_path / "boxes.json"
    assert run(["ground", str(desk), "red square", "blue square", "--coco", str(coco), "--json"]) == 0
    assert [target["status"] for target in document(capsys)["result"]["targets"]] == ["found", "found"]
    written = json.loads(coco.read_text(encoding="utf-8"))
    assert [category["name"] for category in written["categories"]] == ["red square", "blue square"]
    assert written["annotations"][0]["bbox"] == pytest.approx([80, 120, 50, 50], abs=4)


def test_what_is_not_there_is_exit_1(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ground", str(desk), "green square"]) == 1
    assert "not here" in capsys.readouterr().out


def test_nonsense_is_exit_7_and_names_the_unknown_words(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", str(desk), "put the frobnicator on the red square"]) == 7
    told = capsys.readouterr().out
    assert "NOT UNDERSTOOD" in told
    assert "frobnicator" in told


def test_an_unknown_task_is_exit_2_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["run", "tabletop/rotat"]) == 2
    assert "Did you mean 'tabletop/rotate'?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("argv", "says"),
    [
        (["run", "tabletop"], "say which task"),
        (["run", "rotate"], "say tabletop/rotate"),
        (["run", "tabletop/rotate", "--model", "http://me:word@127.0.0.1:8000/v1"], "must hold no user, password"),
        (["run", "tabletop/rotate", "--model", "ofline"], "Did you mean 'offline'?"),
        (["run", "tabletop/rotate", "--model", "chequer=offline"], "Did you mean 'checker'?"),
        (["run", "tabletop/rotate", "--model", "missing.py:M"], "there is no file"),
        (["run", "tabletop/rotate", "--method", "teem"], "Did you mean 'team'?"),
        (["run", "tabletop/rotate", "--video", "out.avi"], ".webp"),
        (["run", "tabletop/rotate", "--plan", "nothing"], "unknown run"),
        (["run", "tabletop/rotate", "--seed", "-1"], "--seed"),
        (["show", "nothing"], "unknown run"),
        (["plan", "no-such.jpg", "put the red square on the blue square"], "no-such.jpg"),
        (["plan", "one-word"], "INSTRUCTION"),
        (["dem"], "Did you mean 'demo'?"),
        (["list", "modells"], "models"),
    ],
)
def test_wrong_use_is_exit_2_in_one_paragraph(argv: list[str], says: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(argv) == 2
    told = capsys.readouterr()
    assert says in told.err
    assert "Traceback" not in told.err
    assert len(told.err.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("extra", "says"),
    [
        (["--corners", "1,2 3,4"], "four are needed"),
        (["--corners", "0,0 9,0 9,9 0,9"], "metres are missing"),
        (["--corners", "0,0 9,0 9,9 0,900=1x1"], "outside the picture"),
        (["--corners", "0,0 9,0 90,0 0,9=1x1"], "one line"),
        (["--corners", "0,0 9,0 9,9 0,9=0x1"], "must be positive"),
        (["--keep-out", "1,2,3"], "x0,y0,x1,y1"),
        (["--keep-out", "9,9,3,3"], "x0 < x1"),
        (["--picture", "cup"], "NAME=FILE"),
        (["--depth", "depth.npy"], "--camera"),
        (["--camera", "camera.json"], "camera.json"),
        (["--prompts", "nowhere"], "is not a folder"),
    ],
)
def test_malformed_options_say_what_is_valid(
    desk: Path, extra: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["plan", str(desk), "put the red square on the blue square", *extra]) == 2
    assert says in capsys.readouterr().err


def test_an_error_with_json_is_a_document_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["run", "tabletop/rotat", "--json"]) == 2
    found = document(capsys)
    assert found["exit_code"] == 2
    assert found["error"]["type"] == "UnknownNameError"


def test_an_unavailable_model_is_exit_3(desk: Path, own: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", str(desk), "put the red square on the blue square", "--model", f"{own}:Down"]) == 3
    assert "no server at the other end" in capsys.readouterr().err


def test_a_region_in_the_way_is_exit_4(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    argv = ["plan", str(desk), "put the red square to the left of the blue square", "--keep-out", "lamp=60,100,150,190"]
    assert run(argv) == 4
    assert "keep-out lamp" in capsys.readouterr().out


def test_a_cap_is_exit_5_and_keeps_the_best_so_far(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    argv = ["plan", str(desk), "put the red square to the left of the blue square", "--max-calls", "2", "--json"]
    assert run(argv) == 5
    result = document(capsys)["result"]
    assert result["status"] == "budget"
    assert "2 calls" in result["message"]
    assert result["usage"]["calls"] == 2
    assert result["subgoals"]


def test_a_robot_fault_is_exit_6(own: Path, capsys: pytest.CaptureFixture[str]) -> None:
    argv = ["run", f"{own}:Faulty", "move it", "--method", f"{own}:Fixed"]
    assert run(argv) == 6
    assert "torque limit" in capsys.readouterr().out


def test_a_model_that_babbles_is_the_methods_failure(desk: Path, own: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", str(desk), "put the red square on the blue square", "--model", f"{own}:Babbling"]) == 1
    assert "no valid answer to DraftPlan in 3 attempts" in capsys.readouterr().out


def approved_run(own: Path) -> list[str]:
    return f"run tabletop/rotate --seed 3 --method {own}:Fixed --approve --replans 0 --json".split()


def test_approval_that_is_refused_moves_nothing(own: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.setattr("builtins.input", lambda: "n")
    assert run(approved_run(own)) == 4
    result = document(capsys)["result"]
    assert result["executed"] == 0
    assert any("approval" in reason for reason in result["refusals"])


def test_approval_that_is_given_lets_it_run(own: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.setattr("builtins.input", lambda: "y")
    run(approved_run(own))
    assert document(capsys)["result"]["executed"] == 1


def test_the_plan_that_was_read_is_the_plan_that_runs(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    film = tmp_path / "run.webp"
    assert run(["run", "tabletop/rotate", "--seed", "3", "--json"]) == 0
    first = document(capsys)["result"]
    assert run(["run", "tabletop/rotate", "--seed", "3", "--plan", "latest", "--video", str(film), "--json"]) == 0
    second = document(capsys)["result"]
    assert second["plan_ids"] == first["plan_ids"]
    assert film.stat().st_size > 1000
    assert run(["run", "tabletop/rotate", "--seed", "4", "--plan", first["folder"], "--replans", "0", "--json"]) == 4
    assert any("instruction of the plan" in reason for reason in document(capsys)["result"]["refusals"])


def test_show_tells_the_story_and_one_role(desk: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run(["plan", str(desk), "put the red square to the left of the blue square"])
    capsys.readouterr()
    assert run(["show", "latest"]) == 0
    told = capsys.readouterr().out
    assert "put the red square to the left of the blue square" in told
    assert "again: wonderful-team plan" in told
    assert run(["show", "latest", "--role", "supervisor"]) == 0
    assert "DraftPlan" in capsys.readouterr().out
    assert run(["show", "latest", "--role", "chef"]) == 2
    assert "supervisor" in capsys.readouterr().err


@pytest.mark.parametrize("kind", ["models", "worlds", "tasks", "methods", "prompts", "runs"])
def test_list(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["list", kind, "--json"]) == 0
    found = document(capsys)["result"][kind]
    assert found or kind == "runs"


def test_listed_prompts_can_be_edited_and_used(desk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = tmp_path / "words"
    assert run(["list", "prompts", "--out", str(words)]) == 0
    file = words / "supervisor.md"
    file.write_text("You plan. Be brief.\n", encoding="utf-8")
    capsys.readouterr()
    assert run(["plan", str(desk), "put the red square on the blue square", "--prompts", str(words), "--json"]) == 0
    folder = Path(document(capsys)["result"]["folder"])
    assert "You plan. Be brief." in (folder / "record.json").read_text(encoding="utf-8")


def test_doctor_finds_this_machine_ready(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", "not-to-be-shown")
    assert run(["doctor", "--json"]) == 0
    told = document(capsys)
    assert told["result"]["ready"] is True
    assert "not-to-be-shown" not in json.dumps(told)
    assert "OPENAI_API_KEY set" in json.dumps(told)


def test_doctor_says_when_the_disk_cannot_be_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("", encoding="utf-8")
    assert run(["doctor", "--out", str(blocked / "runs")]) == 2
    assert "cannot be written" in capsys.readouterr().out


@pytest.mark.parametrize("command", ["plan", "run"])
def test_ctrl_c_ends_cleanly(command: str, desk: Path, own: Path, runs_folder: Path) -> None:
    what = [str(desk), "put the red square on the blue square"] if command == "plan" else ["tabletop/rotate"]
    process = subprocess.Popen(
        [sys.executable, "-m", "wonderful_team", command, *what, "--model", f"{own}:Slow"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=dict(os.environ),
        preexec_fn=listen,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ASKED\n"
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "interrupted" in told
    assert "Traceback" not in told
    record = json.loads((runs_folder / "latest" / "record.json").read_text(encoding="utf-8"))
    assert "interrupted" in (record["state"], (record["outcome"] or {}).get("stage"))
    assert (runs_folder / "latest" / "page.html").is_file()
    assert run(["show", "latest"]) == 0


def test_a_script_without_input_approves_nothing(own: Path, runs_folder: Path) -> None:
    argv = ["run", "tabletop/rotate", "--method", f"{own}:Fixed", "--approve", "--replans", "0"]
    done = subprocess.run(
        [sys.executable, "-m", "wonderful_team", *argv], stdin=subprocess.DEVNULL, capture_output=True, text=True
    )
    assert done.returncode == 4
    assert "you declined" in done.stdout
