"""Instructions in other orders of words: light verbs, pronouns, towers, swaps, exceptions, reasons, what must stay."""

from __future__ import annotations

import pytest

from wonderful_team.errors import NotUnderstoodError
from wonderful_team.offline.language import Command, understand


def _told(command: Command) -> str:
    to = command.to
    where = "" if to is None else " > " + " ".join(w for w in (to.how, to.what.text if to.what else "", to.side) if w)
    turn = f" {command.rotate_deg:g}" if command.kind == "rotate" else ""
    return f"{command.kind} {command.thing.text}{where}{turn}"


TURNS = {
    "Give the star a clockwise turn of 90 degrees.": ["rotate star 90"],
    "Make the star point the other way.": ["rotate star 180"],
    "Turn the heart around so that it faces the other way.": ["rotate heart 180"],
    "Let the star do a quarter turn counterclockwise.": ["rotate star -90"],
    "Rotate the heart by a third of a turn.": ["rotate heart 120"],
    "Rotate the star by 30 degrees and the heart by that much.": ["rotate star 30", "rotate heart 30"],
    "Turn the red star counter-clockwise; forty five degrees is enough.": ["rotate red star -45"],
    "A turn of 60 degrees clockwise is needed for the star.": ["rotate star 60"],
    "Rotate the star by -30 degrees.": ["rotate star -30"],
    "Rotate the star 60 degrees to the left.": ["rotate star -60"],
}
MOVES = {
    "The red block belongs in the blue bowl. Please put it there.": ["put red block > in blue bowl"],
    "The blue bowl is where the red block belongs.": ["put red block > in blue bowl"],
    "The place of the red block is the blue bowl.": ["put red block > in blue bowl"],
    "You see a red block and a blue bowl. Put the former into the latter.": ["put red block > in blue bowl"],
    "On the plate goes the banana.": ["put banana > on plate"],
    "Put the red block into the blue bowl because the cat wants it.": ["put red block > in blue bowl"],
    "Since dinner is ready, put the apple on the plate.": ["put apple > on plate"],
    "Put the lime on the green area.": ["put lime > on green area"],
    "Remove the red block from the bowl.": ["put red block inside the bowl > in free area"],
    "Take the red block out of the bowl and put it on the plate.": ["put red block inside the bowl > on plate"],
    "Put the star between the two bowls.": ["put star > between leftmost bowl"],
    "Put the third block from the left into the bowl.": ["put third block from the left > in bowl"],
    "Before you put the heart in the bowl, rotate the star by 30 degrees.": ["rotate star 30", "put heart > in bowl"],
    "Place the apple and the lime on the red area and the green area respectively.": [
        "put apple > on red area",
        "put lime > on green area",
    ],
    "Put the red, green and blue blocks into the bowl.": [
        "put all red blocks > in bowl",
        "put all green blocks > in bowl",
        "put all blue blocks > in bowl",
    ],
    "Put the red and the green block into the bowl.": ["put red block > in bowl", "put green block > in bowl"],
    "Build a tower of the red block on the green block on the blue block.": [
        "put green block > on blue block",
        "put red block > on green block",
    ],
    "Build a tower with the blue block at the bottom, the green block in the middle and the red block on top.": [
        "put green block > on blue block",
        "put red block > on green block",
    ],
    "Swap the red block with the blue star.": [
        "put red block > in free area",
        "put blue star > origin red block",
        "put red block > origin blue star",
    ],
    "Put the star into the red bowl, then into the blue bowl, then restore it to where it was.": [
        "put star > in red bowl",
        "put star > in blue bowl",
        "put star > origin",
    ],
    "First put {a} into {b} then put the object that was previously at its north into the same {b}.": [
        "put object shown in {a} > in object shown in {b}",
        "put object above the object shown in {a} nearest to the object shown in {a} > in object shown in {b}",
    ],
}


@pytest.mark.parametrize(("text", "wanted"), (TURNS | MOVES).items())
def test_read_the_same(text: str, wanted: list[str]) -> None:
    assert [_told(command) for command in understand(text).commands] == wanted


MATCHING = """
The fruits should go to the regions whose colour matches theirs.
Sort the fruits onto the areas accordingly.
Place the fruits in the areas according to their colours.
Where an area has the same colour as a fruit, put the fruit there.
If a fruit has the same colour as an area, move it to that area.
Fruits whose colour matches an area go onto that area, the rest stay where they are.
Put each fruit in the area with its colour and do not touch anything else.
Bring together fruits and areas that have the same colour.
"""


@pytest.mark.parametrize("text", MATCHING.strip().splitlines())
def test_each_to_its_colour_however_it_is_put(text: str) -> None:
    (command,) = understand(text).commands
    assert command.to is not None
    assert command.thing.quantity in ("each", "all")
    assert (command.thing.noun, command.to.how, command.to.aspect) == ("fruit", "matching", "colour")


@pytest.mark.parametrize(
    ("text", "left_out"),
    [
        ("Put all blocks except the red one into the bowl.", ("red block",)),
        ("Put every fruit but not the banana on the plate.", ("banana",)),
        ("The blocks, apart from the blue one, go into the bowl.", ("blue block",)),
        ("Put all fruits but the lime into the bowl.", ("lime",)),
    ],
)
def test_exceptions_are_kept(text: str, left_out: tuple[str, ...]) -> None:
    (command,) = understand(text).commands
    assert tuple(item.text for item in command.thing.excluded) == left_out


@pytest.mark.parametrize(
    "text",
    [
        "Put the red block into the blue bowl and do nothing else.",
        "Only move the red block into the blue bowl.",
        "Put the red block into the blue bowl without touching the other things.",
    ],
)
def test_nothing_else_may_be_moved(text: str) -> None:
    read = understand(text)
    assert [_told(command) for command in read.commands] == ["put red block > in blue bowl"]
    assert read.nothing_else


def test_a_thing_that_must_stay_is_kept_in_mind() -> None:
    read = understand("Put each fruit in its area but do not move the banana.")
    assert [item.text for item in read.spared] == ["banana"]


@pytest.mark.parametrize(
    ("text", "missing"),
    [
        ("Put the red into.", "red"),
        ("Put the red block.", "not said where"),
        ("Rotate the star.", "by how much"),
        ("Stack the red block.", "at least two things"),
        ("Place the apple and the lime on the red area respectively.", "respectively"),
    ],
)
def test_incomplete_commands_say_what_is_missing(text: str, missing: str) -> None:
    with pytest.raises(NotUnderstoodError, match=f"I used: .*I do not know: .*{missing}.*I understand: "):
        understand(text)


@pytest.mark.parametrize(
    ("text", "unknown"),
    [
        ("Do not put the red block into the bowl.", "not"),
        ("Move the red block a little to the left.", "slightly"),
        ("Move the red block 10 cm to the left.", "cm"),
        ("Rotate the star by 30 degrees twice.", "twice"),
    ],
)
def test_words_that_change_the_meaning_are_refused(text: str, unknown: str) -> None:
    with pytest.raises(NotUnderstoodError, match=f"I do not know: [^.]*{unknown}"):
        understand(text)
