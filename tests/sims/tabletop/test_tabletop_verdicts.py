"""What each VIMA task's scorer says to right, half-right, wrong, lucky and late sequences of actions, as one table.

`hands` in conftest.py explains the sentences. The verdicts follow VIMA-Bench; those marked with a star were seen there,
on its own simulator, for the same kind of sequence.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

Truth = dict[str, Any]


def movable(truth: Truth) -> bool:
    return bool(truth["things"][truth["distractors"][0]]["movable"])


def fixed(truth: Truth) -> bool:
    return not movable(truth)


@cache
def goals(count: int) -> Callable[[Truth], bool]:
    return lambda truth: len(truth["phases"][0]) == count


def on_target(truth: Truth) -> bool:
    at, goal = [(truth["things"][n]["position_m"]) for n in truth["distractors"][:1]], truth["phases"][0][0]["at_m"]
    return bool(at) and abs(at[0][0] - goal[0]) + abs(at[0][1] - goal[1]) < 0.02


def aside(truth: Truth) -> bool:
    return len(truth["distractors"]) == 1 and not on_target(truth)


PUT = [
    ("its place*", "a0 > goal", "success"),
    ("half-right: 14 cm away", "a0 > goal +14cm", "open"),
    ("half-right, then repaired", "a0 > goal +16cm; a0 > goal", "success"),
    ("a missed pick is nothing*", "miss; a0 > goal", "success"),
    ("four misses and luck", "miss; miss; miss; miss; a0 > goal", "success"),
    ("too late", "miss; miss; miss; miss; miss; a0 > goal", "horizon of 5"),
    ("off the table", "nudge a0 > away; miss", "left the table"),
    ("onto free table", "a0 > bare", "open"),
]
SPOILED = [
    ("the distractor there*", "d0 > goal_of_a0", "distractor"),
    ("a failure is for good", "d0 > goal_of_a0; d0 > bare; a0 > goal", "distractor"),
    ("the distractor elsewhere*", "d0 > bare; a0 > goal", "success"),
]
PUTTING = ["visual_manipulation", "scene_understanding", "novel_noun", "novel_adj", "novel_adj_and_noun"]
CASES: list[tuple[str, Callable[[Truth], bool] | None, str, str, str]] = [
    *((task, None, *case) for task in PUTTING for case in PUT),
    *((task, movable, *case) for task in PUTTING for case in SPOILED),
    *((task, fixed, "onto the other container*", "a0 > d0", "distractor") for task in PUTTING[:2]),
    ("rotate", None, "right", "a0 > home turned 0", "success"),
    ("rotate", None, "10 degrees off*", "a0 > home turned 10", "success"),
    ("rotate", None, "20 degrees off*", "a0 > home turned 20", "open"),
    ("rotate", None, "half of it, then the rest", "a0 > home turned 20; a0 > home turned 0", "success"),
    ("rotate", None, "right turn, wrong place", "a0 > bare turned 0", "open"),
    ("rotate", None, "8 cm off", "a0 > home +8cm turned 0", "success"),
    ("rotate", None, "off the table", "nudge a0 > away; miss", "left the table"),
    ("rotate", None, "the distractor there", "d0 > home_of_a0", "distractor"),
    ("twist", goals(2), "one of two", "a0 > home turned 0", "open"),
    ("twist", goals(2), "both", "a0 > home turned 0; a1 > home turned 0", "success"),
    ("twist", goals(2), "the other first", "a1 > home turned 0; a0 > home turned 0", "success"),
    ("twist", goals(2), "one put away again*", "a0 > home turned 0; a0 > bare; a1 > home turned 0", "success"),
    ("twist", goals(1), "7 cm off", "a0 > home +7cm turned 0", "open"),
    ("twist", goals(1), "4 cm off", "a0 > home +4cm turned 12", "success"),
    ("twist", goals(1), "20 degrees off", "a0 > home turned -20", "open"),
    ("twist", goals(1), "a distractor there", "d0 > home_of_a0", "distractor"),
    ("rearrange", goals(2), "one of two", "a1 > goal", "open"),
    ("rearrange", goals(2), "both, the other first, turned*", "a1 > goal turned 45; a0 > goal +8cm", "success"),
    ("rearrange", goals(2), "one put away again", "a0 > goal; a0 > bare; a1 > goal", "success"),
    ("rearrange", goals(2), "12 cm off", "a0 > goal; a1 > goal +12cm", "open"),
    ("rearrange", goals(2), "off the table", "nudge a1 > away; a0 > goal", "left the table"),
    ("rearrange", on_target, "on top of what is in the way", "a0 > goal", "distractor"),
    ("rearrange", on_target, "after clearing it away", "d0 > bare; a0 > goal", "success"),
    ("rearrange", aside, "the distractor there only costs at the end", "d0 > goal_of_a0; d0 > bare; a0 > goal", "success"),
    ("rearrange_then_restore", goals(2), "nothing done", "miss", "open"),
    ("rearrange_then_restore", goals(2), "the setup alone", "a0 > goal; a1 > goal", "open"),
    ("rearrange_then_restore", goals(2), "there and back", "a0 > goal; a1 > goal; a1 > home; a0 > home", "success"),
    ("rearrange_then_restore", goals(2), "one by one*", "a0 > goal; a0 > home; a1 > goal; a1 > home", "success"),
    ("rearrange_then_restore", goals(2), "restored too soon", "a0 > home; a1 > home; a0 > goal; a1 > goal", "open"),
    ("rearrange_then_restore", goals(2), "only one back", "a0 > goal; a1 > goal; a1 > home", "open"),
    ("rearrange_then_restore", on_target, "what was in the way stays aside*", "d0 > bare; a0 > goal; a0 > home", "success"),
    (
        "rearrange_then_restore", on_target, "what was in the way goes back first*",
        "d0 > bare; a0 > goal; a0 > bare; d0 > home; a0 > home", "distractor",
    ),
    *(("follow_motion", None, *case) for case in (
        ("step by step", "a0 > goal; b0 > goal2", "success"),
        ("the second place first", "a0 > goal2", "did not bring"),
        ("a missed pick fails*", "miss", "did not bring"),
        ("a miss between", "a0 > goal; miss", "did not bring"),
        ("the other thing moved", "a0 > goal; other", "did not bring"),
        ("9 cm off", "a0 > goal +9cm; b0 > goal2", "success"),
        ("12 cm off", "a0 > goal +12cm", "did not bring"),
        ("only the first", "a0 > goal", "open"),
    )),
    *(("follow_order", None, *case) for case in (
        ("bottom to top", "a0 > goal; b0 > goal2", "success"),
        ("the top first", "b0 > goal2", "did not bring"),
        ("a missed pick fails", "miss", "did not bring"),
        ("beside the stack", "a0 > goal +14cm", "did not bring"),
        ("the first alone", "a0 > goal", "open"),
    )),
    *((task, None, *case) for task in ("same_texture", "same_shape") for case in (
        ("one of two", "a0 > goal", "open"),
        ("both", "a0 > goal; a1 > goal", "success"),
        ("the other first", "a1 > goal; a0 > goal", "success"),
        ("one taken out again*", "a0 > goal; a0 > bare; a1 > goal", "success"),
        ("the odd one in", "d0 > goal_of_a0", "distractor"),
        ("a right one and the odd one", "a0 > goal; d0 > goal_of_a0", "distractor"),
        ("off the table", "nudge a1 > away; a0 > goal", "left the table"),
    )),
    *(("manipulate_old_neighbor", None, *case) for case in (
        ("the first alone", "a0 > goal", "open"),
        ("one, then the other", "a0 > goal; b0 > goal2", "success"),
        ("the neighbour first*", "b0 > goal2", "before the next one"),
        ("another neighbour", "a0 > goal; d0 > goal_of_a0", "distractor"),
        ("the first taken out again*", "a0 > goal; a0 > bare; b0 > goal2", "success"),
        ("a miss between", "a0 > goal; miss; b0 > goal2", "success"),
        ("off the table", "nudge b0 > away; a0 > goal", "left the table"),
    )),
    *(("pick_in_order_then_restore", None, *case) for case in (
        ("in order", "a0 > goal; a0 > goal2; a0 > goal3", "success"),
        ("the second first*", "a0 > goal2", "before the next one"),
        ("not restored", "a0 > goal; a0 > goal2", "open"),
        ("home too soon skips nothing*", "a0 > goal; a0 > home; a0 > goal2; a0 > home", "success"),
        ("by way of free table", "a0 > bare; a0 > goal; a0 > goal2; a0 > goal3", "success"),
        ("6 cm off", "a0 > goal +6cm; a0 > goal2", "before the next one"),
        ("off the table", "nudge a0 > away; miss", "left the table"),
    )),
]  # fmt: skip


@pytest.mark.parametrize(
    ("task", "fits", "sentences", "verdict"),
    [pytest.param(t, f, s, v, id=f"{t}: {what}") for t, f, what, s, v in CASES],
)
def test_the_scorer_says(
    hands: Callable[..., Any], task: str, fits: Callable[[Truth], bool] | None, sentences: str, verdict: str
) -> None:
    hand = hands(task, fits)
    for sentence in sentences.split("; "):
        hand.do(sentence)
    assert verdict in hand.verdict, sentences


def test_every_vima_task_is_in_the_table_or_a_sweep() -> None:
    from wonderful_team.sims.tabletop import task_names

    tried = {task for task, *_ in CASES} | {"sweep_without_exceeding", "sweep_without_touching"}
    assert tried == {name for name in task_names() if "/" not in name}
    assert len(tried) == 17


@pytest.mark.parametrize("task", sorted({task for task, *_ in CASES}))
def test_the_oracle_is_a_success_and_doing_nothing_is_not(hands: Callable[..., Any], task: str) -> None:
    assert hands(task).verdict == "open"
    hand = hands(task, seed=3)
    hand.do("solve")
    assert hand.verdict == "success"
