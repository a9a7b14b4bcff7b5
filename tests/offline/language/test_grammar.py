"""Instructions of every kind, noun phrases, and refusals by name."""

from __future__ import annotations

import pytest

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.description import Description, Related
from wonderful_team.offline.language import Command, describe, render, understand


def _plain(command: Command) -> tuple[object, ...]:
    to = command.to
    where = "" if to is None else " ".join(w for w in (to.how, to.what.text if to.what else "", to.side) if w)
    return command.kind, command.thing.text, where, command.rotate_deg


COMMANDS = {
    "put the red block to the left of the blue bowl": [("put", "red block", "left blue bowl", 0)],
    "Place the star right of the heart": [("put", "star", "right heart", 0)],
    "set the apple on top of the red block": [("put", "apple", "on red block", 0)],
    "Put the red block in front of the bowl": [("put", "red block", "below bowl", 0)],
    "Put the red block behind the bowl": [("put", "red block", "above bowl", 0)],
    "Put the letter G next to the largest block": [("put", "letter G", "near largest block", 0)],
    "put all red blocks into the blue bowl": [("put", "all red blocks", "in blue bowl", 0)],
    "all red blocks into the blue bowl": [("put", "all red blocks", "in blue bowl", 0)],
    "Put two red blocks on the plate": [("put", "2 red blocks", "on plate", 0)],
    "Put the banana in the bowl and the apple on the plate": [
        ("put", "banana", "in bowl", 0),
        ("put", "apple", "on plate", 0),
    ],
    "put the red block and the green star into the bowl": [
        ("put", "red block", "in bowl", 0),
        ("put", "green star", "in bowl", 0),
    ],
    "Stack the red block on the green block on the blue bowl.": [
        ("put", "green block", "on blue bowl", 0),
        ("put", "red block", "on green block", 0),
    ],
    "Push the yellow ball towards the green area": [("push", "yellow ball", "in green area", 0)],
    "slide the star to the right": [("push", "star", "side rightmost", 0)],
    "Rotate the star counterclockwise by 45 degrees": [("rotate", "star", "", -45)],
    "turn the heart ninety degrees anti-clockwise": [("rotate", "heart", "", -90)],
    "Turn the blue heart a quarter turn": [("rotate", "blue heart", "", 90)],
    "give the star half a turn": [("rotate", "star", "", 180)],
    "Turn the heart 90 degrees to the left.": [("rotate", "heart", "", -90)],
    "Put the block on the left into the bowl on the right.": [("put", "leftmost block", "in rightmost bowl", 0)],
    "move the middle block to the top left corner": [("put", "middle block", "side topmost leftmost", 0)],
    "Put the star into the bowl, then put it back": [("put", "star", "in bowl", 0), ("put", "star", "origin", 0)],
    "Put the red block in the bowl to the left of the star": [("put", "red block", "in bowl left of the star", 0)],
    "put the red block left of the bowl into the box": [("put", "red block left of the bowl", "in box", 0)],
    "put the orange on the orange area": [("put", "orange", "on orange area", 0)],
    "sort the blocks into the bowls of the same colour": [("put", "all blocks", "matching bowl", 0)],
}


@pytest.mark.parametrize(("text", "wanted"), COMMANDS.items())
def test_commands(text: str, wanted: list[tuple[object, ...]]) -> None:
    assert [_plain(command) for command in understand(text).commands] == wanted


def test_between_has_two_references() -> None:
    (command,) = understand("put the star between the red block and the blue bowl").commands
    assert command.to is not None
    assert command.to.other is not None
    assert (command.to.how, command.to.other.text) == ("between", "blue bowl")


def test_then_orders_and_and_does_not() -> None:
    first, second = understand("put the star into the bowl, then rotate the heart by 30 degrees").commands
    assert not first.after_last
    assert second.after_last
    assert not understand("put the star into the bowl and rotate the heart by 30 degrees").commands[1].after_last


def test_condition_is_kept() -> None:
    assert understand("Put each fruit on the area of its colour, if there is one.").commands[0].conditional
    assert not understand("Put each fruit on the area of its colour.").commands[0].conditional


PHRASES = {
    "the crimson star": {"colours": ("red",), "shape": "star", "noun": "object"},
    "a dark blue striped bowl": {"colours": ("blue",), "dark": True, "pattern": "striped", "name": "bowl"},
    "the bowl with purple stripes": {"colours": ("purple",), "pattern": "striped", "noun": "container"},
    "the red and yellow polka-dot block": {"colours": ("red", "yellow"), "pattern": "dotted", "noun": "block"},
    "the L-shaped green object": {"shape": "l-shape", "colours": ("green",)},
    "the letter G": {"noun": "letter", "name": "G"},
    "the second red block from the left": {"superlative": "leftmost", "ordinal": 2, "noun": "block"},
    "the rightmost one": {"superlative": "rightmost"},
    "a free area": {"noun": "area", "name": "free"},
    "the {texture1} object": {"like": "texture1", "like_only": "texture"},
    "object shown in {base_obj}": {"like": "base_obj", "like_only": None},
    "the ripe-free banana": None,
    "yellow fruit": {"noun": "fruit", "colours": ("yellow",)},
    "orange": {"noun": "fruit", "name": "orange"},
    "tiger object": {"material": "tiger", "pattern": None},
    "the object with red paisley": {"material": "paisley", "colours": ("red",)},
}


@pytest.mark.parametrize(("words", "wanted"), PHRASES.items())
def test_noun_phrases(words: str, wanted: dict[str, object] | None) -> None:
    if wanted is None:
        with pytest.raises(NotUnderstoodError, match="ripe"):
            describe(words)
        return
    description = describe(words)
    assert {name: getattr(description, name) for name in wanted} == wanted


def test_where_adds_a_relation() -> None:
    description = describe("red block", "left of the blue bowl")
    assert [item.relation for item in description.related] == ["left_of"]
    assert description.related[0].to[0].colours == ("blue",)


@pytest.mark.parametrize(
    "description",
    [
        Description("block", "", colours=("red",), superlative="leftmost", ordinal=3),
        Description("object", "", shape="star", colours=("blue",), dark=True),
        Description("fruit", "", name="banana", related=(Related("left_of", (Description("container", "bowl"),)),)),
        Description("object", "", like="base_obj"),
        Description("object", "", like="texture_2", like_only="texture"),
        Description("letter", "", name="T", pattern="striped", colours=("red", "green")),
        Description("area", "", name="free"),
        Description("object", "", shape="l-shape", colours=("pink",)),
    ],
)
def test_rendered_words_read_back_the_same(description: Description) -> None:
    words = render(description)
    assert render(describe(words)) == words
    back = describe(words)
    assert (back.noun, back.colours, back.shape, back.like) == (
        description.noun,
        description.colours,
        description.shape,
        description.like,
    )


NONSENSE = {
    "put the red mug to the left of the laptop": ("mug", "laptop"),
    "colourless green ideas sleep furiously": ("colourless", "ideas", "sleep", "furiously"),
    "weld the red block to the blue block": ("weld",),
    "Open the drawer": ("drawer",),
    "Pour the water into the glass": ("pour", "water", "glass"),
    "Make me a sandwich": ("sandwich",),
    "asdf qwer zxcv": ("asdf", "qwer", "zxcv"),
    "Do not put the red block into the bowl": ("not",),
    "Put the red block into the bowl unless the moon is full": ("unless", "moon", "full"),
    "Put the fruit in the bowl if the moon exists": ("if", "moon", "exists"),
    "put the {a} into the fridge": ("fridge",),
    "Mettez le bloc rouge dans le bol": ("mettez",),
    "12345 !!": ("12345",),
}


@pytest.mark.parametrize(("text", "unknown"), NONSENSE.items())
def test_unknown_words_are_refused_by_name(text: str, unknown: tuple[str, ...]) -> None:
    with pytest.raises(NotUnderstoodError) as error:
        understand(text)
    message = str(error.value)
    if text[0].isdigit():
        return
    named = message.split("I do not know: ")[1].split(". I know:")[0].split(", ")
    assert set(unknown) <= set(named)
    assert "--model anthropic:" in message


def test_the_refusal_says_what_was_used() -> None:
    with pytest.raises(NotUnderstoodError, match=r"I used: .*red.*to left of.*I do not know: mug, laptop\. I know: "):
        understand("put the red mug to the left of the laptop")


@pytest.mark.parametrize(
    "text", ["red left of put blue", "Put the red", "into the bowl", "the red block", "put", "rotate the star", "blue"]
)
def test_known_words_that_ask_for_nothing_are_refused(text: str) -> None:
    with pytest.raises(NotUnderstoodError, match="do not make an instruction"):
        understand(text)
