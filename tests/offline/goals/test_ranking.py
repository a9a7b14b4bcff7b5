"""Fruits ranked by the price tags that a picture shows: right where they show, asked about where one is missing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wonderful_team.agents.scene import SceneShown
from wonderful_team.core.actions import PICK_PLACE
from wonderful_team.core.values import Instruction, Observation
from wonderful_team.offline.answers.drafting import draft
from wonderful_team.sims.tabletop import make_world
from wonderful_team.sims.tabletop.world import TabletopWorld

pytest.importorskip("rapidocr")


def planned(world: TabletopWorld, seen: Observation, words: str | None = None) -> tuple[list[str], str]:
    """The subgoals of a plan, and the question where there is one."""
    instruction = world.instruction if words is None else Instruction(words)
    plan, _ = draft(SceneShown(seen, instruction, PICK_PLACE, world.limits).task, True)
    return [goal.text for goal in plan.subgoals], plan.clarification.question if plan.clarification else ""


def test_deals_are_counted_and_the_other_way_round_is_another_plan() -> None:
    world = make_world("fruit_price_ranking/deals", seed=3)
    goals = world.privileged.truth()["goals"]
    places = sorted(
        (goal["inside"][0] for goal in goals),
        key=lambda bowl: world.privileged.truth()["things"][bowl]["position_m"][1],
    )
    said = ["the leftmost bowl", *(f"the {word} bowl from the left" for word in ("second", "third", "fourth"))]
    texts, question = planned(world, world.observe())
    assert question == ""
    assert [text.partition(" into ")[2] for text in texts] == [said[places.index(goal["inside"][0])] for goal in goals]
    words = "Rank the fruits from the cheapest to the most expensive and put each into its corresponding bowl."
    other, _ = planned(world, world.observe(), words)
    fruits = [text.partition(" into ")[0] for text in texts]
    assert [text.partition(" into ")[0] for text in other] == fruits[::-1]
    world.close()


def test_a_missing_price_is_asked_about_by_name() -> None:
    world = make_world("fruit_price_ranking/three", seed=4)
    tag = next(name for name in world.privileged.truth()["things"] if name.startswith("price of"))
    seen = world.observe()
    rgb = np.array(seen.main.rgb)
    rgb[world.privileged.mask(tag)] = rgb[4, 60]
    texts, question = planned(world, replace(seen, views={**seen.views, "top": replace(seen.main, rgb=rgb)}))
    assert texts == []
    assert "No price shows beside the" in question
    world.close()


def test_a_dotted_bowl_does_not_hide_the_label_below_it() -> None:
    # In a window all round such a bowl the engine sees its dots, and not the label: deals 784008.
    world = make_world("fruit_price_ranking/deals", seed=784008)
    texts, question = planned(world, world.observe())
    assert question == ""
    assert len(texts) == 4
    world.close()
