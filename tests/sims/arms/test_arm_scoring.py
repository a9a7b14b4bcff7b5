"""The scorer of moved things: right and wrong ends, and the stage of a failure. No physics runs here."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wonderful_team.core.geometry import Pose
from wonderful_team.core.protocols import Score
from wonderful_team.sims.arms.scoring import score_things
from wonderful_team.sims.arms.table import Grip
from wonderful_team.sims.tabletop.goals import Goal
from wonderful_team.sims.tabletop.model import Thing
from wonderful_team.sims.tabletop.rules import Rules

BOWL = Thing("bowl", "bowl", "blue", 0.4, 0.1, 0.0)
BLOCK = Thing("red block", "cube", "red", 0.5, -0.2, 0.0)
OTHER = Thing("green block", "cube", "green", 0.6, 0.2, 0.0)
PAPER = Thing("paper", "paper", "red paper", 0.5, -0.1, 0.0)
THINGS = {thing.name: thing for thing in (BOWL, BLOCK, OTHER, PAPER)}
RULES = Rules(
    ((Goal("red block", inside=("bowl",)), Goal("green block", off=("bowl",))),), (), 28, ends_when_reached=False
)
IN_BOWL = (0.41, 0.11, 0.005)


def scored(
    at: tuple[float, float, float] = IN_BOWL,
    *,
    other: tuple[float, float, float] = (0.6, 0.2, 0.0),
    bowl: tuple[float, float, float] = (0.4, 0.1, 0.0),
    touched: tuple[str, ...] = (),
    grips: tuple[Grip, ...] = (Grip("red block", ("red block",)),),
) -> Score:
    poses = {thing.name: Pose.at((thing.x_m, thing.y_m, 0.0)) for thing in THINGS.values()}
    poses |= {"red block": Pose.at(at), "green block": Pose.at(other), "bowl": Pose.at(bowl)}
    return score_things(RULES, poses, THINGS, touched, grips)


def test_in_the_bowl_and_let_go() -> None:
    assert scored().success


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        ({"at": (0.55, -0.2, 0.0)}, "not in or on bowl"),
        ({"at": (0.41, 0.11, 0.2)}, "20.0 cm high"),
        ({"at": (0.3, 0.1, 0.045)}, "high"),
        ({"touched": ("red block",)}, "not let go"),
        ({"other": IN_BOWL}, "green block is not off bowl"),
        ({"at": (0.41, 1.1, -0.7)}, "fell off"),
        ({"bowl": (0.6, -0.3, 0.0)}, "not in or on bowl"),
    ],
    ids=["beside", "in the air", "on the rim", "still held", "the other too", "on the floor", "bowl pushed away"],
)
def test_wrong_ends(wrong: dict[str, tuple[float, float, float]], why: str) -> None:
    score = scored(**wrong)  # type: ignore[arg-type]
    assert score.success is False
    assert why in score.reason


@pytest.mark.parametrize(
    ("grips", "stage"),
    [
        ((), "plan"),
        ((Grip(None, ()),), "grounding"),
        ((Grip("paper", ()),), "grounding"),
        ((Grip("green block", ("green block",)),), "wrong object"),
        ((Grip("red block", ()),), "execution"),
    ],
)
def test_the_stage_says_what_went_wrong(grips: tuple[Grip, ...], stage: str) -> None:
    assert scored((0.5, -0.2, 0.0), grips=grips).stage == stage


def test_what_lies_on_another_fruit_is_not_on_the_paper() -> None:
    rules = Rules(((Goal("red block", inside=("paper",)),),), (), 14, ends_when_reached=False)
    poses = {thing.name: Pose.at((thing.x_m, thing.y_m, 0.0)) for thing in THINGS.values()}
    for z, success in ((0.0, True), (0.045, False)):
        poses["red block"] = Pose.at(np.array([0.5, -0.1, z]))
        assert score_things(rules, poses, THINGS, (), ()).success is success
    assert replace(PAPER).body.kind == "area"


def test_a_fruit_that_has_rolled_over_on_its_paper_lies_there_all_the_same() -> None:
    orange = Thing("orange", "orange", "orange skin", 0.3, 0.3, 0.0)
    things = {"orange": orange, "paper": PAPER}
    rules = Rules(((Goal("orange", inside=("paper",)),),), (), 14, ends_when_reached=False)
    half = orange.body.height_m / 2
    for turn, up in ((np.pi / 2, 0.0), (np.pi, 0.0), (np.pi / 2, 0.06)):
        turned = np.array([np.cos(turn / 2), np.sin(turn / 2), 0.0, 0.0])
        rolled = Pose(np.zeros(3), turned)
        # Its middle is over the paper, half its height up; its foot points elsewhere.
        rolled = Pose(np.array([0.5, -0.1, half + up]) - rolled.apply([[0.0, 0.0, half]])[0], turned)
        score = score_things(rules, {"orange": rolled, "paper": Pose.at((0.5, -0.1, 0.0))}, things, (), ())
        assert score.success is (up == 0.0), score.reason
