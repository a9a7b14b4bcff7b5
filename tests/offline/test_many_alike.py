"""Many things that look the same: each gets words of its own that lead back to it, or the plan says how many could be told apart."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

import wonderful_team as wt

Field = tuple[np.ndarray, np.ndarray]
SIDE = 46


def drawn(centres: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A photo of red blocks and a blue bowl, shape (960, 1280, 3), uint8."""
    rgb = np.full((960, 1280, 3), (214, 208, 196), np.uint8)
    for radius, colour in ((110, (40, 80, 190)), (88, (30, 60, 150))):
        cv2.circle(rgb, (1130, 480), radius, colour, -1, cv2.LINE_AA)
    for x, y in centres:
        corners = cv2.boxPoints(((float(x), float(y)), (SIDE, SIDE), float(rng.uniform(0, 90))))
        cv2.fillPoly(rgb, [np.round(corners * 16).astype(np.int32)], (196, 44, 40), cv2.LINE_AA, 4)
    return rgb


def scattered(count: int, seed: int) -> Field:
    rng = np.random.default_rng(seed)
    centres: list[np.ndarray] = []
    while len(centres) < count:
        point = rng.uniform((60, 60), (960, 900))
        if all(np.hypot(*(point - other)) > 2 * SIDE for other in centres):
            centres.append(point)
    return drawn(np.array(centres), rng), np.array(centres)


def lined_up(rows: int, columns: int) -> Field:
    centres = np.array([(90 + 105 * x, 80 + 115 * y) for x in range(columns) for y in range(rows)])
    return drawn(centres, np.random.default_rng(0)), centres


def picked(plan: wt.Plan, centres: np.ndarray) -> list[int]:
    """The block under the pick point of every action."""
    points = [plan.grounded[str(action.step.pick)].points["pick"] for action in plan.actions]
    return [int(np.argmin(np.hypot(*(centres - point).T))) for point in points]


@pytest.mark.parametrize("field", [lined_up(6, 8), scattered(14, 2), scattered(30, 4)], ids=["rows", "14", "30"])
def test_every_one_of_many_is_picked_once(field: Field, tmp_path: Path) -> None:
    rgb, centres = field
    plan = wt.Team(model="offline", out=tmp_path).plan(rgb, "put every red block into the blue bowl").plan
    assert plan.status == "planned", plan.message
    assert sorted(picked(plan, centres)) == list(range(len(centres)))
    assert len({target.words for target in plan.targets}) == len(plan.targets)


def test_words_that_count_a_field_mean_the_same_thing_to_a_reader(tmp_path: Path) -> None:
    """Of three rows of four the 8th block is the second of the third column, and the last of the second row."""
    rgb, centres = lined_up(3, 4)
    words = "put the 8th red block counted column by column from the top left into the blue bowl"
    plan = wt.Team(model="offline", out=tmp_path).plan(rgb, words).plan
    assert picked(plan, centres) == [7]
    plan = wt.Team(model="offline", out=tmp_path).plan(rgb, words.replace("column by column", "row by row")).plan
    assert picked(plan, centres) == [10]


def test_an_order_that_ends_before_is_not_guessed(tmp_path: Path) -> None:
    rgb, _ = lined_up(3, 4)
    made = wt.Team(model="offline", out=tmp_path).plan(rgb, "put the 13th red block from the left into the blue bowl")
    assert made.plan.status != "planned"
    assert "No 13th red block from the left is in the picture" in made.plan.message


def test_more_things_than_a_plan_may_hold_are_said_to_be_too_many(tmp_path: Path) -> None:
    centres = np.array([(50 + 86 * x, 50 + 95 * y) for x in range(11) for y in range(10)])
    rgb = drawn(centres, np.random.default_rng(0))
    made = wt.Team(model="offline", out=tmp_path).plan(rgb, "put every red block into the blue bowl")
    assert (made.plan.status, made.plan.actions) == ("not_understood", ())
    assert "110 subgoals, at most 100 are allowed" in made.plan.message
