"""What an instruction presumes must show: nothing is planned, or called fulfilled, on a false premise."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest

from wonderful_team.agents.scene import SceneShown
from wonderful_team.contracts.shown import ShownTask
from wonderful_team.core.geometry.arrays import Array
from wonderful_team.core.values import Subgoal, Target, View
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.images import whole
from wonderful_team.offline.answers.drafting import draft
from wonderful_team.offline.answers.reviewing import findings
from wonderful_team.sims.tabletop import make_world

HERE = Path(__file__).parent
DESK = Path(__file__).parents[2] / "examples" / "desk.png"


def read_premises(name: str) -> list[tuple[str, str]]:
    """Scene and instruction of every line of a table."""
    out, scene = [], ""
    for line in (HERE / name).read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            scene = line[3:].split(":")[0]
        elif line.strip() and not line.startswith("#"):
            out.append((scene, line))
    return out


@cache
def shown(scene: str) -> ShownTask:
    """A scene of the tables, without an instruction."""
    kind, *rest = scene.split()
    if kind in ("tabletop", "photo"):
        world = make_world(rest[0], seed=int(rest[1]))
        try:
            if kind == "photo":
                return _photo(np.array(next(iter(world.observe().views.values())).rgb))
            return replace(
                SceneShown(world.observe(), world.instruction, world.vocabulary, world.limits).task, slots=()
            )
        finally:
            world.close()
    rgb = {"desk": lambda: cv2.imread(str(DESK))[..., ::-1].copy(), "blank": _blank, "noise": _noise}[kind]()
    return _photo(rgb)


def _photo(rgb: Array) -> ShownTask:
    """A picture without depth."""
    return ShownTask("", (whole(View("top", "top", 0.0, rgb), "top view"),), ())


def _blank() -> Array:
    return np.full((320, 640, 3), 128, np.uint8)


def _noise() -> Array:
    coarse = np.random.default_rng(5).uniform(0, 255, (10, 20, 3)).astype(np.float32)
    return np.clip(cv2.resize(coarse, (640, 320), interpolation=cv2.INTER_CUBIC), 0, 255).astype(np.uint8)


@pytest.mark.parametrize(("scene", "text"), read_premises("false_premises.txt"))
def test_a_false_premise_is_asked_about_or_refused(scene: str, text: str) -> None:
    try:
        plan, _ = draft(replace(shown(scene), instruction=text), with_targets=True)
    except NotUnderstoodError as refused:
        assert "I do not know" in str(refused)  # noqa: PT017  either of two is right
        return
    assert plan.clarification is not None, [goal.text for goal in plan.subgoals]
    assert plan.subgoals == []


@pytest.mark.parametrize(("scene", "line"), read_premises("true_premises.txt"))
def test_a_true_premise_is_planned(scene: str, line: str) -> None:
    count, text = line.split(" ", 1)
    plan, _ = draft(replace(shown(scene), instruction=text), with_targets=True)
    assert plan.clarification is None, plan.clarification
    assert len(plan.subgoals) == int(count)


def test_sixty_false_premises_stand_in_the_table() -> None:
    assert len(read_premises("false_premises.txt")) >= 60


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("Put two red blocks into the blue bowl.", "2 are asked for, but only 1 fit"),
        ("Put the red star into the blue bowl.", "no red star is in the picture"),
        ("Put everything except the green block into the blue bowl.", "no green block is in the picture"),
    ],
)
def test_verification_doubts_another_planners_plan_on_a_false_premise(text: str, said: str) -> None:
    goal = Subgoal("G1", "put the red block into the blue bowl", targets=("T1", "T2"))
    targets = (
        Target("T1", "object", "red block", use=("pick",)),
        Target("T2", "object", "blue bowl", use=("place",)),
    )
    found = findings(replace(shown("desk"), instruction=text), (goal,), targets, ("pick_place",))
    assert said in found[0].question


def test_a_corner_is_a_corner_of_the_table_and_not_the_nearest_thing_to_it() -> None:
    words = "Put the yellow block in the top right corner."
    plan, _ = draft(replace(shown("desk"), instruction=words), with_targets=True)
    assert plan.targets[1].words == "area in the top right corner"
    crowded = replace(shown("desk"), instruction="Put the block in the top right corner into the blue bowl.")
    asked = draft(crowded, with_targets=True)[0].clarification
    assert asked is not None
    assert "No block in the top right corner" in asked.question
