"""The words that a plan of pushes is written in are read back: subgoals by the grammar, places by themselves."""

from __future__ import annotations

import pytest

from wonderful_team.offline.description import Way
from wonderful_team.offline.language import describe, try_understand
from wonderful_team.offline.pushing.sweeping import place_words, read_place


@pytest.mark.parametrize("thing", ["leftmost blue object", "blue checkered object", "second red object from the left"])
@pytest.mark.parametrize("line", ["object shown in {line}", "red line"])
@pytest.mark.parametrize(("words", "name"), [("touching", "off"), ("exceeding", "limit")])
def test_a_push_past_a_line_is_read_back(thing: str, line: str, words: str, name: str) -> None:
    understood = try_understand(f"push the {thing} into the object shown in {{frame}} without {words} the {line}")
    assert understood is not None
    (command,) = understood.commands
    assert command.kind == "push"
    assert command.to is not None
    assert command.to.what is not None
    assert command.to.what.like == "frame"
    assert command.thing.quantity == "one"
    kept = getattr(command, name)
    assert kept is not None
    assert kept.like == "line" or kept.colours == ("red",)
    assert getattr(command, "limit" if name == "off" else "off") is None


@pytest.mark.parametrize(
    ("text", "quantity", "number"),
    [
        ("Sweep any {a} into {b} without exceeding {c}.", "number", 1),
        ("Sweep one {a} into {b} without touching {c}.", "number", 1),
        ("Sweep three {a} into {b} without touching {c}.", "number", 3),
        ("Sweep all {a} into {b} without exceeding {c}.", "all", 1),
    ],
)
def test_how_many_are_swept(text: str, quantity: str, number: int) -> None:
    understood = try_understand(text)
    assert understood is not None
    (command,) = understood.commands
    assert (command.kind, command.thing.quantity, command.thing.number) == ("push", quantity, number)
    assert (command.off is None) != (command.limit is None)


@pytest.mark.parametrize("leg", ["before", "inside", "away"])
@pytest.mark.parametrize("kept", ["off", "limit", "none"])
def test_places_on_a_way_are_read_back(leg: str, kept: str) -> None:
    line = describe("red line")
    way = Way(
        describe("leftmost blue object"),
        describe("object shown in {frame}"),
        leg,  # type: ignore[arg-type]
        line if kept == "off" else None,
        line if kept == "limit" else None,
    )
    words, where, pictures = place_words(way)
    back = read_place(words, where)
    assert back is not None
    assert back.way is not None
    assert back.way.leg == leg
    assert pictures == ("frame",)
    assert (back.way.off is None, back.way.limit is None) == (kept != "off", kept != "limit")
    assert back.way.into.like == "frame"
    assert back.way.thing.superlative == "leftmost"


def test_other_areas_are_no_places_on_a_way() -> None:
    assert read_place("free area", "left of the blue bowl") is None
    assert read_place("red area", "") is None
