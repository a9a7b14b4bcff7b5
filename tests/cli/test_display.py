"""What people are shown: actions in numbers, films of the motion, tables of runs, notebooks, lists."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from PIL import Image

import wonderful_team as wt
from wonderful_team.api.results import TrialResult
from wonderful_team.cli.app import run
from wonderful_team.cli.wording import trial_lines

ROOT = Path(__file__).parents[2]
DESK = str(ROOT / "examples" / "desk.png")
WORDS = "put the red block into the blue bowl"
NASTY = '<script>alert(1)</script>\x1b[2J\u202e"'


@pytest.fixture
def out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("WONDERFUL_TEAM_RUNS", str(tmp_path / "runs"))
    return tmp_path


def test_a_plan_for_an_arm_prints_where_every_move_goes(out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    corners = ["--corners", "20,10 620,10 620,310 20,310=1.0x0.5"]
    assert run(["plan", DESK, WORDS, "--vocabulary", "arm", *corners]) == 0
    moves = [line for line in capsys.readouterr().out.splitlines() if line.startswith("PLAN  move")]
    assert len(moves) >= 4
    for line in moves:
        assert re.search(r"T\d [a-z ]+ @ \(\d+, \d+\) px  \(-?\d\.\d{3}, -?\d\.\d{3}, -?\d\.\d{3}\) m$", line), line


def test_a_film_of_one_action_shows_the_motion_and_changes_nothing(out: Path) -> None:
    film = out / "film.webp"
    words = ["run", "tabletop/rotate", "--seed", "3"]
    assert run([*words, "--video", str(film)]) == 0
    with Image.open(film) as pictures:
        assert getattr(pictures, "n_frames", 1) >= 10
    assert run(words) == 0
    first, second = (json.loads((f / "record.json").read_text("utf-8")) for f in sorted((out / "runs").glob("2*")))
    assert first["planner"]["executions"] == second["planner"]["executions"]


def test_gate_and_pictures_by_number_stand_in_show_the_log_and_the_folder_name(
    out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["run", "tabletop/rotate", "--seed", "3"]) == 0
    told = capsys.readouterr()
    assert "1 plan, 1 action executed" in told.out
    assert run(["show", "latest"]) == 0
    shown = capsys.readouterr().out
    log = (out / "runs" / "latest" / "log.txt").read_text("utf-8")
    for text in (shown, log):
        assert re.search(r"gate +before motion: admitted \(\d+ checks\)", text)
    for text in (told.out, told.err, shown, log, (out / "runs" / "latest").resolve().name):
        assert "{" not in text
        assert "dragged" not in text


def test_the_table_of_runs_is_one_file_with_one_script_named_by_its_hash(
    out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["plan", DESK, WORDS]) == 0
    assert run(["ground", DESK, "red block"]) == 0
    record = out / "runs" / "latest" / "record.json"
    content = json.loads(record.read_text("utf-8"))
    content["planner"]["instruction"]["text"] = NASTY
    record.write_text(json.dumps(content), "utf-8")
    (out / "runs" / "broken").mkdir()
    (out / "runs" / "broken" / "record.json").write_text("{", "utf-8")
    table = out / "new" / "table.html"
    assert run(["list", "runs", "--html", str(table)]) == 0
    assert capsys.readouterr().out.splitlines()[-1].endswith("table.html")
    text = table.read_text("utf-8")
    scripts = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    assert len(scripts) == 1
    digest = base64.b64encode(hashlib.sha256(scripts[0].encode()).digest()).decode()
    assert f"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{digest}'" in text
    assert "<script>alert" not in text
    assert "\x1b" not in text
    assert "\u202e" not in text
    assert text.count("<tr data-outcome=") == 3
    assert text.count("data:image/webp;base64,") == 2
    assert 'data-outcome="unreadable"' in text
    assert "http:" not in text
    assert "https:" not in text
    for link in re.findall(r'href="([^"]+)"', text):
        assert (table.parent / link).is_file()


def test_html_goes_with_runs_only(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["list", "tasks", "--html", "x.html"]) == 2
    assert "list runs" in capsys.readouterr().err


def test_photos_plans_and_trials_show_themselves_in_a_notebook(out: Path) -> None:
    photo = wt.Observation.from_files(DESK)
    team = wt.Team(model="offline")
    plan = team.plan(photo, WORDS)
    world = wt.make_world("tabletop/rotate", seed=3)
    trial = wt.rollout(team, world, seed=3)
    seen = world.observe()
    world.close()
    for shown, pictures in ((photo, 1), (plan, 1), (trial, 2), (seen, 2)):
        html = shown._repr_html_()
        coded = re.findall(r'src="data:image/png;base64,([^"]+)"', html)
        assert len(coded) == pictures
        for data in coded:
            assert base64.b64decode(data).startswith(b"\x89PNG")
        assert "<script" not in html
        assert "{" not in html
    assert "planned: " + WORDS in plan._repr_html_()
    assert "success: every goal is met" in trial._repr_html_()


def test_a_notebook_shows_the_pixels_and_escapes_every_word() -> None:
    from io import BytesIO

    from wonderful_team.core.notebook import card, png_bytes

    rgb = np.random.default_rng(0).integers(0, 255, (37, 53, 3), dtype=np.uint8)
    assert np.array_equal(np.asarray(Image.open(BytesIO(png_bytes(rgb)))), rgb)
    html = card(NASTY, [NASTY], [(rgb, NASTY)])
    assert "<script" not in html
    assert "\x1b" not in html
    assert "\u202e" not in html
    wide = np.zeros((10, 1500, 3), np.uint8)
    assert 'width="500"' in card("wide", pictures=[(wide, "wide")])


def test_list_methods_says_what_each_setting_switches_off(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["list", "methods"]) == 0
    told = capsys.readouterr().out
    for name, words in (
        ("s1", "without Verification"),
        ("s5", "without Verification, Checker and Mover"),
        ("s7", "without Verification, Manager, Checker and Mover"),
        ("s8", "without Memory"),
    ):
        assert re.search(rf"^team:{name} .*: {words}(:|$)", told, re.MULTILINE)


def test_json_on_a_terminal_holds_no_hidden_characters_and_the_same_values(
    capsys: pytest.CaptureFixture[str],
) -> None:
    from wonderful_team.cli.output import print_document

    print_document("plan", 0, {"message": NASTY + "\x9b"})
    told = capsys.readouterr().out
    assert not set(told) & set("\x1b\x9b\u202e")
    assert json.loads(told)["result"]["message"] == NASTY + "\x9b"


def test_what_became_of_a_trial_names_pictures_as_people_do() -> None:
    said = SimpleNamespace(text="Put {dragged_obj} in the bowl.", slots={"dragged_obj": None})
    verdict = SimpleNamespace(subgoal="G1", status="not_done", cause="the tallest {dragged_obj} is not at the bowl")
    trial = SimpleNamespace(
        outcome="failure", ending="failure", stage="execution", reason="no replans left; G1 not done: the {dragged_obj} stayed",
        verdicts=[verdict], plans=[SimpleNamespace(instruction=said, subgoals=())], reports=[],
    )  # fmt: skip
    text = "\n".join(trial_lines(cast(TrialResult, trial)))
    assert "{" not in text
    assert text.count("[picture 1]") == 2
