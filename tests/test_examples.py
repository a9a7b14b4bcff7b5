"""The examples run as the files they are, and as FILE.py:NAME on the command line."""

from __future__ import annotations

import json
import runpy
from pathlib import Path

import pytest

from wonderful_team.cli.app import run

EXAMPLES = Path(__file__).parents[1] / "examples"


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("own_task", "-> success"),
        ("own_world", "unscored"),
        ("own_model", "supervisor: DraftPlan"),
        ("own_method", "failure"),
    ],
)
def test_every_example_runs(name: str, says: str, capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
    assert says in capsys.readouterr().out


def test_every_example_is_tested() -> None:
    assert {path.stem for path in EXAMPLES.glob("*.py")} == {"own_task", "own_world", "own_model", "own_method"}


@pytest.mark.parametrize(
    ("argv", "code", "outcome"),
    [
        (["run", f"{EXAMPLES}/own_task.py:blocks", "--seed", "3"], 0, "success"),
        (["run", f"{EXAMPLES}/own_world.py:TileDesk"], 0, "unscored"),
        (["run", "tabletop/rotate", "--seed", "3", "--model", f"{EXAMPLES}/own_model.py:Counting"], 0, "success"),
        (["run", "tabletop/rotate", "--seed", "3", "--method", f"{EXAMPLES}/own_method.py:Stirring"], 1, "failure"),
    ],
)
def test_every_example_is_loaded_by_name(
    argv: list[str], code: int, outcome: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([*argv, "--json"]) == code
    assert json.loads(capsys.readouterr().out)["result"]["outcome"] == outcome


def test_the_own_world_ends_as_it_was_told(capsys: pytest.CaptureFixture[str]) -> None:
    import wonderful_team as wt

    world = wt.make_world(f"{EXAMPLES}/own_world.py:TileDesk", seed=4)
    wt.rollout(wt.Team(), world)
    red_m, blue_m = world.inner.tiles_m[0], world.inner.tiles_m[1]  # type: ignore[attr-defined]
    assert red_m[1] < blue_m[1]
    assert abs(red_m[0] - blue_m[0]) < 0.05
