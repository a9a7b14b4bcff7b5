"""What the scorers of both sweeps say: exactly so many, never on the line, no stranger; by pushes that are aimed by hand.

Points are given by the frame: (across its opening, out of it) from its middle [m]. A star: seen so on VIMA-Bench's own
simulator, or in its source.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

BEFORE = 0.17
"""In front of the opening [m]."""
EXCEEDING, TOUCHING = "sweep_without_exceeding", "sweep_without_touching"
Way = tuple[tuple[float, float], tuple[float, float]]
IN = {EXCEEDING: ((0.0, BEFORE), (0.0, 0.03)), TOUCHING: ((0.121, BEFORE), (0.121, -0.02))}
"""A way into the zone for one thing."""
IN_TOO = {EXCEEDING: ((0.08, BEFORE), (0.08, 0.03)), TOUCHING: ((-0.121, BEFORE), (-0.121, -0.02))}
OVER = {EXCEEDING: ((0.0, BEFORE), (0.0, -0.05)), TOUCHING: ((0.0, BEFORE), (0.0, 0.0))}
"""A way that ends well, or would, but leads over the line."""


@cache
def wants(exactly: int, at_least: int = 1) -> Callable[[dict[str, Any]], bool]:
    def fits(truth: dict[str, Any]) -> bool:
        (count,) = truth["counts"]
        return count["exactly"] == exactly and len(count["things"]) >= at_least

    return fits


def _push(hand: Any, word: str, way: Way) -> None:
    hand.push(hand.name(word), *(hand.frame(*point) for point in way))


@pytest.fixture(params=[EXCEEDING, TOUCHING])
def task(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def _open_table(hand: Any, words: tuple[str, ...] = ("s1", "s2", "x0", "x1", "x2")) -> None:
    """What is not needed stands far from the ways."""
    count = hand.truth["counts"][0]
    for k, word in enumerate(words):
        kind, number = word[0], int(word[1:])
        if number < len(count["things" if kind == "s" else "strangers"]):
            hand.do(f"nudge {word} > bare")
            hand.world.privileged.nudge(hand.name(word), *(hand.frame(0.06 * (k - 2), 0.5) - hand.at(hand.name(word))))


def test_one_where_one_is_wanted(hands: Callable[..., Any], task: str) -> None:
    hand = hands(task, wants(1))
    _open_table(hand)
    hand.do("miss")
    assert hand.verdict == "open"
    _push(hand, "s0", IN[task])
    assert hand.verdict == "success"


def test_two_where_two_are_wanted_and_one_is_half_right(hands: Callable[..., Any], task: str) -> None:
    hand = hands(task, wants(2))
    _open_table(hand)
    _push(hand, "s0", IN[task])
    assert hand.verdict == "open"
    _push(hand, "s1", IN_TOO[task])
    assert hand.verdict == "success"


def test_what_was_inside_stays_counted(hands: Callable[..., Any], task: str) -> None:
    """* A thing that came in counts, even where it is pushed out again before the next comes in."""
    hand = hands(task, wants(2))
    _open_table(hand)
    _push(hand, "s0", IN[task])
    hand.world.privileged.nudge(hand.name("s0"), *(hand.frame(0.0, 0.4) - hand.at(hand.name("s0"))))
    _push(hand, "s1", IN_TOO[task])
    assert hand.verdict == "success"


def test_two_at_once_where_one_is_wanted(hands: Callable[..., Any], task: str) -> None:
    """* One more than was asked for fails, even where the right number came in by the same push."""
    hand = hands(task, wants(1, at_least=2))
    _open_table(hand)
    end = hand.frame(*IN_TOO[task][1])
    hand.world.privileged.nudge(hand.name("s1"), *(end - hand.at(hand.name("s1"))))
    _push(hand, "s0", IN[task])
    assert "exactly 1 may" in hand.verdict


def test_any_means_one(hands: Callable[..., Any], task: str) -> None:
    hand = hands(task, lambda truth: truth["words"]["number"] == "any")
    assert hand.truth["counts"][0]["exactly"] == 1


def test_all_means_every_one(hands: Callable[..., Any], task: str) -> None:
    hand = hands(task, lambda t: t["words"]["number"] == "all" and len(t["counts"][0]["things"]) > 1)
    assert hand.truth["counts"][0]["exactly"] == len(hand.truth["counts"][0]["things"])


def test_over_the_line_fails_and_stays_failed(hands: Callable[..., Any], task: str) -> None:
    hand = hands(task, wants(1))
    _open_table(hand)
    _push(hand, "s0", OVER[task])
    assert "touched" in hand.verdict
    hand.do("miss")
    assert "touched" in hand.verdict


def test_half_in_is_not_in(hands: Callable[..., Any], task: str) -> None:
    hand = hands(task, wants(1))
    _open_table(hand)
    (start, _), edge = IN[task], {EXCEEDING: 0.101, TOUCHING: 0.086}[task]
    _push(hand, "s0", (start, (start[0], edge)))
    assert hand.verdict == "open"


def test_a_stranger_in_the_zone_fails(hands: Callable[..., Any], task: str) -> None:
    hand = hands(task, wants(1))
    _open_table(hand)
    _push(hand, "x0", IN[task])
    assert "came into the zone" in hand.verdict


def test_a_stranger_may_touch_the_line_but_not_stand_in_the_zone(hands: Callable[..., Any]) -> None:
    """* Only what is to be swept must keep off the line, and strangers are looked for at rest."""
    hand = hands(EXCEEDING, wants(1))
    _open_table(hand)
    _push(hand, "x0", ((0.0, BEFORE), (0.0, -0.062)))
    assert hand.verdict == "open"
    _push(hand, "s0", IN[EXCEEDING])
    assert hand.verdict == "success"


def test_off_the_table_fails_unless_it_was_inside_before(hands: Callable[..., Any], task: str) -> None:
    hand = hands(task, wants(2))
    _open_table(hand)
    _push(hand, "s0", IN[task])
    hand.do("nudge s0 > away")
    hand.do("miss")
    assert hand.verdict == "open", "it counts already"
    hand.do("nudge s1 > away")
    hand.do("miss")
    assert "left the table" in hand.verdict


def test_nothing_after_the_horizon_counts(hands: Callable[..., Any], task: str) -> None:
    hand = hands(task, wants(1))
    _open_table(hand)
    for _ in range(hand.world.horizon):
        hand.do("miss")
    _push(hand, "s0", IN[task])
    assert f"horizon of {hand.world.horizon}" in hand.verdict
