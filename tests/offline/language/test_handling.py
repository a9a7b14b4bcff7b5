"""Figures that are drawn, wiping, shaking and opening, in words of different people: each sentence was written before the reader was tried on it."""

from __future__ import annotations

import pytest

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.language import understand
from wonderful_team.offline.language.vocabulary import FIGURES

_SAID = {
    ("trace", "star", 5, "green area"): """
        draw a five-pointed star on the green paper
        please draw a star on the green sheet of paper
        take the pen and draw a star on the green paper
        I would like you to draw a five pointed star on the green paper with the pen
    """,
    ("trace", "star", 6, "yellow area"): """
        sketch a star with six points on the yellow paper
    """,
    ("trace", "triangle", 0, "area"): """
        trace a triangle on the paper with the pen
    """,
    ("trace", "circle", 0, "pink area"): """
        with the pen, draw a circle on the pink paper
    """,
    ("trace", "square", 0, "orange area"): """
        Could you sketch a square onto the orange sheet?
    """,
    ("trace", "spiral", 0, "cyan area"): """
        use the pen to draw a spiral on the cyan paper
    """,
    ("trace", "zigzag", 0, "green area"): """
        draw a zigzag on the green paper
    """,
    ("trace", "line", 0, "green area"): """
        draw a straight line on the green paper
    """,
    ("trace", "hexagon", 0, "red area"): """
        trace out a hexagon on the red paper
    """,
    ("trace", "star", 7, "blue area"): """
        draw a 7-pointed star in the blue area
    """,
    ("trace", "circle", 0, "green area"): """
        on the green paper, draw a small circle
    """,
    ("trace", "pentagon", 0, "leftmost area"): """
        draw a pentagon on the leftmost paper
    """,
    ("trace", "area", 0, "red plate"): """
        wipe the red plate with the sponge
        clean the red plate with the sponge in your gripper
        wipe down the red plate
        give the red plate a wipe
        scrub the red plate thoroughly
        using the sponge, wipe the red plate
        take the sponge and wipe the red plate
        wipe the whole surface of the red plate
        polish the red plate
    """,
    ("trace", "area", 0, "plate"): """
        scrub the plate
        give the plate a thorough wipe
    """,
    ("trace", "area", 0, "dish"): """
        clean the dish
    """,
    ("trace", "area", 0, "green plate"): """
        please wipe the green plate clean
    """,
    ("trace", "area", 0, "blue bowl"): """
        clean the blue bowl
    """,
    ("shake", "shake", 0, "red bottle"): """
        shake the red bottle
        give the red bottle a shake
        give the red bottle a good, firm shake
        pick up the red bottle and shake it
        shake the red bottle up and down, then put it back
        shake the red bottle and put it back where it was
        please shake up the red bottle well
        lift the red bottle, shake it and put it down again
    """,
    ("shake", "shake", 0, "green block"): """
        shake the green block
    """,
    ("shake", "shake", 0, "leftmost bottle"): """
        shake the bottle on the left
    """,
    ("open", "", 0, "red bottle"): """
        open the red bottle
        unscrew the red bottle
        unscrew the cap of the red bottle
        take the cap off the red bottle
        remove the cap from the red bottle
        twist off the cap of the red bottle
        could you please open the red bottle for me
        uncap the red bottle
    """,
    ("open", "", 0, "box"): """
        take the lid off the box
        remove the lid from the box
        open the box
    """,
}
"""What sentences come to (kind of command, figure, its count, the thing), and the sentences, one a line."""
ROWS = [(*meant, text.strip()) for meant, texts in _SAID.items() for text in texts.strip().splitlines()]


@pytest.mark.parametrize(("kind", "figure", "count", "thing", "text"), ROWS, ids=[row[-1] for row in ROWS])
def test_what_is_done_to_a_thing_where_it_is(kind: str, figure: str, count: int, thing: str, text: str) -> None:
    (command,) = understand(text).commands
    found = (command.figure.name, command.figure.count) if command.figure is not None else ("", 0)
    assert (command.kind, *found, command.thing.text) == (kind, figure, count, thing)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("draw a heart on the paper", "one figure at a time: star, triangle"),
        ("draw two stars on the paper", "one figure at a time"),
        ("draw a red star on the paper", "what 'red' is for"),
        ("draw a star with 12 points on the paper", "3 to 9 tips, not 12"),
        ("draw a triangle with four corners on the paper", "a triangle has no 4 corners"),
        ("shake the bottle 20 times", "at most 9 times"),
        ("rotate the block by 30 degrees 3 times", "3 times"),
        ("draw a star on the paper with the pen and the sponge", "which tool is meant"),
    ],
)
def test_what_cannot_be_led_along_is_refused_by_name(text: str, said: str) -> None:
    with pytest.raises(NotUnderstoodError, match=said):
        understand(text)


@pytest.mark.parametrize("verb", ["wipe", "sweep"])
def test_wiping_things_to_a_place_is_pushing_them_there(verb: str) -> None:
    (command,) = understand(f"{verb} the red blocks into the box").commands
    assert (command.kind, command.figure) == ("push", None)


def test_what_is_done_to_things_joins_other_commands() -> None:
    drawn, put = understand("draw a star on the green paper, then put the red block into the bowl").commands
    assert (drawn.kind, put.kind, put.after_last) == ("trace", "put", True)
    opened, put = understand("Open the box and put the red block in it.").commands
    assert put.to is not None
    assert (opened.kind, put.to.what) == ("open", opened.thing)


def test_a_tool_is_what_leads_and_not_what_is_led_over() -> None:
    for text in ("wipe the red plate with the sponge", "take the sponge and wipe the red plate"):
        (command,) = understand(text).commands
        assert command.tool is not None
        assert (command.tool.name, command.thing.text) == ("sponge", "red plate")


@pytest.mark.parametrize("figure", FIGURES)
def test_every_figure_has_words(figure: str) -> None:
    (command,) = understand(f"draw a {figure} on the paper").commands
    assert command.figure is not None
    assert command.figure.name == figure
