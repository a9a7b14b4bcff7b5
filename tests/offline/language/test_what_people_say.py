"""Plain sentences come to what other words for the same come to; what was said is in the reading or the text is refused."""

from __future__ import annotations

import pytest

from tests.offline.language.scenes import told
from tests.offline.language.wordings import gist
from wonderful_team.errors import NotUnderstoodError
from wonderful_team.evals.perturb import PHRASES
from wonderful_team.offline.language import understand
from wonderful_team.sims.tabletop import task_names

SAME = [
    ("Please stack the red block on top of the green one.", "put the red block on the green block"),
    (
        "The yellow star goes into the red bowl and the blue one into the green one.",
        "put the yellow star into the red bowl and the blue star into the green bowl",
    ),
    ("Put all the blocks in the box, but leave out the red one.", "put all blocks except the red block into the box"),
    ("With the exception of the red block, put the blocks in the box.", "put all blocks except the red block into the box"),
    ("Everything that's a fruit goes in the bowl, but not the banana.", "put all fruits except the banana into the bowl"),
    ("Swap the red and yellow blocks.", "swap the red block and the yellow block"),
    ("Turn the blue square to the left by 90 degrees.", "rotate the blue square by 90 degrees counterclockwise"),
    ("The smallest of the blocks should be on the purple patch.", "put the smallest block onto the purple area"),
    ("Of the apples, put the leftmost into the bowl.", "put the leftmost apple into the bowl"),
    ("The pear should end up on the plum's right.", "put the pear to the right of the plum"),
    ("Which red block is left of the bowl? Put that one into the box.", "put the red block left of the bowl into the box"),
    ("Relocate the yellow block: it belongs left of the bowl.", "put the yellow block to the left of the bowl"),
    ("Once the lemon is in the bowl, move the lime to the box.", "put the lemon into the bowl, then put the lime into the box"),
    ("Shift the red block into the corner at the top left.", "put the red block in the top left corner"),
    (
        "Stack the block that is left of the bowl on the block that is right of the bowl.",
        "put the block left of the bowl onto the block right of the bowl",
    ),
    ("Take the red block that is to the left of the bowl and place it in the box.", "put the red block left of the bowl into the box"),
    ("On top of the orange block, put the purple one.", "put the purple block onto the orange block"),
    ("Cover the light green square with the dark blue one.", "put the dark blue square onto the light green square"),
    ("Nudge the green block to the left, please.", "push the green block to the left"),
    ("The pear in the bowl and the plum on the plate, please.", "put the pear into the bowl, put the plum onto the plate"),
    ("Carefully lower the green block into the red bowl and let go.", "put the green block into the red bowl"),
    ("Centre the green ring between the red and the blue block.", "put the green ring between the red block and the blue block"),
    ("Drop the green block off in the red bowl.", "put the green block into the red bowl"),
    ("The red bowl should end up holding the green block.", "put the green block into the red bowl"),
    ("Bottom left corner is where the red star goes.", "put the red star in the bottom left corner"),
    ("Make a small tower with the green block at the bottom and the blue block on top.", "put the blue block on the green block"),
    ("Tidy away the red blocks: they all live in the white box.", "put all red blocks into the white box"),
    ("Put the red block where the blue star is now, and vice versa.", "swap the red block and the blue star"),
    ("Put one pink block into the blue frame.", "put one of the pink blocks into the blue frame"),
    ("Push two red blocks into the frame; going over the line is not allowed.", "push two red blocks into the frame without exceeding the line"),
    ("Get two red blocks into the frame, but keep off the line.", "push two red blocks into the frame without touching the line"),
    ("Put the red block on the round plate.", "put the red block onto the circular plate"),
    ("Both the red and the green block belong on the blue area.", "put the red block and the green block onto the blue area"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "plain"), SAME)
def test_read_as_plain_words_are(text: str, plain: str) -> None:
    assert gist(understand(text)) == gist(understand(plain))


BEYOND = "superhero_companions/"
"""Its words are beyond the grammar, which says so."""


@pytest.mark.parametrize("level", PHRASES)
@pytest.mark.parametrize(
    "task", sorted(name for name in task_names() if not name.startswith(("test/", "mine/", BEYOND)))
)
def test_sentences_round_an_instruction_change_nothing(task: str, level: int) -> None:
    scene = told(task, 0)
    assert gist(scene.read(PHRASES[level].format(text=scene.instruction))) == gist(scene.read(scene.instruction))


def test_that_no_more_is_to_be_done_is_kept() -> None:
    assert understand(PHRASES[3].format(text="put the red block into the bowl")).nothing_else


@pytest.mark.parametrize(
    "aside",
    [
        "There is a mug on the table.",
        "You should fold this.",
        "Do not break anything.",
        "Fold towels.",
        "I want all of it in the sink.",
        "This is not the task.",
        "If it rains, do this.",
    ],
)
def test_a_sentence_that_asks_for_something_unknown_is_never_passed_over(aside: str) -> None:
    with pytest.raises(NotUnderstoodError, match="I do not know"):
        understand(f"{aside} Put the red block into the blue bowl.")


@pytest.mark.parametrize("text", ["Take the block that lies between the star and the heart and put it in the bowl.",
                                  "There is a block between the star and the heart. Put it into the bowl."])  # fmt: skip
def test_where_a_thing_stands_is_no_place_to_put_it(text: str) -> None:
    (command,) = understand(text).commands
    assert [related.relation for related in command.thing.related] == ["between"]
    assert command.to is not None
    assert command.to.how == "in"


def test_two_moves_that_are_a_swap_are_read_as_one() -> None:
    swap = gist(understand("swap the apple and the pear"))
    assert gist(understand("The apple goes where the pear is and the pear goes where the apple is.")) == swap
    with pytest.raises(NotUnderstoodError, match="not clear"):
        understand("The apple goes where the pear is and the lime goes where the apple is.")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("Empty the red bowl into the box.", "I do not know: to empty"),
        ("Move the red block to the left and keep away from the bowl.", "what must be kept off"),
        ("Rotate the red block by 30 degrees and avoid the bowl.", "what must be kept off"),
    ],
)
def test_a_verb_or_a_constraint_that_finds_no_place_is_refused(text: str, said: str) -> None:
    with pytest.raises(NotUnderstoodError, match=said):
        understand(text)


def test_one_of_two_is_one() -> None:
    (command,) = understand("Put one of the two red blocks into the bowl.").commands
    assert (command.thing.quantity, command.thing.number) == ("number", 1)


@pytest.mark.parametrize("text", ["Put both red blocks into the bowl.", "Both of the red blocks go into the bowl."])
def test_both_means_two(text: str) -> None:
    (command,) = understand(text).commands
    assert (command.thing.quantity, command.thing.number) == ("all", 2)


def test_a_refusal_is_short_and_says_where_the_words_are_listed() -> None:
    with pytest.raises(NotUnderstoodError) as refused:
        understand("put the trianlge into the gorkbox")
    assert len(str(refused.value)) < 350
    assert "I know: triangle" in str(refused.value)
    assert "wonderful-team list words" in str(refused.value)
