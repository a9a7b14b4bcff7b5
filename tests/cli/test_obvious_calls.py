"""What one writes first in Python works, or is refused with what would be valid."""

from __future__ import annotations

import base64
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import wonderful_team as wt
from wonderful_team.cli.app import run
from wonderful_team.core.protocols import Filmed, Privileged, SceneTruth, offers, privileged
from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.offline import OfflineModel
from wonderful_team.registry.simulated import scene_truth
from wonderful_team.runtime.optional import Accounting, ChunkPolicy, Configured, Horizon, NamedModel, Sourced

DESK = Path(__file__).parents[2] / "examples" / "desk.png"
WORDS = "put the red block into the blue bowl"


def pixels():
    with Image.open(DESK) as image:
        return np.asarray(image.convert("RGB"))


@pytest.mark.parametrize(
    "shown",
    [
        str(DESK),
        DESK,
        [DESK],
        pixels(),
        Image.fromarray(pixels()),
        wt.View("desk", "desk", 0.0, pixels()),
        wt.Observation.from_files(DESK),
    ],
    ids=["text", "path", "list", "array", "pil", "view", "observation"],
)
def test_a_plan_is_made_for_whatever_shows_a_scene(shown):
    plan = wt.Team().plan(shown, WORDS)
    assert (plan.status, [target.status for target in plan.targets]) == ("planned", ["found", "found"])


@pytest.mark.parametrize("shown", [None, 3, {"desk": 1}, [], ["a", 3], np.zeros((4, 4)), np.zeros((4, 4, 3)), "no.png"])
def test_what_shows_no_scene_is_refused(shown):
    with pytest.raises(ConfigError):
        wt.Team().plan(shown, WORDS)


def test_an_instruction_is_words():
    with pytest.raises(ConfigError, match="a int is no instruction; valid: text"):
        wt.Team().plan(DESK, 3)
    assert wt.Team().ground(DESK, "red block").targets[0].status == "found"


def test_a_rollout_takes_the_name_of_a_world():
    trial = wt.rollout(wt.Team(), "tabletop/rotate", seed=3)
    assert (trial.outcome, trial.scene, trial.seed) == ("success", "tabletop/rotate#3", 3)
    with pytest.raises(UnknownNameError, match="Did you mean 'tabletop/rotate'"):
        wt.rollout(wt.Team(), "tabletop/rotat")
    with pytest.raises(ConfigError, match="a str is no method; valid: a wt.Team"):
        wt.rollout("team", "tabletop/rotate")


def test_a_price_is_two_numbers_or_their_text():
    for price in ("0,0", (0, 0), [3, 15], (3, 15, 0.3), {"*": (0, 0)}):
        wt.Team(price=price)
    for price in ((1,), (1, 2, 3, 4), (-1, 2), 3, "free", (float("nan"), 1), {"*": "x"}):
        with pytest.raises(ConfigError, match="price"):
            wt.Team(price=price)
    with pytest.raises(ConfigError, match="thinking 3: valid are"):
        wt.Team(thinking=3)


def test_a_study_takes_one_name_or_several(tmp_path):
    study = wt.Study(
        "tabletop/rotate", methods="team", models="offline", seeds=[0], store=tmp_path / "s.db", controls=()
    )
    assert (study.plan.methods, study.plan.models) == (("team",), ("offline",))
    with pytest.raises(ConfigError, match=r"seeds 3: valid is a sequence, as in range\(1000, 1020\)"):
        wt.Study("tabletop/rotate", seeds=3, store=tmp_path / "s.db")


SCRIPT = """
import wonderful_team as wt
{task}
study = wt.Study({suite!r}, methods="team", seeds=[0, 1], controls=(), store={store!r}, jobs=2)
print("ENDED", study.run().status.done)
"""
TASK = '''
@wt.task("mine/spawned", instruction="Put the red block into the blue bowl.", horizon=1)
def spawned(scene, rng):
    """One block and one bowl."""
    bowl, block = scene.add("bowl", "blue"), scene.add("block", "red")
    scene.goal(block, near=bowl)
'''


def test_a_study_runs_as_a_script_without_a_guard(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(SCRIPT.format(task="", suite="tabletop/rotate", store=str(tmp_path / "s.db")), encoding="utf-8")
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stderr
    # The script ran once, not once more in every worker.
    assert done.stdout.count("ENDED") == 1
    assert "ENDED 2" in done.stdout


def test_a_study_of_a_task_of_the_script_itself_asks_for_the_guard(tmp_path):
    script = tmp_path / "script.py"
    words = SCRIPT.format(task=TASK, suite="tabletop/mine/spawned", store=str(tmp_path / "s.db"))
    script.write_text(words, encoding="utf-8")
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode != 0
    assert 'under if __name__ == "__main__"' in done.stderr


def test_a_stored_run_is_loaded():
    world = wt.make_world("tabletop/visual_manipulation", seed=3)
    trial = wt.rollout(wt.Team(), world, seed=3)
    now = world.observe()
    world.close()
    stored = wt.load_run("latest")
    assert len(repr(stored)) < 300, "a prompt that shows it must not be flooded by the record"
    assert stored.folder.resolve() == trial.folder.resolve()
    assert (stored.state, stored.outcome, stored.method, stored.model) == ("finished", "success", "team", "offline")
    assert [plan.id for plan in stored.plans] == [plan.id for plan in trial.plans]
    assert stored.observations[-1].hash == now.hash
    assert set(stored.instruction.slots) == {"dragged_obj_1", "base_obj"}
    assert stored.page.is_file()
    assert {request["role"] for request in stored.requests} >= {"supervisor", "manager"}
    with pytest.raises(UnknownNameError):
        wt.load_run("no-such-run")


def test_warnings_in_json_hold_what_stderr_said(tmp_path, capsys):
    corners = "20,10 620,10 620,310 20,310=1.0x0.5"
    for argv in (["plan", str(DESK), WORDS, "--corners", corners], ["run", "tabletop/rotate", "--seed", "3"]):
        run([*argv, "--json"])
        out, err = capsys.readouterr()
        said = [line.split("warning", 1)[1].strip() for line in err.splitlines() if " s  warning " in line]
        assert set(said) <= set(json.loads(out)["result"]["warnings"])

    class Repairing(OfflineModel):
        note = "this model has a note"

    plan = wt.Team(model=Repairing()).plan(DESK, WORDS)
    assert "this model has a note" in plan.warnings
    assert "this model has a note" in plan.to_json()["warnings"]


class Chatting(OfflineModel):
    """Looks at the messages that a client of a model would send."""

    def __init__(self, pictures="data_url"):
        super().__init__()
        self.pictures, self.sent = pictures, []

    def answer(self, request):
        self.sent.append((request, request.messages(self.pictures)))
        if request.contract == "ReviewSteps" and request.attempt == 0:
            return '{"reasoning": 3}'
        return super().answer(request)


def test_a_request_becomes_chat_messages():
    model = Chatting()
    assert wt.Team(model=model).plan(DESK, WORDS).status == "planned"
    request, (system, user, *rest) = model.sent[0]
    assert (system["role"], user["role"], rest) == ("system", "user", [])
    texts = [part["text"] for part in user["content"] if part["type"] == "text"]
    assert any(WORDS in text for text in texts)
    assert json.loads(texts[-1].split("schema:\n")[1]) == request.output.model_json_schema()
    urls = [part["image_url"]["url"] for part in user["content"] if part["type"] == "image_url"]
    assert len(urls) == len(request.pictures) > 0
    png = base64.b64decode(urls[0].removeprefix("data:image/png;base64,"))
    assert png.startswith(b"\x89PNG")
    # A second try shows the model its answer and what was wrong with it.
    again = next(messages for asked, messages in model.sent if asked.attempt == 1)
    assert [message["role"] for message in again] == ["system", "user", "assistant", "user"]
    assert again[2]["content"] == '{"reasoning": 3}'
    assert "does not fit" in again[3]["content"]


def test_messages_hold_png_bytes_when_asked():
    model = Chatting("png")
    wt.Team(model=model).plan(DESK, WORDS)
    pictures = [part for part in model.sent[0][1][1]["content"] if part["type"] == "image"]
    assert pictures[0]["data"].startswith(b"\x89PNG")
    with pytest.raises(ConfigError, match="valid: data_url, png"):
        model.sent[0][0].messages("jpeg")


class Leaving:
    name, model_name = "leaving", "a model of mine"

    def decide(self, situation):
        return wt.GaveUp("nothing to do", "plan")


class Forwarding:
    """A wrapper of a user."""

    def __init__(self, inner):
        self.inner = inner

    def __getattr__(self, name):
        return getattr(self.inner, name)


def test_a_wrapper_that_forwards_loses_nothing():
    """From Python 3.12 on isinstance with a protocol would miss it; asked so, it fails on every Python."""
    inner = wt.make_world("tabletop/rotate", seed=3)
    world = Forwarding(inner)
    assert privileged(world) is not None
    assert offers(world, Horizon)
    assert offers(world, Filmed)
    assert scene_truth(Forwarding(inner), "simulated:perfect") is inner.privileged
    assert not offers(Forwarding(object()), Horizon)
    for protocol in (Horizon, Filmed, Privileged, SceneTruth, Accounting, NamedModel, Sourced, Configured, ChunkPolicy):
        with pytest.raises(TypeError, match="runtime_checkable"):
            isinstance(world, protocol)
    trial = wt.rollout(Forwarding(Leaving()), world, seed=3)
    assert (trial.stage, trial.model) == ("plan", "a model of mine")
    inner.close()


def test_a_pose_is_public():
    assert wt.Pose(np.zeros(3), np.array([1.0, 0, 0, 0])) is not None
