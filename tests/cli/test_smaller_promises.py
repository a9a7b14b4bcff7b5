"""What a first hour of use met: words and paths that are right, and a new model that really asks a server."""

from __future__ import annotations

import http.server
import json
import shlex
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest

import wonderful_team as wt
from wonderful_team.cli import run_summary
from wonderful_team.cli.app import run
from wonderful_team.cli.wording import trial_word
from wonderful_team.core.values import Verdict

EXAMPLES = Path(__file__).parents[2] / "examples"
DESK = str(EXAMPLES / "desk.png")
WORDS = "put the red block into the blue bowl"


def test_an_own_world_ends_with_the_teams_own_judgement(capsys):
    assert run(["run", f"{EXAMPLES}/own_world.py:TileDesk"]) == 0
    assert capsys.readouterr().out.startswith("DONE, as the team judges (no scorer)  ")


def test_a_plan_is_judged_by_its_own_subgoals(tmp_path):
    trial = wt.rollout(wt.Team(out=tmp_path), f"{EXAMPLES}/own_world.py:TileDesk", replans=1)
    (mine,) = {verdict.subgoal for verdict in trial.verdicts}
    earlier = replace(trial, verdicts=(Verdict("G7", "not_done"), *trial.verdicts))
    assert trial_word(earlier).startswith("DONE"), "an earlier plan had a G7; this one has not"
    assert trial_word(replace(trial, verdicts=(*trial.verdicts, Verdict(mine, "undone")))) == "UNSCORED"
    assert trial_word(replace(trial, verdicts=(Verdict("G7", "done"),))) == "UNSCORED"


def test_what_nobody_judged_is_not_done(capsys):
    assert run(["run", f"{EXAMPLES}/own_world.py:TileDesk", "--replans", "0"]) == 1
    said = capsys.readouterr().out
    assert said.startswith("UNSCORED  ")
    assert "nobody judged the result" in said
    # Where there is a scorer, one attempt is judged.
    assert run(["run", "tabletop/rotate", "--seed", "3", "--replans", "0"]) == 0


def test_probe_says_the_same_number_of_pictures_on_both_streams(capsys):
    assert run(["probe", "offline", "--most-pictures", "4"]) == 0
    out, err = capsys.readouterr()
    assert "pictures per request: 4 (more may fit)" in err
    assert "pictures    at least 4 pictures" in out


@pytest.mark.parametrize("kind", ["world", "method", "task", "model", "detector"])
def test_new_names_paths_that_can_be_typed(kind, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["new", kind, "mine", "--out", "my files/here"]) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("check it:"))
    name = shlex.split(line)[-1]
    assert name == "my files/here/mine.py:mine"
    text = Path("my files/here/mine.py").read_text(encoding="utf-8")
    assert shlex.split(text.splitlines()[3])[-1].endswith("my files/here/mine.py:mine")
    assert "$" not in text


def test_show_from_latest_names_its_parent(tmp_path, capsys):
    made = wt.Team(out=tmp_path).plan(DESK, WORDS)
    assert run(["show", "latest", "--out", str(tmp_path), "--from", "act", "--model", "offline"]) == 0
    assert capsys.readouterr().out.startswith(f"branched off {made.folder.name} at act")
    record = json.loads((tmp_path / "latest" / "record.json").read_text(encoding="utf-8"))
    assert record["configuration"]["parent"]["run"] == made.folder.name


class Server(http.server.BaseHTTPRequestHandler):
    heard: list[dict]

    def do_POST(self):  # noqa: N802  the name that the library calls
        self.heard.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
        body = json.dumps({"choices": [{"message": {"content": "I would rather not."}}]}).encode()
        self.send_response(200)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_):
        pass


def test_a_new_model_asks_a_server(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(["new", "model", "Mine"]) == 0
    assert wt.Team(model="mine.py:Mine").plan(DESK, WORDS).status == "planned"
    Server.heard = []
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Server) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        url = f"http://127.0.0.1:{server.server_port}/v1/chat/completions"
        plan = wt.Team(model=f"mine.py:Mine?url={url}&served=my-vlm").plan(DESK, WORDS)
        server.shutdown()
    assert plan.status == "failed"
    first, second, _ = Server.heard
    assert first["model"] == "my-vlm"
    kinds = {part["type"] for part in first["messages"][1]["content"]}
    assert kinds == {"text", "image_url"}
    assert second["messages"][2]["content"] == "I would rather not."


@pytest.mark.parametrize("called", ["there/wonderful-team", "there/wonderful_team/__main__.py"])
def test_what_to_do_next_names_a_command_that_runs(
    called: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("shutil.which", lambda name: None)
    monkeypatch.setattr("sys.argv", [str(tmp_path / called)])
    monkeypatch.chdir(tmp_path)
    said = run_summary.program()
    assert said == (called if called.endswith("team") else f"{sys.executable} -m wonderful_team")
