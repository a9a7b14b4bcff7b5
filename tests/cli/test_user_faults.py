"""Exceptions in a user's model, method or world, as the command line ends: whose fault, which exit code, which page."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import wonderful_team as wt
from wonderful_team.cli.app import run
from wonderful_team.errors import ModelCodeError, WorldUnavailableError

ROOT = Path(__file__).parents[2]
DESK = str(ROOT / "examples" / "desk.png")
WORDS = "put the red block into the blue bowl"
MINE = """
import importlib.util, sys
import wonderful_team as wt

spec = importlib.util.spec_from_file_location("tiles", {tiles!r})
tiles = importlib.util.module_from_spec(spec)
spec.loader.exec_module(tiles)


class Model:
    name = "mine"
    def answer(self, request):
        return {{}}["weights"]


class Stopping(Model):
    def answer(self, request):
        raise StopIteration("no more")


class Leaving(Model):
    async def answer(self, request):
        sys.exit(3)


class Unmade(Model):
    def __init__(self):
        raise RuntimeError("no weights at /models")


class Method:
    name = "mine"
    def decide(self, situation):
        return 1 / 0


class UnmadeMethod(Method):
    def __init__(self):
        raise RuntimeError("no policy")


class Hot(tiles.TileDesk):
    def execute(self, action):
        raise RuntimeError("joint 3 is hot")


class Blind(tiles.TileDesk):
    def observe(self):
        raise OSError("the camera is unplugged")


class Gone(tiles.TileDesk):
    def __init__(self):
        raise ConnectionError("no robot at 10.0.0.5")


class Unclosed(tiles.TileDesk):
    def close(self):
        raise RuntimeError("the socket is gone")


class Silent(tiles.TileDesk):
    def execute(self, action):
        return wt.StepReport(action, executed=False)


class Arm(tiles.TileDesk):
    def __init__(self, address: str, speed_m_s: float = 0.1, seed: int = 0):
        super().__init__(seed)
        self.address, self.speed_m_s = address, speed_m_s
"""


@pytest.fixture
def mine(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(MINE.format(tiles=str(ROOT / "examples" / "own_world.py")), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("argv", "code", "says", "has_page"),
    [
        (["plan", DESK, WORDS, "--model", "{}:Model"], 3, "the code of model 'mine' raised KeyError: 'weights'", True),
        (["plan", DESK, WORDS, "--model", "{}:Stopping"], 3, "raised StopIteration: no more", True),
        (["plan", DESK, WORDS, "--model", "{}:Leaving"], 3, "raised SystemExit: 3", True),
        (["ground", DESK, "red block", "--model", "{}:Model"], 3, "raised KeyError: 'weights'", True),
        (["plan", DESK, WORDS, "--model", "{}:Unmade"], 3, "raised RuntimeError: no weights at /models", False),
        (["run", "tabletop/rotate", "--model", "{}:Model"], 3, "raised KeyError: 'weights'", True),
        (["run", "tabletop/rotate", "--method", "{}:Method"], 1, "raised ZeroDivisionError", True),
        (["run", "tabletop/rotate", "--method", "{}:UnmadeMethod"], 1, "raised RuntimeError: no policy", True),
        (["run", "{}:Hot"], 6, "execute(pick_place) of world Hot raised RuntimeError: joint 3 is hot", True),
        (["run", "{}:Blind"], 6, "observe() of world Blind raised OSError: the camera is unplugged", True),
        (["run", "{}:Gone"], 6, "raised ConnectionError: no robot at 10.0.0.5", False),
    ],
)
def test_the_exit_code_says_whose_fault_it_is(mine, argv, code, says, has_page, capsys):
    assert run([word.format(mine) for word in argv]) == code
    out, err = capsys.readouterr()
    assert says in out + err
    assert "defect of wonderful-team" not in err
    # The user's own line, so that it can be found; and the page of what had happened.
    assert f'File "{mine}"' in err
    assert ("page: " in out + err) == has_page
    if has_page:
        page = Path((out + err).split("page: ")[1].splitlines()[0])
        assert "Traceback (most recent call last)" in page.read_text(encoding="utf-8")
        record = json.loads((page.parent / "record.json").read_text(encoding="utf-8"))
        assert record["state"] == "finished"
        assert says.split("raised ")[1] in record["outcome"]["reason"]


def test_json_holds_the_error_with_its_trace_and_page(mine, capsys):
    assert run(["plan", DESK, WORDS, "--model", f"{mine}:Model", "--json"]) == 3
    told = json.loads(capsys.readouterr().out)
    assert told["error"]["type"] == "ModelCodeError"
    assert "KeyError: 'weights'" in told["error"]["trace"]
    assert Path(told["result"]["page"]).is_file()


def test_in_python_the_error_names_its_folder(mine):
    with pytest.raises(ModelCodeError) as found:
        wt.Team(model=f"{mine}:Model").plan(wt.Observation.from_files(DESK), WORDS)
    assert found.value.folder is not None
    assert (found.value.folder / "page.html").is_file()
    with pytest.raises(WorldUnavailableError, match="no robot at"):
        wt.make_world(f"{mine}:Gone")


def test_a_close_that_fails_keeps_the_result(mine, capsys):
    assert run(["run", f"{mine}:Unclosed"]) == 0
    out, err = capsys.readouterr()
    assert "page: " in out
    assert "close() of world Unclosed raised RuntimeError: the socket is gone" in err


def test_an_action_that_did_not_run_without_a_reason_says_so(mine, capsys):
    assert run(["run", f"{mine}:Silent", "--replans", "1"]) == 1
    assert "did not run, and the robot gave no reason" in capsys.readouterr().err


def test_a_world_is_given_its_address(mine, capsys):
    world = wt.make_world(f"{mine}:Arm?address=10.0.0.5:8080&speed_m_s=0.3", seed=2)
    assert (world.inner.address, world.inner.speed_m_s) == ("10.0.0.5:8080", 0.3)
    world = wt.make_world(f"{mine}:Arm", seed=2, address="10.0.0.5")
    assert (world.inner.address, world.inner.speed_m_s) == ("10.0.0.5", 0.1)
    assert run(["run", f"{mine}:Arm"]) == 2
    assert "FILE.py:NAME?address=VALUE" in capsys.readouterr().err
    assert run(["run", f"{mine}:Arm?adress=1"]) == 2
    assert "Did you mean 'address'?" in capsys.readouterr().err
    assert run(["run", f"{mine}:Arm?address=1&speed_m_s=fast"]) == 2
    assert "speed_m_s='fast' is not of type float" in capsys.readouterr().err
    assert run(["run", f"{mine}:Arm?address"]) == 2
    assert "is not NAME=VALUE" in capsys.readouterr().err
    with pytest.raises(wt.WonderfulTeamError, match="takes no arguments"):
        wt.make_world("tabletop/rotate", address="10.0.0.5")


def test_a_world_that_shows_no_observation_is_its_owners_fault_in_a_check_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "odd.py"
    file.write_text(
        "import wonderful_team as wt\nclass W:\n    vocabulary = limits = 3\n    instruction = wt.Instruction('x')\n"
        "    observe = execute = stop = close = lambda *_: 1\n"
    )
    assert run(["check", f"{file}:W", "--seeds", "1", "--sheet", str(tmp_path / "s.png")]) == 6
    assert "what observe() of world W returned is a int; valid: Observation" in capsys.readouterr().err
