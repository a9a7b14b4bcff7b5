"""Users write tasks of their own in a few lines, in a file of their own."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from wonderful_team.errors import ConfigError, UnknownNameError
from wonderful_team.sims.tabletop import Scene, make_world, task, task_names

OWN_FILE = '''
from wonderful_team.sims.tabletop import task

@task("test/cups_of_a_file", instruction="put every {colour} cup into the {box}", horizon=4)
def cups(scene, rng):
    """Two cups of one colour go into the box."""
    box = scene.add("container", "wooden")
    colour = scene.pick_textures(1, ["red", "green", "blue"])[0]
    for _ in range(2):
        scene.goal(scene.add("block", colour), near=box)
    scene.add("block", "yellow", distractor=True)
    scene.say(colour=colour)
    scene.show(box=box)
'''


def _load(path: Path) -> None:
    spec = importlib.util.spec_from_file_location("own_tasks", path)
    spec.loader.exec_module(importlib.util.module_from_spec(spec))


def test_a_task_from_a_file_runs_and_can_be_loaded_twice(tmp_path: Path) -> None:
    path = tmp_path / "own.py"
    path.write_text(OWN_FILE, encoding="utf-8")
    _load(path)
    _load(path)
    assert task_names()["test/cups_of_a_file"] == "Two cups of one colour go into the box."
    world = make_world("test/cups_of_a_file", 1)
    assert world.instruction.text.startswith("put every ")
    assert "{colour}" not in world.instruction.text
    assert list(world.instruction.slots) == ["box"]
    for action in world.privileged.oracle():
        world.execute(action)
    assert world.privileged.score().success
    world.close()


def test_mistakes_are_named() -> None:
    @task("test/open_slot", instruction="put the {cup} away", horizon=1)
    def open_slot(scene: Scene, rng: np.random.Generator) -> None:
        scene.goal(scene.add("block", "red"), at=(0.5, 0.0))

    @task("test/no_goal", instruction="do nothing", horizon=1)
    def no_goal(scene: Scene, rng: np.random.Generator) -> None:
        scene.add("block", "red")

    @task("test/crowd", instruction="tidy up", horizon=1)
    def crowd(scene: Scene, rng: np.random.Generator) -> None:
        for _ in range(30):
            scene.add("container", "red")

    @task("test/wrong_name", instruction="tidy up", horizon=1)
    def wrong_name(scene: Scene, rng: np.random.Generator) -> None:
        scene.add("letter Q", "red")

    with pytest.raises(ConfigError, match=r"has the slots \['cup'\], but the scene fills \[\]"):
        make_world("test/open_slot")
    with pytest.raises(ConfigError, match="sets no goal"):
        make_world("test/no_goal")
    with pytest.raises(ConfigError, match="no room for its things"):
        make_world("test/crowd")
    with pytest.raises(UnknownNameError, match="unknown shape 'letter Q'"):
        make_world("test/wrong_name")


def test_a_name_cannot_be_taken_twice() -> None:
    with pytest.raises(ConfigError, match="'rotate' exists already"):

        @task("rotate", instruction="turn it", horizon=1)
        def another(scene: Scene, rng: np.random.Generator) -> None:
            """Never registered."""
